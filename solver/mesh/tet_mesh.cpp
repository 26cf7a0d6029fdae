// Tetrahedral meshes.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/tet_mesh.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/coordinates.h"
#include "solver/mesh/tet_boundary.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sinew::solver {
namespace {

/// One of those with the same lowest corner.
struct Face {
    std::array<int, 2> upper; ///< the other corners, sorted
    std::size_t number;       ///< four a tet
};

/// Tets on the same four vertices would count twice in mass and stiffness.
void refuse_repeated(const std::vector<Tet>& tets) {
    std::vector<std::array<int, 5>> sorted; // corners, tet
    sorted.reserve(tets.size());
    for (std::size_t t = 0; t < tets.size(); ++t) {
        Tet c = tets[t];
        std::sort(c.begin(), c.end());
        sorted.push_back({c[0], c[1], c[2], c[3], static_cast<int>(t)});
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::array<int, 2>> repeated; // tet, the one before it
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (std::equal(sorted[i].begin(), sorted[i].begin() + 4, sorted[i - 1].begin()))
            repeated.push_back({sorted[i][4], sorted[i - 1][4]});
    if (repeated.empty()) return;
    const auto [tet, earlier] = *std::min_element(repeated.begin(), repeated.end());
    throw Error("FE221",
                "tet " + std::to_string(tet) + " has the corners of tet " + std::to_string(earlier) +
                    "; tets that repeat others: " + std::to_string(repeated.size()),
                "remove the repeated tets");
}

} // namespace

double tet_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).dot((c - a).cross(d - a)) / 6;
}

TetBoundary tet_boundary(const std::vector<Tet>& tets) {
    // Corners of the face opposite corner i, outward for a positively oriented tet.
    constexpr int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    // Faces by their lowest corner: few share one, so that little is left to be sorted.
    int vertices = 0;
    for (const Tet& t : tets) vertices = std::max(vertices, *std::max_element(t.begin(), t.end()) + 1);
    std::vector<std::size_t> end(at(vertices) + 1, 0);
    const auto corners = [&](std::size_t face) {
        const Tet& t = tets[face / 4];
        const auto& f = faces[face % 4];
        return Triangle{t[at(f[0])], t[at(f[1])], t[at(f[2])]};
    };
    const auto lowest = [](const Triangle& t) { return at(std::min({t[0], t[1], t[2]})); };
    const std::size_t count = 4 * tets.size();
    for (std::size_t f = 0; f < count; ++f) ++end[lowest(corners(f)) + 1];
    std::partial_sum(end.begin(), end.end(), end.begin());
    std::vector<Face> sorted(count);
    for (std::size_t f = 0; f < count; ++f) {
        Triangle c = corners(f);
        std::sort(c.begin(), c.end());
        sorted[end[at(c[0])]++] = {{c[1], c[2]}, f};
    }
    std::vector<char> is_border(count, 0);
    for (std::size_t v = 0, begin = 0; v < at(vertices); begin = end[v++]) {
        const auto first = sorted.begin() + static_cast<std::ptrdiff_t>(begin),
                   last = sorted.begin() + static_cast<std::ptrdiff_t>(end[v]);
        std::sort(first, last, [](const Face& a, const Face& b) { return a.upper < b.upper; });
        for (auto i = first; i != last;) {
            const auto next = std::find_if(i, last, [&](const Face& f) { return f.upper != i->upper; });
            is_border[i->number] = next - i == 1;
            i = next;
        }
    }
    TetBoundary result;
    for (std::size_t f = 0; f < count; ++f) {
        if (!is_border[f]) continue;
        result.triangles.push_back(corners(f));
        result.tet.push_back(static_cast<int>(f / 4));
    }
    return result;
}

std::vector<Triangle> boundary_triangles(const std::vector<Tet>& tets) { return tet_boundary(tets).triangles; }

void check_and_orient(TetMesh& mesh) {
    if (mesh.vertices.empty()) throw Error("FE201", "the tet mesh has no vertices");
    if (mesh.tets.empty()) throw Error("FE201", "the tet mesh has no tets");
    check_coordinates(mesh.vertices);
    const int count = static_cast<int>(mesh.vertices.size());
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        Tet& tet = mesh.tets[t];
        for (int v : tet)
            if (v < 0 || v >= count)
                throw Error("FE203", "tet " + std::to_string(t) + " uses vertex " + std::to_string(v) + " of " +
                                         std::to_string(count));
        double longest = 0;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < i; ++j)
                longest = std::max(longest, (mesh.vertices[at(tet[at(i)])] - mesh.vertices[at(tet[at(j)])]).norm());
        const double volume = tet_volume(mesh.vertices[at(tet[0])], mesh.vertices[at(tet[1])],
                                         mesh.vertices[at(tet[2])], mesh.vertices[at(tet[3])]);
        // Below this the sign of the volume is rounding error.
        if (!(std::abs(volume) > 1e-15 * longest * longest * longest))
            throw Error("FE215", "tet " + std::to_string(t) + " has no volume", "remove or remesh flat tets");
        if (volume < 0) std::swap(tet[2], tet[3]);
    }
    refuse_repeated(mesh.tets);
    if (mesh.coverage.empty()) mesh.coverage.assign(mesh.tets.size(), 1.0);
    if (mesh.coverage.size() != mesh.tets.size())
        throw Error("FE204", std::to_string(mesh.coverage.size()) + " coverage values for " +
                                 std::to_string(mesh.tets.size()) + " tets");
}

int drop_unused_vertices(TetMesh& mesh) {
    std::vector<int> renumbered(mesh.vertices.size(), -1);
    for (const Tet& tet : mesh.tets)
        for (int v : tet) renumbered[at(v)] = 0;
    std::size_t kept = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        if (renumbered[v] < 0) continue;
        mesh.vertices[kept] = mesh.vertices[v];
        renumbered[v] = static_cast<int>(kept++);
    }
    const int dropped = static_cast<int>(mesh.vertices.size() - kept);
    mesh.vertices.resize(kept);
    for (Tet& tet : mesh.tets)
        for (int& v : tet) v = renumbered[at(v)];
    return dropped;
}

std::vector<std::array<int, 2>> edges_of(const std::vector<Tet>& tets) {
    std::vector<std::array<int, 2>> edges;
    edges.reserve(6 * tets.size());
    for (const Tet& t : tets)
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = a + 1; b < 4; ++b) edges.push_back({std::min(t[a], t[b]), std::max(t[a], t[b])});
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

} // namespace sinew::solver
