// One body of an animated GLB file while the run goes: its poses wait in a spill file, and what is kept in memory of
// each is its place there and its bounds.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"
#include "tools/cli/rigid_motion.h"
#include "tools/cli/spill_file.h"
#include "tools/render/look.h"
#include "tools/render/shading_mesh.h"

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace sinew::cli {

/// Least and largest of each component, as stored.
struct FloatBounds {
    std::array<float, 3> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    void add(float value, std::size_t component);
};

class GlbBody {
  public:
    using Pose = std::shared_ptr<const solver::Points>;

    /// \param first  the pose that others are compared with; not added by this
    GlbBody(std::string name, render::BodyKind kind, std::vector<solver::Triangle> triangles, const Pose& first,
            double units_per_metre, const render::Appearance& appearance = {});
    /// Where it throws engine::Failure IO405, the body is as it was before.
    void add(const Pose& pose, SpillFile& spill);

    const std::string& name() const { return name_; }
    render::BodyKind kind() const { return kind_; }
    const render::Appearance& appearance() const { return appearance_; }
    const std::vector<solver::Triangle>& triangles() const { return triangles_; }
    const render::ShadingMesh& shading() const { return shading_; }
    std::size_t poses() const { return poses_; }

    /// Among the first `poses` (of a body with triangles): do they have one shape, and do they differ at all?
    bool is_rigid(std::size_t poses) const { return rigid_.size() >= poses; }
    bool moves(std::size_t poses) const { return first_moved_ < poses; }
    const std::vector<RigidPose>& rigid_poses() const { return rigid_; }
    /// Of the vertices in the file: scene units where the body is rigid, else zero.
    solver::Vec3 pivot(std::size_t poses) const;

    /// The first pose: positions and normals of shading vertices, in metres about the pivot.
    std::vector<float> base_positions(std::size_t poses) const;
    std::vector<float> base_normals(std::size_t poses) const;
    FloatBounds base_bounds(std::size_t poses) const;
    /// A later pose, as differences from the first one.
    const FloatBounds& target_bounds(std::size_t pose) const { return stored_.at(pose - 1).bounds; }
    struct Target {
        std::vector<float> positions, normals;
    };
    Target target(std::size_t pose, const SpillFile& spill) const;

  private:
    struct Stored {
        std::uint64_t place = 0;
        FloatBounds bounds;
    };
    solver::Points metres(const solver::Points& points, const solver::Vec3& pivot) const;

    std::string name_;
    render::BodyKind kind_;
    render::Appearance appearance_;
    double units_per_metre_;
    std::vector<solver::Triangle> triangles_;
    render::ShadingMesh shading_;
    Pose first_, last_;
    std::vector<float> base_, base_normals_; ///< where the body is not rigid
    std::unique_ptr<RigidFit> fit_;          ///< null from the first pose of another shape on
    std::vector<RigidPose> rigid_;           ///< of the poses before that
    std::vector<Stored> stored_;             ///< of the second pose and all later ones
    std::size_t poses_ = 0, first_moved_ = static_cast<std::size_t>(-1);
};

} // namespace sinew::cli
