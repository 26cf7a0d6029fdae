// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/linear_solver.h"

#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/stopwatch.h"

#include <algorithm>

namespace sinew::solver {

namespace {

/// Steps that stay with the kept factor after multigrid did not pay; then that is tried again.
constexpr int kept_steps = 24;
/// Newton iterations of one step after which the inexact directions are taken to be what holds it up: as many as a
/// factor, whose cost in cycles this is, is worth.
int patience(double cycles) { return static_cast<int>(std::clamp(cycles / 8, 5.0, 25.0)); }
/// Solving more exactly than this costs more with the kept factor than the Newton iterations that it may save.
constexpr double kept_factor_tolerance = 1e-2;
/// But for the first direction of a step, which brings flesh along with its bones: what it leaves to do is much.
constexpr double first_tolerance = 1e-3;
/// With a factor of the matrix itself, of which three digits are kept, an iteration more brings three digits more.
constexpr double fresh_factor_tolerance = 1e-4;
/// Solves with a kept factor in a Newton iteration, as the comparison with multigrid counts them.
constexpr double kept_factor_solves = 5;
/// The same with an overlay, which no factor knows. Smoothed around it takes some 12, as around multigrid; counted so,
/// piles go over to factors sooner and take longer (c_balls_20: 7 %), as their contacts soon make factors old.
constexpr double overlay_solves = 30;
/// What a step is taken to need before it has begun: iterations with multigrid in a Newton iteration, with rows that
/// springs hold, and Newton iterations.
constexpr double usual_cycles = 6, usual_held_cycles = 12, usual_iterations = 4;
/// What an iteration with an overlay costs, which is smoothed before and after the factor, in solves with the factor.
constexpr double overlay_iteration = 3;
/// Iterations with a kept factor, in what a new one costs, after which it is worn out: later matrices of the step will
/// take as many.
constexpr double worn_out = 0.5;
/// A kept factor is given up at a frame's end where it has cost so much more than a new one, in what that costs; its
/// solves, which are counted after as many as a new one takes, go on to.
constexpr double too_late = 0.25;
constexpr int usual_fresh_iterations = 2;
/// A factor of more bytes than this takes more memory than all else together, and so has to bring more: what it costs
/// is taken for so much higher.
constexpr double large_factor = 128e6, price_of_memory = 1.5;
/// Up to here a factor is too cheap for anything else to pay.
constexpr int small_rows = 200;
/// Where there is no factor to fall back on.
constexpr int most_iterations = 5000;
/// A direction that is not exact after so many is taken as it is.
constexpr int most_truncated = 60;

/// Patterns that differ have different ones, but for one in 2^64.
std::uint64_t mark_of(const BlockPattern& pattern) {
    std::uint64_t mark = static_cast<std::uint64_t>(pattern.rows);
    const auto add = [&](const std::vector<int>& numbers) {
        for (const int n : numbers) { // a step of the generator splitmix64
            mark += 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(n);
            mark = (mark ^ (mark >> 30)) * 0xbf58476d1ce4e5b9u;
            mark = (mark ^ (mark >> 27)) * 0x94d049bb133111ebu;
            mark ^= mark >> 31;
        }
    };
    add(pattern.row_start), add(pattern.column);
    return mark;
}

} // namespace

LinearSolver::LinearSolver(const BlockPattern& pattern, UnknownPlaces places)
    : pattern_(pattern)
    , places_(std::move(places))
    , costs_(linear_costs(pattern))
    , mark_(mark_of(pattern)) {}

void LinearSolver::begin_frame(const LinearMemory& memory) {
    used_ = false;
    late_iterations_ = memory.late_iterations, fresh_iterations_ = memory.fresh_iterations;
    if (memory.factor && memory.factor == source_ && kept_ == Kept::single) return;
    // Nor is anything left of it: components that rest would take up what another frame has made.
    kept_ = Kept::none;
    source_.reset(), again_.reset();
    for (ComponentFactors* factors : {single_.get(), factors_.get()})
        if (factors) factors->forget();
    if (memory.factor && memory.factor->pattern == mark_ &&
        memory.factor->values.size() == 9 * pattern_.block_count() &&
        (memory.factor->without.empty() || memory.factor->without.size() == at(pattern_.rows)))
        again_ = memory.factor;
}

void LinearSolver::end_frame(LinearMemory& memory) {
    const bool worth_it = used_ && kept_ == Kept::single && !places_.any_sheet &&
                          late_iterations_ * costs_.factor_solve < too_late * costs_.factor;
    if (!worth_it) {
        source_.reset();
        memory.factor.reset(), memory.late_iterations = memory.fresh_iterations = 0;
        return;
    }
    if (!source_) {
        FactorSource source{mark_, made_of_, single_->rows_without()};
        for (std::size_t i = 0; i < source.without.size(); ++i) // what is left there of other frames is none of it
            if (source.without[i])
                std::fill(source.values.begin() + 9 * pattern_.row_start[i],
                          source.values.begin() + 9 * pattern_.row_start[i + 1], 0.0f);
        source_ = std::make_shared<const FactorSource>(std::move(source));
    }
    memory.factor = source_;
    memory.late_iterations = late_iterations_, memory.fresh_iterations = fresh_iterations_;
}

/// Cycles that this solve may take before the step has cost more than it would with a factor.
int LinearSolver::allowed_cycles(int newton_iteration, double solves) const {
    const double by_factor = factor_cost(solves * (newton_iteration + 1));
    return static_cast<int>(std::clamp((by_factor - spent_ - hierarchy_cost()) / cycle_cost(), 0.0, 1000.0));
}

bool LinearSolver::factor_is_cheaper() const {
    const double by_factor = factor_cost(usual_iterations * kept_factor_solves);
    const double cycles = held_.rows.empty() ? usual_cycles : usual_held_cycles;
    return by_factor < usual_iterations * (hierarchy_cost() + cycles * cycle_cost());
}

double LinearSolver::factor_cost(double solves) const {
    const double price = costs_.factor_bytes > large_factor ? price_of_memory : 1;
    return price * (costs_.factor + solves * costs_.factor_solve);
}

double LinearSolver::hierarchy_cost() const { return costs_.hierarchy + held_costs_.factor; }

double LinearSolver::cycle_cost() const { return costs_.cycle + 2 * held_costs_.factor_solve; }

void LinearSolver::begin_step(std::span<const double> springs, std::span<const double> elastic) {
    spent_ = 0, indefinite_ = false;
    if (std::ranges::equal(springs, springs_) && std::ranges::equal(elastic, elastic_)) return;
    springs_.assign(springs.begin(), springs.end()), elastic_.assign(elastic.begin(), elastic.end());
    HeldRows held = find_held_rows(pattern_, springs, elastic, places_);
    if (held == held_) return;
    held_ = std::move(held);
    held_costs_ = held_costs(pattern_, held_);
    multigrid_.reset(), held_block_.reset();
}

void LinearSolver::rest(std::span<const char> bodies) {
    resting_.clear();
    for (std::size_t i = 0; i < places_.body.size() && !bodies.empty(); ++i)
        resting_.push_back(bodies[at(places_.body[i])]);
    const bool made = kept_ == Kept::none || (kept_ == Kept::single ? single_ : factors_)->is_made(resting_);
    if (!made) kept_ = Kept::none;
}

void LinearSolver::make_multigrid() {
    UnknownPlaces places = places_;
    if (!held_.rows.empty()) {
        places.body = held_.grid_of;
        for (const Held h : held_.rows) places.left_out.push_back(h == Held::pinned);
        held_block_ = std::make_unique<HeldBlock>(pattern_, iterative_->matrix(), held_);
    }
    multigrid_ = std::make_unique<Multigrid>(iterative_->matrix(), places);
}

void LinearSolver::factorize_and_solve(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                                       double tolerance, bool projected, Outcome& outcome, bool plain) {
    {
        const Stopwatch timer(outcome.seconds_factor);
        if (!factors_ || plain != plain_factors_) {
            factors_ = std::make_unique<ComponentFactors>(pattern_, plain ? Factoring::plain : Factoring::by_component);
            plain_factors_ = plain;
            ++symbolic_analyses_;
        }
        if (single_) single_->release_if_large();
        outcome.definite = factors_->factorize(a, resting_);
        ++outcome.factors;
        kept_ = outcome.definite ? Kept::full : Kept::none;
    }
    if (!outcome.definite) return;
    if (!a.overlay.empty()) {
        iterate_with_factor(a, b, x, tolerance, most_iterations, outcome);
        if (outcome.definite || !projected) return;
        // It is definite by construction: rounding it was. The factor's own answer still gives descent.
        outcome.definite = true;
    }
    const Stopwatch timer(outcome.seconds_solve);
    factors_->solve(b.data(), x.data(), resting_);
}

void LinearSolver::prepare_single() {
    if (factors_) factors_->release_if_large();
    if (single_) return;
    single_ = std::make_unique<ComponentFactors>(pattern_, Factoring::single);
    ++symbolic_analyses_;
}

/// Rows of bodies that rest keep what their factor, if any, was made of.
void LinearSolver::keep_rounded(const BlockMatrix& a) {
    made_of_.resize(9 * pattern_.block_count());
    parallel_for(at(pattern_.rows), 256, [&](std::size_t i) {
        if (!resting_.empty() && resting_[i]) return;
        const auto first = 9 * at(pattern_.row_start[i]), last = 9 * at(pattern_.row_start[i + 1]);
        for (std::size_t k = first; k < last; ++k) made_of_[k] = static_cast<float>(a.values[k]);
    });
}

bool LinearSolver::make_single(const BlockMatrix& a, Outcome& outcome) {
    const Stopwatch timer(outcome.seconds_factor);
    prepare_single();
    keep_rounded(a);
    const bool good = single_->factorize(made_of_, resting_);
    ++outcome.factors;
    kept_ = good ? Kept::single : Kept::none;
    source_.reset();
    late_iterations_ = 0;
    return good;
}

/// The factor that the state tells of. That is no work of this frame, and not counted as such.
void LinearSolver::make_again() {
    const auto source = std::exchange(again_, nullptr);
    prepare_single();
    made_of_ = source->values;
    if (!single_->factorize(made_of_, source->without)) return; // of a state that was spoiled
    source_ = source;
    kept_ = single_->is_made(resting_) ? Kept::single : Kept::none;
}

/// With what knows the pattern alone, and what knows the overlay around it. After iterative_->set(a).
ConjugateGradients::Result
LinearSolver::precondition_and_iterate(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                                       double tolerance, int most,
                                       const ConjugateGradients::Preconditioner& by_pattern) {
    if (a.overlay.empty()) return iterative_->solve(b.data(), x.data(), tolerance, most, by_pattern);
    if (!smoother_) smoother_ = std::make_unique<OverlaySmoother>(iterative_->matrix());
    if (!smoother_->set_values(a.overlay)) return {0, false, false};
    const ConjugateGradients::Preconditioner both = [&](const std::vector<double>& in, std::vector<double>& out) {
        smoother_->apply(by_pattern, in, out);
    };
    return iterative_->solve(b.data(), x.data(), tolerance, most, both);
}

ConjugateGradients::Result LinearSolver::iterate_with_factor(const BlockMatrix& a, const std::vector<double>& b,
                                                             std::vector<double>& x, double tolerance, int most,
                                                             Outcome& outcome) {
    const Stopwatch timer(outcome.seconds_solve);
    ComponentFactors& factors = kept_ == Kept::single ? *single_ : *factors_;
    const ConjugateGradients::Preconditioner factor = [&](const std::vector<double>& in, std::vector<double>& out) {
        factors.solve(in.data(), out.data(), resting_);
    };
    if (!iterative_) iterative_ = std::make_unique<ConjugateGradients>(pattern_);
    iterative_->set(a);
    const ConjugateGradients::Result r = precondition_and_iterate(a, b, x, tolerance, most, factor);
    outcome.iterations += r.iterations;
    outcome.definite = r.definite;
    return r;
}

void LinearSolver::solve_with_kept_factor(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                                          double tolerance, int newton_iteration, bool projected, Outcome& outcome) {
    if (again_) {
        const Stopwatch timer(outcome.seconds_factor);
        make_again();
    }
    used_ = true;
    const bool has_overlay = !a.overlay.empty();
    const double loose = newton_iteration == 0 ? first_tolerance : std::max(tolerance, kept_factor_tolerance);
    const double iteration = costs_.factor_solve * (has_overlay ? overlay_iteration : 1);
    const int most = static_cast<int>(std::clamp(worn_out * costs_.factor / iteration, 3.0, 30.0));
    if (kept_ != Kept::none) {
        const int allowed = has_overlay ? fresh_iterations_ + most : most;
        const ConjugateGradients::Result r = iterate_with_factor(a, b, x, loose, allowed, outcome);
        late_iterations_ += std::max(0, r.iterations - (has_overlay ? fresh_iterations_ : usual_fresh_iterations));
        if (r.converged || (!r.definite && !projected)) return;
    }
    if (kept_ != Kept::full) {
        if (make_single(a, outcome)) {
            // An overlay's digits all cost the same, whatever the factor is.
            const double exact = has_overlay ? loose : std::min(loose, fresh_factor_tolerance);
            const ConjugateGradients::Result r =
                iterate_with_factor(a, b, x, exact, has_overlay ? most_iterations : most, outcome);
            fresh_iterations_ = has_overlay ? r.iterations : 0;
            if (!projected && r.definite) indefinite_ = false;
            if (r.converged || (!r.definite && !projected)) return;
        } else if (!projected && (indefinite_ || single_->surely_indefinite())) {
            // Or as double precision said of an earlier matrix of the step: what follows is seldom otherwise.
            outcome.definite = false;
            return;
        }
    }
    // What single precision cannot tell.
    factorize_and_solve(a, b, x, tolerance, projected, outcome);
    if (!projected) indefinite_ = !outcome.definite;
}

bool LinearSolver::precondition(const BlockMatrix& a, bool must, Outcome& outcome) {
    if (make_single(a, outcome)) return true;
    if (!must) return false;
    const Stopwatch timer(outcome.seconds_factor);
    if (!factors_ || plain_factors_) {
        factors_ = std::make_unique<ComponentFactors>(pattern_, Factoring::by_component);
        plain_factors_ = false;
        ++symbolic_analyses_;
    }
    if (single_) single_->release_if_large();
    const bool good = factors_->factorize(a);
    ++outcome.factors;
    kept_ = good ? Kept::full : Kept::none;
    return good;
}

void LinearSolver::solve_truncated(const BlockMatrix& a, const std::vector<double>& b, std::vector<double>& x,
                                   double tolerance, double& length, Outcome& outcome) {
    const Stopwatch timer(outcome.seconds_solve);
    ComponentFactors& factors = kept_ == Kept::single ? *single_ : *factors_;
    const TruncatedNewton::Result r = truncated_.solve(a, factors, b, x, tolerance, most_truncated, length);
    length = r.length;
    outcome.iterations += r.iterations;
    outcome.definite = !r.negative;
    outcome.worn = (!r.converged && r.iterations == most_truncated) ||
                   r.iterations > worn_out * costs_.factor / costs_.factor_solve;
}

ConjugateGradients::Result LinearSolver::iterate(const BlockMatrix& a, const std::vector<double>& b,
                                                 std::vector<double>& x, double tolerance, int most) {
    if (!iterative_) iterative_ = std::make_unique<ConjugateGradients>(pattern_);
    iterative_->set(a);
    if (!multigrid_) make_multigrid();
    spent_ += hierarchy_cost();
    if (!multigrid_->set_values() || (held_block_ && !held_block_->set_values(a))) return {0, false, false};
    const ConjugateGradients::Preconditioner cycle = [&](const std::vector<double>& in, std::vector<double>& out) {
        if (held_block_)
            held_block_->apply(*multigrid_, in, out);
        else
            multigrid_->apply(in, out);
    };
    const ConjugateGradients::Result r = precondition_and_iterate(a, b, x, tolerance, most, cycle);
    spent_ += r.iterations * cycle_cost();
    return r;
}

LinearSolver::Outcome LinearSolver::solve(LinearMethod method, const BlockMatrix& a, const std::vector<double>& b,
                                          std::vector<double>& x, double tolerance, int newton_iteration,
                                          bool projected, LinearMemory& memory) {
    Outcome outcome;
    x.resize(b.size());
    const bool automatic = method == LinearMethod::automatic;
    const bool plain = method == LinearMethod::plain;
    if (plain || method == LinearMethod::direct || (automatic && (pattern_.rows <= small_rows || places_.any_sheet))) {
        factorize_and_solve(a, b, x, tolerance, projected, outcome, plain);
        return outcome;
    }
    const bool has_overlay = !a.overlay.empty();
    const int allowed = automatic ? allowed_cycles(newton_iteration, has_overlay ? overlay_solves : kept_factor_solves)
                                  : most_iterations;
    const bool impatient = !kinked_ && newton_iteration >= patience(factor_cost(0) / costs_.cycle);
    if (automatic && (impatient || allowed == 0 || (!has_overlay && factor_is_cheaper())))
        memory.factor_steps_left = kept_steps;
    if (automatic && memory.factor_steps_left > 0) {
        solve_with_kept_factor(a, b, x, tolerance, newton_iteration, projected, outcome);
        return outcome;
    }
    ConjugateGradients::Result r;
    {
        const Stopwatch timer(outcome.seconds_solve);
        r = iterate(a, b, x, tolerance, allowed);
    }
    outcome.iterations = r.iterations;
    outcome.definite = r.definite;
    // The projected matrix is the last there is: where single precision cannot solve it, a factor must.
    if (r.converged || (!projected && (!r.definite || !automatic))) return outcome;
    if (automatic) memory.factor_steps_left = kept_steps;
    if (automatic)
        solve_with_kept_factor(a, b, x, tolerance, newton_iteration, projected, outcome);
    else
        factorize_and_solve(a, b, x, tolerance, projected, outcome);
    return outcome;
}

} // namespace sinew::solver
