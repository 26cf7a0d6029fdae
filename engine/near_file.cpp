// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/near_file.h"

#include "engine/diagnostics.h"
#include "engine/text.h"

#include <algorithm>
#include <vector>

namespace sinew::engine {

namespace {

namespace fs = std::filesystem;

std::vector<std::string> files_beside(const fs::path& path) {
    constexpr std::size_t most = 1000;
    std::vector<std::string> out;
    std::error_code ec;
    const fs::path folder = path.parent_path();
    for (fs::directory_iterator it(folder.empty() ? "." : folder, ec), end; !ec && it != end && out.size() < most;
         it.increment(ec))
        if (it->is_regular_file(ec)) out.push_back(it->path().filename().string());
    std::sort(out.begin(), out.end());
    return out;
}

} // namespace

std::string near_file(const fs::path& path) {
    const std::vector<std::string> there = files_beside(path);
    const std::string name = path.filename().string(), stem = path.stem().string();
    for (const std::string& other : there)
        if (lower_case(other) == lower_case(name)) return other;
    for (const std::string& other : there)
        if (!stem.empty() && lower_case(fs::path(other).stem().string()) == lower_case(stem)) return other;
    // Endings say nothing of which of them is meant.
    std::vector<std::string> stems;
    for (const std::string& other : there)
        if (fs::path(other).extension() == path.extension()) stems.push_back(fs::path(other).stem().string());
    const std::string near = nearest_name(stem, stems);
    return near.empty() ? near : near + path.extension().string();
}

} // namespace sinew::engine
