// How a graph file is laid out: indentation, line breaks, blanks. Nothing else of the text changes.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace sinew::engine {

constexpr int layout_width = 120; ///< longest line, where something can be broken

/// The same document in the form that Sinew writes: two blanks a level, what fits on a line on one line, unless its
/// author put the first key (of a list of objects: any entry) on a line of its own. Comments, the order of keys, single
/// blank lines, and how numbers and texts are spelled stay. laid_out(laid_out(x)) == laid_out(x).
/// \param text an object that parses without problems (parse_json)
std::string laid_out(std::string_view text);

} // namespace sinew::engine
