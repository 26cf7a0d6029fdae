// zGoalAttachment: draws a tissue to a mesh of the same vertices and faces, point by point.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/body_maps.h"
#include "nodes/options.h"

#include <algorithm>

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<double> envelope{
    .name = "envelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Scales the strength and the damping. May be keyed: 0 lets go.",
};
const Wire<Body> source{.name = "source", .doc = "The body that is drawn."};
const Wire<Body> target{
    .name = "target",
    .doc = "The goal: most often a zBone whose mesh has the same vertices and faces, and is animated. Usually its "
           "collisions are off.",
};
const Input<double> strength{
    .name = "strength",
    .def = 1e6,
    .unit = "N/m^3",
    .limits = {.min = 0, .max = 1e14},
    .doc = "Force per area and distance from the goal.",
};
const Input<double> damping{
    .name = "damping",
    .def = 0,
    .unit = "N*s/m^3",
    .limits = {.min = 0, .max = 1e13},
    .doc = "Force per area and speed relative to the goal.",
};
const Input<NumberList> weights{
    .name = "weights",
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Painted strength: one number per vertex or face of the source (see weightsOn), one for all, or none for 1 "
           "everywhere. It scales strength and damping; 0 leaves free.",
};
const Input<std::string> weights_on{
    .name = "weightsOn",
    .def = std::string(word_of(solver::PaintedOn::vertices)),
    .doc = "What weights counts, as with zAttachment.",
    .keyable = false,
    .options = words(options_of<solver::PaintedOn>),
};
const Output<Attachment> out_attachment{
    .name = "outAttachment",
    .doc = "The attachment; connect to zSolver.attachments.",
};

/// Fails where the meshes do not have the same vertices and faces, naming the first that differ.
void check_same_faces(const Reads& in, const Body& from, const Body& to) {
    const Mesh &a = from.rest->mesh, &b = to.rest->mesh;
    const std::string one = in.source_name(source.name), other = in.source_name(target.name);
    const auto fail = [&](const std::string& what) {
        in.fail(target.name, "FE217", "a goal needs the same vertices and faces, but " + what,
                "Use a copy of the source's mesh as goal, moved or bent; zAttachment ties other meshes.");
    };
    if (a.points->size() != b.points->size())
        fail(one + " has " + std::to_string(a.points->size()) + " vertices and " + other + " has " +
             std::to_string(b.points->size()));
    if (a.topology->face_sizes.size() != b.topology->face_sizes.size())
        fail(one + " has " + std::to_string(a.topology->face_sizes.size()) + " faces and " + other + " has " +
             std::to_string(b.topology->face_sizes.size()));
    std::size_t corner = 0;
    for (std::size_t f = 0; f < a.topology->face_sizes.size(); ++f) {
        const auto size = static_cast<std::size_t>(a.topology->face_sizes[f]);
        const auto* one_face = a.topology->face_vertices.data() + corner;
        const bool same = a.topology->face_sizes[f] == b.topology->face_sizes[f] &&
                          std::equal(one_face, one_face + size, b.topology->face_vertices.data() + corner);
        if (!same) fail("face " + std::to_string(f) + " of " + one + " has other corners than that of " + other);
        corner += size;
    }
}

void compute(const Reads& in, Writes& out) {
    const Body &from = in[source], &to = in[target];
    if (from.is_bone())
        in.fail(source.name, "FE218", in.source_name(source.name) + " is a bone, and moves as it is given",
                "Connect a tissue.");
    Attachment a;
    a.source_body = id_of(from), a.target_body = id_of(to);
    if (a.source_body == a.target_body)
        in.fail(target.name, "FE219", in.source_name(source.name) + " cannot be its own goal", "Connect another body.");
    check_same_faces(in, from, to);
    a.rest.correspondence = solver::Correspondence::vertex_id;
    a.rest.maintain_offset = false;
    a.rest.source_weights = painted_map(in, weights, weights_on, from, in.source_name(source.name));
    a.rest.source_painted = meaning(options_of<solver::PaintedOn>, in[weights_on]);
    const auto& painted = a.rest.source_weights;
    if (std::all_of(painted.begin(), painted.end(), [](double w) { return w <= 0; }) && !painted.empty())
        in.fail(weights.name, "FE212", "nothing of " + in.source_name(source.name) + " has a weight above 0",
                "Paint what the goal is to draw.");
    a.values.stiffness = in[strength], a.values.envelope = in[envelope], a.values.damping = in[damping];
    out.set(out_attachment, std::move(a));
}

} // namespace

void add_z_goal_attachment(Registry& registry) {
    NodeType type;
    type.name = "zGoalAttachment";
    type.doc = "Draws a tissue to a goal, a mesh of the same vertices and faces: each point to the same point there.";
    type.inputs = {describe(envelope), describe(source),  describe(target),    describe(strength),
                   describe(damping),  describe(weights), describe(weights_on)};
    type.outputs = {describe(out_attachment)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
