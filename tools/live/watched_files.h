// Which files a graph reads, and whether one of them has changed since it was last looked at.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sinew::live {

/// The file that an input names, or each of the numbered files. Empty for the empty path, and for what `files` does not
/// open.
std::vector<std::string> files_named_by(const std::string& path, const engine::FileAccess& files);

/// The graph file itself, the graphs that it includes, and every file that an input names; numbered files each, and
/// their folder.
std::vector<std::string> files_of(const engine::Graph& graph);

/// `file` and the graphs that it says it includes, for a graph that cannot be read: what can be read of each counts.
/// What `files` refuses is not looked at.
std::vector<std::string> graphs_named_in(const std::string& file, const engine::FileAccess& files = {});

/// What tells a file from what it was: editors that write aside and rename are seen as well.
struct FileStamp {
    std::int64_t seconds = 0, nanoseconds = 0, size = 0; ///< time of change
    std::uint64_t inode = 0;
    bool operator==(const FileStamp&) const = default;
};
/// None: it is not there.
std::optional<FileStamp> stamp_of(const std::string& file);

class WatchedFiles {
  public:
    /// Files that were watched before keep what was last seen of them.
    void watch(const std::vector<std::string>& files);
    /// Files that are not as they were, are gone or are back; each is told once.
    std::vector<std::string> take_changed();

  private:
    std::map<std::string, std::optional<FileStamp>> seen_; ///< none: it was never there
};

} // namespace sinew::live
