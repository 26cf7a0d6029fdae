// Tets, fibres, attachments and marks of a frame as coloured lines for tools/render, in the colours of the page.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/render/picture.h"
#include "tools/viewer/view_data.h"

#include <set>
#include <string>

namespace sinew::viewer {

/// "lattice", "fibers", "attachments" and "marks".
const std::set<std::string>& overlay_names();

/// Lines of the overlays in `names` at `frame` (an index). What a scene does not have gives none.
std::vector<render::Segment> overlay_segments(const ViewScene& scene, std::size_t frame,
                                              const std::set<std::string>& names);

} // namespace sinew::viewer
