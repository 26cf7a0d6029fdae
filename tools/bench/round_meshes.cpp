// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/round_meshes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace sinew::bench {

using namespace solver;

namespace {

/// Hexahedra of several blocks, joined where their corners meet, cut into tets.
class Blocks {
  public:
    /// nx x ny x nz cells over the unit cube, each point where `place` puts it.
    template <class Place>
    void add(int nx, int ny, int nz, const Place& place) {
        const auto corner = [&](int i, int j, int k) {
            return vertex(place(double(i) / nx, double(j) / ny, double(k) / nz));
        };
        for (int k = 0; k < nz; ++k)
            for (int j = 0; j < ny; ++j)
                for (int i = 0; i < nx; ++i) {
                    std::array<int, 8> c;
                    for (int b = 0; b < 8; ++b)
                        c[static_cast<std::size_t>(b)] = corner(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2 & 1));
                    cut(c);
                }
    }
    TetMesh take() {
        mesh_.coverage.assign(mesh_.tets.size(), 1.0);
        check_and_orient(mesh_);
        return std::move(mesh_);
    }

  private:
    int vertex(const Vec3& p) {
        std::array<long long, 3> key; // the shift keeps round numbers away from where keys change
        for (std::size_t d = 0; d < 3; ++d)
            key[d] = std::llround(std::floor(p[static_cast<Eigen::Index>(d)] * 1e8 + 0.37));
        const auto [it, is_new] = number_.emplace(key, static_cast<int>(mesh_.vertices.size()));
        if (is_new) mesh_.vertices.push_back(p);
        return it->second;
    }
    /// From the corner with the lowest number to the halves of the three faces that do not have it. Each face is cut
    /// from its own lowest corner, so neighbours agree.
    void cut(const std::array<int, 8>& c) {
        constexpr std::size_t faces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                             {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
        const int lowest = *std::min_element(c.begin(), c.end());
        for (const auto& face : faces) {
            int q[4];
            for (std::size_t i = 0; i < 4; ++i) q[i] = c[face[i]];
            if (std::find(q, q + 4, lowest) != q + 4) continue;
            std::rotate(q, std::min_element(q, q + 4), q + 4);
            mesh_.tets.push_back({lowest, q[0], q[1], q[2]});
            mesh_.tets.push_back({lowest, q[0], q[2], q[3]});
        }
    }
    TetMesh mesh_;
    std::map<std::array<long long, 3>, int> number_;
};

/// Of a place in the square [0, 1]^2 on a face of the cube [-1, 1]^3, spaced in equal angles.
Vec3 on_cube(int face, double s, double t) {
    const auto spread = [](double u) { return std::tan(0.25 * std::numbers::pi * (2 * u - 1)); };
    const double side = face % 2 ? 1 : -1;
    Vec3 p;
    p[face / 2] = side, p[(face / 2 + 1) % 3] = spread(s), p[(face / 2 + 2) % 3] = spread(t);
    return p;
}

} // namespace

TetMesh shell_mesh(double inner, double outer, int n, int layers) {
    Blocks blocks;
    for (int face = 0; face < 6; ++face)
        blocks.add(n, n, layers, [&](double s, double t, double r) {
            return Vec3((inner + (outer - inner) * r) * on_cube(face, s, t).normalized());
        });
    return blocks.take();
}

TetMesh ball_mesh(double radius, int n, int layers) {
    Blocks blocks;
    const double half = 0.4 * radius; // of the cube in the middle
    blocks.add(n, n, n, [&](double r, double s, double t) {
        Vec3 p = on_cube(1, s, t);
        p.x() = on_cube(1, r, r).y();
        return Vec3(half * p);
    });
    for (int face = 0; face < 6; ++face)
        blocks.add(n, n, layers, [&](double s, double t, double r) {
            const Vec3 p = on_cube(face, s, t);
            return Vec3((1 - r) * half * p + r * radius * p.normalized());
        });
    return blocks.take();
}

} // namespace sinew::bench
