// The incremental potential of one implicit step: inertia, elasticity, fibres, gravity, attachments, damping.
// Gives its value, gradient and sparse Hessian; newton/minimise.h finds its minimum. A term that the scene does not
// use costs nothing here: no pass over the elements, no block in the pattern.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/attach/springs.h"
#include "solver/element/tissue_energy.h"
#include "solver/integrate/implicit_form.h"
#include "solver/linear/block_matrix.h"
#include "solver/linear/multigrid.h"
#include "solver/system.h"

#include <memory>
#include <optional>

namespace sinew::solver {

/// The forces on one tissue [N].
struct BodyForces {
    double sum = 0;     ///< what is left of them: the norm of the gradient
    double at_work = 0; ///< the largest norm among their kinds before they cancel
};

/// How far from equilibrium a position is.
struct Balance {
    double residual = 0;  ///< the worst tissue's sum / at_work
    bool reached = false; ///< every tissue's is within the tolerance, or as small as rounding lets it be
};

class Potential {
  public:
    explicit Potential(const Scene& scene);

    /// Takes the step's material values and makes the pattern for them and for these anchors, if it is not there yet.
    /// Returns true if the pattern is new.
    bool set_structure(const std::vector<std::vector<Anchor>>& anchors, const StepInputs& inputs);
    /// Fixes everything that is constant over the step from `before`, after set_structure. `inputs` must outlive the
    /// step.
    void begin_step(const State& before, const StepInputs& inputs);
    /// Takes other values than those of begin_step for what follows; they may not change the structure.
    void set_values(const StepInputs& inputs);
    /// Fixes what is constant over one stage of it. `form` must outlive the stage.
    void begin_stage(const State& before, const ImplicitForm& form, const std::vector<Points>& bones_after);
    /// Rates of strain at the end of the stage, at x; empty where nothing is damped. Call before describe.
    void strain_rates(const std::vector<double>& x, std::vector<double>& out) const;
    /// Acceleration of every vertex at `before` under the values of begin_step, 3 a vertex [m/s^2]; 0 where held.
    void accelerations(const State& before, std::vector<double>& out);

    const std::vector<int>& vertex_of_unknown() const { return system_.vertex_of_unknown; }
    std::size_t tissue_count() const { return system_.tissues.size(); }
    struct Range {
        std::size_t first, count;
    };
    Range unknowns_of(std::size_t tissue) const {
        return {system_.tissues[tissue].first_unknown, system_.tissues[tissue].unknown_count};
    }
    Range vertices_of(std::size_t tissue) const {
        const int body = system_.tissues[tissue].body;
        return {static_cast<std::size_t>(scene_.first_vertex(body)), scene_.vertex_count(body)};
    }
    /// Per vertex its unknown; -1 where it is held.
    const std::vector<int>& unknown_of_vertex() const { return system_.unknown; }
    /// Sum over the tets at each vertex of their share of modulus x volume [J].
    const std::vector<double>& vertex_stiffness() const { return tissues_.vertex_stiffness(); }
    std::size_t unknown_count() const { return scene_.system().vertex_of_unknown.size(); }
    const BlockPattern& pattern() const { return *pattern_; }
    UnknownPlaces places() const; ///< of the unknowns at rest

    /// How far every unknown, 3 numbers each, is from where it would be if only inertia and gravity acted, and each
    /// tissue's gain by going there, were it not elastic [J]. False, with nothing set, for a step without inertia, or
    /// if that is nowhere.
    bool free_flight(const std::vector<double>& x, std::vector<double>& direction, std::vector<double>& gain) const;
    /// Work of a force, 3 an unknown, against a direction, for each tissue.
    void work(const std::vector<double>& force, const std::vector<double>& direction, std::vector<double>& out) const;
    /// Value at x (3 a vertex, all vertices). With `gradient` (3 an unknown) also the gradient and `forces`, one a
    /// tissue.
    double evaluate(const std::vector<double>& x, std::vector<double>* gradient, std::vector<BodyForces>* forces);
    /// Judges the forces that evaluate found at x. Each tissue by its own: a stiff one does not excuse a soft one.
    Balance balance(const std::vector<double>& x, const std::vector<BodyForces>& forces, double tolerance);
    /// See TissueEnergy.
    int volume_levels() const { return tissues_.volume_levels(); }
    void relax_volume(int level) { tissues_.relax_volume(level); }
    /// Hessian at x; `project` clamps each element's eigenvalues at zero.
    void assemble(const std::vector<double>& x, bool project, BlockMatrix& a);
    /// How far the value may be off by rounding alone [J]: the laws subtract terms of the size of modulus x volume.
    double energy_rounding() const { return 1e-14 * energy_scale_ + 4e-16 * tissues_.elastic_scale(); }

    /// Elastic + fibre + attachment energy [J], least det F, tets with det F <= 0, longest attachment, at x.
    void describe(const std::vector<double>& x, StepRecord& record);
    /// Least det F where the energy is taken, at x.
    double least_j(const std::vector<double>& x);

  private:
    void update_loads(const StepInputs& inputs);
    void set_forces(const std::vector<double>& x, const std::vector<double>& gradient, std::vector<BodyForces>& forces);

    const Scene& scene_;
    const Scene::System& system_;
    TissueEnergy tissues_;
    std::optional<std::vector<std::vector<Anchor>>> anchors_;
    std::unique_ptr<Springs> springs_;
    std::unique_ptr<BlockPattern> pattern_;
    double energy_scale_ = 0;

    const StepInputs* inputs_ = nullptr;
    const ImplicitForm* form_ = nullptr;
    std::vector<double> x_before_;
    std::vector<double> loads_; ///< dead loads, 3 a vertex [N]; empty = none
    std::vector<double> spring_gradient_, velocity_;
    std::vector<double> offset_, inertia_, drag_; ///< x - target, M times it, M times the velocity, 3 an unknown
    std::vector<double> of_body_;                 ///< sums over springs, per body
};

} // namespace sinew::solver
