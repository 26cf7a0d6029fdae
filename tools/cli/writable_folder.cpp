// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/writable_folder.h"

#include "engine/atomic_file.h"
#include "engine/diagnostics.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <unistd.h>

namespace sinew::cli {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& reason, const std::string& hint) {
    engine::Diagnostic d;
    d.code = "IO405";
    d.message = "cannot write " + std::string(hint.find("folder") != std::string::npos ? "into '" : "'") +
                path.string() + "': " + reason;
    d.hint = hint;
    throw engine::Failure(d);
}

/// Why nothing could be written into a folder, there or to be made; empty if something can.
std::string why_not(std::filesystem::path folder) {
    std::error_code error;
    while (!folder.empty() && !std::filesystem::exists(std::filesystem::status(folder, error))) {
        if (error && error != std::errc::no_such_file_or_directory) return error.message();
        folder = folder.has_relative_path() ? folder.parent_path() : std::filesystem::path();
    }
    if (folder.empty()) folder = ".";
    if (!std::filesystem::is_directory(folder, error)) return "'" + folder.string() + "' is a file";
    if (access(folder.c_str(), W_OK | X_OK) != 0) return std::strerror(errno);
    // Permissions are not all: /proc and read-only mounts refuse root too, and a full disk gives files but no room in
    // them. What is not committed leaves nothing.
    try {
        engine::AtomicFile probe(folder / ".sinew-probe");
        probe.write(std::string(4096, '\0'));
        probe.flush();
    } catch (const engine::Failure& failure) {
        const std::string& message = failure.diagnostics().front().message;
        return message.substr(message.rfind("': ") + 3);
    }
    return "";
}

} // namespace

void check_could_be_made(const std::filesystem::path& folder, std::string_view flag) {
    if (const std::string reason = why_not(folder); !reason.empty())
        refuse(folder, reason, "choose another folder with " + std::string(flag));
}

void check_writable_file(const std::filesystem::path& file, std::string_view flag) {
    const std::string hint = "choose another file with " + std::string(flag);
    if (file.filename().empty()) refuse(file, "it has no name", hint);
    std::error_code error;
    const auto there = std::filesystem::status(file, error);
    if (std::filesystem::is_directory(there)) refuse(file, "it is a directory", hint);
    if (engine::names_open_file(file)) return;
    if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there)) { // a device or a pipe
        if (access(file.c_str(), W_OK) != 0) refuse(file, std::strerror(errno), hint);
        return;
    }
    // Files are replaced by new ones, so what counts is the folder.
    if (const std::string reason = why_not(file.parent_path()); !reason.empty()) refuse(file, reason, hint);
    if (file.filename().native().size() > 200) refuse(file, "its name is too long", hint);
}

void check_writable(const std::filesystem::path& folder, std::string_view flag) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!error && access(folder.c_str(), W_OK) == 0) return;
    refuse(folder, error ? error.message() : std::strerror(errno), "choose another folder with " + std::string(flag));
}

} // namespace sinew::cli
