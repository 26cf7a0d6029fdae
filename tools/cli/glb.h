// One animated GLB file (glTF 2.0) of a whole run. Bodies that move rigidly become animated nodes; bodies
// that deform get one morph target a frame, relative to the first one. Positions in metres, y up.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"
#include "tools/render/look.h"

#include <memory>
#include <string>
#include <vector>

namespace sinew::cli {

struct AnimatedBody {
    std::string name;
    render::BodyKind kind = render::BodyKind::plain;
    std::vector<solver::Triangle> triangles;
    std::vector<std::shared_ptr<const solver::Points>> poses; ///< one a frame, scene units, all of one length
    render::Appearance appearance = {};
};

struct Animation {
    double fps = 24;
    std::vector<int> frames; ///< rising
    double units_per_metre = 1;
    char up = 'y'; ///< of the scene: 'y' or 'z'
    std::vector<AnimatedBody> bodies;
};

/// The bytes of the file. Bodies without triangles are left out, because glTF has no empty meshes. Throws
/// engine::Failure IO405 above 4 GB.
std::string encode_glb(const Animation& animation);

} // namespace sinew::cli
