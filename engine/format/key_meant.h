// Keys of a graph file that nobody knows: which one was probably meant, or where it belongs.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/format/json_text.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::engine {

/// A level of the file: the document, "timing", a node, an include.
enum class Level { document, timing, node, include };

/// The keys that a level takes.
std::span<const std::string> keys_of(Level level);

/// The known key that stands most probably behind `key`, by its letters or because other programs call it so ("input",
/// "begin"); empty if there is none.
std::string key_meant(std::string_view key, Level level);

/// What to tell whoever wrote `key`: the key that was meant, the place where it belongs, or all keys that there are.
/// \param inputs of the node's type, for keys of a node: they belong into "inputs"
std::string key_hint(std::string_view key, Level level, std::span<const std::string> inputs = {});

/// The member whose key is not known and probably meant as `wanted`; nullptr if there is none, or `wanted` itself is
/// there.
const JsonMember* meant_as(const Json& object, std::string_view wanted, Level level);

} // namespace sinew::engine
