// Small text helpers that do not depend on the locale: numbers in messages and files, quoted JSON strings.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sinew::engine {

/// The shortest text that reads back as the same bits ("0.1", "5", "1e-09").
std::string number_text(double v);
std::string number_text(std::int64_t v);
/// With so many digits of it, for messages: 1.2 of 1.2345.
std::string rough_text(double v, int digits);
/// A JSON string with its quotes. Bytes that are not UTF-8 become U+FFFD, so the result is always valid JSON.
std::string json_quoted(std::string_view text);
/// The text itself, with U+FFFD for each byte that is not UTF-8.
std::string utf8_text(std::string_view text);
/// What a terminal shows and does not obey: control characters but tabs as \u001b.
/// \param may_break newlines stay
std::string shown_text(std::string_view text, bool may_break = false);
/// One reference token of an RFC 6901 pointer, escaped, with its slash.
std::string pointer_token(std::string_view name);
/// With small letters for A to Z.
std::string lower_case(std::string_view text);
/// "a, b or c".
std::string listed(std::span<const std::string> words);
/// Length of the UTF-8 sequence that starts at text[i], or 0 if it is malformed.
std::size_t utf8_length(std::string_view text, std::size_t i);

} // namespace sinew::engine
