// One input or key of a graph file's text written in place: everything else of the text stays byte for byte, comments,
// order, spacing and how numbers are spelled. Knows text only; what it means is read_graph's to say.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <optional>
#include <string>
#include <string_view>

namespace sinew::engine {

/// The text with `json` at the input. Of a value that is there only the numbers and words that differ are replaced; a
/// "comment" beside it stays; a unit stays where `json` has the same one. A new input goes behind the last of its node,
/// in the way that stands there. Inputs of included nodes go into "overrides".
/// \param text a graph file that parses without problems (parse_json)
/// \param json one JSON value without comments
/// \return nothing if the text has no such node or include, or `json` does not parse
std::optional<std::string> with_input(std::string_view text, const Plug& input, std::string_view json);

/// The text with a key at `frame` among the input's keys: a key that is there gets the value and keeps its tangents, a
/// new one goes to its place in time.
/// \param value in the unit that stands beside the keys (keys_unit)
/// \return nothing if the text has no keys there
std::optional<std::string> with_key(std::string_view text, const Plug& input, int frame, std::string_view value);

/// The unit that stands beside an input's keys; nothing if there are no keys or no unit.
std::optional<std::string> keys_unit(std::string_view text, const Plug& input);

} // namespace sinew::engine
