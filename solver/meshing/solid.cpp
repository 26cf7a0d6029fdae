// A surface prepared for the question "what is inside".
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/solid.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/meshing/holes.h"
#include "solver/meshing/triangle_sides.h"
#include "solver/meshing/welding.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
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
    std::vector<Solid::Sides> sides = find_sides(points, kept, tree, {longest, closed}, phase).sides;
    if (!closed) forget_sides_at_border(kept, sides);
    return Solid{points, std::move(first), std::move(kept), box, static_cast<int>(border.size()),
                 closed, std::move(sides), std::move(tree)};
}

} // namespace sinew::solver
