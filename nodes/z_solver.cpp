// zSolver: simulates bodies and attachments, frame after frame.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/attachment_reach.h"
#include "nodes/contacts.h"
#include "nodes/deep_contact.h"
#include "nodes/frame_warnings.h"
#include "nodes/lines_of_action.h"
#include "nodes/marks.h"
#include "nodes/simulation_state.h"
#include "nodes/solver_setup.h"
#include "nodes/start_warnings.h"
#include "nodes/worst.h"
#include "nodes/z_solver_attributes.h"
#include "solver/integrate/implicit_form.h"
#include "solver/linear/blas_kernel.h"
#include "solver/marks_of.h"
#include "solver/residual_body.h"
#include "solver/terms/attachment/anchors.h"
#include "solver/terms/contact/contact.h"

#include <algorithm>
#include <cstdio>

namespace sinew::nodes {

using namespace engine;
using namespace z_solver;

namespace {

const Output<MeshList> out_meshes{
    .name = "outMeshes",
    .doc = "The meshes of all of `bodies` at this frame, in that order and in scene units; disabled tissues "
           "as modelled.",
    .entries_of = "bodies",
};
const Output<Solved> out_solved{.name = "outSolved", .doc = "The solved tets; connect to zEmbedder.solved."};
const Output<SolveReport> out_report{
    .name = "outReport",
    .doc = "How well this frame converged, and the size of the scene.",
};

const Output<MarkList> out_marks{
    .name = "outMarks",
    .doc = "What forces show of themselves at this frame, for viewers: points and lines in scene units with a number "
           "each, in SI units. Empty if no force of the scene shows anything.",
};

const Output<ContactList> out_contacts{
    .name = "outContacts",
    .doc =
        "Who touches whom at this frame: points, normals, depths, forces, the two bodies of each, sliding or held. In "
        "a fixed order, bodies by their places in `bodies`. Connect to contactWriter.contacts for a table.",
};

const Output<NumberList> out_loa_values{
    .name = "outLoaValues",
    .doc = "What each line of action comes to at this frame, 0 to its maxExcitation: by `bodies` and their fibers. "
           "outReport has lengths and excitations in use, too.",
    .unit = "1",
};

/// The scene and its buffers: derived data that is kept from frame to frame only to save work.
struct Stage {
    std::shared_ptr<const solver::Scene> scene;
    solver::Workspace workspace;
    explicit Stage(const Setup& setup)
        : scene(std::make_shared<const solver::Scene>(describe_scene(setup)))
        , workspace(scene) {}
};

/// Runs a solver call; its errors become diagnostics that name the body, attachment or force to blame.
template <class Call>
auto solving(const Reads& in, const Setup& setup, Call&& call) {
    try {
        return call();
    } catch (const solver::Stopped&) {
        throw Cancelled();
    } catch (const solver::Error& e) {
        std::string message = e.what();
        if (e.attachment >= 0)
            in.fail(attachments.name, e.code, attachment_name(in, setup, e.attachment) + ": " + message, e.hint);
        if (e.body >= 0)
            message = in.source_name(bodies.name,
                                     static_cast<std::size_t>(setup.simulated[static_cast<std::size_t>(e.body)])) +
                      ": " + message;
        const bool of_contact =
            e.part >= 0 && setup.forces[static_cast<std::size_t>(e.part)].get().type == &solver::contact_type;
        if (e.code == "FE232" && of_contact && in[collision_subdivision])
            in.fail(collision_point_spacing.name, e.code, std::move(message), e.hint);
        const int entry = e.part < 0 ? -1 : setup.force_entries[static_cast<std::size_t>(e.part)];
        if (entry >= 0)
            in.fail(forces.name, e.code, in.source_name(forces.name, static_cast<std::size_t>(entry)) + ": " + message,
                    e.hint);
        in.fail(bodies.name, e.code, std::move(message), e.hint);
    }
}

Lease<Stage> lease_stage(const Reads& in, const Setup& setup) {
    const Digest key = Hasher().add("zSolver.stage").add(setup.key.digest()).finish();
    return in.lease<Stage>(key, [&] {
        in.progress(0, "building the scene");
        return solving(in, setup, [&] { return std::make_shared<Stage>(setup); });
    });
}

solver::StepControl control_of(const Reads& in) {
    solver::StepControl c;
    c.stop = [&in] { return in.stop_requested(); };
    c.progress = [&in](double done, int, double) { in.progress(done, "solving"); };
    return c;
}

bool without_inertia(const Reads& in) {
    return meaning(options_of<solver::Integrator>, in[integrator]) == solver::Integrator::quasi_static;
}

SimulationState initial(const Reads& in) {
    if (!in[enable]) return {};
    Setup setup = read_setup(in, nullptr, contact_of(in));
    const std::vector<solver::LineMemory> lines = start_lines(in, setup);
    use_lines(lines, setup);
    if (without_inertia(in)) check_all_tied(in, setup);
    auto stage = lease_stage(in, setup);
    const solver::StepInputs inputs = step_inputs(in, setup, 1);
    std::vector<solver::InitialMotion> motions;
    for (std::size_t i = 0; i < setup.simulated.size(); ++i) motions.push_back(setup.body(i).start);
    SimulationState out{setup.key,
                        solving(in, setup, [&] { return solver::initial_state(*stage->scene, inputs, motions); })};
    out.lines = lines;
    warn_of_reach(in, setup, solver::attachments_kept(out.state.memories).starts);
    warn_of_lone_bodies(in, setup);
    warn_of_lines_elsewhere(in, setup);
    return out;
}

/// TR-BDF2's first stage ends at gamma of the step and sees everything as it is there.
std::vector<double> stages_of(const Value& scheme) {
    const bool two_stages =
        meaning(options_of<solver::Integrator>, scheme.as<std::string>()) == solver::Integrator::tr_bdf2;
    return two_stages ? std::vector{solver::tr_bdf2_gamma} : std::vector<double>{};
}

/// What the sub-steps of a frame come to, as the solver reads it.
struct FrameInputs {
    std::vector<solver::StepInputs> steps;
    Setup setup; ///< at the end of the frame
    std::vector<solver::LineMemory> lines;
};

FrameInputs read_frame(const SimulationState& before, std::span<const SubstepReads> times) {
    FrameInputs out;
    SceneKey known = before.scene; // of the sub-step before: which of two alike bones is meant stays known
    const Reads* contact = contact_of(times.back().end);
    out.lines = before.lines;
    for (const auto& [in, within] : times) {
        out.setup = read_setup(in, &known, contact);
        if (out.setup.key != known) known = out.setup.key;
        if (without_inertia(in)) check_all_tied(in, out.setup);
        if (before.state.steps == 0 && out.steps.empty()) warn_of_lost_velocities(in, out.setup, without_inertia(in));
        const double step = 1 / (in[frames_per_second] * static_cast<double>(times.size()));
        const std::vector<solver::LineMemory> lines_before = std::move(out.lines);
        out.lines = follow_lines(out.setup, lines_before, step);
        use_lines(out.lines, out.setup);
        out.steps.push_back(step_inputs(in, out.setup, times.size()));
        for (const Reads& stage : within) {
            Setup at_gamma = read_setup(stage, &known, contact);
            use_lines(follow_lines(at_gamma, lines_before, solver::tr_bdf2_gamma * step), at_gamma);
            out.steps.back().at_gamma =
                std::make_shared<const solver::StepInputs>(step_inputs(stage, at_gamma, times.size()));
        }
    }
    return out;
}

/// A state as `setup` goes on from it: with the contacts that it lacks.
solver::State with_contacts(const solver::Scene& scene, const SimulationState& before, const Setup& setup,
                            const solver::StepInputs& inputs) {
    if (setup.key.contacts == before.scene.contacts) return before.state;
    return solver::with_other_parts(scene, before.state, before.scene.forces.size() - before.scene.contacts, inputs);
}

SimulationState advance(const SimulationState& before, std::span<const SubstepReads> times) {
    const Reads& now = times.back().end;
    if (!now[enable]) return before;
    FrameInputs frame = read_frame(before, times);
    const Setup& setup = frame.setup;
    auto stage = lease_stage(now, setup);
    if (stage->scene->vertex_count() == 0) return before; // bones alone: nothing to solve
    const auto step = [&] {
        try {
            return solver::advance(stage->workspace, with_contacts(*stage->scene, before, setup, frame.steps.front()),
                                   frame.steps, control_of(now));
        } catch (solver::Error& e) {
            std::string hint;
            if (e.code == "FE302") hint = hint_of_jump(now, setup, before.state, frame.steps.back());
            if (!hint.empty()) e.hint = std::move(hint);
            throw;
        }
    };
    SimulationState after{setup.key, solving(now, setup, step)};
    after.lines = std::move(frame.lines);
    if (setup.key.contacts > before.scene.contacts) warn_of_lone_bodies(now, setup);
    if (const int body = solver::residual_body(stage->workspace); body >= 0)
        after.residual_body = setup.simulated[static_cast<std::size_t>(body)];
    warn_if_unconverged(now, setup, before.state, after);
    warn_if_inverted(now, setup, *stage->scene, after.state);
    return after;
}

/// The state with contacts that come and go as frames are looked at, and lengths of lines as they then are; bodies stay
/// where they were at the start.
SimulationState rehearse(const SimulationState& before, std::span<const SubstepReads> times) {
    const Reads& now = times.back().end;
    if (!now[enable]) return before;
    FrameInputs frame = read_frame(before, times);
    auto stage = lease_stage(now, frame.setup);
    if (stage->scene->vertex_count() == 0) return before;
    SimulationState after = before;
    solving(now, frame.setup, [&] {
        after.state = with_contacts(*stage->scene, before, frame.setup, frame.steps.front());
        solver::rehearse(stage->workspace, after.state, frame.steps);
    });
    after.scene = frame.setup.key;
    after.lines = std::move(frame.lines);
    return after;
}

/// All bodies as they stand without simulation: bones where they are, tissues and cloth as modelled.
MeshList unsolved_meshes(const Setup& setup) {
    MeshList out;
    for (const Body& b : setup.bodies) out.meshes.push_back(b.is_bone() ? std::get<Mesh>(b.values) : b.rest->mesh);
    return out;
}

void publish_tissue(const solver::Scene& scene, const solver::State& state, int body, const SolverSpace& space,
                    Mesh& mesh, solver::Points& tets, solver::Points& midpoints) {
    mesh = mesh.with_points(space.to_scene(solver::surface_positions(scene, state, body)));
    const double* x = state.x.data() + 3 * scene.first_vertex(body);
    const std::size_t corners = scene.tissue(body)->tets.vertices.size();
    for (std::size_t v = 0; v < scene.vertex_count(body); ++v)
        (v < corners ? tets : midpoints).emplace_back(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
    tets = space.to_scene(std::move(tets));
    midpoints = space.to_scene(std::move(midpoints));
}

int nearest_vertex(const solver::Points& points, const std::array<double, 3>& place) {
    const solver::Vec3 p(place[0], place[1], place[2]);
    int best = -1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t v = 0; v < points.size(); ++v)
        if (const double d = (points[v] - p).squaredNorm(); d < least) least = d, best = static_cast<int>(v);
    return best;
}

void publish(const SimulationState& s, const Reads& in, Writes& out) {
    const bool runs = in[enable];
    Setup setup = read_setup(in, runs ? &s.scene : nullptr, runs ? contact_of(in) : nullptr);
    MeshList meshes = unsolved_meshes(setup);
    Solved solved;
    SolveReport report;
    MarkList marks;
    ContactList contacts;
    NumberList loa_values;
    if (runs) {
        use_lines(s.lines, setup);
        auto stage = lease_stage(in, setup);
        report = describe_size(in, setup, *stage->scene);
        report.record = s.state.record;
        const bool slides = std::any_of(setup.attachments.begin(), setup.attachments.end(),
                                        [](const Attachment& a) { return a.values.slides > 0; });
        if (!setup.forces.empty() || slides) {
            const solver::StepInputs inputs = step_inputs(in, setup, 1);
            marks = mark_list(solving(in, setup, [&] { return marks_of(stage->workspace, s.state, inputs); }),
                              setup.simulated, setup.space);
            contacts = contact_list(solver::contacts_shown(stage->workspace), setup.simulated, setup.space);
        }
        add_line_marks(setup, s.lines, marks);
        report.lines = line_reports(setup, s.lines, run_up_of_excitation(in));
        for (const solver::LineMemory& line : s.lines) loa_values.push_back(line.value);
        for (std::size_t i = 0; i < setup.simulated.size(); ++i) {
            const Body& b = setup.body(i);
            Mesh& mesh = meshes.meshes[static_cast<std::size_t>(setup.simulated[i])];
            solver::Points& positions = solved.positions.emplace_back();
            solver::Points& midpoints = solved.midpoints.emplace_back();
            if (b.is_cloth())
                mesh = mesh.with_points(
                    setup.space.to_scene(solver::surface_positions(*stage->scene, s.state, static_cast<int>(i))));
            if (b.is_bone() || b.is_cloth())
                positions = *mesh.points;
            else
                publish_tissue(*stage->scene, s.state, static_cast<int>(i), setup.space, mesh, positions, midpoints);
            solved.bodies.push_back(setup.ids[i]);
            solved.rests.push_back(setup.rests[i]);
        }
        solved.carriers = setup.carriers;
        report.worst = find_worst(setup, *stage->scene, s.state);
        find_deepest(contacts, report.worst);
        find_deep(in, setup, meshes, contacts, report);
        report.worst.residual_body = s.residual_body;
        if (report.worst.attachment >= 0)
            report.worst.vertex = nearest_vertex(
                *meshes.meshes[static_cast<std::size_t>(report.worst.source_body)].points, report.worst.stretch_place);
    }
    out.set(out_meshes, std::move(meshes));
    out.set(out_solved, std::move(solved));
    out.set(out_report, std::move(report));
    out.set(out_marks, std::move(marks));
    out.set(out_contacts, std::move(contacts));
    out.set(out_loa_values, std::move(loa_values));
}

} // namespace

void add_z_solver(Registry& registry) {
    SimulationType<SimulationState> type;
    type.base.name = "zSolver";
    // 28: BDF2 begins anew when a body comes on
    // 29: shares of subtissues and painted layers: sides of triangles in sharp folds are known
    // 30: solves with a factor add up by other pieces of it
    // 31: no direction moves bodies that are off, and they stand from the first step on
    type.base.numerics = 32; // stiff attachments are limited by the flesh where they hold, and their means too
    type.base.machine = solver::machine_numerics();
    type.base.doc = "Simulates soft tissue and cloth: bones move, the others follow by the laws of physics.";
    type.base.inputs = {describe(bodies),
                        describe(attachments),
                        describe(forces),
                        describe(enable),
                        describe(start_frame),
                        describe(translate),
                        describe(rotate),
                        describe(scale),
                        describe(matrix),
                        describe(linear_solver),
                        describe(integrator),
                        describe(frames_per_second),
                        describe(substeps),
                        describe(max_newton_iterations),
                        describe(step_halvings),
                        describe(tolerance_factor),
                        describe(stiffness_damping),
                        describe(mass_damping),
                        describe(gravity),
                        describe(runup_weight),
                        describe(affect_gravity),
                        describe(affect_inertial_damping),
                        describe(affect_pressure),
                        describe(affect_surface_tension),
                        describe(affect_rest_scale),
                        describe(affect_excitation),
                        describe(collision_detection),
                        describe(collision_subdivision),
                        describe(collision_point_spacing),
                        describe(max_contact_length),
                        describe(contact_damping)};
    type.base.outputs = {describe(out_meshes), describe(out_solved),   describe(out_report),
                         describe(out_marks),  describe(out_contacts), describe(out_loa_values)};
    type.initial = initial;
    type.advance = advance;
    type.rehearse = rehearse;
    type.publish = publish;
    type.save = [](const SimulationState& s) { return save(s); };
    type.load = [](std::span<const std::byte> bytes) { return load_simulation(bytes); };
    type.start_frame_input = start_frame.name;
    type.substeps_input = substeps.name;
    type.stages_input = integrator.name;
    type.stages = stages_of;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
