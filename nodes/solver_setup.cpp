// Resolves zSolver's wires, checks the rules across them, and converts units.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/solver_setup.h"
#include "nodes/adapters.h"

#include "nodes/contact_inputs.h"
#include "nodes/lines_of_action.h"
#include "nodes/options.h"
#include "nodes/z_solver_attributes.h"
#include "solver/terms/contact/contact.h"
#include "solver/terms/contact/contact_rest.h"
#include "solver/terms/elastic/rest_change.h"
#include "solver/terms/hold/hold.h"
#include "solver/terms/pressure/pressure.h"
#include "solver/terms/surface_tension/surface_tension.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace sinew::nodes {

using engine::Digest;
using engine::Reads;
using namespace z_solver;

namespace {

/// The tissue that a subtissue is a part of: its place among all bodies. Fails with FE228 where there is none.
std::size_t whole_of(const Reads& in, const Setup& setup, std::size_t body) {
    const engine::Digest& wanted = setup.bodies[body].get().subtissue->digest;
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < setup.bodies.size(); ++i)
        for (const BodyRest::Part& part : setup.bodies[i].get().rest->parts)
            if (part.digest == wanted) found.push_back(i);
    if (found.size() > 1)
        in.fail(bodies.name, "FE228",
                in.source_name(bodies.name, body) + " is a part of both " + in.source_name(bodies.name, found[0]) +
                    " and " + in.source_name(bodies.name, found[1]),
                "Connect it to subtissues of one tissue, and a zSubtissue of its own to those of the other.");
    if (!found.empty()) return found.front();
    in.fail(bodies.name, "FE228", in.source_name(bodies.name, body) + " is a part of none of this solver's bodies",
            "Connect it to subtissues of the tissue that it lies in, and that tissue to zSolver.bodies.");
}

ModelledBone modelled_bone(const BodyRest& rest) {
    const auto* bone = std::get_if<std::shared_ptr<const solver::BoneRest>>(&rest.data);
    if (!bone) return {};
    return {std::shared_ptr<const solver::Points>(*bone, &(*bone)->surface), rest.mesh.points_digest};
}

/// Whether one bone may be the other at another time.
bool alike(const ModelledBone& a, const ModelledBone& b) {
    return a.points && b.points ? a.points->size() == b.points->size() : !a.points && !b.points;
}

void take_bodies(const Reads& in, Setup& setup) {
    setup.bodies = in[bodies];
    for (std::size_t i = 0; i < setup.bodies.size(); ++i) {
        const Body& b = setup.bodies[i];
        const Body& whole = b.subtissue ? setup.bodies[whole_of(in, setup, i)].get() : b;
        if (!whole.takes_part) continue;
        setup.simulated.push_back(static_cast<int>(i));
        setup.ids.push_back(id_of(b));
        setup.rests.push_back(b.rest);
        for (const BodyRest::Part& part : whole.rest->parts)
            if (b.subtissue && part.digest == b.subtissue->digest) setup.rests.back() = part.rest;
        setup.key.bodies.push_back(setup.rests.back()->digest);
        setup.key.modelled.push_back(modelled_bone(*setup.rests.back()));
        for (const FiberLine& line : b.lines) {
            if (b.subtissue) break; // those of its tissue stand for them
            setup.lines.push_back({setup.simulated.size() - 1, &line});
            setup.key.lines.push_back(bound_digest(*line.line));
        }
    }
    for (std::size_t i = 0; i < setup.simulated.size(); ++i) {
        const auto body = static_cast<std::size_t>(setup.simulated[i]);
        const auto whole = static_cast<int>(setup.body(i).subtissue ? whole_of(in, setup, body) : body);
        const auto at = std::find(setup.simulated.begin(), setup.simulated.end(), whole);
        setup.carriers.push_back(static_cast<int>(at - setup.simulated.begin()));
    }
}

/// Bones may be alike at the start and go apart later. Tissues may not: what each becomes hangs on what is attached to
/// it, which nothing could find.
void refuse_twins(const Reads& in, const Setup& setup) {
    for (std::size_t i = 0; i < setup.ids.size(); ++i)
        for (std::size_t j = i + 1; j < setup.ids.size(); ++j) {
            if (setup.ids[i] != setup.ids[j]) continue;
            const std::string one = body_name(in, setup, i), other = body_name(in, setup, j);
            if (one == other)
                in.fail(bodies.name, "FE213", one + " is connected twice", "Remove one of the two connections.");
            if (!setup.body(i).is_bone())
                in.fail(bodies.name, "FE213",
                        one + " and " + other + " are alike: the same mesh and values at the same place",
                        "Remove one of them, or make them differ in place or material; what they collide with and "
                        "later keys tell nothing apart.");
        }
}

/// What resolve says of a body that is not among the simulated ones.
constexpr int disabled = -10, not_there = -11;

/// Position among the simulated bodies, or why there is none.
int resolve(const Reads& in, const Setup& setup, std::string_view attribute, std::size_t entry, const BodyId& wanted,
            int hint, bool is_start, const char* end) {
    const std::string name = in.source_name(attribute, entry);
    const int found = find_body(setup.ids, wanted, hint);
    // Bones that are alike in all: whichever is taken gives the same as long as they are, and when they part, their
    // values tell which was meant.
    for (std::size_t i = 0; i < setup.ids.size() && found == body_ambiguous; ++i)
        if (setup.ids[i] == wanted && setup.body(i).is_bone()) return static_cast<int>(i);
    const bool some_alike = std::find(setup.ids.begin(), setup.ids.end(), wanted) != setup.ids.end();
    if (found == body_ambiguous && some_alike)
        in.fail(attribute, "FE213",
                "two bodies are exactly alike, so the " + std::string(end) + " of " + name + " could be either",
                "Make them differ in place or material.");
    // Bones of one topology have one rest digest. At the start, where both wires are read at one time, what is meant
    // has the same place, too; from then on the key tells which it was, but for what is disabled and not in the key.
    if (found >= 0 && setup.ids[static_cast<std::size_t>(found)] == wanted) return found;
    const auto is_off = [&](const Body& b) { return !b.takes_part || b.subtissue; }; // disabled, or a part of what is
    const auto any_off = [&](const auto& fits) {
        return std::ranges::any_of(setup.bodies, [&](const Body& b) { return is_off(b) && fits(b); });
    };
    if (any_off([&](const Body& b) { return id_of(b) == wanted; })) return disabled;
    if (is_start) return not_there;
    if (found >= 0) return found;
    return any_off([&](const Body& b) { return b.rest->digest == wanted.rest; }) ? disabled : not_there;
}

/// An input of what is connected to the solver, and what stands there that the solver does not have.
struct MissingBody {
    std::string input, name;
};

[[noreturn]] void refuse_missing(const Reads& in, std::string_view attribute, std::size_t entry,
                                 const std::vector<MissingBody>& bodies) {
    std::string ends, wanted;
    for (const MissingBody& b : bodies) {
        ends += (ends.empty() ? "the " : " and the ") + b.input + " (" + b.name + ")";
        wanted += (wanted.empty() ? "" : ", ") + b.name;
    }
    in.fail(attribute, "FE209",
            ends + " of " + in.source_name(attribute, entry) + (bodies.size() == 1 ? " is none" : " are none") +
                " of this solver's bodies",
            "Connect to zSolver.bodies too: " + wanted + ".");
}

/// Of a force's bodies the one of that number: a hold's tissue or bone, or an entry of a field's bodies.
MissingBody body_of_force(const Reads& in, std::size_t entry, std::size_t body) {
    const std::string_view attribute = z_solver::forces.name;
    const char* input = body == 0 ? "tissue" : "bone";
    if (!in.source_behind(attribute, entry, "tissue").empty())
        return {input, in.source_behind(attribute, entry, input)};
    return {"body", in.source_behind(attribute, entry, "bodies", body)};
}

/// Of an entry of zSolver.attachments, between two bodies that take part.
void refuse_own_part(const Reads& in, const Setup& setup, std::size_t entry, int from, int to) {
    const auto carrier = [&](int body) { return setup.carriers[static_cast<std::size_t>(body)]; };
    if (from == to || (carrier(from) != to && carrier(to) != from)) return;
    const auto name = [&](int body) { return body_name(in, setup, static_cast<std::size_t>(body)); };
    const bool source_is_part = carrier(from) == to;
    in.fail(attachments.name, "FE219",
            in.source_name(attachments.name, entry) + ": " + name(source_is_part ? from : to) + " is a part of " +
                name(source_is_part ? to : from) + ", and goes along with it without being attached",
            "Connect another body, or take the attachment out.");
}

void take_attachments(const Reads& in, Setup& setup, const SceneKey* known) {
    const auto all = in[attachments];
    refuse_twice(in, attachments.name, all.size(), "pull");
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Attachment& a = all[i];
        const std::size_t next = setup.key.links.size();
        const std::array<int, 2> hint = known && next < known->links.size() ? known->links[next] : std::array{-1, -1};
        const int from = resolve(in, setup, attachments.name, i, a.source_body, hint[0], !known, "source");
        const int to = resolve(in, setup, attachments.name, i, a.target_body, hint[1], !known, "target");
        std::vector<MissingBody> missing;
        if (from == not_there) missing.push_back({"source", in.source_behind(attachments.name, i, "source")});
        if (to == not_there) missing.push_back({"target", in.source_behind(attachments.name, i, "target")});
        if (!missing.empty()) refuse_missing(in, attachments.name, i, missing);
        if (from < 0 || to < 0) continue;
        refuse_own_part(in, setup, i, from, to);
        setup.attachments.emplace_back(a);
        setup.attachment_entries.push_back(static_cast<int>(i));
        setup.key.links.push_back({from, to});
        setup.key.attachments.push_back(static_digest(a.rest));
    }
}

void take_force(Setup& setup, const Force& f, int entry, std::vector<int> bodies) {
    setup.forces.emplace_back(f);
    setup.force_entries.push_back(entry);
    setup.key.forces.push_back(static_digest(f));
    setup.key.reach.push_back(std::move(bodies));
}

/// Bodies are found as those of attachments are. A force all of whose bodies are disabled takes no part.
void take_forces(const Reads& in, Setup& setup, const SceneKey* known, const Reads* contact) {
    const auto all = in[z_solver::forces];
    refuse_twice(in, z_solver::forces.name, all.size(), "act");
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Force& f = all[i];
        const std::size_t next = setup.key.reach.size();
        std::vector<int> reached;
        for (std::size_t b = 0; b < f.bodies.size(); ++b) {
            const bool has_hint = known && next < known->reach.size() && b < known->reach[next].size();
            const int found = resolve(in, setup, z_solver::forces.name, i, f.bodies[b],
                                      has_hint ? known->reach[next][b] : body_missing, !known, "body");
            if (found == not_there) refuse_missing(in, z_solver::forces.name, i, {body_of_force(in, i, b)});
            if (found >= 0) reached.push_back(found);
        }
        for (std::size_t b = 0; f.on_all && b < setup.simulated.size(); ++b)
            if (!setup.body(b).is_bone() && !setup.body(b).subtissue) reached.push_back(static_cast<int>(b));
        if (!reached.empty()) take_force(setup, f, static_cast<int>(i), std::move(reached));
    }
    for (std::size_t b = 0; b < setup.simulated.size(); ++b)
        for (const Force& f : setup.body(b).forces) take_force(setup, f, -1, {static_cast<int>(b)});
    if (!contact) return;
    const Reads& source = in[collision_detection] ? in : *contact;
    const auto bodies_then = source[z_solver::bodies];
    for (std::size_t b = 0; b < setup.simulated.size(); ++b) {
        const Body& body = bodies_then[static_cast<std::size_t>(setup.simulated[b])];
        if (!body.contact) continue;
        setup.contacts.push_back(
            std::make_shared<const Force>(contact_in_solver(source, *body.contact, setup.key.scale)));
        take_force(setup, *setup.contacts.back(), -1, {static_cast<int>(b)});
    }
    setup.key.contacts = setup.contacts.size();
}

/// Contact may come in and go; all else must stay as it is.
SceneKey without_contacts(SceneKey key) {
    key.forces.resize(key.forces.size() - key.contacts);
    key.reach.resize(key.forces.size());
    key.contacts = 0;
    return key;
}

/// Of attachments and forces that hold on to one of several bones of the same rest data, it may turn out only when
/// those part which one was meant. Until then they moved alike, so nothing that the state holds changes.
bool same_but_for_twins(const Setup& setup, const SceneKey& now, const SceneKey& known) {
    const auto fits = [&](int a, int b) {
        const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
        return i == j || (now.bodies[i] == now.bodies[j] && setup.body(i).is_bone());
    };
    SceneKey linked_as_known = now;
    for (std::size_t l = 0; l < now.links.size() && l < known.links.size(); ++l)
        for (std::size_t end = 0; end < 2; ++end)
            if (fits(now.links[l][end], known.links[l][end])) linked_as_known.links[l][end] = known.links[l][end];
    for (std::size_t f = 0; f < now.reach.size() && f < known.reach.size(); ++f)
        for (std::size_t b = 0; b < now.reach[f].size() && b < known.reach[f].size(); ++b)
            if (fits(now.reach[f][b], known.reach[f][b])) linked_as_known.reach[f][b] = known.reach[f][b];
    return linked_as_known == known;
}

void refuse_changes(const Reads& in, const Setup& setup, const SceneKey& now, const SceneKey& known) {
    if (now == known || (now.bodies == known.bodies && same_but_for_twins(setup, now, known))) return;
    const std::string hint = "Meshes, tets and painted maps must not change over time; key stiffness, excitation or "
                             "bone motion instead.";
    for (std::size_t i = 0; i < now.bodies.size() && now.bodies.size() == known.bodies.size(); ++i)
        if (now.bodies[i] != known.bodies[i])
            in.fail(bodies.name, "FE211",
                    "the rest shape of " + body_name(in, setup, i) +
                        " is not that of the start "
                        "frame",
                    hint);
    for (std::size_t i = 0; i < now.attachments.size() && now.attachments.size() == known.attachments.size(); ++i)
        if (now.attachments[i] != known.attachments[i] || now.links[i] != known.links[i])
            in.fail(attachments.name, "FE211",
                    "the painted weights of " +
                        in.source_name(attachments.name, static_cast<std::size_t>(setup.attachment_entries[i])) +
                        " are not those of the start frame",
                    hint);
    for (std::size_t i = 0; i < now.forces.size() && i < known.forces.size(); ++i)
        if (now.forces[i] != known.forces[i] && setup.forces[i].get().type == &solver::rest_shape_type)
            in.fail(bodies.name, "FE211",
                    "a target among the restShapes of " +
                        body_name(in, setup, static_cast<std::size_t>(now.reach[i].front())) +
                        " is not that of the start frame",
                    "Targets do not move over time; key zRestShape.targetWeight, or blend two targets.");
    for (std::size_t i = 0; i < now.forces.size() && i < known.forces.size(); ++i)
        if (now.forces[i] != known.forces[i] && setup.forces[i].get().type == &solver::contact_type) {
            const auto b = static_cast<std::size_t>(now.reach[i].front());
            const Mesh& mesh = mesh_of(setup.body(b));
            const bool inside_out = solver::is_closed(mesh.topology->triangles) &&
                                    solver::enclosed_volume(*mesh.points, mesh.topology->triangles) < 0;
            in.fail(bodies.name, "FE211",
                    inside_out ? "the surface of " + body_name(in, setup, b) +
                                     " is inside out, which it was not at the start frame, so it bounds no solid that "
                                     "others could collide with"
                               : "what " + body_name(in, setup, b) + " collides by is not that of the start frame",
                    inside_out ? "Scale it by positive numbers and let nothing turn its flesh inside out, or set its "
                                 "collisionVolume to off."
                               : hint);
        }
    if (now.forces != known.forces)
        in.fail(z_solver::forces.name, "FE211",
                "the painted weights or options of a force are not those of the start frame", hint);
    in.fail(bodies.name, "FE211", "other bodies, attachments or forces take part than at the start frame", hint);
}

std::shared_ptr<solver::TissueRest> in_metres(const solver::TissueRest& rest, double units) {
    auto t = std::make_shared<solver::TissueRest>(rest);
    t->tets.vertices = to_metres(rest.tets.vertices, units);
    t->surface = to_metres(rest.surface, units);
    return t;
}

std::shared_ptr<const solver::ClothRest> in_metres(const solver::ClothRest& rest, double units) {
    auto cloth = std::make_shared<solver::ClothRest>(rest);
    cloth->surface = to_metres(rest.surface, units);
    return cloth;
}

} // namespace

solver::Points to_metres(const solver::Points& points, double units) {
    solver::Points out(points);
    if (units != 1)
        for (solver::Vec3& p : out) p /= units;
    return out;
}

solver::Points to_scene_units(solver::Points points, double units) {
    if (units != 1)
        for (solver::Vec3& p : points) p *= units;
    return points;
}

const Reads* contact_of(const Reads& frame) { return frame[collision_detection] ? &frame : nullptr; }

std::string body_name(const Reads& in, const Setup& setup, std::size_t simulated_index) {
    return in.source_name(bodies.name, static_cast<std::size_t>(setup.simulated[simulated_index]));
}

std::string attachment_name(const Reads& in, const Setup& setup, int attachment) {
    const int entry = setup.attachment_entries[static_cast<std::size_t>(attachment)];
    return in.source_name(attachments.name, static_cast<std::size_t>(entry));
}

Setup read_setup(const Reads& in, const SceneKey* known, const Reads* contact) {
    Setup setup;
    const engine::Matrix4 frame = solver_frame(in);
    setup.key.scale = known ? known->scale : in[scale];
    setup.key.frame = known ? known->frame : frame;
    setup.space = solver_space(setup.key.scale, setup.key.frame, frame);
    take_bodies(in, setup);
    if (known && std::ranges::equal(known->modelled, setup.key.modelled, alike)) setup.key.modelled = known->modelled;
    if (!known) refuse_twins(in, setup);
    take_attachments(in, setup, known);
    take_forces(in, setup, known, contact);
    if (!known) return setup;
    refuse_unbound_lines(in, setup, *known);
    if (setup.key.contacts == known->contacts)
        refuse_changes(in, setup, setup.key, *known);
    else
        refuse_changes(in, setup, without_contacts(setup.key), without_contacts(*known));
    return setup;
}

solver::SceneDescription describe_scene(const Setup& setup) {
    const double units = setup.key.scale;
    solver::SceneDescription scene;
    for (std::size_t i = 0; i < setup.simulated.size(); ++i) {
        const auto& data = setup.rests[i]->data;
        if (const auto* t = std::get_if<std::shared_ptr<const solver::TissueRest>>(&data)) {
            auto tissue = in_metres(**t, units);
            if (setup.body(i).subtissue) tissue->carried_by = setup.carriers[i];
            scene.bodies.emplace_back(std::shared_ptr<const solver::TissueRest>(std::move(tissue)));
        } else if (const auto* cloth = std::get_if<std::shared_ptr<const solver::ClothRest>>(&data)) {
            scene.bodies.emplace_back(in_metres(**cloth, units));
        } else {
            auto bone = std::make_shared<solver::BoneRest>();
            bone->triangles = std::get<std::shared_ptr<const solver::BoneRest>>(data)->triangles;
            bone->surface = to_metres(*setup.key.modelled[i].points, units);
            scene.bodies.emplace_back(std::shared_ptr<const solver::BoneRest>(std::move(bone)));
        }
    }
    for (std::size_t i = 0; i < setup.attachments.size(); ++i) {
        solver::AttachmentRest rest = setup.attachments[i].get().rest;
        rest.source = setup.key.links[i][0];
        rest.target = setup.key.links[i][1];
        rest.max_distance /= units;
        scene.attachments.push_back(std::move(rest));
    }
    for (std::size_t i = 0; i < setup.forces.size(); ++i) {
        const Force& f = setup.forces[i];
        scene.parts.push_back({f.type, setup.key.reach[i], f.rest});
    }
    return scene;
}

namespace {

/// runupWeight, where the channel's flag is on.
double run_up(const Reads& in, const engine::Input<bool>& flag) { return in[flag] ? in[runup_weight] : 1; }

solver::TissueInputs tissue_inputs(const Reads& in, const Body& body, solver::TissueInputs out) {
    out.enable = body.enable ? 1 : 0;
    out.inertial_damping = std::min(1.0, out.inertial_damping * run_up(in, affect_inertial_damping));
    out.rest_scale_envelope *= run_up(in, affect_rest_scale);
    for (solver::SubtissueInputs& part : out.subtissues) part.rest_scale_envelope *= run_up(in, affect_rest_scale);
    for (solver::FiberValues& fiber : out.fibers) fiber.excitation *= run_up(in, affect_excitation);
    return out;
}

solver::ClothInputs cloth_inputs(const Reads& in, const Body& body) {
    solver::ClothInputs out = std::get<solver::ClothInputs>(body.values);
    out.enable = body.enable ? 1 : 0;
    out.inertial_damping = std::min(1.0, out.inertial_damping * run_up(in, affect_inertial_damping));
    out.rest_scale_envelope *= run_up(in, affect_rest_scale);
    return out;
}

/// In metres, and in the solver's space.
solver::PartValues part_values(const Reads& in, const Setup& setup, std::size_t force) {
    Force f = setup.forces[force];
    for (std::size_t i = 0; i < f.values.size(); ++i)
        if (f.type->values[i].unit == std::string_view("m")) f.values[i] /= setup.key.scale;
    if (f.type == &solver::hold_type) take_into_space(in, setup.space, f);
    if (f.type == &solver::pressure_type) f.values.front() *= run_up(in, affect_pressure);
    if (f.type == &solver::surface_tension_type) f.values.front() *= run_up(in, affect_surface_tension);
    if (f.type == &solver::contact_type && !setup.acts(static_cast<std::size_t>(setup.key.reach[force].front()))) {
        auto values = solver::get_fields<solver::ContactValues>(f.values);
        values.collides = 0;
        put_fields(values, f.values);
    }
    return std::move(f.values);
}

} // namespace

solver::StepInputs step_inputs(const Reads& in, const Setup& setup, std::size_t steps_per_frame) {
    solver::StepInputs s;
    s.step_size = 1 / (in[frames_per_second] * static_cast<double>(steps_per_frame));
    s.integrator = meaning(options_of<solver::Integrator>, in[integrator]);
    s.linear_method = meaning(options_of<solver::LinearMethod>, in[linear_solver]);
    s.gravity = run_up(in, affect_gravity) * solver::Vec3(in[gravity][0], in[gravity][1], in[gravity][2]);
    s.mass_damping = in[mass_damping];
    s.stiffness_damping = in[stiffness_damping];
    s.max_newton_iterations = static_cast<int>(in[max_newton_iterations]);
    s.max_halvings = static_cast<int>(in[step_halvings]);
    s.tolerance_factor = in[tolerance_factor];
    for (std::size_t i = 0; i < setup.simulated.size(); ++i) {
        const Body& b = setup.body(i);
        if (b.is_bone())
            s.bodies.emplace_back(solver::BoneInputs{setup.space.to_metres(*std::get<Mesh>(b.values).points)});
        else if (b.is_cloth())
            s.bodies.emplace_back(cloth_inputs(in, b));
        else
            s.bodies.emplace_back(tissue_inputs(in, b, setup.tissue_values(i)));
    }
    for (std::size_t i = 0; i < setup.attachments.size(); ++i) {
        s.attachments.push_back(setup.attachments[i].get().values);
        const auto acts = [&](int body) { return setup.acts(static_cast<std::size_t>(body)); };
        if (!acts(setup.key.links[i][0]) || !acts(setup.key.links[i][1]))
            s.attachments.back().set_mode(solver::AttachmentMode::none);
    }
    for (std::size_t i = 0; i < setup.forces.size(); ++i) s.parts.push_back(part_values(in, setup, i));
    return s;
}

double run_up_of_excitation(const Reads& in) { return run_up(in, affect_excitation); }

void check_all_tied(const Reads& in, const Setup& setup) {
    std::vector<std::size_t> group(setup.simulated.size());
    std::iota(group.begin(), group.end(), std::size_t{0});
    const auto root = [&](std::size_t i) {
        while (group[i] != i) i = group[i];
        return i;
    };
    for (std::size_t i = 0; i < setup.attachments.size(); ++i) {
        const solver::AttachmentInputs& values = setup.attachments[i].get().values;
        // One that slides leaves ways free.
        if (values.stiffness <= 0 || values.envelope <= 0 || values.holds <= 0) continue;
        const auto [from, to] = setup.key.links[i];
        const auto acts = [&](int body) { return setup.acts(static_cast<std::size_t>(body)); };
        if (!acts(from) || !acts(to)) continue;
        group[root(static_cast<std::size_t>(from))] = root(static_cast<std::size_t>(to));
    }
    for (std::size_t i = 0; i < group.size(); ++i) group[root(i)] = root(static_cast<std::size_t>(setup.carriers[i]));
    std::vector<char> holds(group.size(), 0);
    for (std::size_t i = 0; i < setup.forces.size(); ++i)
        if (setup.forces[i].get().type->ties)
            for (const int body : setup.key.reach[i]) holds[root(static_cast<std::size_t>(body))] = 1;
    for (std::size_t i = 0; i < group.size(); ++i)
        if (setup.body(i).is_bone() || !setup.acts(i)) holds[root(i)] = 1; // what is disabled stays
    for (std::size_t i = 0; i < group.size(); ++i)
        if (!holds[root(i)])
            in.fail(bodies.name, "FE303",
                    body_name(in, setup, i) +
                        " floats: no hold and no chain of attachments to a bone or a held "
                        "tissue ties it (sliding ties nothing), so QuasiStatic finds no rest for it",
                    "Attach it to a bone, hold a part of it by zHold, or use BackwardEuler.");
}

SolveReport describe_size(const Reads& in, const Setup& setup, const solver::Scene& scene) {
    SolveReport r;
    r.bodies = scene.body_count();
    r.dofs = 3 * scene.vertex_count();
    bool holds = false, slides = false;
    for (const Attachment& a : setup.attachments) {
        holds = holds || a.values.holds > 0, slides = slides || a.values.slides > 0;
        r.attachments += a.values.mode() != solver::AttachmentMode::none;
    }
    std::vector<std::string> laws;
    bool calms = false, fibers = false, resists = false, conserves = false, rest_changes = false, cloth = false;
    for (int i = 0; i < scene.body_count(); ++i) {
        const solver::TissueRest* t = scene.tissue(i);
        r.triangles += static_cast<std::int64_t>(scene.triangles(i).size());
        if (scene.cloth(i)) {
            cloth = true;
            const auto& values = std::get<solver::ClothInputs>(setup.body(static_cast<std::size_t>(i)).values);
            calms = calms || values.inertial_damping > 0;
            for (const solver::ClothMaterial& m : values.layers)
                rest_changes = rest_changes || (m.rest_scale != 1 && values.rest_scale_envelope != 0);
        }
        if (!t || t->carried_by >= 0) continue; // what a subtissue has is counted with its tissue
        r.tets += static_cast<std::int64_t>(t->tets.tets.size());
        const solver::LawFacts& law = law_facts(t->law);
        if (std::find(laws.begin(), laws.end(), law.name) == laws.end()) laws.emplace_back(law.name);
        fibers = fibers || !t->fibers.empty();
        const solver::TissueInputs& values = setup.tissue_values(static_cast<std::size_t>(i));
        calms = calms || values.inertial_damping > 0;
        resists = resists || (law.resists_compression && values.compression_resistance > 0);
        conserves = conserves || conserves_volume(values);
        rest_changes = rest_changes || changes_rest(values);
    }
    const bool moves = meaning(options_of<solver::Integrator>, in[integrator]) != solver::Integrator::quasi_static;
    r.terms = std::move(laws);
    if (cloth) r.terms.push_back("cloth");
    if (resists) r.terms.push_back("compressionResistance");
    if (conserves) r.terms.push_back("volumeConservation");
    if (rest_changes) r.terms.push_back("restShapeChange");
    if (in[gravity] != engine::Vec3{}) r.terms.push_back("gravity");
    if (moves) r.terms.push_back("inertia");
    if (moves && (in[stiffness_damping] > 0 || in[mass_damping] > 0)) r.terms.push_back("damping");
    if (moves && calms) r.terms.push_back("inertialDamping");
    if (fibers) r.terms.push_back("fiber");
    if (!setup.lines.empty()) r.terms.push_back("lineOfAction");
    if (holds) r.terms.push_back("attachment");
    if (slides) r.terms.push_back("sliding");
    for (const Force& f : setup.forces)
        if (std::find(r.terms.begin(), r.terms.end(), f.type->name) == r.terms.end())
            r.terms.emplace_back(f.type->name);
    return r;
}

} // namespace sinew::nodes
