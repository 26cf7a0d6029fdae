// The file that somebody meant who named one that is not there.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

namespace sinew::engine {

/// The name of the file in the folder of `path` that is nearest to it: the same in other letters or with another
/// ending, or misspelt with the same ending. Empty if none is near. Of a large folder the first thousand are looked at.
std::string near_file(const std::filesystem::path& path);

} // namespace sinew::engine
