// Files that are there whole or not at all. While a file is being written it has no name (O_TMPFILE), so even
// a killed program leaves nothing half-made; where the file system cannot do that, a temporary name in the
// same folder is used and removed again.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string_view>

namespace sinew::engine {

/// Puts `bytes` at `path`, over an older file if there is one; makes missing folders. Throws Failure
/// IO405 (with the system's reason), and then the older file is untouched.
void write_file(const std::filesystem::path& path, std::string_view bytes);

} // namespace sinew::engine
