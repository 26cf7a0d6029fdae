// What bodies say about contact, alike for bones, tissues and cloth, and what zSolver adds.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/node_type.h"
#include "nodes/values.h"

#include <vector>

namespace sinew::nodes {

/// Whose contact it is: a cloth is never a solid, a bone does not meet itself.
enum class Collider { bone, tissue, cloth };

/// Of a body's contactStiffness [N/m^3].
inline constexpr double most_contact_stiffness = 1e12;

std::vector<engine::AttributeInfo> contact_attributes(Collider kind);

/// What a body brings to contact: a force on itself alone, without what zSolver adds. `surface`: what collides, its own
/// mesh or `shape`, which rides on a tissue's tets. Fails with FE254 where collisionVolume is on and the surface is
/// open or looks inwards, FE255 where collisionSets are no numbers.
Force read_contact(const engine::Reads& in, Collider kind, const Mesh& surface, const CollisionSurface* shape);

/// That force as the solver's contacts want it: in metres, with the solver's spacing, damping and longest contact.
Force contact_in_solver(const engine::Reads& solver, const Force& of_body, double units);

} // namespace sinew::nodes
