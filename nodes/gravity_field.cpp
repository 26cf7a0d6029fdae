// gravityField: the same acceleration everywhere.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/field_node.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const auto magnitude = field::magnitude(9.8, "m/s^2", "Force per mass. Always in metres, whatever the scale.");
const auto attenuation = field::attenuation(0);
const auto direction = field::direction({0, -1, 0}, "Where mass falls to; its length does not count.");

void compute(const Reads& in, Writes& out) {
    solver::FieldRest rest;
    rest.kind = solver::FieldKind::gravity;
    solver::FieldValues values = field::read_common(in, magnitude, attenuation, rest);
    field::read_direction(in, direction, values.direction_x, values.direction_y, values.direction_z);
    field::publish(in, out, rest, values);
}

} // namespace

void add_gravity_field(Registry& registry) {
    registry.add(field::node_type("gravityField",
                                  "Pulls on mass: every tissue falls alike. It adds to zSolver.gravity.", magnitude,
                                  attenuation, {describe(direction)}, compute));
}

} // namespace sinew::nodes
