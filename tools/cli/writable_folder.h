// Output folders and files that are found to be of no use now rather than after a long run.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string_view>

namespace sinew::cli {

/// Makes the folder where it is missing. Throws Failure IO405 if nothing can be written into it.
/// \param flag  that names the folder, for the hint
void check_writable(const std::filesystem::path& folder, std::string_view flag);

/// The same, but makes nothing: for checks before it is known that there will be something to write.
void check_could_be_made(const std::filesystem::path& folder, std::string_view flag);

/// The same for a file; makes nothing.
void check_writable_file(const std::filesystem::path& file, std::string_view flag);

} // namespace sinew::cli
