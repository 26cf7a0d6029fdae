// The data part of a page: a JSON header that names blocks. The other side is page/src/scene_data.js.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/viewer/block.h"
#include "tools/viewer/view_data.h"

#include <string>
#include <vector>

namespace sinew::viewer {

struct PageData {
    std::string header; ///< JSON without '<', so that it can stand in HTML
    std::vector<Block> blocks;
};

/// `other`: a second run to compare with, under "other" in the header; may be null.
PageData page_data(const ViewScene& scene, const ViewScene* other = nullptr);

} // namespace sinew::viewer
