// In what two graphs differ for those who run them: not by order, comments, spelling, or defaults written out.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <string>
#include <vector>

namespace sinew::cli {

struct Difference {
    /// `prefix`: an include that is called otherwise, with all its nodes.
    enum class Kind { timing, added, removed, renamed, type, input, prefix };
    Kind kind = Kind::input;
    std::string node;      ///< as the second graph calls it; removed ones as the first
    std::string attribute; ///< Kind::input, Kind::timing
    /// What stands there in the first and the second graph: JSON at inputs (empty: nothing is connected), a name, a
    /// prefix or a type at the other kinds.
    std::string before, after;
    std::string unit; ///< of the numbers in `before` and `after`; may be empty
};

/// Included graphs are in both. A node that is only in one graph and says the same as one that is only in the other
/// counts as renamed where there is no doubt which. Files are the same if their content is.
std::vector<Difference> differences(const engine::Graph& a, const engine::Graph& b);

} // namespace sinew::cli
