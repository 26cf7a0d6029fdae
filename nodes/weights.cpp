// weights: a painted map, one number per vertex of a mesh, by one of several rules.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/painted_maps.h"

#include <algorithm>

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<Mesh> mesh{
    .name = "mesh",
    .doc = "The mesh that is painted; its vertices give the numbers' order.",
};
const Input<std::string> mode{
    .name = "mode",
    .def = "constant",
    .doc = "The rule: constant (one value), list (given numbers), ramp (along an axis), near "
           "(distance to another mesh), sphere (distance to a point), file (numbers or "
           "vertices from a JSON file), vertices (1 at the listed vertices).",
    .options = {"constant", "list", "ramp", "near", "sphere", "file", "vertices"},
};
const Input<double> value{
    .name = "value",
    .def = 1,
    .unit = "1",
    .doc = "constant: the value everywhere.",
    .keyable = false,
};
const Input<NumberList> values{
    .name = "values",
    .doc = "list: one number per vertex; may come from another node.",
};
const Input<std::string> axis{
    .name = "axis",
    .def = "x",
    .doc = "ramp: the axis it runs along.",
    .options = {"x", "y", "z"},
};
const Input<double> start{
    .name = "start",
    .def = 0,
    .doc = "ramp: the coordinate with weight 0, in scene units.",
    .keyable = false,
};
const Input<double> end{
    .name = "end",
    .def = 1,
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
    .limits = {.min = 0},
    .doc = "near: weight 1 up to this distance, in scene units.",
    .keyable = false,
};
const Input<double> outer{
    .name = "outerDistance",
    .def = 2,
    .limits = {.min = 0},
    .doc = "near: weight 0 from this distance on, in scene units; not below innerDistance.",
    .keyable = false,
};
const Input<Vec3> centre{.name = "center", .doc = "sphere: its centre, in scene units.", .keyable = false};
const Input<double> radius{
    .name = "radius",
    .def = 1,
    .limits = {.min = 0},
    .doc = "sphere: weight 1 up to this distance from the centre, in scene units.",
    .keyable = false,
};
const Input<double> falloff{
    .name = "falloff",
    .def = 0,
    .limits = {.min = 0},
    .doc = "sphere: the weight falls to 0 over this distance beyond the radius, in scene units.",
    .keyable = false,
};
const Input<File> file{
    .name = "file",
    .doc = "file: a JSON file with a list of numbers or with {\"vertices\": [ … ]}.",
};
const Input<std::string> key{
    .name = "key",
    .doc = "file: JSON pointer to the list, for example /attachments/0/vertices; empty if the "
           "file is the list. A list under a key \"vertices\" holds vertex numbers.",
};
const Input<NumberList> vertices{
    .name = "vertices",
    .doc = "vertices: the numbers of the vertices with weight 1, from 0.",
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
    .doc = "Multiplies the weight, after invert.",
    .keyable = false,
};
const Input<double> offset{
    .name = "offset",
    .def = 0,
    .unit = "1",
    .doc = "Added to the weight, after scale; the result is kept "
           "between 0 and 1.",
    .keyable = false,
};
const Output<NumberList> out_weights{
    .name = "outWeights",
    .doc = "One number per vertex, 0 to 1.",
    .unit = "1",
};

NumberList near_weights(const Reads& in) {
    const Mesh* m = in.find(other);
    if (!m) in.fail(other.name, "DG110", "mode near needs a mesh to measure to", "Connect otherMesh.");
    if (in[outer] < in[inner])
        in.fail(outer.name, "DG110",
                "outerDistance " + std::to_string(in[outer]) + " is below innerDistance " + std::to_string(in[inner]),
                "Make it equal or larger.");
    return near_map(*in[mesh].points, *m, in[inner], in[outer]);
}

NumberList by_rule(const Reads& in) {
    const solver::Points& points = *in[mesh].points;
    const std::string& rule = in[mode];
    if (rule == "constant") return NumberList(points.size(), in[value]);
    if (rule == "near") return near_weights(in);
    if (rule == "sphere") return sphere_map(points, in[centre], in[radius], in[falloff]);
    if (rule == "vertices") return guarded(in, vertices.name, [&] { return vertex_map(points.size(), in[vertices]); });
    if (rule == "ramp") {
        if (in[start] == in[end])
            in.fail(end.name, "DG110", "start and end are both " + std::to_string(in[start]), "Give two coordinates.");
        return ramp_map(points, in[axis][0] - 'x', in[start], in[end], in[smooth]);
    }
    const bool by_file = rule == "file";
    if (by_file && in[file].path.empty())
        in.fail(file.name, "DG110", "mode file needs a file", "Name a JSON file with numbers or vertices.");
    NumberList map =
        by_file ? guarded(in, file.name, [&] { return file_map(points.size(), in[file].path, in[key]); }) : in[values];
    if (map.empty() && !points.empty())
        in.fail(by_file ? file.name : values.name, "FE204",
                "no numbers for a mesh of " + std::to_string(points.size()) + " vertices",
                "Give one number per vertex.");
    check_map(in, by_file ? file.name : values.name, map, points.size(), "the weights");
    return per_vertex(map, points.size());
}

void compute(const Reads& in, Writes& out) {
    NumberList map = by_rule(in);
    for (double& w : map) w = std::clamp((in[invert] ? 1 - w : w) * in[scale] + in[offset], 0.0, 1.0);
    out.set(out_weights, std::move(map));
}

} // namespace

void add_weights(Registry& registry) {
    NodeType type;
    type.name = "weights";
    type.doc = "Paints a mesh: one number per vertex, for materials, fibres and attachments.";
    type.inputs = {describe(mesh),  describe(mode),     describe(value),  describe(values),  describe(axis),
                   describe(start), describe(end),      describe(smooth), describe(other),   describe(inner),
                   describe(outer), describe(centre),   describe(radius), describe(falloff), describe(file),
                   describe(key),   describe(vertices), describe(invert), describe(scale),   describe(offset)};
    type.outputs = {describe(out_weights)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
