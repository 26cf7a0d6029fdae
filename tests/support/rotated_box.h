// A box, or another body of six sides, that stands askew in the lattice that is made around it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

namespace sinew::test {

struct RotatedBox {
    solver::Vec3 size; ///< along its own sides [m]
    solver::Mat3 turn; ///< from its own axes to the world's

    /// Turned about x, then about y [degrees].
    RotatedBox(const solver::Vec3& box_size, double about_x, double about_y)
        : size(box_size) {
        using Eigen::AngleAxisd;
        constexpr double degree = std::numbers::pi / 180;
        turn =
            (AngleAxisd(about_y * degree, solver::Vec3::UnitY()) * AngleAxisd(about_x * degree, solver::Vec3::UnitX()))
                .toRotationMatrix();
    }
    /// A point given in the box's own coordinates, 0 to size.
    solver::Vec3 at(const solver::Vec3& local) const { return turn * local; }
    solver::Vec3 local(const solver::Vec3& p) const { return turn.transpose() * p; }

    /// Its surface, each side in squares no larger than longest side / `parts`, in two triangles each. With `shape`
    /// that of what it makes of the box.
    solver::SurfaceMesh surface(int parts, const std::function<solver::Vec3(const solver::Vec3&)>& shape = {}) const {
        const double step = size.maxCoeff() / parts;
        std::array<int, 3> n;
        for (int d = 0; d < 3; ++d)
            n[static_cast<std::size_t>(d)] = std::max(1, static_cast<int>(std::ceil(size[d] / step - 1e-9)));
        std::map<std::array<int, 3>, int> numbers;
        solver::Points points;
        std::vector<solver::Triangle> triangles;
        const auto vertex = [&](const std::array<int, 3>& key) {
            const auto [found, is_new] = numbers.try_emplace(key, static_cast<int>(points.size()));
            if (is_new) {
                const solver::Vec3 p(key[0] * size[0] / n[0], key[1] * size[1] / n[1], key[2] * size[2] / n[2]);
                points.push_back(at(shape ? shape(p) : p));
            }
            return found->second;
        };
        for (std::size_t d = 0; d < 3; ++d) {
            const std::size_t u = (d + 1) % 3, v = (d + 2) % 3;
            for (const bool high : {false, true})
                for (int i = 0; i < n[u]; ++i)
                    for (int j = 0; j < n[v]; ++j) {
                        const auto corner = [&](int a, int b) {
                            std::array<int, 3> key;
                            key[d] = high ? n[d] : 0, key[u] = i + a, key[v] = j + b;
                            return vertex(key);
                        };
                        const std::array<int, 4> q{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
                        if (high)
                            triangles.push_back({q[0], q[1], q[2]}), triangles.push_back({q[0], q[2], q[3]});
                        else
                            triangles.push_back({q[0], q[2], q[1]}), triangles.push_back({q[0], q[3], q[2]});
                    }
        }
        return solver::SurfaceMesh::from_triangles(points, triangles);
    }
};

} // namespace sinew::test
