// Surface tension [N/m] on the surfaces of tissues and on cloth: tension times deformed area, which it makes smaller
// where it is positive and larger where it is negative. The area is that of the pieces of surface in each tet, which
// move by its shape functions: flat in linear tets, curved in quadratic ones.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/layered_surfaces.h"
#include "solver/terms/surface_tension/tense_tets.h"

namespace sinew::solver {

/// Parts: one tissue or cloth, SurfaceLayers [N/m].
extern const TermType surface_tension_type;

class SurfaceTension final : public Term {
  public:
    explicit SurfaceTension(const Scene& scene);

    Changes take(const StepInputs& inputs, const State& before) override;
    void add_couplings(Couplings& couplings) const override;
    void bind(const BlockPattern& pattern) override;
    void begin_stage(const Stage&) override {}
    /// Measured from the area at rest.
    double energy(const Positions& x, bool with_forces) override;
    void add_gradient(std::span<double> gradient) const override;
    void add_held_gradient(std::span<double> gradient) const override;
    void add_hessian(const Positions& x, bool project, BlockMatrix& a) override;
    void raise_forces_at_work(const Positions& x, std::span<double> largest) const override;
    void add_squared_stiffnesses(std::span<double> squares) const override;
    double energy_scale() const override {
        return triangles_.energy_scale() + linear_.energy_scale() + quadratic_.energy_scale();
    }
    double stored_energy(const Positions& x) override;
    void measure(const Positions& x, std::span<const double> reactions, std::vector<Measured>& out) const override;
    /// Points with the tension there.
    void marks(const Positions& x, Marks& out) const override;

  private:
    bool acts() const { return !surfaces_.all_zero(); }
    /// For cloth's triangles and both kinds of tets, as far as they are there.
    template <class Do>
    void for_each(const Do& what) {
        if (!triangles_.is_empty()) what(triangles_);
        if (!linear_.is_empty()) what(linear_);
        if (!quadratic_.is_empty()) what(quadratic_);
    }
    template <class Do>
    void for_each(const Do& what) const {
        if (!triangles_.is_empty()) what(triangles_);
        if (!linear_.is_empty()) what(linear_);
        if (!quadratic_.is_empty()) what(quadratic_);
    }

    LayeredSurfaces surfaces_;
    mutable TenseTets<3> triangles_;
    mutable TenseTets<4> linear_; ///< with their buffers
    mutable TenseTets<quadratic_nodes> quadratic_;
    mutable std::vector<double> squares_, places_;
};

} // namespace sinew::solver
