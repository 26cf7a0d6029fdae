// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/step.h"

#include "solver/error.h"
#include "solver/integrate/part_motion.h"
#include "solver/integrate/standing_form.h"
#include "solver/integrate/values_between.h"
#include "solver/marks_of.h"
#include "solver/newton/minimise.h"
#include "solver/newton/potential.h"
#include "solver/parallel.h"
#include "solver/residual_body.h"
#include "solver/scene_inputs.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

namespace sinew::solver {

struct Workspace::Impl {
    const Scene& scene;
    Potential potential;
    std::unique_ptr<NewtonWorkspace> newton;
    ImplicitForm form;
    std::vector<double> x, v, x_gamma, v_gamma, acceleration, whole_velocity, history_x, history_v;
    std::vector<Measured> measured, measured_before; ///< at the end of the last sub-step, and of the one before
    std::vector<Points> bones;                       ///< at the end of the step
    std::vector<Points> bones_at_gamma;              ///< of in.at_gamma; stale where that is missing
    StepInputs between;                              ///< values within it
    StepInputs followed;    ///< the step's inputs with what follows from bones; unused where nothing does
    int residual_body = -1; ///< of the last advance
    const bool parts_move, parts_follow;
    explicit Impl(const Scene& scene)
        : scene(scene)
        , potential(scene)
        , parts_move(has_moving_parts(scene))
        , parts_follow(has_followers(scene)) {}

    /// The inputs with the values of parts that follow from where `bones` are.
    const StepInputs& with_followers(const State& s, const StepInputs& in) {
        if (!parts_follow) return in;
        followed = in;
        follow_bones(scene, s.memories, bones, followed.parts);
        if (in.at_gamma) {
            auto at_gamma = std::make_shared<StepInputs>(*in.at_gamma);
            follow_bones(scene, s.memories, bones_at_gamma, at_gamma->parts);
            followed.at_gamma = std::move(at_gamma);
        }
        return followed;
    }

    /// Checks a sub-step's inputs and takes its bones. Gives the inputs with what follows from those.
    const StepInputs& receive(const State& s, const StepInputs& in) {
        check_inputs(scene, in);
        set_bones(scene, in, bones);
        if (in.at_gamma) {
            check_inputs(scene, *in.at_gamma);
            set_bones(scene, *in.at_gamma, bones_at_gamma);
        }
        return with_followers(s, in);
    }

    void check_finite(const std::vector<double>& x) const {
        for (const Deformable& d : potential.numbering().deformables) {
            const double* first = x.data() + 3 * d.first_unknown;
            if (std::all_of(first, first + 3 * d.unknown_count, [](double c) { return std::isfinite(c); })) continue;
            Error e("FE302", "the step gave positions that are not finite numbers");
            e.body = d.body;
            throw e;
        }
    }

    void prepare(const State& before, const StepInputs& in) {
        take(before, in);
        if (potential.unknown_count() > 0 && !newton) newton = std::make_unique<NewtonWorkspace>(potential);
    }
    /// A new pattern leaves nothing of the old one's analysis.
    void take(const State& before, const StepInputs& in) {
        if (potential.take(before, in)) newton.reset();
    }
};

Workspace::Workspace(std::shared_ptr<const Scene> scene)
    : scene_(std::move(scene))
    , impl_(std::make_unique<Impl>(*scene_)) {}
Workspace::~Workspace() = default;
int Workspace::symbolic_analyses() const { return impl_->newton ? impl_->newton->linear.symbolic_analyses() : 0; }

namespace {

/// Base of the tolerance that zSolver.solverToleranceFactor multiplies.
constexpr double base_tolerance = 1e-6;

/// Minimises the stage that impl.form describes, from x.
void solve_stage(Workspace::Impl& impl, const State& s, const StepInputs& in, const std::vector<Points>& bones,
                 const StepControl& control, std::vector<double>& x, LinearMemory& memory, StepRecord& record) {
    impl.potential.begin_stage(s, impl.form, bones);
    impl.potential.place_held(x);
    const NewtonOptions options{in.max_newton_iterations, base_tolerance * in.tolerance_factor, in.linear_method};
    if (impl.newton) minimise(impl.potential, *impl.newton, options, control, x, memory, record);
}

/// The state's velocity without the affine momentum that the step's values take out, while this lives; what was there
/// before comes back unless the step is taken.
class DampedVelocity {
  public:
    DampedVelocity(Workspace::Impl& impl, State& s, const StepInputs& in)
        : whole_(impl.whole_velocity)
        , before_(impl.history_x)
        , velocity_before_(impl.history_v)
        , s_(s) {
        whole_.clear(), before_.clear();
        if (in.integrator == Integrator::quasi_static || !damps_affine_momentum(in)) return;
        whole_ = s.v;
        impl.potential.damp_affine_momentum(s.x, s.v);
        if (in.integrator == Integrator::bdf2 && s.history.step_size > 0) damp_history(impl);
    }
    DampedVelocity(const DampedVelocity&) = delete;
    void keep() { whole_.clear(); }
    ~DampedVelocity() {
        if (whole_.empty()) return;
        s_.v = whole_;
        if (before_.empty()) return;
        s_.history.x = before_, s_.history.v = velocity_before_;
    }

  private:
    /// BDF2 draws its momentum from the step before as well, which then must have been as slow: what is taken out of
    /// the velocities at both of its ends it has not gone either.
    void damp_history(Workspace::Impl& impl) {
        History& h = s_.history;
        before_ = h.x, velocity_before_ = h.v;
        impl.potential.damp_affine_momentum(before_, h.v);
        for (std::size_t i = 0; i < h.x.size(); ++i)
            h.x[i] += 0.5 * h.step_size * ((whole_[i] - s_.v[i]) + (velocity_before_[i] - h.v[i]));
    }

    std::vector<double>&whole_, &before_, &velocity_before_;
    State& s_;
};

/// At the end of a sub-step; what adds up counts from the begin of the frame on.
void measure(Workspace::Impl& impl) {
    impl.measured.swap(impl.measured_before);
    impl.potential.measure(impl.x, impl.measured);
    for (Measured& m : impl.measured) {
        if (m.what->combine != Combine::sum) continue;
        const auto same = [&](const Measured& b) { return b.what == m.what && b.part == m.part; };
        const auto before = std::ranges::find_if(impl.measured_before, same);
        if (before != impl.measured_before.end()) m.value += before->value;
    }
}

/// One time step. Takes it, and returns true, if it has converged or `anyhow`; else, and where it throws, `s` stays
/// where it was (its acceleration may be filled in, and what is switched off stands). What it did is in `record`.
bool take_step(Workspace::Impl& impl, State& s, const StepInputs& in, const std::vector<Points>& bones, bool anyhow,
               const StepControl& control, StepRecord& record) {
    const double h = in.step_size;
    LinearMemory memory = s.linear;
    if (memory.factor_steps_left > 0) --memory.factor_steps_left;
    impl.potential.begin_step(s, in);
    // What is switched off stands, whatever it did before, and brakes and drags what touches it as one that stood.
    impl.potential.stop_frozen(s.v), impl.potential.stop_frozen(s.history.v);
    if (s.history.x.size() == s.x.size()) impl.potential.put_frozen_back(s.x, s.history.x);
    // Accelerations of others tell of forces of when it moved.
    if (impl.potential.has_frozen()) s.history.acceleration.clear();
    impl.x = s.x;
    DampedVelocity damped(impl, s, in);
    switch (in.integrator) {
    case Integrator::backward_euler:
        backward_euler_form(s, h, impl.form);
        break;
    case Integrator::quasi_static:
        quasi_static_form(s, impl.form);
        break;
    case Integrator::bdf2:
        // A body that stood still has no past that its motion could go on from.
        impl.potential.lets_go(s.history.frozen) ? backward_euler_form(s, h, impl.form) : bdf2_form(s, h, impl.form);
        break;
    case Integrator::tr_bdf2: {
        if (s.history.acceleration.empty()) impl.potential.accelerations(s, s.history.acceleration);
        const std::vector<Points>* bones_at_gamma = in.at_gamma ? &impl.bones_at_gamma : nullptr;
        tr_bdf2_trapezoid_form(s, h, bones_at_gamma, impl.form);
        if (in.at_gamma) {
            values_within(impl.scene, *in.at_gamma, in, impl.between);
        } else if (s.history.values) {
            values_between(impl.scene, *s.history.values, in, tr_bdf2_gamma, impl.between);
        } else if (impl.parts_move) {
            copy_values(in, impl.between);
            go_part_way(impl.scene, s.parts, tr_bdf2_gamma, impl.between.parts);
        }
        const bool others = in.at_gamma || s.history.values || impl.parts_move;
        if (others) impl.potential.set_values(s, impl.between);
        solve_stage(impl, s, in, bones, control, impl.x, memory, record);
        update_velocity(impl.form, impl.x, impl.v_gamma);
        impl.potential.stop_frozen(impl.v_gamma);
        impl.x_gamma = impl.x;
        if (others) impl.potential.set_values(s, in);
        tr_bdf2_bdf2_form(s, impl.x_gamma, impl.v_gamma, h, bones_at_gamma, impl.form);
        break;
    }
    }
    solve_stage(impl, s, in, bones, control, impl.x, memory, record);
    if (!record.converged && !anyhow) return false;

    damped.keep();
    update_velocity(impl.form, impl.x, impl.v);
    impl.potential.stop_frozen(impl.v);
    // History is kept by the schemes that read it; an unconverged acceleration would carry its error on.
    impl.acceleration.clear();
    const bool keeps_history = in.integrator == Integrator::tr_bdf2 && record.converged;
    // What a frozen body would do if it were let go is another thing than what it did.
    if (keeps_history && !impl.potential.has_frozen()) {
        implied_acceleration(impl.form, impl.x, impl.acceleration);
        impl.potential.leave_out_presses(impl.x, impl.acceleration);
    }
    measure(impl);
    impl.potential.remember(impl.x, keeps_history, s.memories);
    const bool multistep = in.integrator == Integrator::bdf2 || in.integrator == Integrator::tr_bdf2;
    if (multistep) {
        s.history.step_size = h;
        s.history.x.swap(s.x);
        s.history.v.swap(s.v);
        s.history.bones.swap(s.bones);
        s.history.acceleration.swap(impl.acceleration);
        s.history.frozen = impl.potential.frozen();
        if (in.integrator == Integrator::tr_bdf2) {
            if (!s.history.values) s.history.values.emplace();
            copy_values(in, *s.history.values);
        } else {
            s.history.values.reset();
        }
    } else {
        s.history = {};
    }
    s.x = impl.x;
    s.v = impl.v;
    s.bones = bones;
    keep_places(impl.scene, in.parts, s.parts);
    s.linear = memory;
    return true;
}

/// Adds what a step did; what a step reached only if it was `taken`.
void add_step(const StepRecord& from, bool taken, StepRecord& to) {
    to.newton_iterations += from.newton_iterations;
    to.linear_iterations += from.linear_iterations;
    to.factorizations += from.factorizations;
    to.seconds_assembly += from.seconds_assembly;
    to.seconds_factor += from.seconds_factor;
    to.seconds_solve += from.seconds_solve;
    if (!taken) return;
    to.residual = std::max(to.residual, from.residual);
    to.converged = to.converged && from.converged;
}

/// Bones halfway through the step, on the curve that the schemes read them from.
std::vector<Points> bones_halfway(const Workspace::Impl& impl, const State& s, const StepInputs& in,
                                  const std::vector<Points>& after) {
    ImplicitForm form;
    if (in.at_gamma)
        set_bone_weights(impl.bones_at_gamma, in.step_size, 0.5, form);
    else
        set_bone_weights(s, in.step_size, 0.5, form);
    const auto [first, start, end] = bones_weighed(form, s, after);
    std::vector<Points> out = after;
    for (std::size_t body = 0; body < out.size(); ++body)
        for (std::size_t i = 0; i < out[body].size(); ++i)
            out[body][i] = form.bone_position[0] * (*first)[body][i] + form.bone_position[1] * (*start)[body][i] +
                           form.bone_position[2] * (*end)[body][i];
    return out;
}

/// Whether nothing that moves parts has changed since the last step.
bool parts_stand_still(const State& s, const StepInputs& in) {
    for (std::size_t k = 0; k < in.parts.size(); ++k)
        if (!s.parts[k].empty() && s.parts[k] != in.parts[k]) return false;
    return true;
}

/// Takes the values halfway through the step of `in`, as far as those at its start are kept, into `half`.
void set_values_halfway(const Scene& scene, const State& s, const StepInputs& in, StepInputs& half) {
    if (in.integrator != Integrator::tr_bdf2 || !s.history.values) {
        go_part_way(scene, s.parts, 0.5, half.parts);
        return;
    }
    StepInputs middle, known;
    if (in.at_gamma) {
        values_within(scene, *in.at_gamma, in, known);
        values_between(scene, *s.history.values, known, 0.5 / tr_bdf2_gamma, middle);
    } else {
        values_between(scene, *s.history.values, in, 0.5, middle);
    }
    copy_values(middle, half);
}

/// One step; where it fails and `halvings` are left, again as two steps of half the size, bones and what is keyed taken
/// in between.
/// If the halves fail too, what they reached is kept and reported as not converged.
void take_step_or_halves(Workspace::Impl& impl, State& s, const StepInputs& in, const std::vector<Points>& bones,
                         int halvings, const StepControl& control, StepRecord& record) {
    StepRecord attempt;
    // Without inertia, and where nothing moves, half a step is the same problem again: keep what was reached.
    const bool stands_still = bones == s.bones && parts_stand_still(s, in);
    const bool last_chance = halvings == 0 || (in.integrator == Integrator::quasi_static && stands_still);
    bool taken = false;
    if (impl.newton) impl.newton->worst_residual = 0, impl.newton->worst_deformable = -1;
    try {
        taken = take_step(impl, s, in, bones, last_chance, control, attempt);
    } catch (const Error&) {
        if (last_chance) throw;
    }
    if (taken && impl.newton && impl.newton->worst_deformable >= 0 && attempt.residual > record.residual) {
        const auto worst = static_cast<std::size_t>(impl.newton->worst_deformable);
        impl.residual_body = impl.potential.numbering().deformables[worst].body;
    }
    add_step(attempt, taken, record);
    if (taken) return;
    ++record.halvings;
    StepInputs first = in, second = in;
    set_values_halfway(impl.scene, s, in, first);
    for (StepInputs* half : {&first, &second}) {
        half->step_size = 0.5 * in.step_size;
        half->at_gamma = nullptr; // the halves look at other times
    }
    const std::vector<Points> middle = bones_halfway(impl, s, in, bones);
    impl.potential.set_values(s, first); // what failed may have left those of a stage
    take_step_or_halves(impl, s, first, middle, halvings - 1, control, record);
    impl.prepare(s, second); // what is coupled may be other than at the start of the first half
    impl.potential.set_values(s, second);
    take_step_or_halves(impl, s, second, bones, halvings - 1, control, record);
}

} // namespace

State advance(Workspace& workspace, const State& before, std::span<const StepInputs> substeps,
              const StepControl& control) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    Workspace::Impl& impl = workspace.impl();
    State s = before;
    StepRecord record;
    impl.residual_body = -1;
    impl.measured.clear();
    std::size_t k = 0;
    StepControl inner = control;
    if (control.progress)
        inner.progress = [&](double done, int iteration, double residual) {
            control.progress((static_cast<double>(k) + done) / static_cast<double>(substeps.size()), iteration,
                             residual);
        };
    for (; k < substeps.size(); ++k) {
        const StepInputs& in = impl.receive(s, substeps[k]);
        impl.prepare(s, in);
        if (k == 0 && impl.newton) impl.newton->linear.begin_frame(s.linear);
        take_step_or_halves(impl, s, in, impl.bones, in.max_halvings, inner, record);
        ++s.steps;
        ++record.substeps;
    }
    impl.check_finite(s.x);
    if (impl.newton) impl.newton->linear.end_frame(s.linear);
    impl.potential.describe(s.x, record);
    record.measured = impl.measured;
    const double total = std::chrono::duration<double>(Clock::now() - start).count();
    record.seconds_other =
        std::max(0.0, total - record.seconds_assembly - record.seconds_factor - record.seconds_solve);
    s.record = record;
    return s;
}

void rehearse(Workspace& workspace, const State& state, std::span<const StepInputs> substeps) {
    Workspace::Impl& impl = workspace.impl();
    for (const StepInputs& in : substeps) impl.take(state, impl.receive(state, in));
}

int residual_body(Workspace& workspace) { return workspace.impl().residual_body; }

Marks marks_of(Workspace& workspace, const State& state, const StepInputs& inputs) {
    Marks out;
    const SceneDescription& scene = workspace.scene().description();
    if (scene.parts.empty() && scene.attachments.empty()) return out;
    check_inputs(workspace.scene(), inputs);
    Workspace::Impl& impl = workspace.impl();
    impl.take(state, inputs);
    impl.potential.begin_step(state, inputs);
    standing_form(state, impl.form);
    impl.potential.begin_stage(state, impl.form, state.bones);
    impl.potential.marks(state.x, out);
    return out;
}

const Term* term_shown(Workspace& workspace, const TermType& type) { return workspace.impl().potential.find(type); }

Points surface_positions(const Scene& scene, const State& state, int body) {
    if (scene.bone(body)) return state.bones[static_cast<std::size_t>(body)];
    const TissueRest* tissue = scene.tissue(body);
    if (!tissue) {
        Points out(scene.vertex_count(body));
        const double* x = state.x.data() + 3 * static_cast<std::size_t>(scene.first_vertex(body));
        for (std::size_t v = 0; v < out.size(); ++v) out[v] = Eigen::Map<const Vec3>(x + 3 * v);
        return out;
    }
    return carried_positions(scene, state.x, body, tissue->embedding);
}

Points carried_positions(const Scene& scene, const std::vector<double>& x, int body, const Embedding& embedding) {
    Points out(embedding.size());
    parallel_for(out.size(), 1024, [&](std::size_t i) {
        const PointWeights w = scene.embedded(body, embedding.tet[i], embedding.barycentric[i]);
        Vec3 p = Vec3::Zero();
        for (int k = 0; k < w.count; ++k)
            for (int c = 0; c < 3; ++c)
                p[c] += w.weight[k] * x[3 * static_cast<std::size_t>(w.vertex[k]) + static_cast<std::size_t>(c)];
        out[i] = p;
    });
    return out;
}

} // namespace sinew::solver
