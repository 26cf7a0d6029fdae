// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/typed_text.h"

#include "engine/text.h"

#include <algorithm>
#include <charconv>

namespace sinew::engine {

namespace {

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
    return first == std::string_view::npos ? std::string_view() : text.substr(first, last - first + 1);
}

} // namespace

std::optional<Quantity> parse_quantity(std::string_view text) {
    text = trimmed(text);
    if (text.starts_with('+')) text.remove_prefix(1);
    const std::size_t sign = text.starts_with('-') ? 1 : 0;
    // from_chars also takes "inf" and "nan".
    if (text.size() <= sign || !(text[sign] == '.' || (text[sign] >= '0' && text[sign] <= '9'))) return {};
    Quantity out;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out.number);
    if (error != std::errc()) return {};
    out.unit = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
    return out;
}

NumberList numbers_in(std::string text) {
    std::replace(text.begin(), text.end(), ',', ' ');
    NumberList out;
    std::string_view inside = trimmed(text);
    if (inside.size() > 1 &&
        ((inside.front() == '[' && inside.back() == ']') || (inside.front() == '(' && inside.back() == ')')))
        inside = trimmed(inside.substr(1, inside.size() - 2));
    for (std::string_view rest = inside; !rest.empty();) {
        const std::size_t end = std::min(rest.find(' '), rest.size());
        const auto one = parse_quantity(rest.substr(0, end));
        if (!one || !one->unit.empty()) return {};
        out.push_back(one->number);
        rest = trimmed(rest.substr(end));
    }
    return out;
}

std::string list_text(std::span<const double> numbers) {
    std::string out = "[";
    for (const double v : numbers) out += (out.size() > 1 ? ", " : "") + number_text(v);
    return out + "]";
}

} // namespace sinew::engine
