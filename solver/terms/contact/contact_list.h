// Contacts as data: who touches whom, where, how deep and how hard, at the end of a frame.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/step.h"

#include <vector>

namespace sinew::solver {

/// A point of one body that is inside of another one's surface, or held to it.
struct ContactPoint {
    int source = -1, target = -1; ///< whose point, and whose surface
    int point = -1;               ///< of those that are tested of the source: first the vertices of what collides
    bool slides = true;           ///< false: it is held where it touched
    Vec3 place = Vec3::Zero();    ///< of the point [m]
    Vec3 normal = Vec3::Zero();   ///< of unit length, outwards of the target where it is nearest: the way it pushes
    double depth = 0;             ///< distance to the surface [m]; negative where a held point is outside
    /// What the contact does to the source, and the opposite to the target, but for damping: of what slides the
    /// pressure and the friction, of what is held the pull to where it touched [N].
    Vec3 force = Vec3::Zero();
};

/// The contacts of the state that marks_of of this workspace has just looked at; empty at no cost where the scene has
/// none. By source, target and point.
std::vector<ContactPoint> contacts_shown(Workspace& workspace);

} // namespace sinew::solver
