// Bending of four triangles, each by the angles at which its three neighbours stand to it: D/2 A |K|^2 with the
// curvature K that those angles say, K = B (t - t_0), and D the bendStiffness [N m]. B is found at rest, so that every
// quadratic surface over the sheet has its own K on any mesh: angles alone, weighed one by one, would bend more easily
// in one direction than in another, and on another triangulation otherwise. A free edge has no angle: K is then the
// smallest that the others allow. In small deflections this is a plate without lateral contraction.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/terms/cloth/hinge.h"

#include <cmath>

namespace sinew::solver {

/// A batch of triangles at rest.
struct FoldBatch {
    double weight[6][lanes] = {};     ///< A B^T B by angles (0,0) (0,1) (0,2) (1,1) (1,2) (2,2)
    double stiffness[lanes] = {};     ///< D [N m]
    double rest_angle[3][lanes] = {}; ///< t_0 [rad]
    double least[3][lanes] = {};      ///< see Hinge
    bool is_there[3][lanes] = {};     ///< whether there is a neighbour across from corner 0, 1, 2
};

/// An angle with whole turns added that bring it nearest to another.
inline Pack turned_to(Pack angle, Pack other) {
    const Pack apart = angle - other;
    for (int i = 0; i < lanes; ++i)
        if (std::abs(apart.v[i]) > M_PI) angle.v[i] -= 2 * M_PI * std::round(apart.v[i] / (2 * M_PI));
    return angle;
}

/// Corners: the triangle's, then what lies across from each in its neighbours; where there is none, the corner itself,
/// with weights of zero.
class Fold {
  public:
    static constexpr std::size_t corners[3][4] = {{1, 2, 0, 3}, {2, 0, 1, 4}, {0, 1, 2, 5}};

    /// `start`: per angle, where it was: what folds on beyond pi from there goes on to do so, else its energy would
    /// jump there, and a sheet that gravity folds onto itself would stop short of it. `damping`: share of stiffness
    /// times the scheme's velocity factor; `reference`: per angle, of its rate.
    Fold(const FoldBatch& batch, const StencilVectors<6>& x, const double* start, double damping,
         const double* reference)
        : hinges_{hinge(x, batch, 0), hinge(x, batch, 1), hinge(x, batch, 2)} {
        const Pack d = Pack::load(batch.stiffness);
        Pack off[3], rate[3];
        for (std::size_t i = 0; i < 3; ++i) {
            angle_[i] = turned_to(hinges_[i].angle(), Pack::load(start + i * lanes));
            off[i] = angle_[i] - Pack::load(batch.rest_angle[i]);
            rate[i] = damping > 0 ? angle_[i] - Pack::load(reference + i * lanes) : Pack(0.0);
        }
        energy_ = Pack(0.0);
        const Pack both = Pack(1 + damping) * d, braking = Pack(damping) * d;
        for (std::size_t i = 0; i < 3; ++i) {
            moment_[i] = Pack(0.0);
            for (std::size_t j = 0; j < 3; ++j) {
                const Pack w = Pack::load(batch.weight[i < j ? entry(i, j) : entry(j, i)]);
                moment_[i] += w * (d * off[j] + braking * rate[j]);
                energy_ += Pack(0.5) * w * (d * off[i] * off[j] + braking * rate[i] * rate[j]);
                stiffness_[i][j] = both * w;
            }
        }
    }

    /// Of the edge across from a corner.
    static Hinge hinge(const StencilVectors<6>& x, const FoldBatch& batch, std::size_t i) {
        return Hinge({x[corners[i][0]], x[corners[i][1]], x[corners[i][2]], x[corners[i][3]]},
                     Pack::load(batch.least[i]));
    }

    Pack energy() const { return energy_; }
    /// With whole turns since the start.
    Pack angle(std::size_t i) const { return angle_[i]; }

    void gradient(StencilVectors<6>& g) const {
        for (PackVector& v : g) v = {Pack(0.0), Pack(0.0), Pack(0.0)};
        StencilVectors<4> slope;
        for (std::size_t i = 0; i < 3; ++i) {
            hinges_[i].gradient(slope);
            for (std::size_t c = 0; c < 4; ++c) g[corners[i][c]] = g[corners[i][c]] + moment_[i] * slope[c];
        }
    }

    /// Rates of the angles for points that move at v.
    void rates(const StencilVectors<6>& v, Pack (&out)[3]) const {
        StencilVectors<4> slope;
        for (std::size_t i = 0; i < 3; ++i) {
            hinges_[i].gradient(slope);
            out[i] = Pack(0.0);
            for (std::size_t c = 0; c < 4; ++c) out[i] += dot(slope[c], v[corners[i][c]]);
        }
    }

    /// `project`: without the angles' own second derivatives, which leaves a positive semi-definite matrix.
    void hessian(bool project, StencilBlocks<6>& h) const {
        for (PackMatrix& block : h) block.fill(Pack(0.0));
        StencilVectors<6> slope[3];
        for (std::size_t i = 0; i < 3; ++i) {
            StencilVectors<4> own;
            hinges_[i].gradient(own);
            for (PackVector& v : slope[i]) v = {Pack(0.0), Pack(0.0), Pack(0.0)};
            for (std::size_t c = 0; c < 4; ++c) slope[i][corners[i][c]] = own[c];
        }
        for (std::size_t i = 0; i < 3; ++i) {
            StencilVectors<6> pull; // how the moment grows
            for (std::size_t c = 0; c < 6; ++c)
                pull[c] =
                    stiffness_[i][0] * slope[0][c] + stiffness_[i][1] * slope[1][c] + stiffness_[i][2] * slope[2][c];
            std::size_t pair = 0;
            for (std::size_t a = 0; a < 6; ++a)
                for (std::size_t b = a; b < 6; ++b, ++pair) add_outer(h[pair], slope[i][a], pull[b]);
        }
        if (project) return;
        for (std::size_t i = 0; i < 3; ++i) {
            StencilBlocks<4> own;
            for (PackMatrix& block : own) block.fill(Pack(0.0));
            hinges_[i].add_hessian(moment_[i], own);
            std::size_t pair = 0;
            for (std::size_t c = 0; c < 4; ++c)
                for (std::size_t d = c; d < 4; ++d, ++pair) {
                    const std::size_t a = corners[i][c], b = corners[i][d];
                    PackMatrix& to = h[a < b ? block(a, b) : block(b, a)];
                    for (std::size_t k = 0; k < 9; ++k) to[k] += own[pair][a <= b ? k : 3 * (k % 3) + k / 3];
                }
        }
    }

    /// Place of (i, j), i <= j, among the weights.
    static constexpr std::size_t entry(std::size_t i, std::size_t j) { return i * (5 - i) / 2 + j; }

  private:
    static constexpr std::size_t block(std::size_t a, std::size_t b) { return a * (11 - a) / 2 + b; }
    Hinge hinges_[3];
    Pack angle_[3], energy_, moment_[3], stiffness_[3][3];
};

} // namespace sinew::solver
