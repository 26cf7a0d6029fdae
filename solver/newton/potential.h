// The incremental potential of one implicit step: dynamics plus the terms that the scene uses, in the order of
// terms/all_terms.cpp. Gives its value, gradient and sparse Hessian; newton/minimise.h finds its minimum. Knows no
// force by name: a term that the scene does not use is not there.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/multigrid.h"
#include "solver/newton/affine_momentum.h"
#include "solver/newton/dynamics.h"
#include "solver/scene.h"

#include <memory>
#include <optional>

namespace sinew::solver {

/// The forces on one body that deforms [N].
struct BodyForces {
    double sum = 0;     ///< what is left of them: the norm of the gradient
    double at_work = 0; ///< the largest norm among their kinds before they cancel
};

/// How far from equilibrium a position is.
struct Balance {
    double residual = 0;  ///< the worst body's sum / at_work
    bool reached = false; ///< every body's is within the tolerance, or as small as rounding lets it be
};

class Potential {
  public:
    explicit Potential(const Scene& scene);
    ~Potential();

    /// Takes the step's values, and the terms' memories in `before`, and makes the pattern for them if it is not there
    /// yet. Returns true if the pattern is new. `within_step`: they are other values of a step that was taken.
    bool take(const State& before, const StepInputs& inputs, bool within_step = false);
    /// Fixes everything that is constant over the step from `before`, after take. `inputs` must outlive the step.
    void begin_step(const State& before, const StepInputs& inputs);
    /// Takes affine momentum out of v at x, as the step's values ask (AffineMomentum).
    void damp_affine_momentum(const Positions& x, Positions& v) {
        affine_momentum_.remove(numbering_, masses(), dynamics_.inputs(), x, v);
    }
    bool has_frozen() const { return !frozen_.empty(); }
    /// Flags of bodies that are frozen in the step; empty: none is.
    const std::vector<char>& frozen() const { return frozen_; }
    /// Whether one of those flagged is frozen no longer.
    bool lets_go(const std::vector<char>& frozen_before) const;
    /// Sets v, 3 a vertex or empty, to zero where bodies are frozen (TissueInputs::enable).
    void stop_frozen(Positions& v) const;
    /// The same of a direction, 3 an unknown: what was solved with a factor of other times may lead anywhere.
    void stop_frozen_unknowns(std::vector<double>& direction) const;
    /// Puts their vertices to where they are in `from`.
    void put_frozen_back(const Positions& from, Positions& x) const;
    /// Takes other values than those of begin_step for what follows; they may not change the structure.
    void set_values(const State& before, const StepInputs& inputs);
    /// Fixes what is constant over one stage of it. What is passed must outlive the stage.
    void begin_stage(const State& before, const ImplicitForm& form, const std::vector<Points>& bones_after);
    /// Puts what is held to where it is at the end of the stage.
    void place_held(Positions& x);
    /// Where x is as place_held left it: into `out` x with bodies taken along by what moved then, and flags of those
    /// deformables. False: nothing has moved.
    bool carry(const Positions& x, Positions& out, std::vector<char>& bodies) const;
    /// Acceleration of every vertex at `before` under the values of begin_step, 3 a vertex [m/s^2]; 0 where held.
    /// Without what touches (TermType::presses).
    void accelerations(const State& before, std::vector<double>& out);
    /// Takes out of accelerations at the end of the stage, at x, what comes from what touches.
    void leave_out_presses(const Positions& x, std::vector<double>& accelerations);

    const Numbering& numbering() const { return numbering_; }
    std::size_t unknown_count() const { return numbering_.unknown_count(); }
    /// Sum over the elements at each vertex of their share of modulus x volume [J].
    const std::vector<double>& vertex_stiffness() const { return vertex_stiffness_; }
    const BlockPattern& pattern() const { return *pattern_; }
    const MassMatrix& masses() const { return dynamics_.masses(); }
    UnknownPlaces places() const; ///< of the unknowns at rest
    /// Of the stage: stiffness of springs by blocks of the pattern, and of what the unknowns are made of, one each
    /// [N/m].
    void add_up_springs(std::vector<double>& springs, std::vector<double>& elastic) const;

    /// How far every unknown, 3 numbers each, is from where it would be if only inertia and gravity acted, and each
    /// body's gain by going there, were it not elastic [J]. False, with nothing set, for a step without inertia, or if
    /// that is nowhere.
    bool free_flight(const Positions& x, std::vector<double>& direction, std::vector<double>& gain) const;
    /// Work of a force, 3 an unknown, against a direction, for each deformable.
    void work(const std::vector<double>& force, const std::vector<double>& direction, std::vector<double>& out) const;
    /// Before an iteration at x; returns by how much it changes the value there (see Term).
    double begin_iteration(const Positions& x);
    /// Whether a term takes in something anew (see Term).
    bool settle(const Positions& x, bool stuck);
    bool renew(const Positions& x);
    bool widen(const Positions& x);
    /// Value at x. With `gradient` (3 an unknown) also the gradient and `forces`, one a deformable. Where settle and
    /// renew alone came since the forces at the same x, only terms that took something in anew are asked again.
    double evaluate(const Positions& x, std::vector<double>* gradient, std::vector<BodyForces>* forces);
    /// Judges the forces that evaluate found at x. Each body by its own: a stiff one does not excuse a soft one.
    Balance balance(const Positions& x, const std::vector<BodyForces>& forces, double tolerance);
    /// Flags of the deformables whose forces were found small enough by the last balance.
    const std::vector<char>& in_balance() const { return in_balance_; }
    /// Hessian at x; `project` clamps each element's eigenvalues at zero.
    void assemble(const Positions& x, bool project, BlockMatrix& a);
    /// From here on deformables with a flag, of whole islands (newton/islands.h), stay where they were evaluated last:
    /// what they are made of is not asked again, their gradient is zero and their rows of the Hessian are the
    /// identity's. Forces are judged as before. An empty list: none stays.
    void rest(const std::vector<char>& deformables);
    bool rests(std::size_t deformable) const { return !resting_.empty() && resting_[deformable] != 0; }
    const std::vector<char>& resting() const { return resting_; } ///< flags of deformables; empty: none
    /// The longest share of a direction (3 an unknown) that a move from x may take.
    double longest_move(const Positions& x, const std::vector<double>& direction) const;
    /// How far the value may be off by rounding alone [J].
    double energy_rounding() const;

    /// After evaluate: whether bones have moved and the springs by which flesh hangs on them hold so much more energy
    /// than contacts that those are between the new places of bones and the old ones of flesh.
    bool contacts_are_early() const;
    /// After evaluate: whether contacts press.
    bool contacts_press() const;
    /// See Term.
    bool keep_to_edges(bool on) {
        bool any = false;
        for (const auto& term : changing_terms()) any = term->keep_to_edges(on) || any;
        return any;
    }
    /// See Term.
    void press_as_before(bool on) {
        for (const auto& term : changing_terms()) term->press_as_before(on);
    }

    /// See Term.
    int levels() const;
    void relax(int level);
    void continue_laws(bool on) {
        for (const auto& term : changing_terms()) term->continue_laws(on);
    }

    /// What the terms keep for the next step, after a step that ended at x.
    void remember(const Positions& x, bool keeps_history, std::vector<TermMemory>& memories) const;
    /// The terms' measures at x, at the end of a stage.
    void measure(const Positions& x, std::vector<Measured>& out);
    /// Stored energy [J], least det F and inverted elements at x. What it does to the stage's damping ends the stage.
    void describe(const Positions& x, StepRecord& record);
    /// Least det F where the energy is taken, at x.
    double least_j(const Positions& x);
    void marks(const Positions& x, Marks& out) const;
    /// Null: the scene does not use it.
    const Term* find(const TermType& type) const;

  private:
    /// For whatever may change what a term gives, or what it keeps of the last evaluation.
    const std::vector<std::unique_ptr<Term>>& changing_terms() {
        forces_hold_ = false;
        return terms_;
    }
    CoupledRows coupled_by(const Term& term) const;
    template <class Take>
    bool take_anew(const Take& take);
    void set_forces(const Positions& x, const std::vector<double>& gradient, std::vector<BodyForces>& forces);
    void freeze_rows(BlockMatrix& a) const;
    void rest_rows(BlockMatrix& a) const;

    const Scene& scene_;
    const Numbering& numbering_;
    std::vector<std::unique_ptr<Term>> terms_;
    std::vector<const TermType*> types_; ///< of the terms, in the same order
    Dynamics dynamics_;
    AffineMomentum affine_momentum_;
    std::vector<char> frozen_;          ///< flags of deformables that the step leaves where they are; empty: none
    std::vector<char> frozen_unknowns_; ///< likewise of their unknowns
    std::vector<char> resting_;         ///< see rest
    std::vector<char> in_balance_;      ///< see in_balance
    std::optional<Stage> stage_;
    // What terms have taken that is still to be taken in here, also where a later one has thrown:
    std::vector<CoupledRows> coupled_; ///< unknowns by each term; without a start where it is to be asked
    bool masses_due_ = false;
    std::unique_ptr<BlockPattern> pattern_;
    Positions before_held_; ///< where place_held found everything; empty in scenes where terms hold nothing
    std::vector<double> pressing_, pressed_; ///< scratch of leave_out_presses
    double energy_scale_ = 0;
    std::vector<double> energies_; ///< of the terms, as last evaluated [J]
    bool forces_hold_ = false;     ///< the terms' forces are those at evaluated_at_, but for what was taken_anew_
    Positions evaluated_at_;
    std::vector<char> taken_anew_; ///< flags of terms
    std::vector<double> vertex_stiffness_, of_body_, reactions_, reaction_gradient_;
};

} // namespace sinew::solver
