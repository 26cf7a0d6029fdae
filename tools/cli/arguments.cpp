// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/arguments.h"

#include "engine/diagnostics.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <climits>
#include <cmath>
#include <cstdio>
#include <unordered_set>

namespace sinew::cli {

namespace {

const Flag* find_flag(const Command& command, std::string_view word) {
    for (const Flag& f : command.flags)
        if (f.name == word || (f.letter && word.size() == 2 && word[0] == '-' && word[1] == f.letter)) return &f;
    return nullptr;
}

[[noreturn]] void unknown_flag(const Command& command, std::string_view word) {
    std::vector<std::string> known{"--help"};
    for (const Flag& f : command.flags) known.emplace_back(f.name);
    // "-j4", and letters of other programs.
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    if (const std::string_view letter = word.substr(0, 2), rest = word.substr(letter.size());
        std::all_of(rest.begin(), rest.end(), is_digit)) {
        const Flag* meant = find_flag(command, letter);
        if (!meant && letter == "-t") meant = find_flag(command, "--threads");
        if (!meant && letter == "-f") meant = find_flag(command, "--frames");
        if (meant)
            throw UsageError("unknown flag '" + std::string(word) + "'. Did you mean '" + std::string(meant->name) +
                             (rest.empty() ? "" : " ") + std::string(rest) + "'?");
    }
    throw UsageError("unknown flag '" + std::string(word) + "'." + did_you_mean(word, known));
}

template <class T>
std::optional<T> whole_text(std::string_view text) {
    T value{};
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || text.empty()) return {};
    return value;
}

/// A whole number that is larger than any that is taken.
bool is_beyond(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos && !whole_text<int>(text);
}

} // namespace

Arguments::Arguments(const Command& command, std::span<const std::string> words) {
    bool only_operands = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string& word = words[i];
        if (only_operands || word.size() < 2 || word[0] != '-') {
            operands_.push_back(word);
            continue;
        }
        if (word == "--") {
            only_operands = true;
            continue;
        }
        const std::size_t equals = word.starts_with("--") ? word.find('=') : std::string::npos;
        const std::string name = word.substr(0, equals);
        if (name == "--help" || name == "-h") {
            help_ = true;
            continue;
        }
        const Flag* flag = find_flag(command, name);
        if (!flag) unknown_flag(command, name);
        std::vector<std::string>& given = flags_[std::string(flag->name)];
        if (!given.empty() && !flag->repeats) throw UsageError(std::string(flag->name) + " is given twice.");
        if (flag->value.empty()) {
            if (equals != std::string::npos) throw UsageError(std::string(flag->name) + " takes no value.");
            given.emplace_back();
        } else if (equals != std::string::npos) {
            given.push_back(word.substr(equals + 1));
        } else if (i + 1 < words.size()) {
            // Taken for the next flag rather than for a file or folder of that name.
            if (words[i + 1].starts_with("--"))
                throw UsageError(std::string(flag->name) + " needs a value: " + std::string(flag->value) + ". '" +
                                 words[i + 1] + "' looks like a flag; if it is meant, write " +
                                 std::string(flag->name) + "=" + words[i + 1] + ".");
            given.push_back(words[++i]);
        } else {
            throw UsageError(std::string(flag->name) + " needs a value: " + std::string(flag->value) + ".");
        }
    }
    if (help_) return; // whoever asks for help need not get the rest right
    for (std::size_t i = operands_.size(); i < command.operands.size(); ++i)
        if (command.operands[i].required) throw UsageError(std::string(command.operands[i].name) + " is missing.");
    const bool any_number = !command.operands.empty() && command.operands.back().repeats;
    if (operands_.size() > command.operands.size() && !any_number)
        throw UsageError("unexpected word '" + operands_[command.operands.size()] + "'.");
}

std::optional<std::string> Arguments::value(std::string_view flag) const {
    const auto it = flags_.find(flag);
    return it == flags_.end() ? std::nullopt : std::optional(it->second.back());
}

std::vector<std::string> Arguments::values(std::string_view flag) const {
    const auto it = flags_.find(flag);
    return it == flags_.end() ? std::vector<std::string>{} : it->second;
}

int Arguments::whole_number(std::string_view flag, int otherwise, int least, int most) const {
    const auto text = value(flag);
    if (!text) return otherwise;
    const auto number = to_int(*text);
    if (!number || *number < least || *number > most)
        throw UsageError(std::string(flag) + " needs a whole number " +
                         (most < INT_MAX || is_beyond(*text)
                              ? "from " + std::to_string(least) + " to " + std::to_string(most)
                              : "of at least " + std::to_string(least)) +
                         ", not '" + *text + "'.");
    return *number;
}

std::vector<double> Arguments::numbers(std::string_view flag, std::vector<double> otherwise) const {
    const auto text = value(flag);
    if (!text) return otherwise;
    std::vector<double> out;
    for (const std::string& word : split(*text, ',')) {
        const auto number = to_number(word);
        if (!number)
            throw UsageError(std::string(flag) + " needs numbers with commas between them, not '" + *text + "'.");
        out.push_back(*number);
    }
    return out;
}

std::optional<std::string> Arguments::operand(std::size_t index) const {
    return index < operands_.size() ? std::optional(operands_[index]) : std::nullopt;
}

std::vector<std::string> Arguments::operands_from(std::size_t first) const {
    if (first >= operands_.size()) return {};
    return {operands_.begin() + static_cast<std::ptrdiff_t>(first), operands_.end()};
}

std::vector<std::string> split(std::string_view text, char separator) {
    std::vector<std::string> out;
    for (std::size_t at = 0;;) {
        const std::size_t next = text.find(separator, at);
        out.emplace_back(text.substr(at, next - at));
        if (next == std::string_view::npos) return out;
        at = next + 1;
    }
}

std::optional<int> to_int(std::string_view text) { return whole_text<int>(text); }

std::optional<double> to_number(std::string_view text) {
    const auto value = whole_text<double>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<double> to_bytes(std::string_view text) {
    constexpr std::array<std::pair<std::string_view, double>, 9> units{{{"b", 1},
                                                                        {"kb", 1e3},
                                                                        {"mb", 1e6},
                                                                        {"gb", 1e9},
                                                                        {"tb", 1e12},
                                                                        {"kib", 0x1p10},
                                                                        {"mib", 0x1p20},
                                                                        {"gib", 0x1p30},
                                                                        {"tib", 0x1p40}}};
    const std::size_t end = text.find_last_of("0123456789.");
    if (end == std::string_view::npos) return {};
    const auto number = to_number(text.substr(0, end + 1));
    std::string unit(text.substr(std::min(text.size(), text.find_first_not_of(' ', end + 1))));
    for (char& c : unit) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (const auto& [name, bytes] : units)
        if (unit == name && number && *number >= 0) return *number * bytes;
    return {};
}

std::string rounded_bytes(double bytes) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g GB", bytes / 1e9);
    return text;
}

std::vector<int> parse_frames(std::string_view text) {
    constexpr int most = 1'000'000; // a typing error, not a film
    std::vector<int> out;
    std::unordered_set<int> seen;
    for (const std::string& part : split(text, ',')) {
        // The dash of a range is not the sign of its first frame.
        const std::size_t dash = part.find('-', 1);
        const auto first = to_int(std::string_view(part).substr(0, dash));
        const auto last = dash == std::string::npos ? first : to_int(std::string_view(part).substr(dash + 1));
        if (first && last && *last < *first)
            throw UsageError("'" + part + "' ends before it begins; write " + std::to_string(*last) + "-" +
                             std::to_string(*first) + ".");
        for (const std::string_view end : {std::string_view(part).substr(0, dash),
                                           std::string_view(part).substr(dash == std::string::npos ? 0 : dash + 1)})
            if (is_beyond(end.substr(end.starts_with('-') ? 1 : 0)))
                throw UsageError("frame " + std::string(end) + " is too far from 0; frames lie within a billion.");
        if (!first || !last)
            throw UsageError("'" + std::string(text) + "' is no list of frames; write 12, 1-24 or 1,64,128.");
        if (static_cast<long long>(*last) - *first >= most)
            throw UsageError("'" + part + "' is more than a million frames.");
        for (int frame = *first; frame <= *last; ++frame)
            if (seen.insert(frame).second) out.push_back(frame);
    }
    return out;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> known) {
    const std::string nearest = engine::nearest_name(word, known);
    return nearest.empty() ? "" : " Did you mean '" + nearest + "'?";
}

} // namespace sinew::cli
