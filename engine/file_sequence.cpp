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

std::map<long long, std::string> find_sequence(const std::string& path) {
    const fs::path whole(path);
    const std::string name = whole.filename().string();
    const std::size_t last = name.rfind('#');
    if (last == std::string::npos) return {};
    std::size_t first = last;
    while (first > 0 && name[first - 1] == '#') --first;
    const std::string before = name.substr(0, first), after = name.substr(last + 1);
    const std::size_t digits = last + 1 - first;
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

} // namespace sinew::engine
