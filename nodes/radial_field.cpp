// radialField: pushes away from a point.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/field_node.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const auto magnitude = field::magnitude(
    1000, "N/m^3",
    "Force per volume, away from the field; negative pulls. A magnitude of Maya's divided by zSolver.scale.");
const auto attenuation = field::attenuation(0);

void compute(const Reads& in, Writes& out) {
    solver::FieldRest rest;
    rest.kind = solver::FieldKind::radial;
    const solver::FieldValues values = field::read_common(in, magnitude, attenuation, rest);
    field::publish(in, out, rest, values);
}

} // namespace

void add_radial_field(Registry& registry) {
    registry.add(field::node_type("radialField", "Pushes tissue away from a point, or pulls it there.", magnitude,
                                  attenuation, {}, compute));
}

} // namespace sinew::nodes
