// What contact keeps from step to step: who touches whom and where, and which vertices are coupled for it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/state.h"

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

namespace sinew::solver {

/// A point that is inside of a surface, through which it came. Bodies are places among the scene's parts of contact.
struct KeptContact {
    int source = -1, point = -1;    ///< whose point
    int target = -1, triangle = -1; ///< whose surface, and where it is touched
    std::array<double, 3> place{};  ///< barycentric coordinates there
    int anchor_triangle = -1;       ///< where the point sticks; it is drawn there by friction or, if fixed, altogether
    int side = 0; ///< of a cloth, along its faces' normals, on which the point is: 1 or -1; 0: at its rim, or a solid's
    std::array<double, 3> anchor{}; ///< barycentric coordinates there
    double force = 0;               ///< that it presses with [N]
    friend bool operator==(const KeptContact&, const KeptContact&) = default;
};
static_assert(sizeof(KeptContact) == 4 * 6 + 8 * 7, "no padding: its bytes are kept as they are");

/// What carries points of two bodies, coupled because they are near each other: bodies as above, carriers by number
/// (CollisionBody). The lower one first.
struct CoupledCarriers {
    int body = -1, carrier = -1, other_body = -1, other_carrier = -1;
    friend auto operator<=>(const CoupledCarriers&, const CoupledCarriers&) = default;
};

/// A pair of bodies, as above, whose points may press into each other's surface.
struct CollidingBodies {
    int source = -1, target = -1;
    friend auto operator<=>(const CollidingBodies&, const CollidingBodies&) = default;
};

struct ContactMemory {
    std::vector<KeptContact> contacts;      ///< by source, target, point
    std::vector<CoupledCarriers> couplings; ///< sorted
    std::vector<CollidingBodies> pairs;     ///< that collided, sorted: what is inside of others in none of them begins
    std::uint64_t dropped = 0; ///< points that were inside, but too deep, where contact began since the last step
};

void keep_contacts(const ContactMemory& contacts, TermMemory& memory);
/// Into `out`; empty where none of `memories` is that of contact. Throws Error IO403 where the bytes do not make sense.
void contacts_kept(const std::vector<TermMemory>& memories, ContactMemory& out);

} // namespace sinew::solver
