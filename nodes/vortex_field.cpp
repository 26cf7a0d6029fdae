// vortexField: pushes around an axis.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/field_node.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const auto magnitude =
    field::magnitude(1000, "N/m^3",
                     "Force per volume around the axis, counter-clockwise where it points at the eye; negative turns "
                     "the other way. A magnitude of Maya's divided by zSolver.scale.");
const auto attenuation = field::attenuation(0);
const auto axis = field::axis("Direction of the axis through translate; its length does not count.");

void compute(const Reads& in, Writes& out) {
    solver::FieldRest rest;
    rest.kind = solver::FieldKind::vortex;
    solver::FieldValues values = field::read_common(in, magnitude, attenuation, rest);
    field::read_direction(in, axis, values.axis_x, values.axis_y, values.axis_z);
    field::publish(in, out, rest, values);
}

} // namespace

void add_vortex_field(Registry& registry) {
    registry.add(field::node_type("vortexField",
                                  "Pushes tissue around an axis. Distances count from the axis, all along it.",
                                  magnitude, attenuation, {describe(axis)}, compute));
}

} // namespace sinew::nodes
