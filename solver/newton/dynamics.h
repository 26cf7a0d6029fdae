// What acts on every vertex of every scene: inertia, mass damping, gravity and dead loads. Fused into a few passes over
// the unknowns, and not a term of the list: no scene is without it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/mass_matrix.h"
#include "solver/integrate/implicit_form.h"
#include "solver/numbering.h"
#include "solver/term/term.h"

#include <memory>

namespace sinew::solver {

class Dynamics {
  public:
    explicit Dynamics(const Numbering& numbering)
        : numbering_(numbering) {}

    /// Sums up the masses of all terms. The pattern must outlive this.
    void set_masses(const BlockPattern& pattern, const std::vector<std::unique_ptr<Term>>& terms);
    /// Work of constant forces counts from x_before. `inputs` must outlive the step.
    void begin_step(const Positions& x_before, const StepInputs& inputs);
    void take(const StepInputs& inputs);
    /// `form` must outlive the stage.
    void begin_stage(const ImplicitForm& form) { form_ = &form; }
    const StepInputs& inputs() const { return *inputs_; }

    /// Energy at x [J]; adds the sizes of what it is the sum of to `scale`.
    double energy(const Positions& x, double& scale);
    /// Adds the gradient at the x of the last energy, 3 an unknown [N].
    void add_gradient(std::span<double> gradient) const;
    /// Adds the gradient by held vertices, 3 a vertex [N], at the x of the last energy.
    void add_held_gradient(const Positions& x, std::span<double> gradient);
    void raise_forces_at_work(std::span<double> largest) const;
    void add_hessian(BlockMatrix& a) const;

    /// See Potential.
    bool free_flight(const Positions& x, std::vector<double>& direction, std::vector<double>& gain) const;
    const MassMatrix& masses() const { return masses_; }

  private:
    double mass_damping() const { return form_->velocity_factor > 0 ? inputs_->mass_damping : 0; }
    std::size_t vertex(std::size_t unknown) const {
        return static_cast<std::size_t>(numbering_.vertex_of_unknown[unknown]);
    }
    const Numbering& numbering_;
    MassMatrix masses_;
    const StepInputs* inputs_ = nullptr;
    const ImplicitForm* form_ = nullptr;
    Positions x_before_;
    std::vector<double> loads_;                    ///< dead loads, 3 a vertex [N]; empty = none
    std::vector<double> offset_, inertia_;         ///< x - target and M times it, 3 an unknown
    std::vector<double> velocity_, drag_;          ///< likewise of the velocity
    std::vector<double> held_offset_, held_speed_; ///< both at held vertices, 3 a vertex; empty where none is coupled
};

} // namespace sinew::solver
