// The tets under surfaces with tension, all with N nodes. The area of a surface in a tet is summed up at points of its
// pieces; at each stands a facet, spanned by the derivatives of place along the piece, x_u and x_v, which are weighted
// sums of the nodes. In linear tets a piece is one facet and exact.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/surface_tets.h"

namespace sinew::solver {

template <int N>
class TenseTets {
  public:
    TenseTets(const Scene& scene, const LayeredSurfaces& surfaces);
    bool is_empty() const { return stencils_.count() == 0; }

    void take();
    /// At the places of the last `move`, measured from rest.
    double energy(bool with_forces);
    void add_hessian(bool project, BlockMatrix& a);
    void add_squared_stiffnesses(std::span<double> squares) const;
    double energy_scale() const { return energy_scale_; }
    /// Of all surfaces, at the places of the last `move` [m^2].
    double area();

    Stencils<N>& stencils() { return stencils_; }
    const Stencils<N>& stencils() const { return stencils_; }

  private:
    TenseTets(const Scene& scene, const LayeredSurfaces& surfaces, SurfaceTets<N> tets);
    /// One facet in each tet of a batch; those that a tet lacks have no tension.
    struct Facets {
        double u[N][lanes] = {}, v[N][lanes] = {};
        double share[lanes] = {};                                     ///< of the piece's area
        double tension[lanes] = {};                                   ///< times the share [N/m]
        double rest_area[lanes] = {}, rounding[lanes] = {1, 1, 1, 1}; ///< [m^2]
        int triangle[lanes] = {};
        Vec3 place[lanes];
    };
    void find_rest_areas(const std::vector<double>& rest);
    static StencilVectors<3> spanned(const Facets& f, const StencilVectors<N>& x) {
        const Pack zero(0.0);
        StencilVectors<3> out{PackVector{zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
        for (std::size_t a = 0; a < N; ++a) {
            out[1] = out[1] + Pack::load(f.u[a]) * (x[a] - x[0]);
            out[2] = out[2] + Pack::load(f.v[a]) * (x[a] - x[0]);
        }
        return out;
    }

    const LayeredSurfaces& surfaces_;
    std::vector<std::size_t> surface_; ///< per slot
    Stencils<N> stencils_;
    std::vector<Facets> facets_;
    std::vector<std::size_t> first_; ///< per batch, of its facets
    std::vector<double> squares_;    ///< per slot: of its tensions
    double rest_energy_ = 0, energy_scale_ = 0;
};

extern template class TenseTets<3>;
extern template class TenseTets<4>;
extern template class TenseTets<quadratic_nodes>;

} // namespace sinew::solver
