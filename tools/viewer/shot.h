// A frame of a ViewScene as surfaces that tools/render draws: pictures show what the page shows.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/render/picture.h"
#include "tools/viewer/view_data.h"

#include <set>

namespace sinew::viewer {

/// All bodies that are there at `frame` (an index), labelled "frame N". With `overlays` (names of
/// shot_overlays.h) these are drawn too, and flesh lets them shine through.
render::Shot shot_of(const ViewScene& scene, std::size_t frame, const std::set<std::string>& overlays = {});

/// Leaves these bodies (indices) alone in the scene, with the attachments between them and the marks about some of
/// them; marks that are about nobody stay.
void keep_bodies(ViewScene& scene, const std::set<std::size_t>& kept);

} // namespace sinew::viewer
