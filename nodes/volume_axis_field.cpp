// volumeAxisField: pushes within a volume, in directions that its centre and axis give.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/field_node.h"
#include "nodes/limits.h"
#include "nodes/options.h"

namespace sinew::nodes {

using namespace engine;

namespace {

constexpr Option<solver::FieldVolume> volumes[] = {{"sphere", solver::FieldVolume::sphere},
                                                   {"cylinder", solver::FieldVolume::cylinder}};

const auto magnitude = field::magnitude(
    1000, "N/m^3",
    "Force per volume; multiplies the sum of the directions below. A magnitude of Maya's divided by zSolver.scale.");
const Input<double> attenuation{
    .name = "attenuation",
    .def = 0,
    .unit = "1",
    .limits = {.min = 0, .max = 1e3},
    .doc = "Exponent of the fall from the centre (sphere) or axis (cylinder) to the border: (1 - distance / "
           "radius)^attenuation. 0: the same strength but for the last fifth, where it fades.",
};
const Input<bool> invert_attenuation{
    .name = "invertAttenuation",
    .def = false,
    .doc = "On: with attenuation above 0 the force grows from the middle outwards, (distance / radius)^attenuation.",
    .keyable = false,
};
const Input<std::string> volume_shape{
    .name = "volumeShape",
    .def = "sphere",
    .doc = "The volume that the force is confined to; it fades over the last fifth of the way to its border.",
    .keyable = false,
    .options = words(volumes),
};
const Input<double> radius{
    .name = "radius",
    .def = 1,
    .limits = {.min = 0, .max = 1e60, .open_min = true},
    .doc = "Radius of the sphere or cylinder, in scene units.",
};
const Input<double> height{
    .name = "height",
    .def = 2,
    .limits = {.min = 0, .max = 1e60, .open_min = true},
    .doc = "Height of the cylinder along the axis, in scene units, half of it to each side.",
};
const auto axis = field::axis("Direction of the axis through translate; its length does not count.");
Input<double> share(std::string_view name, double def, std::string_view doc) {
    return {.name = name, .def = def, .unit = "1", .limits = {.min = -1e9, .max = 1e9}, .doc = doc};
}
const auto away_from_center = share("awayFromCenter", 1, "Force away from the centre; negative pulls.");
const auto away_from_axis = share("awayFromAxis", 0, "Force away from the axis; negative pulls.");
const auto along_axis = share("alongAxis", 0, "Force along the axis.");
const auto around_axis = share("aroundAxis", 0, "Force around the axis, counter-clockwise where it points at the eye.");
const auto directional_speed = share("directionalSpeed", 0, "Force along `direction`.");
const auto direction = field::direction({1, 0, 0}, "Where directionalSpeed points; its length does not count.");

void compute(const Reads& in, Writes& out) {
    solver::FieldRest rest;
    rest.kind = solver::FieldKind::volume_axis;
    rest.invert_attenuation = in[invert_attenuation];
    rest.volume = meaning(volumes, in[volume_shape]);
    solver::FieldValues v;
    v.magnitude = in[magnitude];
    v.attenuation = in[attenuation];
    const Vec3& place = in[field::translate];
    v.x = place[0], v.y = place[1], v.z = place[2];
    v.radius = in[radius], v.height = in[height];
    field::read_direction(in, axis, v.axis_x, v.axis_y, v.axis_z);
    v.away_from_center = in[away_from_center], v.away_from_axis = in[away_from_axis];
    v.along_axis = in[along_axis], v.around_axis = in[around_axis];
    v.directional_speed = in[directional_speed];
    if (v.directional_speed != 0) field::read_direction(in, direction, v.direction_x, v.direction_y, v.direction_z);
    field::publish(in, out, rest, v);
}

} // namespace

void add_volume_axis_field(Registry& registry) {
    NodeType type;
    type.name = "volumeAxisField";
    type.doc = "Pushes tissue within a sphere or cylinder: away from its centre or axis, along or around the axis, or "
               "along a direction.";
    type.inputs = {describe(field::bodies),
                   describe(magnitude),
                   describe(attenuation),
                   describe(invert_attenuation),
                   describe(field::translate),
                   describe(volume_shape),
                   describe(radius),
                   describe(height),
                   describe(axis),
                   describe(away_from_center),
                   describe(away_from_axis),
                   describe(along_axis),
                   describe(around_axis),
                   describe(directional_speed),
                   describe(direction)};
    type.outputs = {describe(field::out_force)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
