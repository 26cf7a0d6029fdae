// Pressure on four flat triangles, linear between their corners: with the area vector A = 1/2 (x1 - x0) x (x2 - x0),
// which points outwards, corner a gets the force -w_a A, w_a = (p_a + p0 + p1 + p2) / 12.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/symmetric3.h"
#include "solver/term/stencils.h"

namespace sinew::solver {

/// w_a of each corner [Pa].
struct PressureWeights {
    double of_corner[3][lanes];
    Pack operator[](std::size_t corner) const { return Pack::load(of_corner[corner]); }
};

/// Twice the area vector.
inline PackVector twice_area(const StencilVectors<3>& x) { return cross(x[1] - x[0], x[2] - x[0]); }

/// What is to be added to the energy, as the gradient: w_a A.
inline void pressure_gradient(const PressureWeights& w, const StencilVectors<3>& x, StencilVectors<3>& g) {
    const PackVector area = Pack(0.5) * twice_area(x);
    for (std::size_t a = 0; a < 3; ++a) g[a] = w[a] * area;
}

/// Volume of the tetrahedron between a triangle and a point.
inline Pack volume_seen_from(PackVector origin, const StencilVectors<3>& x) {
    return Pack(1.0 / 6) * dot(x[0] - origin, cross(x[1] - origin, x[2] - origin));
}

/// Symmetric part of the gradient's derivative: dA/dx_b is the matrix of 1/2 e_b x, where e_b is the edge across from
/// corner b, so the block (a, b) is that of 1/4 (w_a e_b - w_b e_a) x. Summed over a closed surface under constant
/// pressure, the part left out cancels (Bufler 1984).
inline PackVector pressure_axis(const PressureWeights& w, const StencilVectors<3>& edges, std::size_t a,
                                std::size_t b) {
    return Pack(0.25) * (w[a] * edges[b] - w[b] * edges[a]);
}

inline StencilVectors<3> edges_across(const StencilVectors<3>& x) { return {x[2] - x[1], x[0] - x[2], x[1] - x[0]}; }

inline void pressure_hessian(const PressureWeights& w, const StencilVectors<3>& x, StencilBlocks<3>& h) {
    const StencilVectors<3> edges = edges_across(x);
    std::size_t pair = 0;
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = a; b < 3; ++b) h[pair++] = cross_matrix(pressure_axis(w, edges, a, b));
}

inline PackVector longer(PackVector a, PackVector b) { return select(dot(a, a) > dot(b, b), a, b); }

/// The same with negative eigenvalues clamped. Its axes lie in the triangle's plane, so it couples motion along the
/// normal n with motion in the plane and nothing else: [0 B; B^T 0] with eigenvalues +-s, where s^2, u are those of
/// B B^T (3 x 3), and eigenvectors (u, +-B^T u / s).
inline void projected_pressure_hessian(const PressureWeights& w, const StencilVectors<3>& x, StencilBlocks<3>& h) {
    const StencilVectors<3> edges = edges_across(x);
    // The normal; of a triangle without area any direction across its longest edge.
    PackVector longest = edges[0];
    for (const PackVector& e : {edges[1], edges[2]}) longest = longer(e, longest);
    PackVector across{Pack(0.0), Pack(0.0), Pack(1e-150)};
    for (const PackVector& v :
         {PackVector{Pack(0.0), longest.z, -longest.y}, PackVector{-longest.z, Pack(0.0), longest.x},
          PackVector{longest.y, -longest.x, Pack(0.0)}})
        across = longer(v, across);
    PackVector n = twice_area(x);
    const Pack squared = dot(longest, longest);
    n = select(dot(n, n) > Pack(1e-24) * squared * squared, n, across);
    n = (Pack(1.0) / sqrt(dot(n, n))) * n;

    PackVector b[3][3]; // rows: along n at corner a; columns: in the plane at corner b
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) b[r][c] = cross(n, pressure_axis(w, edges, r, c));
    Pack squares[9], u[9];
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c)
            squares[3 * r + c] = dot(b[r][0], b[c][0]) + dot(b[r][1], b[c][1]) + dot(b[r][2], b[c][2]);
    const Pack size = squares[0] + squares[4] + squares[8];
    diagonalise_symmetric3(squares, u);
    for (PackMatrix& block : h) block.fill(Pack(0.0));
    for (std::size_t i = 0; i < 3; ++i) {
        const auto counts = squares[4 * i] > Pack(1e-28) * size;
        const Pack s = sqrt(select(counts, squares[4 * i], Pack(1.0)));
        const Pack half = select(counts, Pack(0.5) / s, Pack(0.0));
        PackVector mode[3]; // s times the eigenvector
        for (std::size_t c = 0; c < 3; ++c)
            mode[c] = (s * u[3 * c + i]) * n + u[i] * b[0][c] + u[3 + i] * b[1][c] + u[6 + i] * b[2][c];
        std::size_t pair = 0;
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = r; c < 3; ++c) add_outer(h[pair++], half * mode[r], mode[c]);
    }
}

} // namespace sinew::solver
