// uniformField: the same force everywhere.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/field_node.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const auto magnitude = field::magnitude(
    1000, "N/m^3", "Force per volume. A magnitude of Maya's divided by zSolver.scale; density times 9.8 is weight.");
const auto attenuation = field::attenuation(0);
const auto direction = field::direction({1, 0, 0}, "Where the force points; its length does not count.");

void compute(const Reads& in, Writes& out) {
    solver::FieldRest rest;
    rest.kind = solver::FieldKind::uniform;
    solver::FieldValues values = field::read_common(in, magnitude, attenuation, rest);
    field::read_direction(in, direction, values.direction_x, values.direction_y, values.direction_z);
    field::publish(in, out, rest, values);
}

} // namespace

void add_uniform_field(Registry& registry) {
    registry.add(field::node_type("uniformField", "Pushes tissue with the same force everywhere, along a direction.",
                                  magnitude, attenuation, {describe(direction)}, compute));
}

} // namespace sinew::nodes
