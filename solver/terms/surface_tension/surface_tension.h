// Surface tension [N/m] on the surfaces of tissues: tension times deformed area, which it makes smaller where it is
// positive and larger where it is negative. The area is that of the pieces of surface in each tet, which move by its
// shape functions: flat in linear tets; in quadratic ones curved, summed up at points, each a facet of three points
// that spans the surface there.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/layered_surfaces.h"
#include "solver/term/stencils.h"

namespace sinew::solver {

/// Parts: one tissue, SurfaceLayers [N/m].
extern const TermType surface_tension_type;

class SurfaceTension final : public Term {
  public:
    explicit SurfaceTension(const Scene& scene);

    Changes take(const StepInputs& inputs, const State& before) override;
    void add_couplings(Couplings& couplings) const override { facets_->add_couplings(couplings); }
    void bind(const BlockPattern& pattern) override { facets_->bind(pattern); }
    void begin_stage(const Stage&) override {}
    /// Measured from the area at rest.
    double energy(const Positions& x, bool with_forces) override;
    void add_gradient(std::span<double> gradient) const override;
    void add_held_gradient(std::span<double> gradient) const override;
    void add_hessian(const Positions& x, bool project, BlockMatrix& a) override;
    void raise_forces_at_work(const Positions& x, std::span<double> largest) const override;
    void add_squared_stiffnesses(std::span<double> squares) const override;
    double energy_scale() const override { return energy_scale_; }
    double stored_energy(const Positions& x) override { return energy(x, false); }
    void measure(const Positions& x, std::span<const double> reactions, std::vector<Measured>& out) const override;
    /// Points with the tension there.
    void marks(const Positions& x, Marks& out) const override;

  private:
    bool acts() const { return !surfaces_.all_zero(); }

    LayeredSurfaces surfaces_;
    std::unique_ptr<Stencils<3>> facets_;
    std::vector<double> share_;                          ///< per facet: of the piece's area
    std::vector<Vec3> place_;                            ///< and where it lies in the surface's triangle
    std::vector<std::size_t> surface_;                   ///< and in which of the surfaces
    std::vector<int> triangle_;                          ///< and triangles
    std::vector<double> rest_area_, tension_, rounding_; ///< per slot; the tension times the share
    double rest_energy_ = 0, energy_scale_ = 0;
    mutable std::vector<double> squares_, places_, vertex_places_;
};

} // namespace sinew::solver
