// The angle between two triangles at their common edge, of four such pairs, in (-pi, pi], and its derivatives. They
// are those of Tamstorf and Grinspun, "Discrete bending forces and their Jacobians" (2013), written by edges.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/stencils.h"
#include "solver/terms/cloth/pack_atan2.h"

namespace sinew::solver {

/// Corners: the edge's ends, then what lies across from it.
class Hinge {
  public:
    /// \param least of squared normals (four times those of areas), below which a triangle has no direction [m^4].
    Hinge(const StencilVectors<4>& x, Pack least)
        : edge_(x[1] - x[0])
        , to_2_(x[2] - x[0])
        , to_3_(x[3] - x[0]) {
        length_ = sqrt(dot(edge_, edge_));
        along_ = (Pack(1.0) / max(length_, Pack(1e-150))) * edge_;
        n_1_ = cross(edge_, to_2_), n_2_ = cross(to_3_, edge_);
        over_1_ = Pack(1.0) / max(dot(n_1_, n_1_), least), over_2_ = Pack(1.0) / max(dot(n_2_, n_2_), least);
        m_1_ = over_1_ * n_1_, m_2_ = over_2_ * n_2_;
        const Pack sine = dot(cross(n_2_, n_1_), along_), cosine = dot(n_1_, n_2_);
        angle_ = atan2(sine, cosine);
        // The gradient of the angle at corner i is a_i m_1 + b_i m_2.
        a_[0] = dot(to_2_ - edge_, along_), a_[2] = length_, a_[3] = Pack(0.0), a_[1] = -(a_[0] + a_[2]);
        b_[0] = dot(to_3_ - edge_, along_), b_[3] = length_, b_[2] = Pack(0.0), b_[1] = -(b_[0] + b_[3]);
    }

    Pack angle() const { return angle_; }

    void gradient(StencilVectors<4>& g) const {
        for (std::size_t i = 0; i < 4; ++i) g[i] = a_[i] * m_1_ + b_[i] * m_2_;
    }

    /// Adds `factor` times the second derivatives of the angle.
    void add_hessian(Pack factor, StencilBlocks<4>& h) const {
        const Pack zero(0.0);
        const PackVector none{zero, zero, zero};
        // By corner j: how the normals turn, m_1 and m_2 with them.
        PackMatrix by_1[4], by_2[4];
        for (std::size_t j = 0; j < 4; ++j) by_1[j].fill(zero), by_2[j].fill(zero);
        turn(n_1_, over_1_, Pack(-1.0) * to_2_, by_1[1]);
        turn(n_1_, over_1_, edge_, by_1[2]);
        turn(n_1_, over_1_, to_2_ - edge_, by_1[0]);
        turn(n_2_, over_2_, to_3_, by_2[1]);
        turn(n_2_, over_2_, Pack(-1.0) * edge_, by_2[3]);
        turn(n_2_, over_2_, edge_ - to_3_, by_2[0]);
        // And how a_i and b_i change.
        PackVector of_a[4][4], of_b[4][4];
        for (auto& row : of_a)
            for (PackVector& v : row) v = none;
        for (auto& row : of_b)
            for (PackVector& v : row) v = none;
        const Pack over = Pack(1.0) / max(length_, Pack(1e-150));
        const auto slope = [&](const PackVector& across, PackVector(&rows)[4][4], std::size_t far) {
            const PackVector bent = over * (across - dot(across, along_) * along_);
            rows[0][far] = along_, rows[0][1] = bent - along_, rows[0][0] = Pack(-1.0) * bent;
            rows[far][1] = along_, rows[far][0] = Pack(-1.0) * along_;
            for (std::size_t j = 0; j < 4; ++j) rows[1][j] = Pack(-1.0) * (rows[0][j] + rows[far][j]);
        };
        slope(to_2_ - edge_, of_a, 2);
        slope(to_3_ - edge_, of_b, 3);
        std::size_t pair = 0;
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i; j < 4; ++j, ++pair) {
                PackMatrix& block = h[pair];
                add_outer(block, factor * m_1_, of_a[i][j]);
                add_outer(block, factor * m_2_, of_b[i][j]);
                for (std::size_t d = 0; d < 9; ++d) block[d] += factor * (a_[i] * by_1[j][d] + b_[i] * by_2[j][d]);
            }
    }

  private:
    /// (I - 2 n n^T/n^2)/n^2 times the matrix of d -> v x d: how m = n/n^2 changes with n.
    static void turn(const PackVector& n, Pack over, const PackVector& v, PackMatrix& out) {
        const PackMatrix cross_v = cross_matrix(v);
        const PackVector row{n.x * cross_v[0] + n.y * cross_v[3] + n.z * cross_v[6],
                             n.x * cross_v[1] + n.y * cross_v[4] + n.z * cross_v[7],
                             n.x * cross_v[2] + n.y * cross_v[5] + n.z * cross_v[8]};
        for (std::size_t d = 0; d < 9; ++d) out[d] = over * cross_v[d];
        add_outer(out, (Pack(-2.0) * over * over) * n, row);
    }

    PackVector edge_, to_2_, to_3_, along_, n_1_, n_2_, m_1_, m_2_;
    Pack length_, over_1_, over_2_, angle_, a_[4], b_[4];
};

} // namespace sinew::solver
