// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/file_sequence.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

namespace sinew::engine {

namespace fs = std::filesystem;

bool names_sequence(const std::string& path) {
    std::error_code ec;
    return fs::path(path).filename().string().find('#') != std::string::npos && !fs::exists(path, ec);
}

namespace {

/// The last part of a path around its run of #.
struct Pattern {
    std::string before, after;
    std::size_t digits = 0; ///< 0: there is no #
};

Pattern pattern_of(const fs::path& path) {
    const std::string name = path.filename().string();
    const std::size_t last = name.rfind('#');
    if (last == std::string::npos) return {};
    std::size_t first = last;
    while (first > 0 && name[first - 1] == '#') --first;
    return {name.substr(0, first), name.substr(last + 1), last + 1 - first};
}

} // namespace

std::map<long long, std::string> find_sequence(const std::string& path) {
    const fs::path whole(path);
    const auto [before, after, digits] = pattern_of(whole);
    if (digits == 0) return {};
    std::map<long long, std::string> out;
    std::error_code ec;
    const fs::path folder = whole.has_parent_path() ? whole.parent_path() : fs::path(".");
    for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) {
        const std::string found = it->path().filename().string();
        if (found.size() < before.size() + digits + after.size()) continue;
        if (!found.starts_with(before) || !found.ends_with(after)) continue;
        const std::string number = found.substr(before.size(), found.size() - before.size() - after.size());
        const bool is_number = std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
        if (!is_number || (number.size() > digits && number.front() == '0')) continue;
        long long value = 0;
        const auto [rest, error] = std::from_chars(number.data(), number.data() + number.size(), value);
        if (error == std::errc()) out[value] = (whole.parent_path() / found).generic_string();
    }
    return out;
}

std::string near_sequence(const std::string& path) {
    constexpr std::size_t most_digits = 10;
    const auto [before, after, digits] = pattern_of(path);
    std::string out;
    std::size_t most = 0;
    for (std::size_t n = 1; digits > 0 && n <= most_digits; ++n) {
        const std::string other =
            fs::path(path).replace_filename(before + std::string(n, '#') + after).generic_string();
        if (const std::size_t count = find_sequence(other).size(); count > most) most = count, out = other;
    }
    return out;
}

} // namespace sinew::engine
