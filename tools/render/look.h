// How a body is painted, from what it is said to be made of. Shared by pictures, the viewer and GLB materials.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/appearance.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <string_view>

namespace sinew::render {

enum class BodyKind { plain, bone, tissue, cloth };

/// "bone", "tissue" …; the word that output files carry.
std::string_view word_of(BodyKind kind);
/// BodyKind::plain for any other word.
BodyKind kind_of(std::string_view word);

/// What a graph or a file says of a body's look; where it says nothing, tissues are muscle, bones bone.
struct Appearance {
    std::optional<nodes::Matter> matter;
    std::optional<Eigen::Vector3f> colour; ///< sRGB, 0…1
};

/// The matter that is painted.
nodes::Matter matter_of(BodyKind kind, const Appearance& appearance);
/// The matter that a file's word names; none for any other word.
std::optional<nodes::Matter> matter_of(std::string_view word);

struct Look {
    Eigen::Vector3f colour{0.5f, 0.5f, 0.5f}; ///< linear light
    float stripes = 0;                        ///< strength of the fibre grain, 0…1
    float gloss = 0.2f;                       ///< strength of the highlight, 0…1
};

/// Bodies of one matter without a colour of their own differ a little by `index`; plain ones much.
Look look_of(BodyKind kind, const Appearance& appearance, int index);

/// "#c8553d" of an sRGB colour, and back; none where the text is no such colour.
std::string hex_of(const Eigen::Vector3f& srgb);
std::optional<Eigen::Vector3f> colour_of(std::string_view hex);

/// sRGB component 0…1 -> linear light and back.
float to_linear(float srgb);
float to_srgb(float linear);

} // namespace sinew::render
