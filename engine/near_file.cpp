// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/near_file.h"

#include "engine/diagnostics.h"
#include "engine/text.h"

#include <algorithm>

namespace sinew::engine {

namespace fs = std::filesystem;

std::vector<std::string> files_in(const fs::path& folder) {
    constexpr std::size_t most = 1000; // of a folder that holds anything, it is not worth while to look at all
    std::vector<std::string> out;
    std::error_code ec;
    for (fs::directory_iterator it(folder.empty() ? "." : folder, ec), end; !ec && it != end && out.size() < most;
         it.increment(ec))
        if (it->is_regular_file(ec)) out.push_back(it->path().filename().string());
    std::sort(out.begin(), out.end());
    return out;
}

std::string near_file(const fs::path& path, std::span<const std::string_view> endings) {
    const std::vector<std::string> there = files_in(path.parent_path());
    const std::string name = path.filename().string(), stem = path.stem().string();
    const auto ending_of = [](const std::string& file) { return lower_case(fs::path(file).extension().string()); };
    for (const std::string& other : there)
        if (lower_case(other) == lower_case(name)) return other;
    // Endings say nothing of which of them is meant.
    std::vector<std::string> alike, stems;
    for (const std::string& other : there)
        if (ending_of(other) == ending_of(name))
            alike.push_back(other), stems.push_back(fs::path(other).stem().string());
    const std::string near = nearest_name(stem, stems);
    if (!near.empty())
        return alike[static_cast<std::size_t>(std::find(stems.begin(), stems.end(), near) - stems.begin())];
    for (const std::string& other : there)
        if (!stem.empty() && lower_case(fs::path(other).stem().string()) == lower_case(stem) &&
            std::find(endings.begin(), endings.end(), ending_of(other)) != endings.end())
            return other;
    return {};
}

} // namespace sinew::engine
