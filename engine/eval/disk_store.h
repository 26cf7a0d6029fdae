// Bytes on disk under their keys: one file each, whole or not there, so that several processes may share a folder.
// Knows neither nodes nor values; what is kept (outputs today) gives it a key and bytes.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/diagnostics.h"
#include "engine/digest.h"
#include "engine/file_access.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::engine {

/// Why nothing is kept in `folder`: that it, or what it shall be in, is a file; else what the failure says.
FileFault why_not_kept(const std::filesystem::path& folder, const Failure& failure);

/// What Digest::hex wrote; nothing for other texts.
std::optional<Digest> key_of(std::string_view hex);

/// Thread-safe. The folder is made when the first file is written.
class DiskStore {
  public:
    /// \param ending of the files' names; stores of different things share a folder by theirs
    /// \param files Throws Failure IO410 where the folder is outside of its root.
    explicit DiskStore(std::filesystem::path folder, std::string ending = ".kept", FileAccess files = {})
        : folder_(std::move(folder))
        , ending_(std::move(ending))
        , files_(std::move(files)) {
        files_.check(folder_, "the cache folder");
    }
    const std::filesystem::path& folder() const { return folder_; }
    std::filesystem::path file_of(const Digest& key) const;

    struct Found {
        std::optional<std::vector<std::byte>> payload;
        std::vector<std::byte> tail; ///< empty if it was not asked for
        std::string fault; ///< a file is there and cannot be used: why. Without payload and fault there is none.
    };
    /// Checks mark, key, lengths and the checksum of each part that is read.
    /// \param with_tail else that part of the file is not read
    /// \param room memory for the payload, if it is large enough; what it holds does not matter
    Found read(const Digest& key, bool with_tail = false, std::vector<std::byte> room = {}) const;
    /// Keys of all files in the folder; none if it cannot be listed.
    std::vector<Digest> newest_first() const;
    bool contains(const Digest& key) const;
    /// Replaces what is there. Throws Failure IO405, and then what was there is untouched.
    /// \param waits until it is on the disk, and so outlives a power cut
    /// \param tail what not all who read the file need
    void write(const Digest& key, std::span<const std::byte> payload, bool waits = true,
               std::span<const std::byte> tail = {}) const;
    /// Of the file that it would make.
    static std::uintmax_t file_size(std::size_t payload, std::size_t tail);
    /// What is there counts as used then, for whoever makes room.
    void touch(const Digest& key, std::filesystem::file_time_type when) const;
    void touch(const Digest& key) const { touch(key, std::filesystem::file_time_type::clock::now()); }

  private:
    std::filesystem::path folder_;
    std::string ending_;
    FileAccess files_;
};

} // namespace sinew::engine
