// zRestShape: another shape in which a tissue is at rest, blended with the model by a keyed weight and paint.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/rest_shapes.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<Mesh> target{
    .name = "target",
    .doc = "The shape: the tissue's mesh with its vertices elsewhere, its faces the same. Where the shape lies and how "
           "it is turned means nothing. It does not change over time; key targetWeight instead.",
};
const Input<double> envelope{
    .name = "envelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Multiplies targetWeight.",
};
const Input<double> target_weight{
    .name = "targetWeight",
    .def = 1,
    .unit = "1",
    .limits = {.min = -1e6, .max = 1e6},
    .doc = "How much of the change the tissue makes: 0 stays as modelled, 1 is at rest in the target, more goes beyond "
           "it and -1 does the reciprocal. Targets blend by the logarithms of their stretches, so that no weights turn "
           "tets inside out.",
};
const Input<NumberList> weights{
    .name = "weights",
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Where the target acts: one number per vertex of the tissue's mesh, one for all, or none for everywhere.",
};
const Output<RestShapeTarget> out_rest_shape{.name = "outRestShape", .doc = "For zTissue.restShapes."};

void compute(const Reads& in, Writes& out) {
    out.set(out_rest_shape, {in[target], in[weights], in[envelope] * in[target_weight]});
}

} // namespace

void add_z_rest_shape(Registry& registry) {
    NodeType type;
    type.name = "zRestShape";
    type.doc = "A shape in which a tissue is at rest instead of the one it is modelled in.";
    type.inputs = {describe(target), describe(envelope), describe(target_weight), describe(weights)};
    type.outputs = {describe(out_rest_shape)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
