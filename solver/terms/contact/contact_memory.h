// What contact keeps from step to step: who touches whom and where, and which vertices are coupled for it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/state.h"

#include <array>
#include <utility>
#include <vector>

namespace sinew::solver {

/// A point that is inside of a surface, through which it came. Bodies are places among the scene's parts of contact.
struct KeptContact {
    int source = -1, point = -1;    ///< whose point
    int target = -1, triangle = -1; ///< whose surface, and where it is touched
    std::array<double, 3> place{};  ///< barycentric coordinates there
    int anchor_triangle = -1;       ///< where the point sticks; it is drawn there by friction or, if fixed, altogether
    int unused = 0;
    std::array<double, 3> anchor{}; ///< barycentric coordinates there
    double force = 0;               ///< that it presses with [N]
    friend bool operator==(const KeptContact&, const KeptContact&) = default;
};
static_assert(sizeof(KeptContact) == 4 * 6 + 8 * 7, "no padding: its bytes are kept as they are");

struct ContactMemory {
    std::vector<KeptContact> contacts; ///< by source, target, point
    /// Vertices of bodies that deform, coupled because they are near each other; lower number first, sorted.
    std::vector<std::pair<int, int>> couplings;
};

void keep_contacts(const ContactMemory& contacts, TermMemory& memory);
/// Empty where none of `memories` is that of contact. Throws Error IO403 where the bytes do not make sense.
ContactMemory contacts_kept(const std::vector<TermMemory>& memories);

} // namespace sinew::solver
