// Pressure [N/m^2] on the surfaces of tissues: a force along the deformed normal, inwards where it is positive. Where a
// connected piece of surface is closed and its pressure constant it is the gradient of p (V - V at rest), V the volume
// that the piece encloses. Elsewhere it has no energy: the force is exact, the Hessian the symmetric part of its
// derivative, and within an iteration the energy is the work against the force as it was at the iteration's start.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/layered_surfaces.h"
#include "solver/terms/pressure/pressure_triangle.h"
#include "solver/terms/pressure/surface_pieces.h"

namespace sinew::solver {

/// Parts: one tissue, SurfaceLayers [Pa].
extern const TermType pressure_type;

class Pressure final : public Term {
  public:
    explicit Pressure(const Scene& scene);

    Changes take(const StepInputs& inputs, const State& before) override;
    void add_couplings(Couplings& couplings) const override { surfaces_.triangles().add_couplings(couplings); }
    void bind(const BlockPattern& pattern) override { surfaces_.triangles().bind(pattern); }
    void begin_stage(const Stage& stage) override;
    double begin_iteration(const Positions& x) override;
    double energy(const Positions& x, bool with_forces) override;
    void add_gradient(std::span<double> gradient) const override;
    void add_held_gradient(std::span<double> gradient) const override;
    void add_hessian(const Positions& x, bool project, BlockMatrix& a) override;
    void raise_forces_at_work(const Positions& x, std::span<double> largest) const override;
    void add_squared_stiffnesses(std::span<double> squares) const override;
    double energy_scale() const override { return energy_scale_; }
    double stored_energy(const Positions& x) override;
    void measure(const Positions& x, std::span<const double> reactions, std::vector<Measured>& out) const override;
    /// Lines along the normal: they end on the surface where it is pushed inwards and begin there where it is pulled.
    void marks(const Positions& x, Marks& out) const override;

  private:
    bool acts() const { return !surfaces_.all_zero(); }
    double potential_energy(bool with_forces);
    double frozen_work() const;

    LayeredSurfaces surfaces_;
    SurfacePieces pieces_;
    std::vector<PressureWeights> weights_;          ///< per batch
    std::vector<double> pressure_;                  ///< per slot, where there is a potential, else 0 [Pa]
    std::vector<int> origin_;                       ///< per slot: a point of the same piece
    std::vector<char> piece_is_frozen_, is_frozen_; ///< per piece, per point: its force has no potential
    bool some_frozen_ = false;
    std::vector<double> frozen_places_, frozen_gradient_; ///< at the start of the iteration, 3 a point
    double rest_energy_ = 0, energy_scale_ = 0;
    mutable std::vector<double> squares_, places_;
};

} // namespace sinew::solver
