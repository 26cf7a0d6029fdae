// A run as one HTML file: opens from disk, asks nothing of the network. The script and the style come from
// asset/, which is part of the program; the data follows as compressed blocks.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/viewer/view_data.h"

#include <filesystem>
#include <optional>
#include <string>

namespace sinew::viewer {

struct PageOptions {
    /// Above this many bytes of positions (before compression) frames are left out, evenly, and a note says
    /// so.
    std::size_t most_motion_bytes = std::size_t{256} << 20;
};

struct Page {
    std::string html;
    std::size_t motion_bytes = 0, packed_bytes = 0; ///< positions before and all data after compression
    std::size_t asset_bytes = 0;                    ///< script and style
    std::vector<ViewNote> notes;                    ///< the scene's and those made here
};

/// True for a page in `file` that was made from a graph: it may hold more than the meshes beside it.
bool holds_evaluated_page(const std::filesystem::path& file);

/// `other`: a second run, which the page shows beside the first and as the difference between the two.
Page write_page(ViewScene scene, const PageOptions& options = {}, std::optional<ViewScene> other = {});

/// "3.4 MB".
std::string size_text(std::size_t bytes);

} // namespace sinew::viewer
