// Content digests of files on disk, read once for each (path, size, time of change).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/digest.h"
#include "engine/file_access.h"

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <variant>

namespace sinew::engine {

using FileContents = std::map<std::string, std::variant<Digest, FileFault>>;

/// Thread-safe. A file that changes without changing size and time of change is not noticed.
class FileDigests {
  public:
    /// Of a path that names numbered files (file_sequence.h): of all of them, with their numbers.
    std::variant<Digest, FileFault> of(const std::string& path, const FileAccess& files = {});

  private:
    std::variant<Digest, FileFault> of_sequence(const std::string& path, const FileAccess& files);
    std::variant<Digest, FileFault> of_file(const std::string& path, const FileAccess& files);
    struct Row {
        std::uintmax_t size;
        std::int64_t changed;
        Digest content;
    };
    std::mutex mutex_;
    std::map<std::string, Row> rows_;
};

} // namespace sinew::engine
