// OFF, ascii, with the usual variants (COFF, NOFF, STOFF …: the extra numbers of a vertex are passed over).
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/mesh_readers.h"
#include "solver/mesh/text_scanner.h"

namespace sinew::solver {

SurfaceMesh read_off(std::string_view bytes, const std::string& file) {
    TextScanner text(bytes, file);
    const std::string_view magic = text.word();
    if (magic.size() < 3 || magic.substr(magic.size() - 3) != "OFF") text.fail("the file does not begin with OFF");
    const std::string_view kind = magic.substr(0, magic.size() - 3);
    if (kind.find('4') != std::string_view::npos || kind.find('n') != std::string_view::npos)
        text.fail("'" + printable(magic) + "' has points that are not three-dimensional");
    if (text.peek() == "BINARY") text.fail("binary OFF cannot be read; save it as ascii");
    const std::size_t vertex_count = text.count("the number of vertices");
    const std::size_t face_count = text.count("the number of faces");
    text.integer("the number of edges");

    Points points;
    points.reserve(vertex_count);
    for (std::size_t i = 0; i < vertex_count; ++i) {
        Vec3 p;
        for (int d = 0; d < 3; ++d) p[d] = text.number("a coordinate of vertex " + std::to_string(i));
        points.push_back(p);
        while (!text.word_on_line().empty()) {
        } // normal, colour, texture
    }
    std::vector<int> sizes, corners;
    sizes.reserve(face_count);
    for (std::size_t f = 0; f < face_count; ++f) {
        const std::size_t size = text.count("the size of face " + std::to_string(f));
        if (size < 3)
            text.fail("face " + std::to_string(f) + " has " + std::to_string(size) +
                      " corners; it needs at least three");
        sizes.push_back(static_cast<int>(size));
        for (std::size_t k = 0; k < size; ++k) {
            const long long v = text.integer("a vertex number of face " + std::to_string(f));
            if (v < 0 || v >= static_cast<long long>(vertex_count))
                text.fail("face " + std::to_string(f) + " uses vertex " + std::to_string(v) + " of " +
                          std::to_string(vertex_count));
            corners.push_back(static_cast<int>(v));
        }
        while (!text.word_on_line().empty()) {
        } // colour
    }
    return finish_surface(file, std::move(points), std::move(sizes), std::move(corners));
}

} // namespace sinew::solver
