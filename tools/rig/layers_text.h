// Starting graphs of two more kinds: a cloth over bodies, and layers of tissue, fascia and skin.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/rig/part_text.h"

#include <string>
#include <vector>

namespace sinew::rig {

/// `bodies` as bones, and `cloth` over them. Notes: DG162 for a cloth that begins inside a body. Throws
/// engine::Failure: as read_parts, DG151, FE2xx for a body that cannot be closed, DG161 for a mesh that can be no
/// cloth; std::invalid_argument for options.
Rig guess_cloth(const std::vector<std::string>& bodies, const std::string& cloth, const GuessOptions& options);
std::string cloth_text(const Rig& rig, const TextOptions& options);

struct LayerFiles {
    std::vector<std::string> bones, tissues;
    std::string fascia, skin; ///< empty: made around what is below
};
/// Parts: the bones, then the tissues, then fascia and skin as far as they are given.
struct Layers {
    Rig rig;
    std::vector<std::size_t> tissues;
    int fascia = -1, skin = -1; ///< places among the parts; -1: made around what is below
    double reach = 0;           ///< of attachments, in scene units
    struct Holder {
        std::size_t bone = 0; ///< place among the parts
        double gap = 0;       ///< smallest distance to it
        double reach = 0; ///< what is so much farther is held fully, twice as much not at all; never the whole surface
    };
    std::vector<std::vector<Holder>>
        holders;                   ///< of each tissue: bones that it touches, or all that are near if it touches none
    double tet_size = 0;           ///< of fascia and skin
    std::vector<double> tet_sizes; ///< of the tissues
};
/// Notes: DG155 for a tissue that is tied to bones over a gap, DG158 for one that no bone is near to.
/// Throws engine::Failure: as read_parts, DG151, DG156 without bones, DG158 for tissues of which none is near a bone;
/// std::invalid_argument for options; solver::Stopped.
Layers guess_layers(const LayerFiles& files, const GuessOptions& options);
std::string layers_text(const Layers& layers, const TextOptions& options);

} // namespace sinew::rig
