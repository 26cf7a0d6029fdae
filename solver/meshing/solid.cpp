// A surface prepared for the question "what is inside".
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/solid.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/meshing/holes.h"
#include "solver/meshing/welding.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

namespace sinew::solver {
namespace {

void refuse_one_sided(const OneSided& found) {
    if (found.parts == 0) return;
    throw Error("FE223",
                std::to_string(found.parts) + (found.parts == 1 ? " part" : " parts") +
                    " of the mesh cannot be turned to face one way, the first at the edge between vertices " +
                    std::to_string(found.first[0]) + " and " + std::to_string(found.first[1]) +
                    ": like a twisted ring it has one side only, and so no inside",
                "repair the mesh there, or wrap it by zIsoMesh with isoValue > 0");
}

double area(const Points& points, const std::vector<Triangle>& triangles) {
    double sum = 0;
    for (const Triangle& t : triangles)
        sum += 0.5 * (points[at(t[1])] - points[at(t[0])]).cross(points[at(t[2])] - points[at(t[0])]).norm();
    return sum;
}

/// Places on a triangle with corner a and edges u, v, no farther apart than a twentieth of the mesh or so: the middles
/// of n * n equal parts, or of strips across the longest edge where the triangle is much longer than high. Calls
/// use(place) until it returns false.
template <class Use>
void for_places_on(const Vec3& a, const Vec3& u, const Vec3& v, double longest_side, const Use& use) {
    const double longest_edge = std::max({u.norm(), v.norm(), (u - v).norm()});
    const auto parts = [&](double length) {
        return std::clamp(static_cast<int>(std::ceil(20 * length / longest_side)), 1, 12);
    };
    const int n = parts(longest_edge), high = parts(u.cross(v).norm() / longest_edge);
    if (4 * high <= n) {
        // From the longest edge towards the corner opposite.
        Vec3 from = a, along = u, top = a + v;
        if (v.norm() == longest_edge) along = v, top = a + u;
        if ((u - v).norm() == longest_edge) from = a + u, along = v - u, top = a;
        for (int row = 0; row < high; ++row)
            for (int i = 0; i < n; ++i) {
                const double up = (row + 1.0 / 3) / high;
                if (!use((1 - up) * (from + (i + 0.5) / n * along) + up * top)) return;
            }
        return;
    }
    for (int p = 0; p < n; ++p)
        for (int q = 0; p + q < n; ++q)
            for (int half = 0; half < (p + q + 1 < n ? 2 : 1); ++half) {
                const double offset = half == 0 ? 1.0 / 3 : 2.0 / 3;
                if (!use(a + ((p + offset) * u + (q + offset) * v) / n)) return;
            }
}

/// Looks just below and above each triangle.
std::vector<Solid::Sides> find_sides(const Points& points, const std::vector<Triangle>& triangles,
                                     const SurfaceTree& tree, double longest_side, const MeshingPhase& phase) {
    std::vector<Solid::Sides> result(triangles.size());
    phase.run(triangles.size(), 16, [&](std::size_t i) {
        const Vec3 &a = points[at(triangles[i][0])], u = points[at(triangles[i][1])] - a,
                   v = points[at(triangles[i][2])] - a;
        const Vec3 normal = u.cross(v);
        const double twice_area = normal.norm();
        if (!(twice_area > 0)) return;
        const double longest_edge = std::max({u.norm(), v.norm(), (u - v).norm()});
        const int n = std::clamp(static_cast<int>(std::ceil(20 * longest_edge / longest_side)), 1, 12);
        const Vec3 step = normal * (1e-3 / std::sqrt(twice_area) / n);
        // A few places often tell that there is nothing to be known. All the others are asked at once, which costs a
        // long triangle, that all the rest of the mesh is near of, a fraction.
        Points places;
        const auto sides_at = [](double below, double above) -> std::optional<Solid::Sides> {
            for (const double x : {below, above})
                if (std::abs(x - std::round(x)) > 0.25 || std::abs(x) > 100) return {};
            return Solid::Sides{static_cast<signed char>(std::lround(below)),
                                static_cast<signed char>(std::lround(above))};
        };
        for_places_on(a, u, v, longest_side, [&](const Vec3& middle) {
            places.push_back(middle - step), places.push_back(middle + step);
            return true;
        });
        const std::vector<double> two = tree.winding_numbers({places[0], places[1]});
        const auto first = sides_at(two[0], two[1]);
        if (!first) return;
        for (std::size_t from = 2, several = 4; from < places.size(); from += several, several *= 4) {
            const auto begin = places.begin() + static_cast<std::ptrdiff_t>(from),
                       end = places.begin() + static_cast<std::ptrdiff_t>(std::min(from + several, places.size()));
            const std::vector<double> w = tree.winding_numbers(Points(begin, end));
            for (std::size_t k = 0; k < w.size(); k += 2)
                if (sides_at(w[k], w[k + 1]) != first) return;
        }
        result[i] = *first;
    });
    return result;
}

/// At a border the solid does not end at the triangle alone.
void forget_sides_at_border(const std::vector<Triangle>& triangles, std::vector<Solid::Sides>& sides) {
    std::set<std::array<int, 2>> border;
    for (const auto& [a, b] : border_edges_of(triangles)) border.insert({std::min(a, b), std::max(a, b)});
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            if (border.count({std::min(a, b), std::max(a, b)}) > 0) sides[t] = {};
        }
}

bool is_flat(const Vec3& size) { return !(size.minCoeff() > 1e-9 * size.maxCoeff()); }

/// A single vertex that went astray makes everything flat beside its distance: it is named.
[[noreturn]] void refuse_flat(const Points& points, const Points& used, const Vec3& size) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : used) middle += p / static_cast<double>(used.size());
    const Vec3 farthest = *std::ranges::max_element(used, {}, [&middle](const Vec3& p) { return (p - middle).norm(); });
    char text[160];
    std::snprintf(text, sizeof text, "the mesh is flat: its bounding box is %.4g x %.4g x %.4g", size.x(), size.y(),
                  size.z());
    Points others(used);
    std::erase(others, farthest);
    if (is_flat(bounding_box(others).size())) throw Error("FE223", text, "a tissue needs a surface with an inside");
    const auto vertex = std::find(points.begin(), points.end(), farthest) - points.begin();
    throw Error("FE223",
                std::string(text) + ", since vertex " + std::to_string(vertex) +
                    " (counted from 0) lies far away from the others",
                "repair the coordinates of that vertex");
}

} // namespace

Solid make_solid(const Points& points, const std::vector<Triangle>& triangles, Fill fill,
                 const MeshingControl& control) {
    const MeshingPhase phase{control, 0, 0.15, "preparing the surface"};
    control.report(0, phase.what);
    SurfaceMesh view; // checks in the one place where the rules stand
    view.points = points;
    view.triangles = triangles;
    check_usable(view);

    auto [first, kept] = weld(points, triangles);
    if (kept.empty()) throw Error("FE223", "the mesh has no triangle with an area");
    Points used;
    for (const Triangle& t : kept)
        for (int v : t) used.push_back(points[at(v)]);
    const Box box = bounding_box(used);
    const double longest = box.size().maxCoeff();
    if (!(longest < 1e60)) throw Error("FE224", "the mesh is larger than 1e60 units");
    // Volumes below the smallest numbers there are; a flat or single place is named below.
    if (longest > 0 && longest < 1e-60) throw Error("FE224", "the mesh is smaller than 1e-60 units");
    if (is_flat(box.size())) refuse_flat(points, used, box.size());
    auto border = border_edges_of(kept);
    if (!border.empty()) {
        refuse_one_sided(turn_alike(points, kept));
        border = border_edges_of(kept);
    }
    if (fill == Fill::empty_cavities) check_watertight(border);
    const std::vector<Triangle> lids = close_holes(points, kept);
    const bool closed = area(points, lids) <= 0.1 * area(points, kept);
    if (closed) kept.insert(kept.end(), lids.begin(), lids.end());
    const double volume = apply_fill(points, kept, fill);
    if (closed && !(volume > 1e-12 * longest * longest * longest))
        throw Error("FE223", "the surface is closed but encloses no volume",
                    "look for doubled faces, or parts that are turned inside out");

    SurfaceTree tree(points, kept);
    std::vector<Solid::Sides> sides = find_sides(points, kept, tree, longest, phase);
    if (!closed) forget_sides_at_border(kept, sides);
    return Solid{points, std::move(first), std::move(kept), box, static_cast<int>(border.size()),
                 closed, std::move(sides), std::move(tree)};
}

} // namespace sinew::solver
