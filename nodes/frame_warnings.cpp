// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/frame_warnings.h"

#include "nodes/options.h"
#include "nodes/worst.h"
#include "nodes/z_solver_attributes.h"

#include <algorithm>
#include <cstdio>

namespace sinew::nodes {

using namespace engine;
using namespace z_solver;

namespace {

/// The bone that has gone farthest between two states, measured by its own size.
struct Leap {
    int body = -1; ///< in the solver's scene; -1: no bone moves
    double distance = 0, sizes = 0;
};
Leap farthest_leap(const std::vector<solver::Points>& before, const std::vector<solver::Points>& after) {
    Leap out;
    for (std::size_t body = 0; body < std::min(before.size(), after.size()); ++body) {
        if (before[body].empty() || before[body].size() != after[body].size()) continue;
        double distance = 0;
        for (std::size_t v = 0; v < after[body].size(); ++v)
            distance = std::max(distance, (after[body][v] - before[body][v]).norm());
        const double size = solver::bounding_box(after[body]).size().norm();
        if (distance > out.sizes * size) out = {static_cast<int>(body), distance, distance / size};
    }
    return out;
}

/// Whether it is a cloth that has not come to rest. `body`: of zSolver.bodies; -1: it is not known which.
bool cloth_is_left(const Setup& setup, int body) {
    if (body >= 0) return setup.bodies[static_cast<std::size_t>(body)].get().is_cloth();
    return std::any_of(setup.bodies.begin(), setup.bodies.end(), [](const Body& b) { return b.is_cloth(); });
}

/// A bone that goes farther in a frame is hardly meant to.
constexpr double most_sizes_a_frame = 3;

/// Of a bone that has jumped: its name, and how far it has gone.
struct Jump {
    std::string bone, far;
    explicit operator bool() const { return !bone.empty(); }
};
Jump find_jump(const Reads& in, const Setup& setup, const std::vector<solver::Points>& before,
               const std::vector<solver::Points>& after) {
    const Leap leap = farthest_leap(before, after);
    if (!(leap.sizes > most_sizes_a_frame)) return {};
    char far[100];
    std::snprintf(far, sizeof far, "%.4g in this frame, %.3g times its size", leap.distance * setup.key.scale,
                  leap.sizes);
    return {in.source_name(bodies.name, static_cast<std::size_t>(setup.simulated[static_cast<std::size_t>(leap.body)])),
            far};
}

constexpr const char* look_at_jump = " (the unit of its motion, a jump between keys); if it is, raise substeps.";

} // namespace

void warn_if_unconverged(const Reads& in, const Setup& setup, const solver::State& before, const SimulationState& s) {
    const solver::StepRecord& record = s.state.record;
    if (record.converged) return;
    char text[160];
    int length = std::snprintf(text, sizeof text, " after %d Newton iterations", record.newton_iterations);
    // All of the frame are counted, so there may be more than maxNewtonIterations.
    const auto room = [&] { return sizeof text - static_cast<std::size_t>(length); };
    if (record.substeps > 1) length += std::snprintf(text + length, room(), " in %d substeps", record.substeps);
    if (record.halvings > 0)
        std::snprintf(text + length, room(), "; the step was halved %d time%s", record.halvings,
                      record.halvings == 1 ? "" : "s");
    const std::string of =
        s.residual_body < 0 ? "" : " of " + in.source_name(bodies.name, static_cast<std::size_t>(s.residual_body));
    char residual[32];
    std::snprintf(residual, sizeof residual, "%.3g", record.residual);
    char frame[32];
    std::snprintf(frame, sizeof frame, "%g", in.frame());
    std::string leaps,
        hint = "Raise maxNewtonIterations or substeps, or accept it with a larger solverToleranceFactor.";
    const std::string few = std::to_string(few_cloth_iterations), most = std::to_string(most_cloth_iterations);
    const auto limit = in[max_newton_iterations];
    // Sums over several pieces say nothing of one, and a step of motion that finds no lower energy is halved.
    if (in[integrator] == word_of(solver::Integrator::quasi_static) && record.substeps <= 1 && record.halvings == 0 &&
        record.newton_iterations < limit)
        hint = std::string("More iterations would not help: no lower energy was found from where they led") +
               (cloth_is_left(setup, -1) ? ", as where a flat sheet without tension carries something" : "") +
               ". Give it inertia (another integrator), or accept it with a larger solverToleranceFactor.";
    else if (limit < most_cloth_iterations && cloth_is_left(setup, s.residual_body))
        hint = "Raise maxNewtonIterations from " + std::to_string(limit) + " to " + most +
               ": cloth that touches or folds takes " + few + " to " + most +
               ", and halved steps cost more than they; or raise substeps.";
    if (const Jump jump = find_jump(in, setup, before.bones, s.state.bones)) {
        leaps = "; " + jump.bone + " has gone " + jump.far;
        hint = "Look whether " + jump.bone + " is meant to" + look_at_jump;
    }
    in.warn(max_newton_iterations.name, "FE301",
            "frame " + std::string(frame) + " has not converged: residual " + residual + of + text + leaps, hint);
}

std::string hint_of_jump(const Reads& in, const Setup& setup, const solver::State& before,
                         const solver::StepInputs& after) {
    std::vector<solver::Points> bones(after.bodies.size());
    for (std::size_t i = 0; i < bones.size(); ++i)
        if (const auto* bone = std::get_if<solver::BoneInputs>(&after.bodies[i])) bones[i] = bone->positions;
    const Jump jump = find_jump(in, setup, before.bones, bones);
    return jump ? "Look whether " + jump.bone + " is meant to go " + jump.far + look_at_jump : "";
}

void warn_if_inverted(const Reads& in, const Setup& setup, const solver::Scene& scene, const solver::State& state) {
    const solver::StepRecord& record = state.record;
    if (!record.converged || record.inverted == 0) return; // what has not converged is told already
    const WorstPlaces worst = find_worst(setup, scene, state);
    char text[240];
    std::snprintf(text, sizeof text, "frame %g has converged with %d inverted tet%s; the worst is tet %d of ",
                  in.frame(), record.inverted, record.inverted == 1 ? "" : "s", worst.tet);
    const std::string name =
        worst.body < 0 ? "a tissue" : in.source_name(bodies.name, static_cast<std::size_t>(worst.body));
    char place[120];
    std::snprintf(place, sizeof place, ", near (%.4g, %.4g, %.4g)", worst.tet_place[0], worst.tet_place[1],
                  worst.tet_place[2]);
    in.warn(bodies.name, "FE306", text + name + place,
            "Take more substeps through this frame, or look for a bone that jumps or passes through the tissue.");
}

} // namespace sinew::nodes
