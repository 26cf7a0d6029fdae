// Files that are there whole or not at all. While a file is being written it has no name (O_TMPFILE), so even
// a killed program leaves nothing half-made; where the file system cannot do that, a temporary name in the
// same folder is used and removed again.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/file_access.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace sinew::engine {

/// Puts `bytes` at `path`, over an older file if there is one; makes missing folders. Throws Failure
/// IO405 (with the system's reason) or IO410 (`files` is confined, and links counted), and then the older file is
/// untouched.
void write_file(const std::filesystem::path& path, std::string_view bytes, const FileAccess& files = {});

/// The same for what may be lost in a power cut, as long as it is whole or not there as far as programs see: it does
/// not wait for the disk. For caches that check what they read.
void write_file_soon(const std::filesystem::path& path, std::string_view bytes, const FileAccess& files = {});

/// Throws Failure IO405: `path` cannot be written, and why.
[[noreturn]] void fail_to_write(const std::filesystem::path& path, const std::string& reason);

/// Whether `path` names what this program has open, as /dev/stdout and /dev/fd/1 do: that is written on, wherever it
/// leads.
bool names_open_file(const std::filesystem::path& path);

/// The same for content that comes piece by piece. Devices and pipes take the pieces as they come.
class AtomicFile {
  public:
    /// Makes missing folders. Throws Failure IO405, IO410.
    explicit AtomicFile(const std::filesystem::path& path, const FileAccess& files = {});
    ~AtomicFile(); ///< without `commit` nothing is left
    AtomicFile(const AtomicFile&) = delete;
    void write(std::string_view bytes);
    /// Hands the system what was written so far. Throws Failure IO405 where there is no room for it.
    void flush();
    /// The file is on the disk, then in its place.
    void commit() { commit(true); }
    /// \param waits for the disk
    void commit(bool waits);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The name of the file that a temporary file of that name becomes when it is whole; nothing for other names.
std::optional<std::filesystem::path> finished_name(const std::filesystem::path& temporary);
/// Whether a temporary file is left by a process that is gone, and nobody has written to it for an hour (other machines
/// may share the folder).
bool is_abandoned(const std::filesystem::path& temporary);

/// Removes what a program that was killed has left of `path` on a file system that has no files without names.
void remove_abandoned(const std::filesystem::path& path);

} // namespace sinew::engine
