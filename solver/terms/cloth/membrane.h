// Stretch and shear of four flat triangles, after Baraff and Witkin (1998), per rest area, so that values mean the same
// on any mesh:
//   A [ k/2 ((|w_u| - 1)^2 + (|w_v| - 1)^2) + s/2 (w_u . w_v)^2 ],  w_u = F e_u, w_v = F e_v,
// e_u along the warp, e_v along the weft. k is tensileStiffness, s shearStiffness [N/m]. Damping adds to each of the
// three numbers c the energy b/2 (c - r)^2, r the reference of its rate (integrate/strain_reference.h).
// The eigenvalues of the shear's second derivatives: Kim, "A Finite Element Formulation of Baraff-Witkin Cloth" (2020).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/stencils.h"

namespace sinew::solver {

/// A batch of triangles at rest, their stiffnesses, and what they are damped against.
struct MembraneBatch {
    double u[2][lanes], v[2][lanes];     ///< w_u = sum over a = 1, 2 of u[a-1] (x_a - x_0) [1/m]
    double stretch[lanes], shear[lanes]; ///< times rest area [J]
    double area[lanes];                  ///< at rest, as modelled [m^2]
};

class Membrane {
  public:
    /// `damping`: share of stiffness times the scheme's velocity factor; `reference`: per number, of |w_u| - 1,
    /// |w_v| - 1 and w_u . w_v; read where there is damping.
    Membrane(const MembraneBatch& batch, const StencilVectors<3>& x, double damping, const double (*reference)[lanes])
        : u_{Pack::load(batch.u[0]), Pack::load(batch.u[1])}
        , v_{Pack::load(batch.v[0]), Pack::load(batch.v[1])} {
        const PackVector e1 = x[1] - x[0], e2 = x[2] - x[0];
        wu_ = u_[0] * e1 + u_[1] * e2, wv_ = v_[0] * e1 + v_[1] * e2;
        length_u_ = sqrt(dot(wu_, wu_)), length_v_ = sqrt(dot(wv_, wv_));
        const Pack one(1.0), numbers[3] = {length_u_ - one, length_v_ - one, dot(wu_, wv_)};
        const Pack k[3] = {Pack::load(batch.stretch), Pack::load(batch.stretch), Pack::load(batch.shear)};
        for (std::size_t i = 0; i < 3; ++i) {
            const Pack c = number_[i] = numbers[i];
            energy_[i] = Pack(0.5) * k[i] * c * c, force_[i] = k[i] * c, stiffness_[i] = k[i];
            if (!(damping > 0)) continue;
            const Pack b = Pack(damping) * k[i], off = c - Pack::load(reference[i]);
            energy_[i] += Pack(0.5) * b * off * off, force_[i] += b * off, stiffness_[i] += b;
        }
        // Directions end where there is no length to have one.
        const Pack tiny(1e-12);
        over_u_ = one / max(length_u_, tiny), over_v_ = one / max(length_v_, tiny);
    }

    Pack energy() const { return energy_[0] + energy_[1] + energy_[2]; }
    /// |w_u| - 1, |w_v| - 1, w_u . w_v.
    const Pack& number(std::size_t i) const { return number_[i]; }

    /// Rates of the three numbers for points that move at v.
    void rates(const StencilVectors<3>& v, Pack (&out)[3]) const {
        const PackVector e1 = v[1] - v[0], e2 = v[2] - v[0];
        const PackVector du = u_[0] * e1 + u_[1] * e2, dv = v_[0] * e1 + v_[1] * e2;
        out[0] = over_u_ * dot(wu_, du), out[1] = over_v_ * dot(wv_, dv), out[2] = dot(wu_, dv) + dot(wv_, du);
    }

    void gradient(StencilVectors<3>& g) const {
        const PackVector by_u = (force_[0] * over_u_) * wu_ + force_[2] * wv_;
        const PackVector by_v = (force_[1] * over_v_) * wv_ + force_[2] * wu_;
        for (std::size_t a = 0; a < 2; ++a) g[a + 1] = u_[a] * by_u + v_[a] * by_v;
        g[0] = Pack(-1.0) * (g[1] + g[2]);
    }

    /// `project`: of each of the three parts the negative eigenvalues clamped to zero, in closed form.
    void hessian(bool project, StencilBlocks<3>& h) const {
        const Pack zero(0.0);
        PackMatrix uu, uv, vv; // by w_u and w_v
        uu.fill(zero), uv.fill(zero), vv.fill(zero);
        add_stretch(wu_, over_u_, force_[0], stiffness_[0], project, uu);
        add_stretch(wv_, over_v_, force_[1], stiffness_[1], project, vv);
        if (project)
            add_projected_shear(uu, uv, vv);
        else
            add_shear(uu, uv, vv);
        const Pack u[3] = {-(u_[0] + u_[1]), u_[0], u_[1]}, v[3] = {-(v_[0] + v_[1]), v_[0], v_[1]};
        std::size_t pair = 0;
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = a; b < 3; ++b, ++pair)
                for (std::size_t d = 0; d < 9; ++d)
                    h[pair][d] = u[a] * u[b] * uu[d] + v[a] * v[b] * vv[d] + u[a] * v[b] * uv[d] +
                                 v[a] * u[b] * uv[3 * (d % 3) + d / 3];
    }

  private:
    /// Of k/2 (|w| - 1)^2: k along w, the force over the length across it.
    static void add_stretch(const PackVector& w, Pack over, Pack force, Pack stiffness, bool project, PackMatrix& m) {
        Pack across = force * over;
        if (project) across = max(across, Pack(0.0));
        for (std::size_t d = 0; d < 9; d += 4) m[d] += across;
        const PackVector along = over * w;
        add_outer(m, (stiffness - across) * along, along);
    }
    /// Of s/2 I^2, I = w_u . w_v, with f its first and k its second derivative by I: f times the exchange of the two
    /// vectors, and k g g^T with g = (w_v, w_u).
    void add_shear(PackMatrix& uu, PackMatrix& uv, PackMatrix& vv) const {
        const Pack k = stiffness_[2];
        add_outer(uu, k * wv_, wv_);
        add_outer(uv, k * wv_, wu_);
        add_outer(vv, k * wu_, wu_);
        for (std::size_t d = 0; d < 9; d += 4) uv[d] += force_[2];
    }
    /// By sums and differences of the two vectors, over sqrt 2, the exchange is +1 and -1, and g = (p, m). Square to p
    /// and m there is f and -f; along them the 2 x 2 matrix [f + k p^2, k p m; k p m, -f + k m^2].
    void add_projected_shear(PackMatrix& uu, PackMatrix& uv, PackMatrix& vv) const {
        const Pack zero(0.0), f = force_[2], k = stiffness_[2], half(0.5);
        const PackVector plus = Pack(0.7071067811865476) * (wv_ + wu_), minus = Pack(0.7071067811865476) * (wv_ - wu_);
        const Pack pp = dot(plus, plus), mm = dot(minus, minus), p = sqrt(pp), m = sqrt(mm), tiny(1e-150);
        const PackVector to_p = (Pack(1.0) / max(p, tiny)) * plus, to_m = (Pack(1.0) / max(m, tiny)) * minus;
        Pack a = f + k * pp, b = k * p * m, c = k * mm - f;
        const Pack mean = half * (a + c), root = sqrt(half * (a - c) * half * (a - c) + b * b);
        const Pack high = mean + root, low = mean - root;
        // Of two signs: the part along the positive one's direction, (A - low) high / (high - low).
        const Pack share = high / max(Pack(2.0) * root, tiny);
        const auto clamp = [&](Pack entry, Pack less) {
            const Pack mixed = select(high > zero, share * (entry - less), zero);
            return select(low < zero, mixed, entry);
        };
        const Pack pa = clamp(a, low), pb = clamp(b, zero), pc = clamp(c, low);
        const Pack rest_p = max(f, zero), rest_m = max(-f, zero);
        PackMatrix by_p, by_m, mixed;
        by_p.fill(zero), by_m.fill(zero), mixed.fill(zero);
        for (std::size_t d = 0; d < 9; d += 4) by_p[d] += rest_p, by_m[d] += rest_m;
        add_outer(by_p, (pa - rest_p) * to_p, to_p);
        add_outer(by_m, (pc - rest_m) * to_m, to_m);
        add_outer(mixed, pb * to_p, to_m);
        for (std::size_t d = 0; d < 9; ++d) {
            const std::size_t turned = 3 * (d % 3) + d / 3;
            uu[d] += half * (by_p[d] + mixed[d] + mixed[turned] + by_m[d]);
            vv[d] += half * (by_p[d] - mixed[d] - mixed[turned] + by_m[d]);
            uv[d] += half * (by_p[d] - mixed[d] + mixed[turned] - by_m[d]);
        }
    }

    Pack u_[2], v_[2];
    PackVector wu_, wv_;
    Pack length_u_, length_v_, over_u_, over_v_;
    Pack number_[3], energy_[3], force_[3], stiffness_[3];
};

} // namespace sinew::solver
