// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/step.h"

#include "solver/attach/anchors.h"
#include "solver/error.h"
#include "solver/newton/minimise.h"
#include "solver/newton/potential.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

namespace sinew::solver {

struct Workspace::Impl {
    Potential potential;
    std::unique_ptr<NewtonWorkspace> newton;
    ImplicitForm form;
    explicit Impl(const Scene& scene) : potential(scene) {}

    void prepare(const std::vector<std::vector<Anchor>>& anchors) {
        const bool new_pattern = potential.set_anchors(anchors);
        if (potential.unknown_count() == 0 || (newton && !new_pattern)) return;
        newton = std::make_unique<NewtonWorkspace>(potential.pattern());
    }
};

Workspace::Workspace(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)), impl_(std::make_unique<Impl>(*scene_)) {}
Workspace::~Workspace() = default;
int Workspace::symbolic_analyses() const { return impl_->newton ? impl_->newton->linear.symbolic_analyses() : 0; }

namespace {

/// Base of the tolerance that zSolver.solverToleranceFactor multiplies.
constexpr double base_tolerance = 1e-6;

void check_inputs(const Scene& scene, const StepInputs& in) {
    if (static_cast<int>(in.bodies.size()) != scene.body_count() ||
        in.attachments.size() != scene.description().attachments.size())
        throw std::logic_error("step inputs must name every body and attachment of the scene, in order");
    if (!(in.step_size > 0) || !std::isfinite(in.step_size))
        throw Error("FE302", "the step size is " + std::to_string(in.step_size) + " s", "it must be positive");
    for (int body = 0; body < scene.body_count(); ++body) {
        const BodyInputs& b = in.bodies[static_cast<std::size_t>(body)];
        Error e("FE202", "", "");
        e.body = body;
        if (const BoneRest* bone = scene.bone(body)) {
            const Points& p = std::get<BoneInputs>(b).positions;
            if (p.size() != bone->surface.size()) {
                Error changed("FE211", "the bone has " + std::to_string(p.size()) + " vertices; it started with " +
                                           std::to_string(bone->surface.size()), "a body keeps its vertices");
                changed.body = body;
                throw changed;
            }
            for (std::size_t i = 0; i < p.size(); ++i)
                if (!p[i].allFinite()) {
                    Error bad("FE202", "vertex " + std::to_string(i) + " of the bone is not a finite number",
                              "check the transform that moves it");
                    bad.body = body;
                    throw bad;
                }
        } else {
            const auto& t = std::get<TissueInputs>(b);
            const TissueRest& rest = *scene.tissue(body);
            if (t.layers.size() != rest.layer_weights.size() || t.fibers.size() != rest.fibers.size())
                throw std::logic_error("step inputs must give values for every layer and fibre of a tissue");
        }
    }
}

std::vector<Points> bone_positions(const Scene& scene, const StepInputs& in) {
    std::vector<Points> bones(static_cast<std::size_t>(scene.body_count()));
    for (int body = 0; body < scene.body_count(); ++body)
        if (scene.bone(body))
            bones[static_cast<std::size_t>(body)] = std::get<BoneInputs>(in.bodies[static_cast<std::size_t>(body)]).positions;
    return bones;
}

} // namespace

State initial_state(const Scene& scene, const StepInputs& inputs) {
    check_inputs(scene, inputs);
    State s;
    s.x = scene.system().rest;
    s.v.assign(s.x.size(), 0.0);
    s.bones = bone_positions(scene, inputs);
    std::vector<Points> surfaces(s.bones);
    for (int body = 0; body < scene.body_count(); ++body)
        if (scene.tissue(body)) surfaces[static_cast<std::size_t>(body)] = surface_positions(scene, s, body);
    for (const AttachmentRest& a : scene.description().attachments) s.anchors.push_back(make_anchors(scene, a, surfaces));
    return s;
}

State advance(Workspace& workspace, const State& before, std::span<const StepInputs> substeps, const StepControl& control) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    const Scene& scene = workspace.scene();
    Workspace::Impl& impl = workspace.impl();
    State s = before;
    s.record = {};
    impl.prepare(s.anchors);
    for (std::size_t k = 0; k < substeps.size(); ++k) {
        const StepInputs& in = substeps[k];
        check_inputs(scene, in);
        std::vector<Points> bones = bone_positions(scene, in);
        make_form(s, in, impl.form);
        impl.potential.begin_step(s, in, impl.form, bones);
        std::vector<double> x = s.x;
        StepControl inner = control;
        if (control.progress)
            inner.progress = [&, k](double done, int iteration, double residual) {
                control.progress((static_cast<double>(k) + done) / static_cast<double>(substeps.size()), iteration, residual);
            };
        if (s.linear.factor_steps_left > 0) --s.linear.factor_steps_left;
        if (impl.newton)
            minimise(impl.potential, *impl.newton, {in.max_newton_iterations, base_tolerance * in.tolerance_factor, in.linear_method}, inner,
                     x, s.linear, s.record);
        update_velocity(impl.form, x, s.v);
        s.x = std::move(x);
        s.bones = std::move(bones);
        ++s.steps;
        ++s.record.substeps;
    }
    for (const double c : s.x)
        if (!std::isfinite(c)) throw Error("FE302", "the step gave positions that are not finite numbers");
    impl.potential.describe(s.x, s.record);
    const double total = std::chrono::duration<double>(Clock::now() - start).count();
    s.record.seconds_other =
        std::max(0.0, total - s.record.seconds_assembly - s.record.seconds_factor - s.record.seconds_solve);
    return s;
}

Points surface_positions(const Scene& scene, const State& state, int body) {
    const TissueRest* tissue = scene.tissue(body);
    if (!tissue) return state.bones[static_cast<std::size_t>(body)];
    Points out;
    apply(tissue->embedding, tissue->tets.tets, state.x.data() + 3 * static_cast<std::size_t>(scene.first_vertex(body)), out);
    return out;
}

} // namespace sinew::solver
