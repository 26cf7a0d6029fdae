// Transversely isotropic St. Venant-Kirchhoff about a fibre a: the Green strain is weighted by
//   Q = a a^T + t^(1/4) (I - a a^T),   psi = mu |Q E Q|^2 + lambda/2 tr(Q E Q)^2,
// t = stiffness across / stiffness along. With the Lamé parameters of Young's modulus along the fibre this is the
// choice nu_ij = nu sqrt(E_i/E_j), G_ij = sqrt(E_i E_j)/(2(1 + nu)) of Li and Barbic 2015 ("Stable anisotropic
// materials"): admissible for every t > 0, and StVK itself for t = 1.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/simd.h"

#include <array>

namespace sinew::solver {

template <class R>
class AnisotropicStVK {
  public:
    /// F row-major, a unit direction, root = t^(1/4).
    AnisotropicStVK(const R* f, const std::array<R, 3>& a, R root, R mu, R lambda)
        : mu_(mu)
        , lambda_(lambda) {
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                q_[3 * i + j] = (i == j ? root : R(0.0)) +
                                (R(1.0) - root) * a[static_cast<std::size_t>(i)] * a[static_cast<std::size_t>(j)];
        product(f, q_, d_);
        energy_ = R(0.0);
        for (R& t : tension_) t = R(0.0);
        for (int i = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j) {
                R c(0.0), squared(0.0); // D^T D = Q C Q and Q^2
                for (int k = 0; k < 3; ++k)
                    c += d_[3 * k + i] * d_[3 * k + j], squared += q_[3 * k + i] * q_[3 * k + j];
                strain_[3 * i + j] = strain_[3 * j + i] = R(0.5) * (c - squared);
            }
        add_strain(mu, lambda, strain_);
    }
    /// Adds damping (viscosity.h) of `share` times the law's own stiffness from the reference strain, whole: the
    /// weighted difference Q (E - E_ref) Q makes the tension.
    void add_viscosity(const R* reference, R share) {
        R qr[9], difference[9];
        product(q_, reference, qr);
        product(qr, q_, difference);
        for (int i = 0; i < 9; ++i) difference[i] = strain_[i] - difference[i];
        add_strain(share * mu_, share * lambda_, difference);
        mu_ *= R(1.0) + share;
        lambda_ *= R(1.0) + share;
    }
    R energy() const { return energy_; }
    /// P = D T Q with T the derivative by the weighted strain.
    void stress(R* p) const {
        R dt[9];
        product(d_, tension_, dt);
        product(dt, q_, p);
    }
    /// T: diagonal (11, 22, 33) and off-diagonal (23, 13, 12) entries, for clamping its eigenvalues.
    void tension(R* diagonal, R* off_diagonal) const {
        for (int i = 0; i < 3; ++i)
            diagonal[i] = tension_[4 * i], off_diagonal[i] = tension_[3 * ((i + 1) % 3) + (i + 2) % 3];
    }
    void set_tension(const R* diagonal, const R* off_diagonal) {
        for (int i = 0; i < 3; ++i) {
            const int a = (i + 1) % 3, b = (i + 2) % 3;
            tension_[4 * i] = diagonal[i];
            tension_[3 * a + b] = tension_[3 * b + a] = off_diagonal[i];
        }
    }
    /// Weighted shape gradient Q g.
    void weigh(const R* g, R* h) const {
        for (int i = 0; i < 3; ++i) h[i] = q_[3 * i] * g[0] + q_[3 * i + 1] * g[1] + q_[3 * i + 2] * g[2];
    }
    /// Adds factor x the Hessian block of the nodes with weighted shape gradients h and k:
    /// D [mu ((h.k) I + k h^T) + lambda h k^T] D^T + (h.T k) I. The first part is positive semi-definite over all
    /// nodes; the second is where T is.
    void add_block(const R* h, const R* k, R factor, R* block) const {
        R m[9], dm[9];
        const R hk = h[0] * k[0] + h[1] * k[1] + h[2] * k[2];
        R geometric(0.0);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                m[3 * i + j] = mu_ * ((i == j ? hk : R(0.0)) + k[i] * h[j]) + lambda_ * h[i] * k[j];
                geometric += h[i] * tension_[3 * i + j] * k[j];
            }
        product(d_, m, dm);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const R v = dm[3 * i] * d_[3 * j] + dm[3 * i + 1] * d_[3 * j + 1] + dm[3 * i + 2] * d_[3 * j + 2];
                block[3 * i + j] += factor * (v + (i == j ? geometric : R(0.0)));
            }
    }

  private:
    void add_strain(R mu, R lambda, const R* e) {
        const R trace = e[0] + e[4] + e[8];
        R squares(0.0);
        for (int i = 0; i < 9; ++i) {
            squares += e[i] * e[i];
            tension_[i] += R(2.0) * mu * e[i] + (i % 4 == 0 ? lambda * trace : R(0.0));
        }
        energy_ += mu * squares + R(0.5) * lambda * trace * trace;
    }
    static void product(const R* a, const R* b, R* out) {
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
    }
    R mu_, lambda_, energy_, q_[9], d_[9], strain_[9], tension_[9];
};

} // namespace sinew::solver
