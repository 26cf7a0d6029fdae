// How a piece of surface moves with the tet that carries it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/quadratic_tets.h"
#include "solver/surface/clipped_surface.h"

#include <algorithm>

namespace sinew::solver {

/// Shape functions of the N = 4 or 10 nodes of a tet, or of the 3 corners of a cloth's triangle, at a place of a piece,
/// and their derivatives towards its corners 1 and 2 from corner 0.
template <int N>
struct PieceShape {
    static_assert(N == 3 || N == 4 || N == quadratic_nodes);
    double value[N] = {}, u[N] = {}, v[N] = {};

    PieceShape(const SurfacePiece& piece, const Vec3& place) {
        double b[4], du[4], dv[4], least = 0;
        constexpr std::size_t corners = N == 3 ? 3 : 4;
        for (std::size_t k = 0; k < corners; ++k) {
            const double c[3] = {piece.inside[0][k], piece.inside[1][k], piece.inside[2][k]};
            b[k] = place[0] * c[0] + place[1] * c[1] + place[2] * c[2];
            du[k] = c[1] - c[0], dv[k] = c[2] - c[0];
            least = std::min({least, c[0], c[1], c[2]});
        }
        // Far outside of its tet it is carried by the corners alone, as embedded_point says.
        const bool is_linear = N <= 4 || least < -0.25;
        for (std::size_t k = 0; k < corners; ++k) {
            const double factor = is_linear ? 1 : 4 * b[k] - 1;
            value[k] = is_linear ? b[k] : b[k] * (2 * b[k] - 1);
            u[k] = factor * du[k], v[k] = factor * dv[k];
        }
        if constexpr (N == quadratic_nodes)
            for (std::size_t e = 0; !is_linear && e < 6; ++e) {
                const int i = tet_edge_corners[e][0], j = tet_edge_corners[e][1];
                value[4 + e] = 4 * b[i] * b[j];
                u[4 + e] = 4 * (b[i] * du[j] + b[j] * du[i]);
                v[4 + e] = 4 * (b[i] * dv[j] + b[j] * dv[i]);
            }
    }
};

} // namespace sinew::solver
