// Tet files that number their vertices and tets: VegaFEM .veg and TetGen .node with .ele.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/mesh_readers.h"
#include "solver/mesh/text_scanner.h"

#include <unordered_map>

namespace sinew::solver {
namespace {

/// Vertices and tets by the numbers that a file gives them.
class Numbered {
  public:
    void add_vertex(TextScanner& text, long long number, const Vec3& p) {
        if (!vertex_.try_emplace(number, static_cast<int>(points.size())).second)
            text.fail("vertex " + std::to_string(number) + " appears twice");
        points.push_back(p);
    }
    void add_tet(TextScanner& text) {
        std::array<long long, 4> numbers{};
        for (long long& n : numbers) n = text.integer("a vertex of a tet");
        tets.push_back(numbers);
        lines.push_back(text.line());
    }
    TetMesh finish(const std::string& file) {
        std::vector<Tet> out;
        for (const auto& numbers : tets) {
            Tet t;
            for (std::size_t k = 0; k < 4; ++k) {
                const auto found = vertex_.find(numbers[k]);
                if (found == vertex_.end())
                    throw Error("FE203", file + ":" + std::to_string(lines[out.size()]) + ": tet " +
                                             std::to_string(out.size()) + " uses vertex " + std::to_string(numbers[k]) +
                                             ", which the file does not have");
                t[k] = found->second;
            }
            out.push_back(t);
        }
        return finish_tets(file, std::move(points), std::move(out));
    }

    Points points;
    std::vector<std::array<long long, 4>> tets;
    std::vector<int> lines; ///< of the tets

  private:
    std::unordered_map<long long, int> vertex_;
};

Vec3 read_point(TextScanner& text) {
    Vec3 p;
    for (int d = 0; d < 3; ++d) p[d] = text.number("a coordinate");
    return p;
}

} // namespace

TetMesh read_veg(std::string_view bytes, const std::string& file) {
    TextScanner text(bytes, file);
    Numbered mesh;
    bool has_vertices = false, has_elements = false;
    while (!text.at_end()) {
        const std::string_view word = text.word();
        if (word == "*VERTICES") {
            if (has_vertices) text.fail("*VERTICES appears twice");
            has_vertices = true;
            const std::size_t n = text.count("the number of vertices");
            if (const long long d = text.integer("the dimension"); d != 3)
                text.fail("the vertices have dimension " + std::to_string(d) + ", not 3");
            text.rest_of_line();
            for (std::size_t i = 0; i < n; ++i) {
                const long long number = text.integer("a vertex number");
                mesh.add_vertex(text, number, read_point(text));
            }
        } else if (word == "*ELEMENTS") {
            if (has_elements) text.fail("*ELEMENTS appears twice");
            has_elements = true;
            if (const std::string_view kind = text.word(); kind != "TET" && kind != "TETS")
                text.fail("elements '" + printable(kind) + "' cannot be used; only TET can");
            const std::size_t n = text.count("the number of elements");
            if (const long long corners = text.integer("the number of corners"); corners != 4)
                text.fail("tets with " + std::to_string(corners) + " corners");
            text.rest_of_line();
            for (std::size_t i = 0; i < n; ++i) {
                text.integer("an element number");
                mesh.add_tet(text);
            }
        } else if (word == "*INCLUDE") {
            text.fail("*INCLUDE cannot be followed; put the vertices into this file");
        } else if (word == "*MATERIAL" || word == "*SET" || word == "*REGION") {
            while (!text.at_end() && text.peek().front() != '*') text.word();
        } else {
            text.fail("'" + printable(word) + "' stands where a section (*VERTICES, *ELEMENTS …) should");
        }
    }
    if (!has_vertices || !has_elements) text.fail(has_vertices ? "there is no *ELEMENTS" : "there is no *VERTICES");
    return mesh.finish(file);
}

TetMesh read_tetgen(std::string_view node_bytes, const std::string& node_file, std::string_view ele_bytes,
                    const std::string& ele_file) {
    Numbered mesh;
    TextScanner nodes(node_bytes, node_file);
    const std::size_t n = nodes.count("the number of vertices");
    if (const long long d = nodes.integer("the dimension"); d != 3)
        nodes.fail("the vertices have dimension " + std::to_string(d) + ", not 3");
    // Attributes and boundary markers stand behind the coordinates, to the end of the line.
    nodes.rest_of_line();
    for (std::size_t i = 0; i < n; ++i) {
        const long long number = nodes.integer("a vertex number");
        mesh.add_vertex(nodes, number, read_point(nodes));
        nodes.rest_of_line();
    }
    TextScanner elements(ele_bytes, ele_file);
    const std::size_t tets = elements.count("the number of tets");
    if (const long long corners = elements.integer("the number of corners"); corners != 4)
        elements.fail("tets with " + std::to_string(corners) + " corners cannot be used; only 4 can");
    elements.rest_of_line();
    for (std::size_t i = 0; i < tets; ++i) {
        elements.integer("a tet number");
        mesh.add_tet(elements);
        elements.rest_of_line();
    }
    return mesh.finish(ele_file);
}

} // namespace sinew::solver
