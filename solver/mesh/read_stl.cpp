// STL, ascii and binary. Corners at exactly the same place become one vertex.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/corner_welder.h"
#include "solver/mesh/mesh_readers.h"
#include "solver/mesh/text_scanner.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace sinew::solver {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is read without swapping bytes");

constexpr std::size_t header_bytes = 84, record_bytes = 50;

SurfaceMesh finish(const std::string& file, CornerWelder& welder, const std::vector<int>& corners) {
    return finish_surface(file, std::move(welder.points), std::vector<int>(corners.size() / 3, 3), corners);
}

SurfaceMesh read_binary(std::string_view bytes, std::size_t count, const std::string& file) {
    CornerWelder welder;
    std::vector<int> corners;
    corners.reserve(3 * count);
    for (std::size_t t = 0; t < count; ++t) {
        float numbers[12]; // normal, then three corners
        std::memcpy(numbers, bytes.data() + header_bytes + t * record_bytes, sizeof numbers);
        for (int c = 1; c < 4; ++c) {
            const Vec3 p(numbers[3 * c], numbers[3 * c + 1], numbers[3 * c + 2]);
            if (!p.allFinite())
                throw Error("FE202", file + ": a corner of triangle " + std::to_string(t) + " is not finite");
            corners.push_back(welder.add(p));
        }
    }
    return finish(file, welder, corners);
}

SurfaceMesh read_ascii(std::string_view bytes, const std::string& file) {
    TextScanner text(bytes, file, 0);
    const auto expect = [&](std::string_view word) {
        if (const std::string_view found = text.word(); found != word)
            text.fail("'" + printable(found) + "' stands where '" + std::string(word) + "' should");
    };
    CornerWelder welder;
    std::vector<int> corners;
    while (!text.at_end()) {
        expect("solid");
        text.rest_of_line(); // its name
        while (text.peek() == "facet") {
            expect("facet");
            expect("normal");
            for (int d = 0; d < 3; ++d) text.word(); // often wrong or NaN; the corners tell the side
            expect("outer");
            expect("loop");
            for (int c = 0; c < 3; ++c) {
                expect("vertex");
                Vec3 p;
                for (int d = 0; d < 3; ++d)
                    p[d] = text.number("a coordinate of triangle " + std::to_string(corners.size() / 3));
                corners.push_back(welder.add(p));
            }
            expect("endloop");
            expect("endfacet");
        }
        expect("endsolid");
        text.rest_of_line();
    }
    return finish(file, welder, corners);
}

} // namespace

SurfaceMesh read_stl(std::string_view bytes, const std::string& file) {
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
    // Some binary files begin with "solid" too, so the size decides first.
    std::uint32_t count = 0;
    if (bytes.size() >= header_bytes) std::memcpy(&count, bytes.data() + 80, sizeof count);
    if (bytes.size() >= header_bytes && bytes.size() == header_bytes + std::size_t{count} * record_bytes)
        return read_binary(bytes, count, file);
    if (bytes.substr(0, 5) == "solid" && bytes.find('\0') == std::string_view::npos) return read_ascii(bytes, file);
    if (bytes.size() < header_bytes)
        throw Error("IO403", file + ":1: " + std::to_string(bytes.size()) +
                                 " bytes are neither a binary STL file (84 and more) nor an ascii one ('solid ...')");
    if (bytes.size() > header_bytes + std::size_t{count} * record_bytes && count > 0 && bytes.substr(0, 5) != "solid")
        return read_binary(bytes, count, file); // writers that pad the end
    throw Error("IO403", file + ": byte 80: " + std::to_string(count) + " triangles announced, but " +
                             std::to_string(bytes.size()) + " bytes hold " +
                             std::to_string((bytes.size() - header_bytes) / record_bytes));
}

} // namespace sinew::solver
