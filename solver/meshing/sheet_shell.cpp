// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/sheet_shell.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/meshing/holes.h"
#include "solver/meshing/shells.h"
#include "solver/meshing/welding.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace sinew::solver {

namespace {

Vec3 area_vector(const Points& points, const Triangle& t) {
    return 0.5 * (points[at(t[1])] - points[at(t[0])]).cross(points[at(t[2])] - points[at(t[0])]);
}

double area(const Points& points, const std::vector<Triangle>& triangles) {
    double sum = 0;
    for (const Triangle& t : triangles) sum += area_vector(points, t).norm();
    return sum;
}

Box box_of(const Points& points, const std::vector<Triangle>& triangles) {
    Points used;
    for (const Triangle& t : triangles)
        for (const int v : t) used.push_back(points[at(v)]);
    return bounding_box(used);
}

double angle_at(const Points& points, const Triangle& t, std::size_t corner) {
    const Vec3 &p = points[at(t[corner])], a = points[at(t[(corner + 1) % 3])] - p,
               b = points[at(t[(corner + 2) % 3])] - p;
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The d nearest to n . d = 1 for the normals of the faces about a vertex, weighted by their angles there; none along
/// directions that they hardly know, as around the faces of a smooth surface.
Vec3 mitre(const Mat3& squares, const Vec3& sum) {
    constexpr double hardly = 0.02;
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(squares);
    Vec3 out = Vec3::Zero();
    for (int i = 0; i < 3; ++i) {
        if (!(axes.eigenvalues()[i] > hardly * axes.eigenvalues()[2])) continue;
        out += axes.eigenvectors().col(i).dot(sum) / axes.eigenvalues()[i] * axes.eigenvectors().col(i);
    }
    return out;
}

} // namespace

bool is_sheet(const Points& points, const std::vector<Triangle>& triangles) {
    std::vector<Triangle> kept = weld(points, triangles).triangles;
    if (kept.empty()) return false;
    const Vec3 size = box_of(points, kept).size();
    if (!(size.minCoeff() > 1e-9 * size.maxCoeff())) return true;
    if (border_edges_of(kept).empty()) return false;
    turn_alike(points, kept);
    return area(points, close_holes(points, kept)) > 0.1 * area(points, kept);
}

SheetShell make_sheet_shell(const Points& points, const std::vector<Triangle>& triangles, double thickness) {
    std::vector<Triangle> kept = weld(points, triangles).triangles;
    if (kept.empty()) throw Error("FE223", "the mesh has no triangle with an area");
    const double longest = box_of(points, kept).size().maxCoeff();
    if (!(thickness > 0) || !(thickness <= 0.5 * longest)) {
        char text[160];
        std::snprintf(text, sizeof text, "a sheet that is %.4g long cannot be %.4g thick", longest, thickness);
        throw Error("FE298", text, "choose a thickness well below its length");
    }
    const OneSided one_sided = turn_alike(points, kept);
    if (one_sided.parts > 0)
        throw Error("FE223",
                    "the mesh has one side only, like a twisted ring, at the edge between vertices " +
                        std::to_string(one_sided.first[0]) + " and " + std::to_string(one_sided.first[1]) +
                        ", so that above and below it are no two sides",
                    "repair the mesh there");
    std::vector<Mat3> squares(points.size(), Mat3::Zero());
    std::vector<Vec3> sums(points.size(), Vec3::Zero());
    for (const Triangle& t : kept) {
        const Vec3 n = area_vector(points, t).normalized();
        for (std::size_t k = 0; k < 3; ++k) {
            const double w = angle_at(points, t, k);
            squares[at(t[k])] += w * n * n.transpose();
            sums[at(t[k])] += w * n;
        }
    }
    SheetShell out;
    out.points.resize(2 * points.size());
    for (std::size_t v = 0; v < points.size(); ++v) {
        const Vec3 d = squares[v].isZero(0) ? Vec3(Vec3::Zero()) : Vec3(0.5 * thickness * mitre(squares[v], sums[v]));
        out.points[v] = points[v] + d, out.points[v + points.size()] = points[v] - d;
    }
    const int below = static_cast<int>(points.size());
    for (const Triangle& t : kept) out.triangles.push_back(t);
    for (const Triangle& t : kept) out.triangles.push_back({t[0] + below, t[2] + below, t[1] + below});
    for (const auto& [a, b] : border_edges_of(kept)) {
        out.triangles.push_back({b, a, a + below});
        out.triangles.push_back({b, a + below, b + below});
    }
    return out;
}

} // namespace sinew::solver
