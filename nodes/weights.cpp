// weights: a painted map, one number per vertex or face of a mesh, by one of several rules.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "engine/text.h"
#include "nodes/adapters.h"
#include "nodes/limits.h"
#include "nodes/options.h"
#include "nodes/painted_maps.h"

#include <algorithm>
#include <stdexcept>

namespace sinew::nodes {

using namespace engine;

namespace {

enum class Rule { constant, list, ramp, near, sphere, file, vertices, faces };
constexpr Option<Rule> rules[] = {
    {"constant", Rule::constant}, {"list", Rule::list}, {"ramp", Rule::ramp},         {"near", Rule::near},
    {"sphere", Rule::sphere},     {"file", Rule::file}, {"vertices", Rule::vertices}, {"faces", Rule::faces},
};
constexpr Option<int> axes[] = {{"x", 0}, {"y", 1}, {"z", 2}};

const Wire<Mesh> mesh{
    .name = "mesh",
    .doc = "The mesh that is painted; its vertices or faces give the numbers' order.",
};
const Input<std::string> on{
    .name = "on",
    .def = "vertices",
    .doc =
        "What is painted: vertices, between which weights run linearly, or faces, which are sharp. A face is where the "
        "mean of its vertices is. Attachments take maps of faces (zAttachment.weightsOn).",
    .options = words(options_of<solver::PaintedOn>),
};
const Input<std::string> mode{
    .name = "mode",
    .def = "constant",
    .doc =
        "The rule: constant (one value), list (given numbers), ramp (along an axis), near "
        "(distance to another mesh), sphere (distance to a point), file (numbers, vertices or faces from a JSON "
        "file), vertices (1 at the listed vertices; of faces those with all vertices listed), faces (1 at the listed "
        "faces; always paints faces).",
    .options = words(rules),
};
const Input<double> value{
    .name = "value",
    .def = 1,
    .unit = "1",
    .limits = within_reach,
    .doc = "constant: the value everywhere.",
    .keyable = false,
};
const Input<NumberList> values{
    .name = "values",
    .limits = within_reach,
    .doc = "list: one number per vertex (or face); may come from another node.",
};
const Input<std::string> axis{
    .name = "axis",
    .def = "x",
    .doc = "ramp: the axis it runs along.",
    .options = words(axes),
};
const Input<double> start{
    .name = "start",
    .def = 0,
    .limits = within_reach,
    .doc = "ramp: the coordinate with weight 0, in scene units.",
    .keyable = false,
};
const Input<double> end{
    .name = "end",
    .def = 1,
    .limits = within_reach,
    .doc = "ramp: the coordinate with weight 1, in scene units; not equal to start.",
    .keyable = false,
};
const Input<bool> smooth{
    .name = "smooth",
    .def = false,
    .doc = "ramp: with flat ends instead of a straight line.",
    .keyable = false,
};
const Wire<Mesh> other{
    .name = "otherMesh",
    .doc = "near: the mesh that the distance is measured to; inside it, if it is closed, the "
           "distance is 0.",
    .required = false,
};
const Input<double> inner{
    .name = "innerDistance",
    .def = 0.5,
    .limits = {.min = 0, .max = 1e60},
    .doc = "near: weight 1 up to this distance, in scene units.",
    .keyable = false,
};
const Input<double> outer{
    .name = "outerDistance",
    .def = 2,
    .limits = {.min = 0, .max = 1e60},
    .doc = "near: weight 0 from this distance on, in scene units; not below innerDistance.",
    .keyable = false,
};
const Input<Vec3> centre{
    .name = "center", .limits = within_reach, .doc = "sphere: its centre, in scene units.", .keyable = false};
const Input<double> radius{
    .name = "radius",
    .def = 1,
    .limits = {.min = 0, .max = 1e60},
    .doc = "sphere: weight 1 up to this distance from the centre, in scene units.",
    .keyable = false,
};
const Input<double> falloff{
    .name = "falloff",
    .def = 0,
    .limits = {.min = 0, .max = 1e60},
    .doc = "sphere: the weight falls to 0 over this distance beyond the radius, in scene units.",
    .keyable = false,
};
const Input<File> file{
    .name = "file",
    .doc = "file: a JSON file with a list of numbers, or with {\"vertices\": [ … ]} or {\"faces\": [ … ]}.",
};
const Input<std::string> key{
    .name = "key",
    .doc = "file: JSON pointer to the list, for example /attachments/0/vertices; empty if the "
           "file is the list. A list under a key \"vertices\" or \"faces\" holds indices; "
           "faces need on faces.",
};
const Input<NumberList> vertices{
    .name = "vertices",
    .limits = within_reach,
    .doc = "vertices: the numbers of the vertices with weight 1, from 0.",
};
const Input<NumberList> faces{
    .name = "faces",
    .limits = within_reach,
    .doc = "faces: the numbers of the faces with weight 1, from 0.",
};
const Input<bool> invert{
    .name = "invert",
    .def = false,
    .doc = "Takes 1 minus the weight.",
    .keyable = false,
};
const Input<double> scale{
    .name = "scale",
    .def = 1,
    .unit = "1",
    .limits = within_reach,
    .doc = "Multiplies the weight, after invert.",
    .keyable = false,
};
const Input<double> offset{
    .name = "offset",
    .def = 0,
    .unit = "1",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Added to the weight, after scale; the result is kept "
           "between 0 and 1.",
    .keyable = false,
};
const Output<NumberList> out_weights{
    .name = "outWeights",
    .doc = "One number per vertex or face, 0 to 1.",
    .unit = "1",
};

NumberList near_weights(const Reads& in, const solver::Points& points) {
    const Mesh* m = in.find(other);
    if (!m) in.fail(other.name, "DG110", "mode near needs a mesh to measure to", "Connect otherMesh.");
    if (in[outer] < in[inner])
        in.fail(outer.name, "DG110",
                "outerDistance " + std::to_string(in[outer]) + " is below innerDistance " + std::to_string(in[inner]),
                "Make it equal or larger.");
    return near_map(points, *m, in[inner], in[outer]);
}

/// 1 at listed vertices, as they are or as a map of faces.
NumberList vertex_weights(const Reads& in, const NumberList& list, bool by_faces) {
    const Mesh& m = in[mesh];
    NumberList map = listed_map(m.points->size(), list, "vertex");
    return by_faces ? faces_within(*m.topology, map) : map;
}

/// Numbers that are given, as many as there are vertices or faces.
NumberList given_weights(const Reads& in, std::string_view attribute, const NumberList& map, std::size_t count,
                         bool by_faces) {
    if (map.empty() && count > 0)
        in.fail(attribute, "FE204",
                "no numbers for a mesh of " + std::to_string(count) + (by_faces ? " faces" : " vertices"),
                by_faces ? "Give one number per face." : "Give one number per vertex.");
    check_map(in, attribute, map, count, "the weights", by_faces ? "face" : "vertex");
    return per_vertex(map, count);
}

NumberList file_weights(const Reads& in, std::size_t count, bool by_faces) {
    if (in[file].path.empty())
        in.fail(file.name, "DG110", "mode file needs a file", "Name a JSON file with numbers, vertices or faces.");
    const FileMap map = guarded(in, file.name, [&] { return file_map(in.files(), in[file].path, in[key]); });
    if (map.kind == FileMap::Kind::numbers) return given_weights(in, file.name, map.numbers, count, by_faces);
    if (map.kind == FileMap::Kind::vertices)
        return guarded(in, file.name, [&] { return vertex_weights(in, map.numbers, by_faces); });
    if (!by_faces) in.fail(on.name, "DG110", "the file lists faces, but vertices are painted", "Set on to faces.");
    return guarded(in, file.name, [&] { return listed_map(count, map.numbers, "face"); });
}

NumberList ramp_weights(const Reads& in, const solver::Points& points) {
    if (in[start] == in[end])
        in.fail(end.name, "DG110", "start and end are both " + std::to_string(in[start]), "Give two coordinates.");
    return ramp_map(points, meaning(axes, in[axis]), in[start], in[end], in[smooth]);
}

NumberList by_rule(const Reads& in) {
    const Mesh& m = in[mesh];
    const Rule rule = meaning(rules, in[mode]);
    const bool by_faces =
        rule == Rule::faces || meaning(options_of<solver::PaintedOn>, in[on]) == solver::PaintedOn::faces;
    const std::size_t count = by_faces ? m.topology->face_sizes.size() : m.points->size();
    const auto points = [&] { return by_faces ? face_centres(m) : *m.points; };
    switch (rule) {
    case Rule::constant:
        return NumberList(count, in[value]);
    case Rule::list:
        return given_weights(in, values.name, in[values], count, by_faces);
    case Rule::ramp:
        return ramp_weights(in, points());
    case Rule::near:
        return near_weights(in, points());
    case Rule::sphere:
        return sphere_map(points(), in[centre], in[radius], in[falloff]);
    case Rule::file:
        return file_weights(in, count, by_faces);
    case Rule::vertices:
        return guarded(in, vertices.name, [&] { return vertex_weights(in, in[vertices], by_faces); });
    case Rule::faces:
        return guarded(in, faces.name, [&] { return listed_map(count, in[faces], "face"); });
    }
    throw std::logic_error("a rule of weights without a map");
}

/// Numbers that were painted in another unit, or go beyond what rounding leaves. Who scales or inverts counts on the
/// limits.
void warn_of_cut_off(const Reads& in, const NumberList& map) {
    constexpr double rounding = 1e-3;
    const Rule rule = meaning(rules, in[mode]);
    const std::string_view attribute = rule == Rule::list       ? values.name
                                       : rule == Rule::constant ? value.name
                                                                : file.name;
    if (map.empty() || in[invert] || in[scale] != 1 || in[offset] != 0) return;
    const auto [least, most] = std::minmax_element(map.begin(), map.end());
    if (*least >= -rounding && *most <= 1 + rounding) return;
    const auto outside = std::count_if(map.begin(), map.end(), [](double w) { return w < 0 || w > 1; });
    in.warn(attribute, "FE257",
            std::to_string(outside) + " of " + std::to_string(map.size()) +
                " weights are not between 0 and 1 and are cut off there: they go from " + rough_text(*least, 4) +
                " to " + rough_text(*most, 4),
            *least >= 0 && *most > 10 && *most <= 100 ? "if they are percent, write \"scale\": 0.01"
                                                      : "scale them where they are made");
}

void compute(const Reads& in, Writes& out) {
    NumberList map = by_rule(in);
    warn_of_cut_off(in, map);
    for (double& w : map) w = std::clamp((in[invert] ? 1 - w : w) * in[scale] + in[offset], 0.0, 1.0);
    out.set(out_weights, std::move(map));
}

} // namespace

void add_weights(Registry& registry) {
    NodeType type;
    type.name = "weights";
    type.doc =
        "Paints a mesh: one number per vertex, for materials, fibres and attachments, or per face, for attachments.";
    type.inputs = {describe(mesh),  describe(on),    describe(mode),     describe(value),  describe(values),
                   describe(axis),  describe(start), describe(end),      describe(smooth), describe(other),
                   describe(inner), describe(outer), describe(centre),   describe(radius), describe(falloff),
                   describe(file),  describe(key),   describe(vertices), describe(faces),  describe(invert),
                   describe(scale), describe(offset)};
    type.outputs = {describe(out_weights)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
