// What a term shows in pictures: points and lines with a number each. The viewer and snapshots draw them all alike.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <array>
#include <string>
#include <vector>

namespace sinew::solver {

/// A line, or a point where both ends are the same [m].
struct Mark {
    int part = -1; ///< of the scene's parts, or of its attachments
    Vec3 from, to;
    double value = 0; ///< in the group's unit
    /// Of the scene, whom it is about, where that is one or two of them: whose point, whose surface; -1: nobody.
    std::array<int, 2> bodies{-1, -1};
};

struct MarkGroup {
    std::string term, what; ///< "attachment", "stretch"
    std::string unit;       ///< of the values
    std::vector<Mark> marks;
};

using Marks = std::vector<MarkGroup>;

} // namespace sinew::solver
