// zLineOfAction: the path of a muscle, whose shortening excites its fibres.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const WireList<CurvePoints> curves{
    .name = "curves",
    .doc = "The curves, from curve.outCurve or zRivetToBone.outCurve; their lengths add up.",
    .min_count = 1,
};
const Input<double> max_excitation{
    .name = "maxExcitation",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "The line of action never gives more than this.",
};
const Input<double> stretch_bias{
    .name = "stretchBias",
    .def = 0,
    .unit = "1",
    .limits = {.min = -1, .max = 1e9, .open_min = true},
    .doc =
        "Moves the length at which the line gives nothing: to (1 + stretchBias) times that at the start frame. Above "
        "0 the muscle fires before it shortens.",
};
const Input<double> pos_sensitivity{
    .name = "posSensitivity",
    .def = 1,
    .unit = "1",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Excitation for a line that has shortened to nothing: 1 takes a line that is a fifth shorter for 0.2.",
};
const Input<double> vel_sensitivity{
    .name = "velSensitivity",
    .def = 0,
    .unit = "s",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Excitation for a line that shortens by its own length in a second.",
};
const Input<double> acc_sensitivity{
    .name = "accSensitivity",
    .def = 0,
    .unit = "s^2",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Likewise by its own length in a second squared.",
};
const Output<LineOfAction> out_line{.name = "outLineOfAction", .doc = "For zFiber.lineOfAction."};
const Output<double> out_length{
    .name = "outLength",
    .doc = "Length of all curves together, in scene units. What it comes to as excitation hangs on the steps before: "
           "zSolver.outLoaValues.",
};

void compute(const Reads& in, Writes& out) {
    LineOfAction line;
    line.values = {in[max_excitation], in[stretch_bias], in[pos_sensitivity], in[vel_sensitivity], in[acc_sensitivity]};
    double length = 0;
    for (const CurvePoints& curve : in[curves]) {
        length += solver::curve_length(curve);
        line.curves.push_back(curve);
    }
    out.set(out_length, length);
    out.set(out_line, std::move(line));
}

} // namespace

void add_z_line_of_action(Registry& registry) {
    NodeType type;
    type.name = "zLineOfAction";
    type.doc = "The path of a muscle: the more it shortens, the more it excites the fibres that it is connected to.";
    type.inputs = {describe(curves),          describe(max_excitation),  describe(stretch_bias),
                   describe(pos_sensitivity), describe(vel_sensitivity), describe(acc_sensitivity)};
    type.outputs = {describe(out_line), describe(out_length)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
