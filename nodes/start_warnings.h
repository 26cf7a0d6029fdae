// What is told once, where a simulation begins or contact does.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/solver_setup.h"

namespace sinew::nodes {

/// Warns (FE256) of bodies that collide and that no other one can touch: none shares a number of their collisionSets,
/// or none that does has a surface that pushes, nor do they.
void warn_of_lone_bodies(const engine::Reads& in, const Setup& setup);

/// At the end of the first step: warns (FE339) of initial velocities that their bodies never get. What is off in that
/// step comes on at rest later. `without_inertia`: its scheme knows no velocities at all.
void warn_of_lost_velocities(const engine::Reads& in, const Setup& setup, bool without_inertia);

} // namespace sinew::nodes
