// What pressure on a surface asks of a tet that carries some of it. In a tet a surface moves by the shape functions N_b
// of its N nodes, so its area vector is a sum of products of two nodes, and the force is one of as many numbers as
// there are nodes and pairs of nodes, however fine the surface is:
//   g_a = int p N_a x_u x x_v du dv = sum over b < c of M(a; b, c) x_b x x_c,
//   M(a; b, c) = int p N_a (N_b,u N_c,v - N_c,u N_b,v) du dv.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/surface/clipped_surface.h"
#include "solver/term/stencils.h"

namespace sinew::solver {

/// Of b < c among N nodes.
template <int N>
constexpr std::size_t node_pair(std::size_t b, std::size_t c) {
    return b * (2 * N - b - 1) / 2 + c - b - 1;
}

/// M of a batch of tets, [a][pair][lane].
template <int N>
struct PressureMoments {
    static constexpr std::size_t pairs = N * (N - 1) / 2;
    double m[N][pairs][lanes];
    Pack at_pair(std::size_t a, std::size_t pair) const { return Pack::load(m[a][pair]); }
    /// M(a; b, c), which changes its sign with the order of b and c.
    Pack of(std::size_t a, std::size_t b, std::size_t c) const {
        return b < c ? at_pair(a, node_pair<N>(b, c)) : -at_pair(a, node_pair<N>(c, b));
    }
};

/// Adds a piece's share for N = 3, 4 or 10 nodes to a lane. `at_corners`: the pressure [Pa], linear between them.
template <int N>
void add_moments(const SurfacePiece& piece, const std::array<double, 3>& at_corners, std::size_t lane,
                 PressureMoments<N>& moments);

/// g by nodes; x by nodes, measured from anywhere.
template <int N>
void pressure_gradient(const PressureMoments<N>& moments, const StencilVectors<N>& x, StencilVectors<N>& g) {
    for (PackVector& v : g) v = {Pack(0.0), Pack(0.0), Pack(0.0)};
    std::size_t pair = 0;
    for (std::size_t b = 0; b < N; ++b)
        for (std::size_t c = b + 1; c < N; ++c, ++pair) {
            const PackVector product = cross(x[b], x[c]);
            for (std::size_t a = 0; a < N; ++a) g[a] = g[a] + moments.at_pair(a, pair) * product;
        }
}

/// Symmetric part of the gradient's derivative: the block (a, c) is the matrix of
///   1/2 sum over b of (M(a; b, c) - M(c; b, a)) x_b x.
/// Summed over a closed surface under constant pressure, the part left out cancels (Bufler 1984).
template <int N>
void pressure_hessian(const PressureMoments<N>& moments, const StencilVectors<N>& x, StencilBlocks<N>& h) {
    const Pack zero(0.0);
    std::size_t block = 0;
    for (std::size_t a = 0; a < N; ++a) {
        h[block++].fill(zero);
        for (std::size_t c = a + 1; c < N; ++c) {
            PackVector axis{zero, zero, zero};
            for (std::size_t b = 0; b < N; ++b) {
                Pack factor = zero;
                if (b != c) factor += moments.of(a, b, c);
                if (b != a) factor -= moments.of(c, b, a);
                axis = axis + Pack(0.5) * factor * x[b];
            }
            h[block++] = cross_matrix(axis);
        }
    }
}

} // namespace sinew::solver
