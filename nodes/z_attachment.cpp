// zAttachment: ties the painted part of one body's surface to the surface of another.
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
    .doc = "Scales the stiffness and the damping.",
};
const Wire<Body> source{.name = "source", .doc = "The body whose painted surface is attached."};
const Wire<Body> target{
    .name = "target",
    .doc = "The body that it holds on to. Not a bone if the source is one.",
};
const Input<std::string> mode{
    .name = "attachmentMode",
    .def = std::string(word_of(solver::AttachmentMode::fixed)),
    .doc = "fixed holds the surface at the places on the target that it finds at the start frame; sliding lets it move "
           "along the target's surface, as far as that has target weight, and holds it along the normal alone; none "
           "switches the attachment off. May be keyed, with effect on whole steps; sliding begins at the closest "
           "places then, at the distance then.",
    .options = words(options_of<solver::AttachmentMode>),
};
const Input<double> stiffness{
    .name = "stiffness",
    .def = 1e8,
    .unit = "N/m^3",
    .limits = {.min = 0, .max = 1e14},
    .doc =
        "Force per attached area and distance. Where that is more than flesh in a lattice can bear at each point, the "
        "mean around each vertex of a tet is held with it, up to 1,250 times what the flesh there resists across a "
        "tet.",
};
const Input<double> damping{
    .name = "damping",
    .def = 0,
    .unit = "N*s/m^3",
    .limits = {.min = 0, .max = 1e13},
    .doc = "Force per attached area and relative speed, sliding along the normal alone; calms an attachment that "
           "swings.",
};
const Input<bool> maintain_offset{
    .name = "maintainOffset",
    .def = true,
    .doc = "Keeps the distance that there is at the start frame; off pulls the surface onto the target. Sliding keeps "
           "the height over the target that there is when it begins.",
    .keyable = false,
};
const Input<std::string> correspondence{
    .name = "correspondence",
    .def = std::string(word_of(solver::Correspondence::closest_point)),
    .doc = "worldSpace ties each point of the source's surface to the closest point of the target at the start frame; "
           "vertexID to the same place in the triangle of the same vertex numbers.",
    .keyable = false,
    .options = words(options_of<solver::Correspondence>),
};
const Input<NumberList> weights{
    .name = "weights",
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc =
        "One number per vertex or face of the source (see weightsOn), one for all, or none for 1 everywhere: above 0 "
        "is attached, and the number scales stiffness and damping.",
};
const Input<std::string> weights_on{
    .name = "weightsOn",
    .def = std::string(word_of(solver::PaintedOn::vertices)),
    .doc = "What weights counts. Between vertices the weight runs linearly, so paint fades out over the faces at its "
           "rim (but not around an edge that bends by more than 60 degrees from faces that are painted whole); painted "
           "faces are sharp.",
    .keyable = false,
    .options = words(options_of<solver::PaintedOn>),
};
const Input<NumberList> target_weights{
    .name = "targetWeights",
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "One number per vertex or face of the target (see targetWeightsOn), one for all, or none for 1 everywhere: "
           "where it is 0 nothing holds on.",
};
const Input<std::string> target_weights_on{
    .name = "targetWeightsOn",
    .def = std::string(word_of(solver::PaintedOn::vertices)),
    .doc = "What targetWeights counts. A face whose vertices are painted in part is not held on to.",
    .keyable = false,
    .options = words(options_of<solver::PaintedOn>),
};
const Input<double> max_distance{
    .name = "maxDistance",
    .def = 0,
    .limits = {.min = 0, .max = 1e60},
    .doc =
        "worldSpace: a point of the source whose closest point of the target has no target weight holds on to the "
        "closest one that has, up to this far away in scene units, and to nothing beyond. 0 takes twice the mean edge "
        "length of the target's painted part or of the source's samples, whichever is smaller.",
    .keyable = false,
};
const Output<Attachment> out_attachment{
    .name = "outAttachment",
    .doc = "The attachment; connect to zSolver.attachments.",
};

std::size_t vertex_count(const Body& body) { return body.rest->mesh.points->size(); }

bool is_blank(const NumberList& map) {
    return std::all_of(map.begin(), map.end(), [](double w) { return w <= 0; });
}

solver::AttachmentMode mode_of(const Reads& in, const Body& from, const Body& to) {
    if (!from.is_bone() || !to.is_bone()) return meaning(options_of<solver::AttachmentMode>, in[mode]);
    in.warn(target.name, "FE207",
            in.source_name(source.name) + " and " + in.source_name(target.name) +
                " are both bones, so the attachment has no effect",
            "Attach a tissue to a bone.");
    return solver::AttachmentMode::none;
}

solver::AttachmentRest rest_of(const Reads& in, const Body& from, const Body& to) {
    solver::AttachmentRest rest;
    rest.correspondence = meaning(options_of<solver::Correspondence>, in[correspondence]);
    rest.maintain_offset = in[maintain_offset];
    rest.source_weights = painted_map(in, weights, weights_on, from, in.source_name(source.name));
    rest.target_weights = painted_map(in, target_weights, target_weights_on, to, in.source_name(target.name));
    rest.source_painted = meaning(options_of<solver::PaintedOn>, in[weights_on]);
    rest.target_painted = meaning(options_of<solver::PaintedOn>, in[target_weights_on]);
    rest.max_distance = in[max_distance];
    return rest;
}

void check_reach(const Reads& in, const solver::AttachmentRest& rest, const Body& from, const Body& to) {
    if (is_blank(rest.source_weights))
        in.fail(weights.name, "FE212", "nothing of " + in.source_name(source.name) + " has a weight above 0",
                "Paint what is to be attached.");
    if (is_blank(rest.target_weights))
        in.fail(target_weights.name, "FE212", "nothing of " + in.source_name(target.name) + " has a weight above 0",
                "Paint where the source may hold on.");
    if (rest.correspondence == solver::Correspondence::vertex_id && vertex_count(from) != vertex_count(to))
        in.fail(correspondence.name, "FE217",
                "vertexID needs equal meshes, but " + in.source_name(source.name) + " has " +
                    std::to_string(vertex_count(from)) + " vertices and " + in.source_name(target.name) + " has " +
                    std::to_string(vertex_count(to)),
                "Use a target with the same vertices, or worldSpace.");
}

void compute(const Reads& in, Writes& out) {
    const Body &from = in[source], &to = in[target];
    Attachment a;
    a.source_body = id_of(from);
    a.target_body = id_of(to);
    if (a.source_body == a.target_body)
        in.fail(target.name, "FE219", in.source_name(source.name) + " cannot be attached to itself",
                "Connect another body.");
    a.rest = rest_of(in, from, to);
    a.values = {in[stiffness], in[envelope], in[damping]};
    a.values.set_mode(mode_of(in, from, to));
    if (a.values.mode() != solver::AttachmentMode::none) check_reach(in, a.rest, from, to);
    out.set(out_attachment, std::move(a));
}

} // namespace

void add_z_attachment(Registry& registry) {
    NodeType type;
    type.name = "zAttachment";
    type.doc = "Ties a tissue or cloth to a bone or to another tissue or cloth; forces act on both.";
    type.inputs = {describe(envelope),         describe(source),  describe(target),          describe(mode),
                   describe(stiffness),        describe(damping), describe(maintain_offset), describe(correspondence),
                   describe(max_distance),     describe(weights), describe(weights_on),      describe(target_weights),
                   describe(target_weights_on)};
    type.outputs = {describe(out_attachment)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
