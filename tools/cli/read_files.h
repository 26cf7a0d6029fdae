// The files that a command reads, so that none of them is written over by what it makes.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace sinew::cli {

class ReadFiles {
  public:
    /// The graph's own file, the graphs that it includes, and what its inputs name, numbered files each.
    void add(const engine::Graph& graph);
    /// A file, and what it is to the command: "a frame that is shown".
    void add(const std::filesystem::path& file, const std::string& role);
    /// Meshes of a folder that `sinew run --out` wrote.
    void add_folder(const std::filesystem::path& folder);
    /// Throws Failure IO420 if `file`, which need not be there, is one of them, by whatever name or link.
    /// \param flag that names it or the folder that it is in
    void check_kept(const std::filesystem::path& file, std::string_view flag) const;

  private:
    struct Entry {
        std::string file, role;
    };
    std::map<std::pair<std::uint64_t, std::uint64_t>, Entry> entries_; ///< by device and inode
};

} // namespace sinew::cli
