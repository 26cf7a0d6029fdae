// One animated GLB file (glTF 2.0) of a whole run. Bodies that move rigidly become animated nodes; bodies
// that deform get one morph target a frame, relative to the first one. Positions in metres, y up. Poses wait on disk
// while the run goes; memory does not grow with the frames but for some hundred bytes a body.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/file_access.h"
#include "tools/cli/glb_body.h"

#include <deque>
#include <filesystem>
#include <memory>

namespace sinew::cli {

struct GlbScene {
    double fps = 24, units_per_metre = 1;
    char up = 'y'; ///< of the scene: 'y' or 'z'
};

/// What a body costs in the file.
struct GlbCost {
    std::size_t shading_vertices = 0, triangles = 0;
    bool deforms = false; ///< its vertices are written once a frame
};

/// Bytes of a file of these bodies, but for its JSON part, of which a share is estimated.
double glb_size(const std::vector<GlbCost>& bodies, std::size_t frames);
/// Tissue and cloth count as deforming; whether a plain body or a bone does shows as its poses come.
GlbCost glb_cost(render::BodyKind kind, const solver::Points& points, const std::vector<solver::Triangle>& triangles);
/// Throws engine::Failure IO405 where that is more than the 4 GB that the format has; says how many frames fit.
void check_glb_size(const std::vector<GlbCost>& bodies, std::size_t frames);

class GlbFile {
  public:
    /// Nothing is on disk yet. Poses will wait beside `file`.
    GlbFile(std::filesystem::path file, const GlbScene& scene, engine::FileAccess files = {});

    /// Bodies without triangles are left out of the file, because glTF has no empty meshes.
    /// \param first  pose, which is to be added too
    std::size_t add_body(std::string name, render::BodyKind kind, std::vector<solver::Triangle> triangles,
                         const GlbBody::Pose& first, const render::Appearance& appearance = {});
    /// Frames rise; all poses of a body are of one length. Throws engine::Failure IO405.
    void add_pose(std::size_t body, int frame, const GlbBody::Pose& pose);
    /// What the bodies cost; those deform too of which poses of two shapes were added.
    std::vector<GlbCost> costs() const;
    /// Puts the file in place with the frames that all bodies have. False, and no file, without any. Throws
    /// engine::Failure IO405, also above 4 GB.
    bool finish();

  private:
    std::filesystem::path file_;
    engine::FileAccess files_;
    GlbScene scene_;
    std::vector<int> frames_;
    std::deque<GlbBody> bodies_;
    std::unique_ptr<SpillFile> spill_;
};

} // namespace sinew::cli
