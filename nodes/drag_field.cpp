// dragField: brakes what moves.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/field_node.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<double> magnitude{
    .name = "magnitude",
    .def = 1000,
    .unit = "N*s/m^4",
    .limits = {.min = 0, .max = 1e13},
    .doc = "Force per volume and speed: flesh that falls under gravity ends at the speed density * 9.8 / magnitude.",
};
const auto attenuation = field::attenuation(0);
const Input<bool> use_direction{
    .name = "useDirection",
    .def = false,
    .doc = "On brakes only the part of the velocity that lies along the direction, both ways.",
    .keyable = false,
};
const auto direction =
    field::direction({0, 1, 0}, "With useDirection: the line along which motion is braked; its length does not count.");
const Input<double> speed_attenuation{
    .name = "speedAttenuation",
    .def = 0,
    .unit = "m/s",
    .limits = {.min = 0, .max = 1e13},
    .doc = "Weakens the drag on what is slower than this, in proportion to its speed.",
};

void compute(const Reads& in, Writes& out) {
    solver::FieldRest rest;
    rest.kind = solver::FieldKind::drag;
    solver::FieldValues values = field::read_common(in, magnitude, attenuation, rest);
    rest.use_direction = in[use_direction];
    if (rest.use_direction)
        field::read_direction(in, direction, values.direction_x, values.direction_y, values.direction_z);
    values.speed_attenuation = in[speed_attenuation];
    field::publish(in, out, rest, values);
}

} // namespace

void add_drag_field(Registry& registry) {
    registry.add(field::node_type(
        "dragField", "Brakes tissue in proportion to its velocity, as water or mud would. Does nothing in QuasiStatic.",
        magnitude, attenuation, {describe(use_direction), describe(direction), describe(speed_attenuation)}, compute));
}

} // namespace sinew::nodes
