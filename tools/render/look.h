// How a body is painted, from what it is and what it is called. Shared by pictures and GLB materials.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <string_view>

namespace sinew::render {

enum class BodyKind { plain, bone, tissue, cloth };

/// "bone", "tissue" …; the word that output files carry.
std::string_view word_of(BodyKind kind);
/// BodyKind::plain for any other word.
BodyKind kind_of(std::string_view word);

struct Look {
    Eigen::Vector3f colour{0.5f, 0.5f, 0.5f}; ///< linear light
    float stripes = 0;                        ///< strength of the fibre grain, 0…1
    float gloss = 0.2f;                       ///< strength of the highlight, 0…1
};

/// Bones ivory, tissues muscle red (tendons and ligaments pale, by name), each a little different by `index`.
Look look_of(BodyKind kind, std::string_view name, int index);

/// sRGB component 0…1 -> linear light and back.
float to_linear(float srgb);
float to_srgb(float linear);

} // namespace sinew::render
