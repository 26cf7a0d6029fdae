// Pressure [N/m^2] on the surfaces of tissues and on cloth: a force along the deformed normal, inwards where it is
// positive. It is integrated over the pieces of surface in each tet, exactly for what the tet's shape functions can do,
// so that a constant pressure is in balance with a constant stress. Where every connected piece of a surface is closed
// and its pressure constant it is the gradient of p (V - V at rest), V the volume that the piece encloses. Elsewhere it
// has no energy: the force is exact, the Hessian the symmetric part of its derivative, and within an iteration the
// energy is the work against the force as it was at the iteration's start. Pressure is as often soft as stiff: where
// negative eigenvalues are clamped, its Hessian is left out.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_pieces.h"
#include "solver/term/layered_surfaces.h"
#include "solver/terms/pressure/pressed_tets.h"

namespace sinew::solver {

/// Parts: one tissue or cloth, SurfaceLayers [Pa].
extern const TermType pressure_type;

class Pressure final : public Term {
  public:
    explicit Pressure(const Scene& scene);

    Changes take(const StepInputs& inputs, const State& before) override;
    void add_couplings(Couplings& couplings) const override;
    void bind(const BlockPattern& pattern) override;
    void begin_stage(const Stage& stage) override;
    double begin_iteration(const Positions& x) override;
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
    /// Lines along the normal: they end on the surface where it is pushed inwards and begin there where it is pulled.
    void marks(const Positions& x, Marks& out) const override;

  private:
    bool acts() const { return !surfaces_.all_zero(); }
    void find_potentials();
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
    SurfacePieces pieces_;
    std::vector<char> has_potential_; ///< per surface
    PressedTets<3> triangles_;
    PressedTets<4> linear_;
    PressedTets<quadratic_nodes> quadratic_;
    mutable std::vector<double> squares_, places_;
    mutable std::vector<Vec3> net_forces_;
};

} // namespace sinew::solver
