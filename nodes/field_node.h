// What the nodes of all fields share: the attributes that say where a field is and how far it reaches, and the way from
// a field's numbers to a force on a wire. One file a field, named as in Maya.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/registry.h"
#include "nodes/limits.h"
#include "nodes/values.h"
#include "solver/terms/field/values.h"

#include <initializer_list>
#include <string_view>

namespace sinew::nodes::field {

using namespace engine;

inline const WireList<Body> bodies{
    .name = "bodies",
    .doc = "The tissues and cloths that the field acts on; none connected: all of the solver's. What is a force per "
           "volume on "
           "tissue [N/m^3] is a force per area on cloth [N/m^2], in the same number.",
};
inline const Input<Vec3> translate{
    .name = "translate",
    .limits = within_reach,
    .doc = "Where the field is, in scene units, in the space of the scene; distances count from here.",
};
inline const Input<double> reference_distance{
    .name = "referenceDistance",
    .def = 1,
    .limits = {.min = 0, .max = 1e60, .open_min = true},
    .doc = "Up to this distance, in scene units, the magnitude holds; attenuation counts from here. A force towards or "
           "around the field grows from zero in its middle to the magnitude here.",
};
inline const Input<bool> use_max_distance{
    .name = "useMaxDistance",
    .def = false,
    .doc = "Whether the field ends at maxDistance.",
    .keyable = false,
};
inline const Input<double> max_distance{
    .name = "maxDistance",
    .def = 20,
    .limits = {.min = 0, .max = 1e60, .open_min = true},
    .doc = "With useMaxDistance: no force beyond this distance, in scene units; it fades smoothly over the last fifth.",
};
inline const Output<Force> out_force{.name = "outForce", .doc = "The field; connect to zSolver.forces."};

inline Input<double> magnitude(double def, std::string_view unit, std::string_view doc) {
    return {.name = "magnitude", .def = def, .unit = unit, .limits = {.min = -1e13, .max = 1e13}, .doc = doc};
}
inline Input<double> attenuation(double def) {
    return {.name = "attenuation",
            .def = def,
            .unit = "1",
            .limits = {.min = 0, .max = 1e3},
            .doc = "Exponent of the fall with distance: beyond referenceDistance the force is magnitude * "
                   "(referenceDistance / distance)^attenuation. 0: no fall."};
}
inline Input<Vec3> direction(const Vec3& def, std::string_view doc) {
    return {.name = "direction", .def = def, .unit = "1", .limits = within_reach, .doc = doc};
}
inline Input<Vec3> axis(std::string_view doc) {
    return {.name = "axis", .def = {0, 1, 0}, .unit = "1", .limits = within_reach, .doc = doc};
}

/// The direction of an input into three numbers. Fails with FE304 where it is zero.
void read_direction(const Reads& in, const Input<Vec3>& input, double& x, double& y, double& z);
/// Magnitude and all that is declared above.
solver::FieldValues read_common(const Reads& in, const Input<double>& magnitude, const Input<double>& attenuation,
                                solver::FieldRest& rest);
/// Fails with FE218 where a bone is connected.
void publish(const Reads& in, Writes& out, const solver::FieldRest& rest, const solver::FieldValues& values);
/// A node type with the inputs above; `own` stand between magnitude and attenuation and the rest of them.
NodeType node_type(std::string_view name, std::string_view doc, const Input<double>& magnitude,
                   const Input<double>& attenuation, std::initializer_list<AttributeInfo> own,
                   void (*compute)(const Reads&, Writes&));

} // namespace sinew::nodes::field
