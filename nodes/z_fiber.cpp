// zFiber: muscle fibres that pull along the muscle when they are excited.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<double> envelope{
    .name = "envelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Scales the excitation.",
};
const Input<NumberList> weights{
    .name = "weights",
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Local strength: one number per vertex of the tissue's mesh, one for all, or none for full strength.",
};
const Input<NumberList> end_points{
    .name = "endPoints",
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "One number per vertex: up to 0.1 where the fibres begin, from 0.9 on where they end, else in "
           "between. "
           "The fibres run from the first to the second; connect endPoints.outEndPoints.",
};
const Input<double> strength{
    .name = "strength",
    .def = 12e3,
    .unit = "Pa",
    .limits = {.min = 0},
    .doc = "Stiffness of the pull along the fibres at full excitation.",
};
const Input<double> contraction_limit{
    .name = "contractionLimit",
    .def = 0,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "The share of its length that a fibre pulls towards: 0 to nothing, 0.5 to half, 1 stiffens without "
           "shortening.",
};
const Input<double> excitation{
    .name = "excitation",
    .def = 0,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "0 relaxed to 1 fully excited; usually keyed or driven by trackChannel.outValue.",
};
const Output<Fiber> out_fiber{.name = "outFiber", .doc = "The fibres; connect to zTissue.fibers."};

void compute(const Reads& in, Writes& out) {
    Fiber f;
    f.values = {in[strength], in[contraction_limit], in[excitation], in[envelope]};
    f.weights = in[weights];
    f.end_points = in[end_points];
    out.set(out_fiber, std::move(f));
}

} // namespace

void add_z_fiber(Registry& registry) {
    NodeType type;
    type.name = "zFiber";
    type.doc = "Fibres of a muscle that contract by excitation.";
    type.inputs = {describe(envelope), describe(weights),           describe(end_points),
                   describe(strength), describe(contraction_limit), describe(excitation)};
    type.outputs = {describe(out_fiber)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
