// The file that somebody meant who named one that is not there.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::engine {

/// Names of the files in a folder, sorted; of a large one the first thousand that it gives. Empty: where one is.
std::vector<std::string> files_in(const std::filesystem::path& folder);

/// The name of the file in the folder of `path` that is nearest to it: the same in other letters, misspelt with the
/// same ending, or the same with one of the endings that are taken, in this order. Empty if none is near. It looks as
/// far as files_in does.
std::string near_file(const std::filesystem::path& path, std::span<const std::string_view> endings);

} // namespace sinew::engine
