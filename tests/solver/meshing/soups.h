// Meshes for the tests of meshing: clean shapes, and soups that are broken in known ways.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/primitives.h"
#include "solver/mesh/surface_mesh.h"

#include <random>
#include <string>
#include <vector>

namespace soups {

using namespace sinew::solver;

struct Shape {
    std::string name;
    Points points;
    std::vector<Triangle> triangles;
    bool is_closed = true;
};

inline void append(Shape& to, const Points& points, std::vector<Triangle> triangles, const Vec3& by = Vec3::Zero()) {
    const int first = static_cast<int>(to.points.size());
    for (const Vec3& p : points) to.points.push_back(p + by);
    for (Triangle t : triangles) {
        for (int& v : t) v += first;
        to.triangles.push_back(t);
    }
}
inline void append(Shape& to, const SurfaceMesh& mesh, const Vec3& by = Vec3::Zero()) {
    append(to, mesh.points, mesh.triangles, by);
}
inline Shape shape(const std::string& name, const SurfaceMesh& mesh, bool is_closed = true) {
    return {name, mesh.points, mesh.triangles, is_closed};
}
inline std::vector<Triangle> reversed(std::vector<Triangle> triangles) {
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
    return triangles;
}

/// Five clean closed shapes, three of several parts, two open ones.
inline std::vector<Shape> ten_shapes() {
    std::vector<Shape> all{shape("sphere", make_sphere(1, 24, 16)), shape("cube", make_cube(1, 2, 3, 1, 1, 1)),
                           shape("cylinder", make_cylinder(0.3, 3, 20, 1, 1)),
                           shape("helix", make_helix(1, 0.2, 2, 2, 12, 24)),
                           shape("flat box", make_cube(3, 0.2, 2, 3, 1, 2))};
    const SurfaceMesh ball = make_sphere(0.5, 20, 12);
    Shape hollow = shape("hollow ball", make_sphere(1, 24, 16));
    append(hollow, ball.points, reversed(ball.triangles));
    Shape overlapping = shape("overlapping balls", make_sphere(1, 24, 16));
    append(overlapping, make_sphere(0.8, 20, 14), {1.1, 0.2, 0});
    Shape six{"six small balls", {}, {}, true};
    for (int i = 0; i < 6; ++i)
        append(six, make_sphere(0.12 + 0.03 * i, 16, 10), {1.0 * (i % 3), 1.3 * (i / 3), 0.2 * i});
    all.insert(all.end(), {hollow, overlapping, six});
    all.push_back(shape("plane", make_plane(2, 1, 4, 2), false));
    Shape cup = shape("open cube", make_cube(1, 1, 1, 2, 2, 2), false);
    std::erase_if(cup.triangles, [&](const Triangle& t) {
        for (const int v : t)
            if (cup.points[static_cast<std::size_t>(v)].y() < 0.49) return false;
        return true;
    });
    all.push_back(cup);
    return all;
}

/// Every triangle with corners of its own, in another order; some left out, doubled, turned round, squashed
/// to a line; and a fin inside.
inline Shape broken(const Shape& whole, unsigned seed) {
    std::mt19937 random(seed);
    const auto chance = [&](double share) { return random() < share * 4294967296.0; };
    Shape out{"broken " + whole.name, {}, {}, false};
    const auto add = [&](Vec3 a, Vec3 b, Vec3 c) {
        const int first = static_cast<int>(out.points.size());
        out.points.insert(out.points.end(), {a, b, c});
        out.triangles.push_back({first, first + 1, first + 2});
    };
    std::vector<Triangle> triangles = whole.triangles;
    for (std::size_t i = triangles.size(); i > 1; --i) std::swap(triangles[i - 1], triangles[random() % i]);
    for (const Triangle& t : triangles) {
        const auto p = [&](std::size_t k) { return whole.points[static_cast<std::size_t>(t[k])]; };
        if (chance(0.03)) continue;
        chance(0.1) ? add(p(0), p(2), p(1)) : add(p(0), p(1), p(2));
        if (chance(0.05)) add(p(1), p(2), p(0));
        if (chance(0.02)) add(p(0), p(1), 0.5 * (p(0) + p(1)));
    }
    const Box box = bounding_box(whole.points);
    const Vec3 c = box.centre(), q = 0.1 * box.size();
    add(c - q, c + q, c + Vec3(q.x(), -q.y(), 0));
    return out;
}

} // namespace soups
