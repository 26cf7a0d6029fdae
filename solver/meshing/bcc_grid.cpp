// The body-centred cubic lattice as numbers.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/bcc_grid.h"

#include "solver/index.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {
namespace {

/// Corners of a cube's lower face across an axis, counter-clockwise about that axis, in the two following
/// axes.
constexpr int corner_offset[4][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};

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

bool BccGrid::holds(std::int64_t tet) const { return cube_of(*this, tet)[at(static_cast<int>(tet % 12) / 4)] > 0; }

std::int64_t BccGrid::tet_number(const std::array<Key, 4>& corners) const {
    const Key *centres[2] = {}, *ends[2] = {};
    int odd = 0, even = 0;
    for (const Key& c : corners) {
        if (c[0] % 2 != 0 && odd < 2) centres[odd++] = &c;
        if (c[0] % 2 == 0 && even < 2) ends[even++] = &c;
    }
    const Key& upper = std::max(*centres[0], *centres[1]); // they differ along one axis only
    int axis = 0;
    while ((*centres[0])[at(axis)] == (*centres[1])[at(axis)]) ++axis;
    Key cube;
    for (std::size_t d = 0; d < 3; ++d) {
        cube[d] = (upper[d] - 1) / 2;
        if (upper[d] < 1 || cube[d] >= cubes[d]) return -1;
    }
    if (cube[at(axis)] < 1) return -1;
    const std::size_t u = at((axis + 1) % 3), v = at((axis + 2) % 3);
    const Key &p = *ends[0], &q = *ends[1];
    const bool along_u = p[v] == q[v];
    const int edge = along_u ? (p[v] == 2 * cube[v] ? 0 : 2) : (p[u] == 2 * cube[u] ? 3 : 1);
    return cube_number(cube) * 12 + axis * 4 + edge;
}

BccGrid::TetRing BccGrid::tets_around(const Key& a, const Key& b) const {
    TetRing ring;
    const auto add = [&](const Key& c, const Key& d, const Key& e, const Key& f) {
        const std::int64_t tet = tet_number({c, d, e, f});
        if (tet >= 0) ring.tets[at(ring.count++)] = tet;
    };
    const bool a_is_centre = a[0] % 2 != 0, b_is_centre = b[0] % 2 != 0;
    if (a_is_centre == b_is_centre) {
        // A long edge: the tet's other long edge stands across it, one unit to either side of its middle.
        Key middle;
        std::size_t axis = 0;
        for (std::size_t d = 0; d < 3; ++d) {
            middle[d] = (a[d] + b[d]) / 2;
            if (a[d] != b[d]) axis = d;
        }
        for (std::size_t k = 1; k < 3; ++k)
            for (int side : {-1, 1}) {
                const std::size_t across = (axis + k) % 3, along = (axis + 3 - k) % 3;
                Key c = middle;
                c[across] += side;
                Key d = c;
                c[along] -= 1, d[along] += 1;
                add(a, b, c, d);
            }
        return ring;
    }
    const Key &centre_key = a_is_centre ? a : b, &corner = a_is_centre ? b : a;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Key beyond = centre_key;
        beyond[axis] += 2 * (corner[axis] - centre_key[axis]);
        for (std::size_t k = 1; k < 3; ++k) {
            const std::size_t along = (axis + k) % 3;
            Key other = corner;
            other[along] = 2 * centre_key[along] - corner[along];
            add(centre_key, beyond, corner, other);
        }
    }
    return ring;
}

std::array<std::int64_t, 8> BccGrid::children(std::int64_t tet) const {
    const auto c = tet_vertices(tet);
    // In the finer lattice's coordinates a corner is its own double, a midpoint the sum of two corners.
    const auto sum = [&](std::size_t i, std::size_t j) {
        return Key{c[i][0] + c[j][0], c[i][1] + c[j][1], c[i][2] + c[j][2]};
    };
    const Key m01 = sum(0, 1), m02 = sum(0, 2), m03 = sum(0, 3), m12 = sum(1, 2), m13 = sum(1, 3), m23 = sum(2, 3);
    const BccGrid fine = finer();
    return {fine.tet_number({sum(0, 0), m01, m02, m03}), fine.tet_number({m01, sum(1, 1), m12, m13}),
            fine.tet_number({m02, m12, sum(2, 2), m23}), fine.tet_number({m03, m13, m23, sum(3, 3)}),
            fine.tet_number({m01, m23, m02, m12}),       fine.tet_number({m01, m23, m12, m13}),
            fine.tet_number({m01, m23, m13, m03}),       fine.tet_number({m01, m23, m03, m02})};
}

std::int64_t BccGrid::parent_of(std::int64_t finer_tet) const {
    // Where the finer tet's centroid lies, in eighths of this lattice's unit, so that all is exact. It is
    // strictly inside the parent: no case below is a tie.
    Key sum{};
    for (const Key& k : finer().tet_vertices(finer_tet))
        for (std::size_t d = 0; d < 3; ++d) sum[d] += k[d];
    Key cube, local; // of the centroid, from the middle of its cube
    for (std::size_t d = 0; d < 3; ++d) cube[d] = sum[d] / 16, local[d] = sum[d] - 16 * cube[d] - 8;
    int axis = 0;
    for (int d = 1; d < 3; ++d)
        if (std::abs(local[at(d)]) > std::abs(local[at(axis)])) axis = d;
    if (local[at(axis)] > 0) ++cube[at(axis)];
    if (cube[at(axis)] < 1 || cube[at(axis)] >= cubes[at(axis)]) return -1;
    const int x = local[at((axis + 1) % 3)], y = local[at((axis + 2) % 3)];
    const int edge = std::abs(y) > std::abs(x) ? (y < 0 ? 0 : 2) : (x > 0 ? 1 : 3);
    return cube_number(cube) * 12 + axis * 4 + edge;
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
    for (int d = 0; d < 3; ++d) grid.cubes[at(d)] = 2 * (static_cast<int>(std::ceil(0.5 * size[d] / side)) + 1);
    return grid;
}

} // namespace sinew::solver
