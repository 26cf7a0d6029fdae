// The body-centred cubic lattice as numbers: which tets and vertices there are and where they lie.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <cstdint>

namespace sinew::solver {

/// Lattice coordinates count half cube sides from the grid's lowest corner: cube corners are even in all
/// three, cube centres odd in all three. Two cubes that share a face give four tets about the line through
/// their centres, one for each edge of the face: (lower centre, upper centre, edge start, edge end),
/// positively oriented, volume side^3 / 12. A tet belongs to the cube above its face and is numbered cube *
/// 12 + axis * 4 + edge.
struct BccGrid {
    using Key = std::array<int, 3>; ///< lattice coordinates of a vertex
    using Barycentric = std::array<double, 4>;

    Vec3 centre = Vec3::Zero(); ///< position of the lattice vertex `half` [m]
    double side = 1;            ///< of a cube [m]
    std::array<int, 3> cubes{}; ///< along x, y, z; even
    Key half() const { return {cubes[0], cubes[1], cubes[2]}; }

    std::int64_t cube_count() const { return std::int64_t{1} * cubes[0] * cubes[1] * cubes[2]; }
    std::int64_t tet_count() const { return 12 * cube_count(); }
    std::int64_t cube_number(const Key& cube) const {
        return (std::int64_t{cube[2]} * cubes[1] + cube[1]) * cubes[0] + cube[0];
    }

    /// Corners of tet `tet`; the lower centre may lie outside the grid for cubes at its lower border.
    std::array<Key, 4> tet_vertices(std::int64_t tet) const;
    /// Whether both centres of the tet belong to cubes of the grid.
    bool holds(std::int64_t tet) const;

    Vec3 position(const Key& v) const {
        return centre + 0.5 * side * Vec3(v[0] - cubes[0], v[1] - cubes[1], v[2] - cubes[2]);
    }
    /// Lattice coordinates of a point.
    Vec3 coordinates(const Vec3& p) const { return (p - centre) * (2 / side) + Vec3(cubes[0], cubes[1], cubes[2]); }
    /// Order of the vertices of a lattice mesh: by z, then y, then x.
    std::int64_t vertex_number(const Key& v) const {
        return (std::int64_t{v[2]} * (2 * cubes[1] + 1) + v[1]) * (2 * cubes[0] + 1) + v[0];
    }
    Key vertex_key(std::int64_t number) const {
        const std::int64_t nx = 2 * cubes[0] + 1, ny = 2 * cubes[1] + 1;
        return {static_cast<int>(number % nx), static_cast<int>(number / nx % ny), static_cast<int>(number / nx / ny)};
    }
    std::int64_t vertex_numbers() const { return vertex_number(Key{0, 0, 2 * cubes[2] + 1}); }

    /// The lattice of half the side that contains this one: its coordinates are twice this one's.
    BccGrid finer() const { return {centre, side / 2, {2 * cubes[0], 2 * cubes[1], 2 * cubes[2]}}; }
    /// The tet with these corners, in any order; -1 if the grid does not hold it.
    std::int64_t tet_number(const std::array<Key, 4>& corners) const;
    /// Tets of the grid about the edge from a to b: up to four for an edge between two centres or two cube
    /// corners (a long one), up to six for one from a centre to a corner (a short one).
    struct TetRing {
        std::array<std::int64_t, 6> tets;
        int count = 0;
    };
    TetRing tets_around(const Key& a, const Key& b) const;
    /// The eight tets of `finer()` that fill a tet: the four at its corners, then the four about the line
    /// that joins the midpoints of its two long edges. All of them are lattice tets again.
    std::array<std::int64_t, 8> children(std::int64_t tet) const;
    /// The tet of this grid in which a tet of `finer()` lies; -1 if the grid does not hold it.
    std::int64_t parent_of(std::int64_t finer_tet) const;
};

/// Barycentric coordinates, in the tet over `cube`'s lower face across `axis` at edge `edge`, of a point
/// given in lattice coordinates.
BccGrid::Barycentric bcc_barycentric(const BccGrid::Key& cube, int axis, int edge, const Vec3& lattice_point);

/// Grid that holds every tet which can touch a box of this size about `centre`; a lattice vertex lies at
/// `centre`. The sizes must be small enough for `int`.
BccGrid make_bcc_grid(const Vec3& centre, const Vec3& size, double side);

} // namespace sinew::solver
