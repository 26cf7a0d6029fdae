// Tets that carry the points of a surface, and how wide they are: what the surface's triangles are measured against.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/embedding.h"

namespace sinew::solver {

/// Immutable; queries are thread-safe. The mesh must outlive it.
class CarrierTets {
  public:
    explicit CarrierTets(const TetMesh& mesh); ///< Throws Error FE201 (no tets).
    /// The tet that carries a point, and the point's coordinates in it (extrapolated outside of all tets).
    int locate(const Vec3& p, std::array<double, 4>& barycentric) const { return locator_.locate(p, barycentric); }
    /// How wide the tet that carries p is along a direction (its extent), but at least a quarter of its longest edge,
    /// so that a sliver does not ask for a fine surface; and at least p's distance from it: what is far away need not
    /// be finer than that.
    double width(const Vec3& p, const Vec3& unit_direction) const;
    /// No width is smaller.
    double least_width() const { return least_width_; }
    const TetMesh& mesh() const { return mesh_; }

  private:
    const TetMesh& mesh_;
    TetLocator locator_;
    std::vector<double> floor_; ///< a quarter of each tet's longest edge
    double least_width_;
};

} // namespace sinew::solver
