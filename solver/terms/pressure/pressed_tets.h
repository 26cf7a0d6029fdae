// The tets under surfaces with pressure, all with N nodes: forces on them, their energy and its derivatives.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/surface_tets.h"
#include "solver/terms/pressure/pressure_moments.h"

namespace sinew::solver {

template <int N>
class PressedTets {
  public:
    PressedTets(const Scene& scene, const LayeredSurfaces& surfaces);
    bool is_empty() const { return stencils_.count() == 0; }

    /// What the layers give on the surfaces, and which surfaces (by place) have a potential.
    void take_values(const std::vector<char>& has_potential);
    void take_envelopes();
    /// Energies from here on are the work against the force as it is where the points are now, where there is no
    /// potential. Returns by how much that changes the energy.
    double freeze();
    /// At the places of the last `move`, measured from rest.
    double energy(bool with_forces);
    double potential_energy(bool with_forces);
    void add_hessian(BlockMatrix& a);
    /// Of the last evaluation with forces, the net force of each surface (by place) [N].
    void add_net_forces(std::vector<Vec3>& forces) const;
    void add_squared_stiffnesses(std::span<double> squares) const;
    double energy_scale() const { return energy_scale_; }

    Stencils<N>& stencils() { return stencils_; }
    const Stencils<N>& stencils() const { return stencils_; }

  private:
    PressedTets(const Scene& scene, const LayeredSurfaces& surfaces, SurfaceTets<N> tets);
    double frozen_work() const;
    StencilVectors<N> from_first(const StencilVectors<N>& x) const {
        StencilVectors<N> y;
        for (std::size_t a = 0; a < N; ++a) y[a] = x[a] - x[0];
        return y;
    }

    const LayeredSurfaces& surfaces_;
    const std::vector<double>& rest_;        ///< of all vertices
    std::vector<std::vector<int>> slot_;     ///< per surface, per piece; none on tets with another count of nodes
    std::vector<std::size_t> surface_;       ///< per slot
    std::vector<std::size_t> point_surface_; ///< per point
    std::vector<int> origin_;                ///< per slot: a point of the same surface
    Stencils<N> stencils_;
    std::vector<PressureMoments<N>> moments_;                       ///< per batch, without the envelope
    std::vector<double> envelope_, has_potential_, size_, squares_; ///< per slot
    std::vector<char> is_frozen_;                                   ///< per point
    bool some_frozen_ = false;
    std::vector<double> frozen_places_, frozen_gradient_; ///< 3 a point
    double rest_energy_ = 0, energy_scale_ = 0;
};

extern template class PressedTets<3>;
extern template class PressedTets<4>;
extern template class PressedTets<quadratic_nodes>;

} // namespace sinew::solver
