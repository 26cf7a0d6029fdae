// The body-centred cubic lattice as numbers.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/bcc_grid.h"

#include <cmath>

namespace sinew::solver {
namespace {

/// Corners of a cube's lower face across an axis, counter-clockwise about that axis, in the two following
/// axes.
constexpr int corner_offset[4][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};

std::size_t at(int i) { return static_cast<std::size_t>(i); }

BccGrid::Key cube_of(const BccGrid& grid, std::int64_t tet) {
    const std::int64_t cube = tet / 12;
    return {static_cast<int>(cube % grid.cubes[0]), static_cast<int>(cube / grid.cubes[0] % grid.cubes[1]),
            static_cast<int>(cube / grid.cubes[0] / grid.cubes[1])};
}

} // namespace

std::array<BccGrid::Key, 4> BccGrid::tet_vertices(std::int64_t tet) const {
    const Key cube = cube_of(*this, tet);
    const int axis = static_cast<int>(tet % 12) / 4, edge = static_cast<int>(tet % 4);
    const std::size_t u = at((axis + 1) % 3), v = at((axis + 2) % 3);
    const Key corner{2 * cube[0], 2 * cube[1], 2 * cube[2]};
    Key upper{corner[0] + 1, corner[1] + 1, corner[2] + 1}, lower = upper;
    lower[at(axis)] -= 2;
    Key start = corner, end = corner;
    start[u] += corner_offset[edge][0], start[v] += corner_offset[edge][1];
    end[u] += corner_offset[(edge + 1) % 4][0], end[v] += corner_offset[(edge + 1) % 4][1];
    return {lower, upper, start, end};
}

bool BccGrid::holds(std::int64_t tet) const {
    return cube_of(*this, tet)[at(static_cast<int>(tet % 12) / 4)] > 0;
}

BccGrid::Barycentric bcc_barycentric(const BccGrid::Key& cube, int axis, int edge, const Vec3& p) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    // Along the axis from the lower centre (0 to 2), and across it from the face's middle.
    const double along = p[axis] - (2 * cube[at(axis)] - 1);
    const double x = p[u] - (2 * cube[at(u)] + 1), y = p[v] - (2 * cube[at(v)] + 1);
    double out = 0, side = 0; // towards the edge, and along it
    switch (edge) {
    case 0:
        side = x, out = -y;
        break;
    case 1:
        side = y, out = x;
        break;
    case 2:
        side = -x, out = y;
        break;
    default:
        side = -y, out = -x;
        break;
    }
    return {0.5 * (2 - along - out), 0.5 * (along - out), 0.5 * (out - side), 0.5 * (out + side)};
}

BccGrid make_bcc_grid(const Vec3& centre, const Vec3& size, double side) {
    BccGrid grid;
    grid.centre = centre;
    grid.side = side;
    // One cube more on each side than the box reaches into: tets on its border span two cubes.
    for (int d = 0; d < 3; ++d)
        grid.cubes[at(d)] = 2 * (static_cast<int>(std::ceil(0.5 * size[d] / side)) + 1);
    return grid;
}

} // namespace sinew::solver
