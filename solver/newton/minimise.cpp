// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/minimise.h"

#include "solver/error.h"
#include "solver/newton/directions.h"
#include "solver/newton/fading_mean.h"
#include "solver/parallel.h"
#include "solver/stopwatch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace sinew::solver {

namespace {

/// At residuals below these what presses presses more and more as hard as it will at the end of the stage.
constexpr std::array<double, 2> roughly_solved{0.3, 0.03};

/// How one run of Newton's method ended.
enum class End { converged, out_of_iterations, stalled };

/// The potential's value at x; its gradient and forces go to the workspace.
double evaluate(Potential& potential, NewtonWorkspace& w, const std::vector<double>& x, StepRecord& record) {
    const Stopwatch timer(record.seconds_assembly);
    return potential.evaluate(x, &w.gradient, &w.forces);
}

/// Moves bodies along with what holds them if the potential is lower there, and flags them. Returns its value at x, if
/// that had to be found.
std::optional<double> choose_carried(Potential& potential, NewtonWorkspace& w, std::vector<double>& x,
                                     StepRecord& record) {
    w.carried.clear();
    if (!potential.carry(x, w.trial, w.carried)) return {};
    const Stopwatch timer(record.seconds_assembly);
    const double here = potential.evaluate(x, nullptr, nullptr), there = potential.evaluate(w.trial, nullptr, nullptr);
    // Written so that a value that is no number is left.
    if (!(here <= there)) {
        x.swap(w.trial);
        return there;
    }
    w.carried.clear();
    return here;
}

/// Takes bodies with a flag out of the direction that w.arcs goes along.
void leave(const Potential& potential, NewtonWorkspace& w, const std::vector<char>& bodies) {
    for (std::size_t d = 0; d < bodies.size(); ++d) {
        if (!bodies[d]) continue;
        const Deformable& body = potential.numbering().deformables[d];
        std::fill_n(w.direction.begin() + static_cast<std::ptrdiff_t>(3 * body.first_unknown), 3 * body.unknown_count,
                    0.0);
        w.gain[d] = 0;
    }
}

/// Moves x along with what holds it, and what is not held to free flight, along arcs, if the potential is lower there:
/// all of it, or the bodies whose forces in flight are next to nothing, while others hang, rest or press.
double choose_start(Potential& potential, NewtonWorkspace& w, std::vector<double>& x, StepRecord& record) {
    constexpr double next_to_nothing = 0.1; // of the force without
    const std::optional<double> known = choose_carried(potential, w, x, record);
    if (!potential.free_flight(x, w.direction, w.gain)) return evaluate(potential, w, x, record);
    leave(potential, w, w.carried);
    const auto fly = [&] {
        const Stopwatch timer(record.seconds_assembly);
        w.arcs.fit(potential, x, w.direction, w.gain);
        w.arcs.move(potential, x, w.direction, 1, w.trial);
    };
    fly();
    const auto value_here = [&] {
        const Stopwatch timer(record.seconds_assembly);
        return potential.evaluate(x, nullptr, nullptr);
    };
    double here = known ? *known : value_here();
    double flight = evaluate(potential, w, w.trial, record);
    if (!(flight <= here)) {
        w.forces_here.swap(w.forces);
        here = evaluate(potential, w, x, record);
        std::vector<char>& stay = w.staying;
        stay.resize(w.gain.size());
        for (std::size_t d = 0; d < stay.size(); ++d)
            stay[d] = !(w.gain[d] > 0 && w.forces_here[d].sum < next_to_nothing * w.forces[d].sum);
        const auto staying = std::count(stay.begin(), stay.end(), 1);
        if (staying == 0 || staying == std::ssize(stay)) return here;
        leave(potential, w, stay);
        fly();
        flight = evaluate(potential, w, w.trial, record);
        if (!(flight <= here)) return evaluate(potential, w, x, record);
    }
    x.swap(w.trial);
    return flight;
}

/// Contacts as they were at the start of the step while this lives.
struct ContactsBefore {
    Potential& potential;
    explicit ContactsBefore(Potential& of)
        : potential(of) {
        potential.press_as_before(true);
    }
    ~ContactsBefore() { potential.press_as_before(false); }
    ContactsBefore(const ContactsBefore&) = delete;
    ContactsBefore& operator=(const ContactsBefore&) = delete;
};

/// The volume let go while this lives; given back also where a solve is stopped or fails.
struct RelaxedTerms {
    Potential& potential;
    ~RelaxedTerms() { potential.relax(0); }
};

/// Whether the forces at x are rounding's, after a step that said so; `w.trial` is where it came from. A gradient with
/// kinks may throw whole steps back and forth between its pieces: halfway there is less of it then.
bool on_floor(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options, const std::vector<double>& x) {
    if (!w.floor.reached(w.forces, options.tolerance)) return false;
    for (std::size_t i = 0; i < x.size(); ++i) w.trial[i] = 0.5 * (w.trial[i] + x[i]);
    w.forces_here = w.forces;
    potential.evaluate(w.trial, &w.gradient, &w.forces);
    const bool lower = is_lower(w.forces, w.forces_here, options.tolerance);
    potential.evaluate(x, &w.gradient, &w.forces);
    if (lower) w.floor.forget();
    return !lower;
}

/// Steps shorter than this share of Newton's own say that the quadratic model is of no use where it points.
constexpr double stalled_step = 0.1;

/// A step that comes before a place where the energy jumps, as that of a contact does where its nearest place passes to
/// another side of the surface, ends there, and so does the next one: after so many steps in a row, shorter than this,
/// one goes over the jump, to the lowest of what it tries beyond, and so often a solve.
constexpr double before_a_jump = 1e-3;
constexpr int before_a_leap = 2, most_leaps = 4, tried_beyond = 8;

/// Of the slope that a step begins with: as much of it, the other way, at the step's end says that it went too far.
constexpr double most_overshoot = 0.9;
/// Of the residual three steps before: more is no progress.
constexpr double idle = 0.9;
/// Of what the slope promises: less energy is hardly any. Newton's step on a quadratic gives half.
constexpr double least_share = 0.1;

/// A step that was accepted may have gone from one side of a narrow valley to the other: where points come in contact,
/// or pass from one face of a dent to the next, the stiffness that they meet there was not in the matrix. Energies do
/// not tell, where they differ by rounding, but slopes do. Then between both sides, by the secant of the slopes, until
/// the valley's floor is nearer (the strong condition of Wolfe 1969). On return x, the gradient and the forces in the
/// workspace are those of the share `t`. `here`: the energy that the step may not exceed. With `wary` slopes may be
/// rounding's too, and the step stays as it was unless clearly less force is left.
void keep_in_valley(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options,
                    const std::vector<double>& x, double slope, double here, bool wary, double& t, double& value) {
    const std::vector<int>& vertex_of = potential.numbering().vertex_of_unknown;
    // Along the chord: bodies may turn on their way.
    const auto slope_there = [&](double share) {
        return ordered_sum(w.gradient.size(),
                           [&](std::size_t i) {
                               const std::size_t v = 3 * static_cast<std::size_t>(vertex_of[i / 3]) + i % 3;
                               return w.gradient[i] * (w.trial[v] - x[v]);
                           }) /
               share;
    };
    double there = slope_there(t);
    if (!(there > -most_overshoot * slope)) return;
    const auto look = [&](double share) {
        w.arcs.move(potential, x, w.direction, share, w.trial);
        value = potential.evaluate(w.trial, &w.gradient, &w.forces);
    };
    constexpr int most_looks = 8;
    if (wary) w.forces_here = w.forces;
    double low = 0, low_slope = slope, high = t, high_slope = there, best = t;
    for (int i = 0; i < most_looks; ++i) {
        // Not nearer to either side than a tenth of the way, so that it cannot creep.
        const double share = low + std::clamp(low_slope / (low_slope - high_slope), 0.1, 0.9) * (high - low);
        look(share);
        if (!(value <= here)) break;
        best = share, there = slope_there(share);
        if (std::abs(there) <= -most_overshoot * slope) break;
        (there > 0 ? high : low) = share, (there > 0 ? high_slope : low_slope) = there;
    }
    if (!(value <= here)) look(best);
    if (wary && !is_lower(w.forces, w.forces_here, options.tolerance)) look(best = t);
    t = best;
}

/// Islands that are in balance rest while the others go on: neither their tets nor their part of the matrix is looked
/// at again. None rests after this has lived.
class Rest {
  public:
    Rest(Potential& potential, NewtonWorkspace& w)
        : potential_(potential)
        , w_(w) {}
    ~Rest() { wake(); }
    Rest(const Rest&) = delete;
    Rest& operator=(const Rest&) = delete;
    /// After Potential::balance where forces were evaluated last. Without `more` nothing comes to rest that did not
    /// before. True: some island has woken up, and its gradient is to be evaluated.
    bool choose(bool more) {
        if (w_.islands.count() < 2) return false;
        // What touches or slides ties islands together, and not through the pattern.
        if (!w_.hessian.overlay.empty() || potential_.contacts_press()) return wake();
        w_.resting = potential_.in_balance();
        for (std::size_t d = 0; d < w_.resting.size() && !more; ++d)
            if (!potential_.rests(d)) w_.resting[d] = 0;
        if (!w_.islands.keep_whole(w_.resting)) return wake();
        bool woken = false;
        for (std::size_t d = 0; d < w_.resting.size(); ++d) woken = woken || (potential_.rests(d) && !w_.resting[d]);
        if (w_.resting != potential_.resting()) tell(w_.resting);
        return woken;
    }
    bool any() const { return !potential_.resting().empty(); }

  private:
    bool wake() {
        const bool any = this->any();
        if (any) tell({});
        return any;
    }
    void tell(const std::vector<char>& deformables) {
        potential_.rest(deformables);
        w_.linear.rest(deformables);
        for (std::size_t d = 0; d < deformables.size(); ++d) {
            const Deformable& body = potential_.numbering().deformables[d];
            const auto first = w_.gradient.begin() + static_cast<std::ptrdiff_t>(3 * body.first_unknown);
            if (deformables[d]) std::fill_n(first, 3 * body.unknown_count, 0.0);
        }
    }
    Potential& potential_;
    NewtonWorkspace& w_;
};

/// Newton's method from x, where the potential's value is `value` and gradient and forces are in the workspace.
/// `may_stall` returns at the first line search that falls below stalled_step. `definite`: a step was taken, and the
/// exact Hessian was positive definite at the last one.
End iterate(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options, double value, bool may_stall,
            const StepControl& control, std::vector<double>& x, LinearMemory& memory, bool& definite,
            StepRecord& record, double& r) {
    definite = false;
    bool converged = false;
    const auto judge = [&] {
        const Balance balance = potential.balance(x, w.forces, options.tolerance);
        r = balance.residual;
        converged = balance.reached;
    };
    judge();
    w.floor.forget();
    const auto look_anew = [&](bool stuck) {
        if (!potential.settle(x, stuck)) return false;
        value = evaluate(potential, w, x, record);
        w.floor.forget();
        judge();
        return true;
    };
    const auto renew = [&] {
        const std::size_t before = w.renewals;
        while (w.renewals < roughly_solved.size() && (converged || r <= roughly_solved[w.renewals])) ++w.renewals;
        if (w.renewals == before || !potential.renew(x)) return false;
        value = evaluate(potential, w, x, record);
        w.floor.forget();
        judge();
        return true;
    };
    bool stuck = false;
    double one_ago = std::numeric_limits<double>::infinity(), two_ago = one_ago; // residuals before the last steps
    Rest rest(potential, w);
    bool unseen = false; // an island rests whose Hessian nobody looked at
    int short_steps = 0, leaps = 0;
    Truncated how;
    FadingMean mean; // of sheets
    const bool sheets = w.linear.takes_sheets(options.method);
    for (int iteration = 0; !converged || renew(); ++iteration) {
        if (iteration == options.max_iterations) return End::out_of_iterations;
        if (!std::isfinite(value) || !std::isfinite(r))
            throw Error(
                "FE302", "the energy of the step is not a finite number",
                "check for extreme material values, bone positions or step sizes at this frame, and for inverted "
                "tets under LogNeoHookean, which it does not know");
        if (control.stop && control.stop()) throw Stopped();
        if (control.progress) control.progress(static_cast<double>(iteration) / options.max_iterations, iteration, r);
        if (look_anew(stuck)) mean.forget();
        if (renew()) mean.forget();
        if (converged) break;
        if (!sheets) {
            if (rest.choose(definite || iteration == 0)) value = evaluate(potential, w, x, record);
            unseen = unseen || (iteration == 0 && rest.any());
        }
        const double change = potential.begin_iteration(x);
        value += change, mean.raise(change);
        double slope = 0;
        if (sheets)
            slope = find_truncated(potential, w, options, r, x, how, definite, record);
        else
            slope = find_direction_to_edges(potential, w, options, r, iteration, x, memory, definite, record);
        if (!(slope < 0)) slope = find_direction(potential, w, options, r, iteration, x, memory, definite, record);
        if (!(slope < 0))
            throw Error(
                "FE302", "the stiffness matrix is not positive definite even with every element projected",
                "a body may be free to move without any force to hold it (attach it to a bone), a material value may "
                "be zero, or stiffnesses may lie too far apart for double precision");
        ++record.newton_iterations;

        // Backtracking until the energy falls enough (Armijo). Where the promised gain is below what rounding does to
        // the energies, the comparison says nothing and the full step is taken.
        const Stopwatch timer(record.seconds_assembly);
        const double rounding = potential.energy_rounding();
        const double before = sheets ? mean.take(value) : value; // without sheets only leaps raise it
        double t = potential.longest_move(x, w.direction);
        bool accepted = false, cut_at_no_number = false; // the last trial: tets inside out under a law that knows none
        const bool below_rounding = definite && r <= RoundingFloor::strict && -0.5 * slope <= rounding;
        if (below_rounding) w.floor.take_direction(potential, w.hessian, w.gradient, w.direction);
        potential.work(w.gradient, w.direction, w.gain);
        w.arcs.fit(potential, x, w.direction, w.gain);
        const bool may_leap =
            short_steps >= before_a_leap && leaps < most_leaps && !sheets && potential.contacts_press();
        bool leaped = false;
        double lowest_t = 0, lowest = std::numeric_limits<double>::infinity();
        for (int trial = 0; trial < 40 && !accepted; ++trial) {
            w.arcs.move(potential, x, w.direction, t, w.trial);
            value = potential.evaluate(w.trial, &w.gradient, &w.forces);
            accepted = std::isfinite(value) && value <= before + 1e-4 * t * slope + rounding;
            if (accepted) break;
            if (value < lowest) lowest = value, lowest_t = t;
            if (may_leap && trial + 1 == tried_beyond && lowest_t > 0) {
                t = lowest_t;
                w.arcs.move(potential, x, w.direction, t, w.trial);
                value = potential.evaluate(w.trial, &w.gradient, &w.forces);
                leaped = accepted = true, ++leaps;
                break;
            }
            cut_at_no_number = !std::isfinite(value);
            t *= 0.5;
            if (may_stall && t < stalled_step) return End::stalled;
        }
        if (!accepted) { // no lower point along a descent direction: this is as far as the arithmetic goes
            potential.evaluate(x, &w.gradient, &w.forces);
            if (!look_anew(true)) return End::out_of_iterations;
            mean.forget();
            continue;
        }
        // Three steps have brought nothing, the last one was Newton's own, and bodies touch each other or it gained
        // next to nothing of the energy that it promised.
        const bool gained = before - value >= least_share * -t * slope;
        if (!sheets && !leaped && definite && (!gained || !w.hessian.overlay.empty()) &&
            potential.balance(w.trial, w.forces, options.tolerance).residual > idle * two_ago)
            keep_in_valley(potential, w, options, x, slope, before + rounding, below_rounding, t, value);
        two_ago = one_ago, one_ago = r;
        stuck = t < stalled_step && !cut_at_no_number; // else it says nothing of what is nearest
        short_steps = t < before_a_jump && !cut_at_no_number ? short_steps + 1 : 0;
        // A trust region: as far as the last step went where that was cut short, else twice as far.
        how.longest = t < 1 ? t * how.length : std::max(how.longest, 2 * how.length);
        x.swap(w.trial);
        judge();
        if (!below_rounding || t < 1) {
            w.floor.forget();
        } else if (!converged) {
            w.floor.take_forces(w.forces);
            converged = on_floor(potential, w, options, x);
        }
    }
    definite = definite && !unseen;
    return End::converged;
}

/// Laws continued to tets inside out while this lives.
struct ContinuedLaws {
    Potential& potential;
    explicit ContinuedLaws(Potential& of)
        : potential(of) {
        potential.continue_laws(true);
    }
    ~ContinuedLaws() { potential.continue_laws(false); }
    ContinuedLaws(const ContinuedLaws&) = delete;
    ContinuedLaws& operator=(const ContinuedLaws&) = delete;
};

/// Where the step to `w.trial` turns tets inside out that their law does not know so: as often only a few of them do,
/// for a law that knows them it is as good as any, and a few iterations by that turn them back. Taken if the
/// potential is lower there. Returns its value at x, with gradient and forces in the workspace.
double follow_inside_out(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options,
                         const StepControl& control, std::vector<double>& x, LinearMemory& memory, StepRecord& record) {
    const std::vector<double> start = x;
    NewtonOptions rough = options;
    rough.tolerance = std::max(options.tolerance, 0.1);
    // After a few whether tets have turned back: some take longer, others never do.
    constexpr int rounds = 2;
    rough.max_iterations = std::min(8, options.max_iterations);
    const auto by_continued_laws = [&] {
        const ContinuedLaws guard(potential);
        bool definite = false;
        double r = 0;
        return iterate(potential, w, rough, evaluate(potential, w, x, record), false, control, x, memory, definite,
                       record, r);
    };
    bool lower = false;
    {
        const ContinuedLaws guard(potential);
        const double here = evaluate(potential, w, x, record);
        lower = evaluate(potential, w, w.trial, record) <= here;
    }
    if (lower) {
        x.swap(w.trial);
        w.renewals = roughly_solved.size(); // what presses there is a guess, too
        try {
            for (int round = 0; round < rounds; ++round)
                if (by_continued_laws() == End::converged || std::isfinite(evaluate(potential, w, x, record))) break;
        } catch (const Error&) { // it was a guess
            x = start;
        }
        w.renewals = 0;
    }
    // By what terms have taken in since, at both.
    const double before = evaluate(potential, w, start, record), now = evaluate(potential, w, x, record);
    if (now <= before || x == start) return now;
    x = start;
    return evaluate(potential, w, x, record);
}

/// A first step of Newton's with the contacts of the start of the step, carried along with bones, where those have
/// moved and the flesh that hangs on them has yet to follow: what touches there never did, and no step that minds it is
/// right for the rest. Taken if the potential is lower there. Returns its value at x, with gradient and forces in the
/// workspace.
double let_flesh_follow(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options, double value,
                        const StepControl& control, std::vector<double>& x, LinearMemory& memory, StepRecord& record) {
    if (!potential.contacts_are_early()) return value;
    double slope = 0;
    {
        const ContactsBefore guard(potential);
        evaluate(potential, w, x, record);
        bool definite = false;
        constexpr double far_away = 1; // the residual
        if (potential.contacts_press())
            slope = find_direction(potential, w, options, far_away, 0, x, memory, definite, record);
    }
    if (!(slope < 0)) return evaluate(potential, w, x, record);
    ++record.newton_iterations;
    {
        const Stopwatch timer(record.seconds_assembly);
        potential.work(w.gradient, w.direction, w.gain);
        w.arcs.fit(potential, x, w.direction, w.gain);
        w.arcs.move(potential, x, w.direction, 1, w.trial);
    }
    const double there = evaluate(potential, w, w.trial, record);
    if (!std::isfinite(there)) return follow_inside_out(potential, w, options, control, x, memory, record);
    if (!(there <= value)) return evaluate(potential, w, x, record);
    x.swap(w.trial);
    return there;
}

/// Flat tets, not turned inside out: det F of a rounding error.
constexpr double flat = -1e-6;
/// How far a body is blown up to get it off a ridge, in its own size at rest.
constexpr double nudge = 0.1;

/// Where the gradient is zero and tets are flat or inverted: whether x may be no minimum. Vertices in one plane feel no
/// force across it under laws that are even in that stretch, and a body in one point feels none at all (its Hessian is
/// then zero too, so that inertia alone makes it definite).
bool may_be_ridge(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options, const std::vector<double>& x,
                  const LinearMemory& memory, bool& definite, StepRecord& record) {
    definite = true;
    double least_j;
    {
        const Stopwatch timer(record.seconds_assembly);
        least_j = potential.least_j(x);
        if (least_j > 0) return false;
        potential.assemble(x, false, w.hessian);
    }
    // Any right-hand side that leaves out no direction shows negative curvature to conjugate gradients; what they say
    // is checked by a factorisation, unless the scene forbids factors.
    std::vector<double> probe(w.gradient.size());
    for (std::size_t i = 0; i < probe.size(); ++i) probe[i] = 1 + 0.5 * std::sin(static_cast<double>(i));
    for (const LinearMethod method : {options.method, LinearMethod::direct}) {
        LinearMemory unchanged = memory;
        const LinearSolver::Outcome outcome =
            w.linear.solve(method, w.hessian, probe, w.direction, 1e-3, 0, false, unchanged);
        record.linear_iterations += outcome.iterations;
        record.factorizations += outcome.factors;
        record.seconds_factor += outcome.seconds_factor;
        record.seconds_solve += outcome.seconds_solve;
        definite = outcome.definite;
        if (definite || options.method != LinearMethod::automatic) break;
    }
    return !definite || least_j > flat;
}

/// x with every body's rest shape, made small, laid over it: that opens flat tets the right way round.
std::vector<double> nudged(const Potential& potential, const std::vector<double>& x) {
    const UnknownPlaces places = potential.places();
    const std::vector<int>& vertex_of = potential.numbering().vertex_of_unknown;
    std::vector<Vec3> centre(places.spacing.size(), Vec3::Zero());
    std::vector<double> count(places.spacing.size(), 0.0);
    for (std::size_t u = 0; u < vertex_of.size(); ++u) {
        centre[static_cast<std::size_t>(places.body[u])] += places.points[u];
        ++count[static_cast<std::size_t>(places.body[u])];
    }
    std::vector<double> out = x;
    for (std::size_t u = 0; u < vertex_of.size(); ++u) {
        const std::size_t body = static_cast<std::size_t>(places.body[u]);
        const Vec3 shift = nudge * (places.points[u] - centre[body] / count[body]);
        for (std::size_t c = 0; c < 3; ++c)
            out[3 * static_cast<std::size_t>(vertex_of[u]) + c] += shift[static_cast<Eigen::Index>(c)];
    }
    potential.put_frozen_back(x, out);
    return out;
}

/// From a point without force that may be a ridge of the potential down to a lower minimum, if there is one. A ridge
/// that cannot be left is not called converged. Where Newton's last step saw a definite Hessian there is nothing to
/// ask.
End leave_ridge(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options, const StepControl& control,
                std::vector<double>& x, LinearMemory& memory, StepRecord& record, double& r) {
    bool definite = true;
    if (!may_be_ridge(potential, w, options, x, memory, definite, record)) return End::converged;
    const double before = evaluate(potential, w, x, record), before_rounding = potential.energy_rounding(),
                 before_r = r;
    std::vector<double> lower = nudged(potential, x);
    LinearMemory lower_memory = memory;
    bool lower_definite = false;
    End end = End::out_of_iterations;
    try {
        end = iterate(potential, w, options, evaluate(potential, w, lower, record), false, control, lower, lower_memory,
                      lower_definite, record, r);
    } catch (const Error&) { // no way down from there: what is left is the point itself
        lower = x;
    }
    if (evaluate(potential, w, lower, record) < before - before_rounding) {
        x = std::move(lower);
        memory = lower_memory;
        if (end == End::converged && !lower_definite &&
            may_be_ridge(potential, w, options, x, memory, definite, record) && !definite)
            end = End::out_of_iterations;
        return end;
    }
    r = before_r;
    return definite ? End::converged : End::out_of_iterations;
}

/// The deformable with the largest share of forces left; -1: there is none.
int worst_deformable(const std::vector<BodyForces>& forces) {
    int worst = -1;
    double residual = 0;
    for (std::size_t d = 0; d < forces.size(); ++d)
        if (const double r = forces[d].sum / forces[d].at_work; !(r <= residual))
            residual = r, worst = static_cast<int>(d);
    return worst;
}

} // namespace

void minimise(Potential& potential, NewtonWorkspace& w, const NewtonOptions& options, const StepControl& control,
              std::vector<double>& x, LinearMemory& memory, StepRecord& record) try {
    w.renewals = 0;
    w.hessian.overlay.clear(); // of another step, which another workspace may not have taken
    potential.add_up_springs(w.springs, w.elastic);
    w.linear.begin_step(w.springs, w.elastic);
    double r = 0;
    const int levels = potential.levels();
    bool definite = false;
    const double start =
        let_flesh_follow(potential, w, options, choose_start(potential, w, x, record), control, x, memory, record);
    End end = iterate(potential, w, options, start, levels > 0, control, x, memory, definite, record, r);
    if (end == End::stalled) {
        // Nearly incompressible: a straight step along a curved path changes volumes, so the line search allows only
        // small ones. With the volume let go tenfold more gently the path is found in a few steps and then tightened.
        NewtonOptions rough = options;
        rough.tolerance = std::max(options.tolerance, 1e-2);
        {
            const RelaxedTerms guard{potential};
            for (int level = levels; level > 0; --level) {
                potential.relax(level);
                iterate(potential, w, rough, evaluate(potential, w, x, record), false, control, x, memory, definite,
                        record, r);
            }
        }
        end = iterate(potential, w, options, evaluate(potential, w, x, record), false, control, x, memory, definite,
                      record, r);
    }
    // What came from farther than anything was expected to is found out here; each body's reach only grows.
    while (end == End::converged && potential.widen(x))
        end = iterate(potential, w, options, evaluate(potential, w, x, record), false, control, x, memory, definite,
                      record, r);
    int worst = worst_deformable(w.forces);
    if (end == End::converged && !definite) {
        const double here = r;
        end = leave_ridge(potential, w, options, control, x, memory, record, r);
        if (r != here) worst = worst_deformable(w.forces);
    }
    if (!(r <= w.worst_residual)) w.worst_residual = r, w.worst_deformable = worst;
    record.residual = std::max(record.residual, r);
    record.converged = record.converged && end == End::converged;
} catch (Error& e) {
    // Of many bodies the one that is farthest from balance is where to look.
    if (const int worst = worst_deformable(w.forces); e.code == "FE302" && e.body < 0 && worst >= 0)
        e.body = potential.numbering().deformables[static_cast<std::size_t>(worst)].body;
    throw;
}

} // namespace sinew::solver
