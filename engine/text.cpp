// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/text.h"

#include <charconv>
#include <cmath>

namespace sinew::engine {

std::string number_text(double v) {
    if (std::isnan(v)) return "nan";
    if (std::isinf(v)) return v < 0 ? "-inf" : "inf";
    char buffer[40];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, v).ptr;
    return {buffer, end};
}

std::string number_text(std::int64_t v) { return std::to_string(v); }

std::string rough_text(double v, int digits) {
    if (!std::isfinite(v)) return number_text(v);
    char buffer[40];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, v, std::chars_format::scientific, digits - 1).ptr;
    double rounded = 0;
    // Of the largest there may be none with fewer digits.
    if (std::from_chars(buffer, end, rounded).ec != std::errc{}) rounded = v;
    if (std::abs(rounded) < 1e5 || std::abs(rounded) >= 1e7) return number_text(rounded);
    // Which the shortest text would have as 1e+06.
    const auto whole = std::to_chars(buffer, buffer + sizeof buffer, rounded, std::chars_format::fixed, 0).ptr;
    return std::string(buffer, whole);
}

std::size_t utf8_length(std::string_view text, std::size_t i) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    const unsigned char first = byte(i);
    if (first < 0x80) return 1;
    std::size_t length = 0;
    unsigned low = 0x80, high = 0xBF; // allowed range of the second byte: no overlong forms, no surrogates
    if (first >= 0xC2 && first <= 0xDF)
        length = 2;
    else if (first >= 0xE0 && first <= 0xEF) {
        length = 3;
        if (first == 0xE0) low = 0xA0;
        if (first == 0xED) high = 0x9F;
    } else if (first >= 0xF0 && first <= 0xF4) {
        length = 4;
        if (first == 0xF0) low = 0x90;
        if (first == 0xF4) high = 0x8F;
    }
    if (length == 0 || i + length > text.size() || byte(i + 1) < low || byte(i + 1) > high) return 0;
    for (std::size_t k = 2; k < length; ++k)
        if (byte(i + k) < 0x80 || byte(i + k) > 0xBF) return 0;
    return length;
}

std::string utf8_text(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = utf8_length(text, i);
        out += length > 0 ? text.substr(i, length) : "\xEF\xBF\xBD";
        i += length > 0 ? length : 1;
    }
    return out;
}

namespace {
/// As JSON writes a character below U+0100 by its number.
std::string escaped(unsigned char c) {
    static constexpr char digits[] = "0123456789abcdef";
    return std::string("\\u00") + digits[c >> 4] + digits[c & 15];
}
} // namespace

std::string json_quoted(std::string_view bytes) {
    const std::string text = utf8_text(bytes);
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            out += {'\\', c};
        else if (c == '\n')
            out += "\\n";
        else if (c == '\t')
            out += "\\t";
        else if (c == '\r')
            out += "\\r";
        else if (static_cast<unsigned char>(c) < 0x20)
            out += escaped(static_cast<unsigned char>(c));
        else
            out += c;
    }
    return out + '"';
}

std::string shown_text(std::string_view text, bool may_break) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0;
        if (c == 0xc2 && next >= 0x80 && next < 0xa0)
            out += escaped(static_cast<unsigned char>(next)), ++i; // U+0080 to U+009F, as UTF-8
        else if ((c < 0x20 && c != '\t' && !(c == '\n' && may_break)) || c == 0x7f)
            out += escaped(c);
        else
            out += text[i];
    }
    return out;
}

std::string pointer_token(std::string_view name) {
    std::string out = "/";
    for (char c : name) {
        if (c == '~')
            out += "~0";
        else if (c == '/')
            out += "~1";
        else
            out += c;
    }
    return out;
}

std::string lower_case(std::string_view text) {
    std::string out(text);
    for (char& c : out)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
}

std::string listed(std::span<const std::string> words) {
    std::string out;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (i > 0) out += i + 1 == words.size() ? " or " : ", ";
        out += words[i];
    }
    return out;
}

} // namespace sinew::engine
