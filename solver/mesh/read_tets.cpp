// Tet mesh files: Medit .mesh and legacy VTK, both ascii.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/mesh_readers.h"
#include "solver/mesh/text_scanner.h"

#include <algorithm>
#include <cctype>

namespace sinew::solver {
namespace {

bool is_word(std::string_view w) { return !w.empty() && std::isalpha(static_cast<unsigned char>(w[0])); }

bool same_word(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

int vertex(TextScanner& text, long long number, long long first, const std::string& owner) {
    if (number < first || number - first > 2147483646)
        text.fail(owner + " uses vertex " + std::to_string(number) + "; numbers begin at " + std::to_string(first));
    return static_cast<int>(number - first);
}

/// A vertex that the file does not have, in the file's own numbers. Files without vertices are refused later.
void require_vertex(int v, std::size_t count, int first, const std::string& owner, const std::string& file, int line) {
    if (count == 0 || static_cast<std::size_t>(v) < count) return;
    throw Error("FE203", file + ":" + std::to_string(line) + ": " + owner + " uses vertex " +
                             std::to_string(static_cast<long long>(v) + first) + "; the file has " +
                             std::to_string(count) + " vertices, numbered from " + std::to_string(first));
}

Vec3 read_point(TextScanner& text, std::size_t i) {
    Vec3 p;
    for (int d = 0; d < 3; ++d) p[d] = text.number("a coordinate of vertex " + std::to_string(i));
    return p;
}

} // namespace

TetMesh read_medit(std::string_view bytes, const std::string& file) {
    TextScanner text(bytes, file);
    if (!same_word(text.word(), "MeshVersionFormatted"))
        text.fail("the file does not begin with MeshVersionFormatted; binary Medit files cannot be read");
    text.integer("the version");
    Points vertices;
    std::vector<Tet> tets;
    std::vector<int> lines; // of the tets
    bool has_end = false;
    while (!text.at_end() && !has_end) {
        const std::string_view keyword = text.word();
        if (!is_word(keyword)) text.fail("'" + printable(keyword) + "' stands where a keyword should");
        if (same_word(keyword, "Dimension")) {
            if (const long long dimension = text.integer("the dimension"); dimension != 3)
                text.fail("the mesh has dimension " + std::to_string(dimension) + ", not 3");
        } else if (same_word(keyword, "Vertices")) {
            const std::size_t count = text.count("the number of vertices");
            vertices.reserve(count);
            for (std::size_t i = 0; i < count; ++i) {
                vertices.push_back(read_point(text, i));
                text.number("the reference of vertex " + std::to_string(i));
            }
        } else if (same_word(keyword, "Tetrahedra")) {
            const std::size_t count = text.count("the number of tetrahedra");
            tets.reserve(count);
            for (std::size_t t = 0; t < count; ++t) {
                const std::string owner = "tet " + std::to_string(t);
                Tet tet;
                for (int& v : tet) v = vertex(text, text.integer("a vertex number of " + owner), 1, owner);
                text.integer("the reference of " + owner);
                lines.push_back(text.line());
                tets.push_back(tet);
            }
        } else if (same_word(keyword, "Hexahedra") || same_word(keyword, "TetrahedraP2")) {
            text.fail(printable(keyword) + " cannot be used; only linear tetrahedra can");
        } else if (same_word(keyword, "End")) {
            has_end = true;
        } else {
            // Triangles, edges, corners, solutions …: numbers up to the next keyword.
            while (!text.at_end() && !is_word(text.peek())) text.number("a number of " + printable(keyword));
        }
    }
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (const int v : tets[t]) require_vertex(v, vertices.size(), 1, "tet " + std::to_string(t), file, lines[t]);
    return finish_tets(file, std::move(vertices), std::move(tets));
}

namespace {

/// The cells of a legacy VTK file before their types are known.
struct VtkCells {
    std::vector<std::size_t> first{0}; ///< where each cell begins in `corners`, and the end
    std::vector<int> corners;
    std::vector<int> lines; ///< of the corners
    std::size_t count() const { return first.size() - 1; }
    void add(TextScanner& text, const std::string& owner) {
        corners.push_back(vertex(text, text.integer("a vertex number of " + owner), 0, owner));
        lines.push_back(text.line());
    }
};

/// From CELL_DATA on: the share of each cell that is solid, as write_vtk puts it (or a program that has turned
/// SCALARS into a FIELD array since); other data is passed over. Empty if there is none. Stops before POINT_DATA.
std::vector<double> read_coverage(TextScanner& text, const std::vector<long long>& types) {
    constexpr long long tet = 10;
    const std::size_t count = text.count("the number of cells with data");
    std::vector<double> coverage;
    bool in_field = false;
    while (!text.at_end() && !same_word(text.peek(), "POINT_DATA") && !same_word(text.peek(), "CELL_DATA")) {
        const std::string_view word = text.word();
        bool begins = false;
        if (same_word(word, "FIELD")) {
            in_field = true;
        } else if (same_word(word, "SCALARS")) {
            in_field = false;
            const bool named = same_word(text.word(), "coverage");
            text.word_on_line(); // the type
            const std::string_view components = text.word_on_line();
            begins = named && (components.empty() || components == "1");
            if (same_word(text.peek(), "LOOKUP_TABLE")) text.word(), text.word();
        } else if (in_field && same_word(word, "coverage")) {
            const bool fits = text.word() == "1" && text.word() == std::to_string(count);
            text.word(); // the type
            begins = fits;
        }
        if (!begins) continue;
        if (count != types.size())
            text.fail("coverage of " + std::to_string(count) + " cells for " + std::to_string(types.size()) + " cells");
        coverage.clear();
        for (std::size_t c = 0; c < count; ++c) {
            const double share = text.number("the coverage of cell " + std::to_string(c));
            if (types[c] == tet && !(share > 0 && share <= 1))
                text.fail("the coverage of cell " + std::to_string(c) + " is " + std::to_string(share) +
                          "; it must be above 0 and at most 1");
            coverage.push_back(share);
        }
    }
    return coverage;
}

/// Up to version 4: "CELLS n size", each cell its size and its vertices.
void read_counted_cells(TextScanner& text, std::size_t count, std::size_t size, VtkCells& cells) {
    std::size_t used = 0;
    for (std::size_t c = 0; c < count; ++c) {
        const std::string owner = "cell " + std::to_string(c);
        const std::size_t corners = text.count("the size of " + owner);
        for (std::size_t k = 0; k < corners; ++k) cells.add(text, owner);
        cells.first.push_back(cells.corners.size());
        used += corners + 1;
    }
    if (used != size) text.fail("CELLS announces " + std::to_string(size) + " numbers but has " + std::to_string(used));
}

/// From version 5: "CELLS offsets corners", then the two arrays.
void read_offset_cells(TextScanner& text, std::size_t offsets, std::size_t size, VtkCells& cells) {
    if (!same_word(text.word(), "OFFSETS")) text.fail("OFFSETS was expected behind CELLS");
    text.word(); // the type
    cells.first.clear();
    for (std::size_t i = 0; i < offsets; ++i) {
        const long long offset = text.integer("a cell offset");
        const long long before = i == 0 ? 0 : static_cast<long long>(cells.first.back());
        if (offset < before || offset > static_cast<long long>(size) || (i == 0 && offset != 0) ||
            (i + 1 == offsets && offset != static_cast<long long>(size)))
            text.fail("cell offset " + std::to_string(offset) + " does not fit between " + std::to_string(before) +
                      " and " + std::to_string(size));
        cells.first.push_back(static_cast<std::size_t>(offset));
    }
    if (cells.first.empty()) cells.first.push_back(0);
    if (!same_word(text.word(), "CONNECTIVITY")) text.fail("CONNECTIVITY was expected behind OFFSETS");
    text.word();
    for (std::size_t k = 0; k < size; ++k) cells.add(text, "the cells");
}

TetMesh tets_of(TextScanner& text, const std::string& file, Points vertices, const VtkCells& cells,
                const std::vector<long long>& types, const std::vector<double>& cell_coverage) {
    std::vector<Tet> tets;
    std::vector<double> coverage;
    for (std::size_t c = 0; c < cells.count(); ++c) {
        const std::size_t first = cells.first[c], size = cells.first[c + 1] - first;
        const long long type = types[c];
        if (type == 10 && size == 4) {
            for (std::size_t k = first; k < first + 4; ++k)
                require_vertex(cells.corners[k], vertices.size(), 0, "cell " + std::to_string(c), file, cells.lines[k]);
            if (!cell_coverage.empty()) coverage.push_back(cell_coverage[c]);
            tets.push_back(
                {cells.corners[first], cells.corners[first + 1], cells.corners[first + 2], cells.corners[first + 3]});
        } else if (type == 10) {
            text.fail("cell " + std::to_string(c) + " is a tet with " + std::to_string(size) + " vertices");
        } else if (type > 10 && type != 21 && type != 22 && type != 23) {
            text.fail("cell " + std::to_string(c) + " has type " + std::to_string(type) +
                      "; only linear tetrahedra (10) can be used");
        }
        // Types below 10 and quadratic edges and faces (21 to 23) are points, lines and faces: the tets stand
        // alone.
    }
    return finish_tets(file, std::move(vertices), std::move(tets), std::move(coverage));
}

} // namespace

TetMesh read_vtk(std::string_view bytes, const std::string& file) {
    TextScanner text(bytes, file, 0);
    if (text.rest_of_line().substr(0, 22) != "# vtk DataFile Version")
        text.fail("the file does not begin with '# vtk DataFile Version'; XML files (.vtu) cannot be read");
    text.rest_of_line(); // title
    const std::string_view encoding = text.word();
    if (!same_word(encoding, "ASCII"))
        text.fail("the file is '" + printable(encoding) + "', not ASCII; save it as ascii");
    if (!same_word(text.word(), "DATASET") || !same_word(text.word(), "UNSTRUCTURED_GRID"))
        text.fail("DATASET UNSTRUCTURED_GRID was expected");

    Points vertices;
    VtkCells cells;
    std::vector<long long> types;
    std::vector<double> coverage;
    bool has_types = false; // their count alone does not tell: both may be none
    while (!text.at_end()) {
        const std::string_view keyword = text.word();
        if (same_word(keyword, "POINTS")) {
            const std::size_t count = text.count("the number of points");
            text.word(); // the type
            vertices.reserve(count);
            for (std::size_t i = 0; i < count; ++i) vertices.push_back(read_point(text, i));
        } else if (same_word(keyword, "CELLS")) {
            if (cells.count() > 0) text.fail("CELLS appears twice");
            const std::size_t count = text.count("the number of cells"), size = text.count("the size of the cells");
            if (same_word(text.peek(), "OFFSETS"))
                read_offset_cells(text, count, size, cells);
            else
                read_counted_cells(text, count, size, cells);
        } else if (same_word(keyword, "CELL_TYPES")) {
            const std::size_t count = text.count("the number of cell types");
            if (count != cells.count())
                text.fail(std::to_string(count) + " cell types for " + std::to_string(cells.count()) + " cells");
            types.clear();
            for (std::size_t i = 0; i < count; ++i) types.push_back(text.integer("a cell type"));
            has_types = true;
        } else if (same_word(keyword, "METADATA") || same_word(keyword, "FIELD")) {
            // Descriptions up to the next section that matters.
            const auto is_section = [](std::string_view w) {
                for (std::string_view s : {"POINTS", "CELLS", "CELL_TYPES", "CELL_DATA", "POINT_DATA"})
                    if (same_word(w, s)) return true;
                return false;
            };
            while (!text.at_end() && !is_section(text.peek())) text.word();
        } else if (same_word(keyword, "CELL_DATA")) {
            coverage = read_coverage(text, types);
        } else if (same_word(keyword, "POINT_DATA")) {
            while (!text.at_end() && !same_word(text.peek(), "CELL_DATA")) text.word();
        } else {
            text.fail("'" + printable(keyword) + "' stands where a section (POINTS, CELLS, CELL_TYPES …) should");
        }
    }
    if (!has_types || types.size() != cells.count())
        text.fail(std::to_string(types.size()) + " cell types for " + std::to_string(cells.count()) + " cells");
    return tets_of(text, file, std::move(vertices), cells, types, coverage);
}

} // namespace sinew::solver
