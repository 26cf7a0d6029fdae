// Flaws of a triangle mesh.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/mesh_check.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/joined_sets.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/tet_quality.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace sinew::solver {
namespace {

struct Use {
    int low, high, triangle;
    bool forward;
};

std::vector<Use> edge_uses(const std::vector<Triangle>& triangles) {
    std::vector<Use> uses;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            if (a != b) uses.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
        }
    std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
        if (a.low != b.low) return a.low < b.low;
        if (a.high != b.high) return a.high < b.high;
        return a.triangle < b.triangle;
    });
    return uses;
}

/// Returns the part of each triangle: the lowest triangle in it.
std::vector<int> check_edges(const std::vector<Triangle>& triangles, MeshCheck& out) {
    const std::vector<Use> uses = edge_uses(triangles);
    JoinedSets parts(triangles.size());
    // Corners are joined over edges; a vertex with more than one group of corners has more than one fan.
    JoinedSets corners(3 * triangles.size());
    const auto corner = [&](int t, int v) {
        const Triangle& c = triangles[at(t)];
        return 3 * t + static_cast<int>(std::find(c.begin(), c.end(), v) - c.begin());
    };
    for (std::size_t i = 0, j; i < uses.size(); i = j) {
        const Use& u = uses[i];
        for (j = i + 1; j < uses.size() && uses[j].low == u.low && uses[j].high == u.high; ++j) {
            parts.join(u.triangle, uses[j].triangle);
            for (const int v : {u.low, u.high}) corners.join(corner(u.triangle, v), corner(uses[j].triangle, v));
        }
        if (j - i == 1) out.open_edges.add(u.low, u.high);
        if (j - i > 2) out.non_manifold_edges.add(u.low, u.high);
        if (j - i == 2 && u.forward == uses[i + 1].forward) out.badly_oriented_edges.add(u.low, u.high);
    }
    std::vector<int> part_of;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        part_of.push_back(parts.root(static_cast<int>(t)));
        out.components += part_of.back() == static_cast<int>(t);
    }

    std::vector<std::array<int, 2>> fans; // vertex, group
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
            fans.push_back({triangles[t][k], corners.root(static_cast<int>(3 * t + k))});
    std::sort(fans.begin(), fans.end());
    fans.erase(std::unique(fans.begin(), fans.end()), fans.end());
    for (std::size_t i = 0, j; i < fans.size(); i = j) {
        for (j = i + 1; j < fans.size() && fans[j][0] == fans[i][0];) ++j;
        if (j - i > 1) out.non_manifold_vertices.add(fans[i][0]);
    }
    return part_of;
}

/// For closed meshes.
void check_sides(const Points& points, const std::vector<Triangle>& triangles, const std::vector<int>& part_of,
                 MeshCheck& out) {
    struct Part {
        double volume = 0;
        Box box{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
        bool holds(const Part& other) const {
            return (box.min.array() <= other.box.min.array()).all() &&
                   (box.max.array() >= other.box.max.array()).all() &&
                   (box.min != other.box.min || box.max != other.box.max);
        }
    };
    std::map<int, Part> parts;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        Part& part = parts[part_of[t]];
        // From the part's own first corner, so that a part far away from the origin keeps its sign.
        const Vec3& origin = points[at(triangles[at(part_of[t])][0])];
        part.volume +=
            tet_volume(origin, points[at(triangles[t][0])], points[at(triangles[t][1])], points[at(triangles[t][2])]);
        for (const int v : triangles[t]) {
            part.box.min = part.box.min.cwiseMin(points[at(v)]);
            part.box.max = part.box.max.cwiseMax(points[at(v)]);
        }
    }
    for (const auto& [first, part] : parts) {
        // Less is rounding: such a part encloses nothing.
        const double size = part.box.size().maxCoeff();
        if (!(part.volume < -1e-12 * size * size * size)) continue;
        const bool inside_another =
            std::any_of(parts.begin(), parts.end(), [&](const auto& other) { return other.second.holds(part); });
        if (!inside_another) out.inside_out_parts.add(first);
    }
}

void check_triangles(const Points& points, const std::vector<Triangle>& triangles, MeshCheck& out) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const Vec3 &a = points[at(triangles[t][0])], &b = points[at(triangles[t][1])], &c = points[at(triangles[t][2])];
        const double longest2 = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
        // Rounding of the coordinates moves a height by about this much.
        const double noise =
            1e-15 * std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff()});
        if (!((b - a).cross(c - a).norm() > noise * std::sqrt(longest2)))
            out.degenerate_triangles.add(static_cast<int>(t));
    }
    std::vector<std::array<int, 4>> sorted; // corners, triangle
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        Triangle c = triangles[t];
        std::sort(c.begin(), c.end());
        sorted.push_back({c[0], c[1], c[2], static_cast<int>(t)});
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<int> repeated;
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (std::equal(sorted[i].begin(), sorted[i].begin() + 3, sorted[i - 1].begin()))
            repeated.push_back(sorted[i][3]);
    std::sort(repeated.begin(), repeated.end());
    for (const int t : repeated) out.duplicate_triangles.add(t);
}

void check_vertices(const Points& points, const std::vector<Triangle>& triangles, MeshCheck& out) {
    std::vector<char> used(points.size(), 0);
    for (const Triangle& t : triangles)
        for (const int v : t) used[at(v)] = 1;
    for (std::size_t v = 0; v < points.size(); ++v)
        if (!used[v]) out.unused_vertices.add(static_cast<int>(v));
    std::vector<int> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    const auto place = [&](int v) {
        const Vec3& p = points[at(v)];
        return std::array<double, 3>{p.x(), p.y(), p.z()};
    };
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return place(a) != place(b) ? place(a) < place(b) : a < b; });
    std::vector<int> coinciding;
    for (std::size_t i = 1; i < order.size(); ++i)
        if (place(order[i]) == place(order[i - 1])) coinciding.push_back(order[i]);
    std::sort(coinciding.begin(), coinciding.end());
    for (const int v : coinciding) out.coinciding_vertices.add(v);
}

} // namespace

void Flaw::add(int place) {
    if (count++ < most_places) first.push_back(place);
}
void Flaw::add(int a, int b) {
    if (count++ < most_places) edges.push_back({a, b});
}

MeshCheck check_mesh(const Points& points, const std::vector<Triangle>& triangles) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (const int v : triangles[t])
            if (v < 0 || at(v) >= points.size())
                throw Error("FE203", "triangle " + std::to_string(t) + " uses vertex " + std::to_string(v) + " of " +
                                         std::to_string(points.size()));
    MeshCheck out;
    const std::vector<int> part_of = check_edges(triangles, out);
    if (out.is_closed()) check_sides(points, triangles, part_of, out);
    check_triangles(points, triangles, out);
    check_vertices(points, triangles, out);
    out.volume = enclosed_volume(points, triangles);
    return out;
}

Flaw flat_tets(const TetMesh& mesh) {
    constexpr double least = 1, largest = 179;
    Flaw out;
    const auto x = [&](int v) -> const Vec3& { return mesh.vertices[at(v)]; };
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const Tet& tet = mesh.tets[t];
        const auto range = dihedral_range(x(tet[0]), x(tet[1]), x(tet[2]), x(tet[3]));
        if (!(range[0] >= least && range[1] <= largest)) out.add(static_cast<int>(t));
    }
    return out;
}

std::string describe(const Flaw& flaw, const std::string& singular, const std::string& plural) {
    if (!flaw) return {};
    std::string text = std::to_string(flaw.count) + " " + (flaw.count == 1 ? singular : plural) + " (";
    const char* comma = "";
    for (const int place : flaw.first) text += comma + std::to_string(place), comma = ", ";
    for (const auto& [a, b] : flaw.edges) text += comma + std::to_string(a) + "-" + std::to_string(b), comma = ", ";
    return text + (flaw.count > Flaw::most_places ? ", …)" : ")");
}

double least_angle(const Points& points, const std::vector<Triangle>& triangles) {
    double least = std::numbers::pi;
    for (const Triangle& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &p = points[at(t[k])], u = points[at(t[(k + 1) % 3])] - p, v = points[at(t[(k + 2) % 3])] - p;
            least = std::min(least, std::atan2(u.cross(v).norm(), u.dot(v)));
        }
    return least * 180 / std::numbers::pi;
}

} // namespace sinew::solver
