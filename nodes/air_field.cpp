// airField: wind.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/field_node.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const auto magnitude = field::magnitude(1000, "N/m^3",
                                        "Force per volume on what is at rest. A magnitude of Maya's divided by "
                                        "zSolver.scale: 10388 holds flesh of 1060 kg/m^3 against gravity.");
const auto attenuation = field::attenuation(0);
const auto direction = field::direction({1, 0, 0}, "Where the air moves to; its length does not count.");
const Input<double> air_speed{
    .name = "airSpeed",
    .def = 10,
    .unit = "m/s",
    .limits = {.min = 0, .max = 1e13, .open_min = true},
    .doc = "Speed of the air: the force is magnitude * (1 - velocity / airSpeed), so what moves with the air feels "
           "none, and what is faster is braked.",
};
const Input<bool> component_only{
    .name = "componentOnly",
    .def = false,
    .doc = "On pushes along the direction alone, and never brakes what is faster or moves across.",
    .keyable = false,
};

void compute(const Reads& in, Writes& out) {
    solver::FieldRest rest;
    rest.kind = solver::FieldKind::air;
    solver::FieldValues values = field::read_common(in, magnitude, attenuation, rest);
    field::read_direction(in, direction, values.direction_x, values.direction_y, values.direction_z);
    values.air_speed = in[air_speed];
    rest.component_only = in[component_only];
    field::publish(in, out, rest, values);
}

} // namespace

void add_air_field(Registry& registry) {
    registry.add(field::node_type(
        "airField",
        "Wind: pushes tissue until it moves with the air. In QuasiStatic everything is at rest, and feels all of it.",
        magnitude, attenuation, {describe(direction), describe(air_speed), describe(component_only)}, compute));
}

} // namespace sinew::nodes
