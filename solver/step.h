// One frame of simulation: pure in (state, inputs). The workspace only saves work: dropping it at any moment changes
// no bit.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/initial_state.h"
#include "solver/scene.h"
#include "solver/state.h"
#include "solver/step_inputs.h"

#include <functional>
#include <memory>
#include <span>

namespace sinew::solver {

/// Symbolic analyses, factors and buffers of one scene. One step at a time may use it.
class Workspace {
  public:
    explicit Workspace(std::shared_ptr<const Scene> scene);
    ~Workspace();
    const Scene& scene() const { return *scene_; }
    struct Impl;
    Impl& impl() { return *impl_; }
    /// Symbolic analyses done so far; a steady simulation does one.
    int symbolic_analyses() const;

  private:
    std::shared_ptr<const Scene> scene_;
    std::unique_ptr<Impl> impl_;
};

/// Called in every Newton iteration.
struct StepControl {
    std::function<bool()> stop; ///< true = throw Stopped
    std::function<void(double done, int iteration, double residual)> progress;
};

/// Advances by all of `substeps`, each with its own step size. Non-convergence is recorded, not thrown. Throws
/// Error FE304 or FE202 (an input is not finite or out of range), FE302 (the step gives NaN), FE305 (memory), and
/// leaves no half-made state.
State advance(Workspace& workspace, const State& before, std::span<const StepInputs> substeps,
              const StepControl& control = {});

/// Throws what `advance` would throw because of its inputs, where it can be told from the state at the start frame
/// alone.
void rehearse(Workspace& workspace, const State& at_start, std::span<const StepInputs> substeps);

/// Deformed surface of every body [m]: tissues through their embedding, cloth by its vertices, bones as
/// given.
Points surface_positions(const Scene& scene, const State& state, int body);

/// Points embedded in a tissue's tets, carried to vertex positions x of the whole scene (3 a vertex) [m].
Points carried_positions(const Scene& scene, const std::vector<double>& x, int body, const Embedding& embedding);

} // namespace sinew::solver
