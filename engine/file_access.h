// The door through which files are opened that a graph names: included graphs, meshes, numbered files, motion, maps.
// A host that runs graphs of others confines it to one folder.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace sinew::engine {

/// Why a file is not opened: a code (IO401, IO402, IO410, IO412), words that name the file, what would be right.
struct FileFault {
    std::string code, message, hint = {};
};

/// A regular file that is open for reading.
class OpenFile {
  public:
    explicit OpenFile(int descriptor)
        : descriptor_(descriptor) {}
    OpenFile(OpenFile&& other) noexcept
        : descriptor_(std::exchange(other.descriptor_, -1)) {}
    OpenFile& operator=(OpenFile&&) = delete;
    ~OpenFile();
    /// How many bytes came; 0 at the end, -1 where the system fails (errno).
    std::ptrdiff_t read(std::span<char> into) const;
    std::uintmax_t size() const; ///< [bytes]

  private:
    int descriptor_;
};

class FileAccess {
  public:
    /// No file may be larger [bytes]: all of a file is held in memory.
    static constexpr std::uintmax_t most_bytes = std::uintmax_t{8} << 30;

    FileAccess() = default; ///< to files anywhere
    /// Only to what lies in `folder`, by its real place: neither "..", nor an absolute path, nor a symbolic link leads
    /// out of it. Throws Failure IO411 where it is no folder.
    static FileAccess within(const std::filesystem::path& folder);
    bool is_confined() const { return !root_.empty(); }
    const std::filesystem::path& root() const { return root_; } ///< absolute, without links; empty: anywhere

    /// IO410 if `path`, there or not, is outside of the root.
    std::optional<FileFault> refusal(const std::filesystem::path& path) const;
    /// The same as Failure. `what` the path is: "--out", "the graph file".
    void check(const std::filesystem::path& path, std::string_view what) const;
    /// Faults IO401 (missing), IO402 (no file, or unreadable), IO410, IO412 (too large). What is confined is the open
    /// file, so a link that changes meanwhile does not lead out either.
    std::variant<OpenFile, FileFault> open(const std::string& path) const;
    /// All bytes; at most `most`.
    std::variant<std::string, FileFault> read(const std::string& path, std::uintmax_t most = most_bytes) const;

  private:
    std::filesystem::path root_;
};

} // namespace sinew::engine
