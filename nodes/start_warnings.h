// What is told once, where a simulation begins or contact does.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/solver_setup.h"

namespace sinew::nodes {

/// Warns (FE256) of bodies that no other one can touch, because no other one shares a number of their collisionSets.
void warn_of_lone_sets(const engine::Reads& in, const Setup& setup);

/// At the end of the first step: warns (FE339) of initial velocities that their bodies never get. What is off in that
/// step comes on at rest later. `without_inertia`: its scheme knows no velocities at all.
void warn_of_lost_velocities(const engine::Reads& in, const Setup& setup, bool without_inertia);

} // namespace sinew::nodes
