// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/lids.h"

#include "solver/index.h"
#include "solver/mesh/closest_point.h"
#include "solver/mesh/surface_pieces.h"
#include "solver/meshing/holes.h"
#include "solver/meshing/welding.h"
#include "tools/rig/graph_text.h"

#include <algorithm>
#include <cstdlib>
#include <map>

namespace sinew::rig {

using solver::at;
using solver::Points;
using solver::Triangle;

namespace {

/// Of the surface; a bowl or a sheet would be filled up to a solid that nobody modelled.
constexpr double largest_share = 1.0 / 3;
constexpr std::size_t most_points = 3000;

double area(const Points& points, const Triangle& t) {
    const solver::Vec3& p = points[at(t[0])];
    return 0.5 * (points[at(t[1])] - p).cross(points[at(t[2])] - p).norm();
}

double area(const Points& points, const std::vector<Triangle>& triangles) {
    double out = 0;
    for (const Triangle& t : triangles) out += area(points, t);
    return out;
}

/// How far the middles of a triangle and its edges are from the surface that it closes a hole of, at most.
double farthest(const Points& points, const Triangle& t, const solver::SurfaceTree& surface) {
    const auto corner = [&](std::size_t i) -> const solver::Vec3& { return points[at(t[i % 3])]; };
    double out = surface.closest((corner(0) + corner(1) + corner(2)) / 3).distance;
    for (std::size_t i = 0; i < 3; ++i)
        out = std::max(out, surface.closest(0.5 * (corner(i) + corner(i + 1))).distance);
    return out;
}

/// As a graph has it.
solver::Vec3 written(const solver::Vec3& p) {
    solver::Vec3 out;
    for (int axis = 0; axis < 3; ++axis) out[axis] = std::strtod(coordinate(p[axis]).c_str(), nullptr);
    return out;
}

} // namespace

Lids make_lids(const Points& points, const std::vector<Triangle>& triangles, double distance) {
    solver::Welded welded = solver::weld(points, triangles);
    solver::turn_alike(points, welded.triangles);
    const solver::SurfaceTree surface(points, welded.triangles);
    Lids out;
    double covered = 0;
    std::map<int, int> own; // by vertex
    for (Triangle t : solver::close_holes(points, welded.triangles)) {
        // What closes cracks, or lies along a rim, the wrap of the surface alone covers.
        const double far = farthest(points, t, surface);
        if (!(far > distance / 2)) continue;
        out.widest = std::max(out.widest, 2 * far);
        covered += area(points, t);
        for (int& v : t) {
            const auto [place, is_new] = own.emplace(v, static_cast<int>(out.points.size()));
            if (is_new) out.points.push_back(written(points[at(v)]));
            v = place->second;
        }
        out.triangles.push_back(t);
    }
    if (covered > largest_share * area(points, welded.triangles) || out.points.size() > most_points) return {};
    out.count = solver::find_pieces_by_place(out.points, out.triangles).count();
    return out;
}

} // namespace sinew::rig
