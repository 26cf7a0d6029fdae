// What is told once, where a simulation begins or contact does.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/solver_setup.h"

namespace sinew::nodes {

/// Warns (FE256) of bodies that no other one can touch, because no other one shares a number of their collisionSets.
void warn_of_lone_sets(const engine::Reads& in, const Setup& setup);

/// Warns (FE339) of initial velocities that their bodies never get: they belong to the start frame, and a body that is
/// off then comes on at rest. `without_inertia`: the scheme knows no velocities at all.
void warn_of_lost_velocities(const engine::Reads& in, const Setup& setup, bool without_inertia);

} // namespace sinew::nodes
