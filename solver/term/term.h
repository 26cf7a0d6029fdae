// A force of the scene that has an energy, or acts as if it had one: elasticity, attachments, fields, pressure … The
// potential sums over the terms that the scene uses, in the order of terms/all_terms.cpp, and knows none by name.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/integrate/implicit_form.h"
#include "solver/linear/block_matrix.h"
#include "solver/state.h"
#include "solver/term/marks.h"
#include "solver/term/measure.h"

#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace sinew::solver {

class MassMatrix;

/// 3 numbers a vertex, of all bodies that deform.
using Positions = std::vector<double>;
/// Pairs of vertices.
using Couplings = std::vector<std::pair<int, int>>;

/// One stage of a step: the scheme's form of it, and where everything is that is prescribed.
struct Stage {
    const StepInputs& inputs;
    const State& before; ///< at the start of the step
    const ImplicitForm& form;
    const std::vector<Points>& bones_after; ///< per body, at the end of the step
};

/// What new values changed.
struct Changes {
    bool couplings = false; ///< which vertices are coupled, or how many entries there are: a new pattern is due
    bool masses = false;
};

/// Health of the bodies' shapes.
struct ShapeQuality {
    double least_j = std::numeric_limits<double>::infinity(); ///< det F
    int inverted = 0;                                         ///< elements with det F <= 0
};

class Term {
  public:
    virtual ~Term() = default;

    /// Takes the values of a step, and the term's memory in `before`. Throws Error with the body or part where a value
    /// cannot be used; then nothing is taken.
    virtual Changes take(const StepInputs& inputs, const State& before) = 0;
    /// Before each `take`: whether it is given other values of the same step, which must not change what is coupled.
    virtual void keep_couplings(bool) {}
    /// Couplings that stand as long as take reports no others; they make up the matrix's pattern.
    virtual void add_couplings(Couplings&) const {}
    /// Finds where entries go, in fixed order. The pattern outlives the next call.
    virtual void bind(const BlockPattern&) {}
    virtual void add_masses(MassMatrix&) const {}
    /// Puts vertices that the term holds to where they are at the end of the stage.
    virtual void place_held(const Stage&, Positions&) const {}
    /// After place_held has moved what was at `before`: takes the free vertices of bodies along, as a place to start
    /// from, and flags those deformables. False: nothing has moved.
    virtual bool carry(const Positions& /*before*/, Positions& /*x*/, std::vector<char>& /*bodies*/) const {
        return false;
    }
    /// Fixes what is constant over a stage. What `stage` refers to outlives the stage.
    virtual void begin_stage(const Stage& stage) = 0;
    /// Before each Newton iteration at x, for forces that have no energy: from here on, until the next call, `energy`
    /// is the work against the force as it is at x, so that a line search sees the true slope. Returns by how much that
    /// changes the energy at x [J]. A stage begins as if called at the start of the step.
    virtual double begin_iteration(const Positions&) { return 0; }

    /// Before Newton iterations at x, and before begin_iteration: looks anew at what it holds fixed between iterations,
    /// such as which face of a surface is nearest. `stuck`: the last iteration could hardly move. True: that changes
    /// the energy at x. A term must become false for good after some times within a stage.
    virtual bool settle(const Positions&, bool /*stuck*/) { return false; }

    /// Called a few times a stage, the closer it is to being solved at x the more it is worth: takes anew what it took
    /// from the end of the step before, such as how hard things press that rub. True: that changes the energy at x.
    virtual bool renew(const Positions&) { return false; }

    /// Where a solve has come to rest at x: takes in what the term left out because it was too far away at the start of
    /// the stage. True: that changes the energy at x, so the solve must go on.
    virtual bool widen(const Positions&) { return false; }

    /// Energy at x [J], damping included. With `with_forces` keeps what add_gradient and the functions after it give.
    virtual double energy(const Positions& x, bool with_forces) = 0;
    /// Adds the gradient at the x of the last evaluation, 3 an unknown [N].
    virtual void add_gradient(std::span<double> gradient) const = 0;
    /// Adds the gradient by vertices that are held, 3 a vertex: what the term does to their holder [N].
    virtual void add_held_gradient(std::span<double>) const {}
    /// Adds the Hessian at x, symmetric; `project`: its element entries' negative eigenvalues clamped to zero.
    virtual void add_hessian(const Positions& x, bool project, BlockMatrix& a) = 0;
    /// The longest share of a direction (3 an unknown) that may be moved; 1 = all.
    virtual double longest_move(const Positions&, std::span<const double>) const { return 1; }

    /// Raises each deformable's number to the norm of this term's forces on it before they cancel [N].
    virtual void raise_forces_at_work(const Positions& x, std::span<double> largest) const = 0;
    /// Adds to each deformable's the squared stiffnesses at work [N^2/m^2], for what rounding does to forces.
    virtual void add_squared_stiffnesses(std::span<double> squares) const = 0;
    /// Size of the numbers that the energy is the difference of [J]; 0 = that of the energy itself.
    virtual double energy_scale() const { return 0; }
    /// Adds what springs between points contribute to the Hessian of the stage, by blocks of the pattern, each a
    /// multiple of the identity [N/m]: where they are stiff, linear solvers take care of them.
    virtual void add_springs(std::span<double> /*blocks*/) const {}
    /// Adds stiffness by vertices [J], with which rigid motions are weighed.
    virtual void add_vertex_stiffness(std::span<double>) const {}
    virtual void add_quality(const Positions* /*x: of the last evaluation, looks closer; null: as evaluated*/,
                             ShapeQuality&) const {}

    /// Whether, from here on, what touched at the start of the step presses as it did then: on the same places, carried
    /// along with what they are on, also where it would have to draw; and nothing else touches, nor does cloth. Of
    /// types that press. Energy and gradient are good for a first direction alone: what the carried way turns by is
    /// left out.
    virtual void press_as_before(bool) {}
    /// After begin_iteration at x, for evaluations there. On: points that went to and fro over an edge between two
    /// faces are taken to be nearest to that edge. True: there are any.
    virtual bool keep_to_edges(bool /*on*/) { return false; }

    /// From here on deformables with a flag stay where they were when forces were evaluated last, none after an empty
    /// list: what the term found of them there alone holds and need not be found again, and nothing reads their rows of
    /// the Hessian.
    virtual void rest(std::span<const char> /*deformables*/) {}

    /// Whether add_hessian writes every block of the pattern, over whatever stood there: the first term of the list
    /// may.
    virtual bool writes_all_blocks() const { return false; }

    /// How many tenfold steps gentler the term can be made, where a solve stalls on it; and that it is for what
    /// follows.
    virtual int levels() const { return 0; }
    virtual void relax(int /*level; 0 = not at all*/) {}
    /// On: laws that know no tets inside out are continued to them (material/law.h), for a first guess.
    virtual void continue_laws(bool) {}

    /// At the end of a step, at x. `keeps_history`: the scheme reads it at the next step.
    virtual void remember(const Positions& /*x*/, bool /*keeps_history*/, TermMemory&) const {}
    /// Energy without damping [J].
    virtual double stored_energy(const Positions& x) = 0;
    /// Appends its type's measures, in that order, at x, where forces were evaluated last. `reactions`: the gradient of
    /// the whole potential, 3 a vertex, at held vertices [N].
    virtual void measure(const Positions&, std::span<const double> /*reactions*/, std::vector<Measured>&) const {}
    virtual bool wants_reactions() const { return false; }
    virtual void marks(const Positions&, Marks&) const {}
};

} // namespace sinew::solver
