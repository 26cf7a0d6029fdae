// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/pressure/pressure_moments.h"

#include "solver/surface/piece_shape.h"
#include "solver/surface/triangle_rule.h"

namespace sinew::solver {

template <int N>
void add_moments(const SurfacePiece& piece, const std::array<double, 3>& at_corners, std::size_t lane,
                 PressureMoments<N>& moments) {
    for (const RulePoint& point : triangle_rule(N <= 4 ? 2 : 5)) { // of p N_a and the area vector
        const PieceShape<N> s(piece, point.place);
        const double p =
            at_corners[0] == at_corners[1] && at_corners[1] == at_corners[2]
                ? at_corners[0]
                : point.place[0] * at_corners[0] + point.place[1] * at_corners[1] + point.place[2] * at_corners[2];
        std::size_t pair = 0;
        for (std::size_t b = 0; b < N; ++b)
            for (std::size_t c = b + 1; c < N; ++c, ++pair) {
                const double area = 0.5 * point.share * p * (s.u[b] * s.v[c] - s.u[c] * s.v[b]);
                for (std::size_t a = 0; a < N; ++a) moments.m[a][pair][lane] += s.value[a] * area;
            }
    }
}

template void add_moments<3>(const SurfacePiece&, const std::array<double, 3>&, std::size_t, PressureMoments<3>&);
template void add_moments<4>(const SurfacePiece&, const std::array<double, 3>&, std::size_t, PressureMoments<4>&);
template void add_moments<quadratic_nodes>(const SurfacePiece&, const std::array<double, 3>&, std::size_t,
                                           PressureMoments<quadratic_nodes>&);

} // namespace sinew::solver
