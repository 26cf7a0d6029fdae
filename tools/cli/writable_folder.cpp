// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/writable_folder.h"

#include "engine/diagnostics.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <unistd.h>

namespace sinew::cli {

void check_writable(const std::filesystem::path& folder, std::string_view flag) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!error && access(folder.c_str(), W_OK) == 0) return;
    engine::Diagnostic d;
    d.code = "IO405";
    d.message = "cannot write into '" + folder.string() + "': " + (error ? error.message() : std::strerror(errno));
    d.hint = "choose another folder with " + std::string(flag);
    throw engine::Failure(d);
}

} // namespace sinew::cli
