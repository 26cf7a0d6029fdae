// Surface tension [N/m] on the surfaces of tissues: tension times deformed area, which it makes smaller where it is
// positive and larger where it is negative. Painted, the tension of a cut triangle is the mean over it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/layered_surfaces.h"

namespace sinew::solver {

/// Parts: one tissue, SurfaceLayers [N/m].
extern const TermType surface_tension_type;

class SurfaceTension final : public Term {
  public:
    explicit SurfaceTension(const Scene& scene);

    Changes take(const StepInputs& inputs, const State& before) override;
    void add_couplings(Couplings& couplings) const override { surfaces_.triangles().add_couplings(couplings); }
    void bind(const BlockPattern& pattern) override { surfaces_.triangles().bind(pattern); }
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
    std::vector<double> rest_area_, tension_, rounding_; ///< per slot
    double rest_energy_ = 0, energy_scale_ = 0;
    mutable std::vector<double> squares_, places_;
};

} // namespace sinew::solver
