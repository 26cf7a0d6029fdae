// What somebody meant whose value is written otherwise: the form that is right, for hints.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/format/json_text.h"
#include "engine/node_type.h"

#include <optional>
#include <span>
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

/// The three numbers that are meant by one, by text or by a list of more or fewer: "write [0, -9.8, 0]".
std::string vector_form(const AttributeInfo& input, const Json& json);

/// "write "1 2"" of 1 2 in a list where text is expected; empty of what holds other than numbers and text.
std::string text_form(const Json& json);

/// What "12 000 Pa" is, a number with its digits in groups of three; empty if it is none.
std::string grouped_form(const std::string& text);

/// Of a number as it is written: whether it is too near to 0 to be told from it, as 1e-400 is.
bool is_rounded_to_zero(std::string_view number);
/// What is wrong with the 0 that such a number is, with the number in front.
std::string rounded_to_zero(const std::string& number, const std::string& wrong);

/// "1e-400": it begins as a number does.
bool begins_as_number(std::string_view text);

/// What "12,5 kPa" is, where it is one number.
std::string decimal_form(std::string text);

/// "#ff8000", "#f80" or "red" as three numbers from 0 to 1.
std::optional<NumberList> colour_meant(std::string_view text);

/// [255, 128, 0] as three numbers from 0 to 1; nothing of what has no number above 1.
std::optional<NumberList> colour_of_bytes(std::span<const double> numbers);

/// The word for how keys are joined.
std::string interpolation_form(const std::string& word);

/// The list of pairs that is meant by { "1": 0, "10": 1 } or [1, 0, 10, 1]; empty if it is none of these.
std::string keys_form(const Json& keys);

/// The keys that are meant by [[1, 0], [10, 1]] without "keys"; empty if it holds no pairs of frame and value.
std::string pairs_form(const Json& json);

/// What is meant by the name of a file, or a list of them, in place of includes: "write { "a": { "file": "a.json" } }".
/// Empty of all else.
/// \param nodes  of the file, whose names are no prefixes; or nullptr
/// \param prefix of the include, where `json` is only one; else empty
std::string include_form(const Json& json, const Json* nodes, const std::string& prefix);

/// A word that is a preset of other attributes of the type: says of which. Empty if it is none.
std::string preset_elsewhere(const NodeType& type, const AttributeInfo& input, const Json& json);

/// "material" is a word, and "materials" what is connected: asks for the list where connections were given to a
/// literal. Empty where nothing speaks for it.
std::string wires_hint(const NodeType& type, const AttributeInfo& input, const Json& json);

} // namespace sinew::engine
