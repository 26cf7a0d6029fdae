// newtonField: attraction by a point.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/field_node.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const auto magnitude =
    field::magnitude(9.8, "m/s^2", "Force per mass at referenceDistance, towards the field; negative pushes away.");
const auto attenuation = field::attenuation(2);

void compute(const Reads& in, Writes& out) {
    solver::FieldRest rest;
    rest.kind = solver::FieldKind::newton;
    const solver::FieldValues values = field::read_common(in, magnitude, attenuation, rest);
    field::publish(in, out, rest, values);
}

} // namespace

void add_newton_field(Registry& registry) {
    registry.add(field::node_type(
        "newtonField",
        "Pulls mass towards a point, by default as Newton's law has it: with the square of the distance.", magnitude,
        attenuation, {}, compute));
}

} // namespace sinew::nodes
