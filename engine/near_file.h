// The file that somebody meant who named one that is not there.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace sinew::engine {

/// The name of the file in the folder of `path` that is nearest to it: the same in other letters, misspelt with the
/// same ending, or the same with one of the endings that are taken, in this order. Empty if none is near. Of a large
/// folder the first thousand are looked at.
std::string near_file(const std::filesystem::path& path, std::span<const std::string_view> endings);

} // namespace sinew::engine
