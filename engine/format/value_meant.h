// What somebody meant whose value is written otherwise: the form that is right, for hints.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/format/json_text.h"
#include "engine/node_type.h"

#include <optional>
#include <string>

namespace sinew::engine {

/// What a key of a value is called elsewhere, where letters alone do not tell: "units" is unit. Empty: no such word.
std::string other_word(std::string_view key);

/// { "x": 1, "y": 2, "z": 3 }, or some of them.
bool is_by_axis(const Json::Object& object);
/// "[1, 2, 3]" of such an object; an axis that is not there is that of `otherwise`.
std::string axes_form(const Json& json, const Vec3& otherwise);

/// "write true" where that is meant; empty where it cannot be told.
std::string bool_form(const Json& json);

/// "write 3" of a plain value; empty of lists and objects.
std::string plain_form(const Json& json);

/// How a list of lists of numbers is written where one list is meant; empty if it holds none or anything else.
std::string flat_form(const Json::List& list);

/// What "12,5 kPa" is, where it is one number.
std::string decimal_form(std::string text);

/// "#ff8000", "#f80" or "red" as three numbers from 0 to 1.
std::optional<NumberList> colour_meant(std::string_view text);

/// The word for how keys are joined.
std::string interpolation_form(const std::string& word);

/// The list of pairs that is meant by { "1": 0, "10": 1 } or [1, 0, 10, 1]; empty if it is none of these.
std::string keys_form(const Json& keys);

/// The keys that are meant by [[1, 0], [10, 1]] without "keys"; empty if it holds no pairs of frame and value.
std::string pairs_form(const Json& json);

/// A word that is a preset of other attributes of the type: says of which. Empty if it is none.
std::string preset_elsewhere(const NodeType& type, const AttributeInfo& input, const Json& json);

/// "material" is a word, and "materials" what is connected: asks for the list where connections were given to a
/// literal. Empty where nothing speaks for it.
std::string wires_hint(const NodeType& type, const AttributeInfo& input, const Json& json);

} // namespace sinew::engine
