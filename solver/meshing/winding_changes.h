// How a closed surface's winding number changes along straight ways: by counting the triangles they go through.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/bvh.h"
#include "solver/meshing/leaf_corners.h"
#include "solver/types.h"

#include <optional>
#include <vector>

namespace sinew::solver {

/// Around a surface whose edges cancel the winding number is whole and changes by one at each triangle. Counting these
/// along a short way meets what is near of it alone, where the winding number itself is a sum over all triangles that
/// are not far away, as those of long thin ones never are.
class WindingChanges {
  public:
    WindingChanges(const Points& points, const std::vector<Triangle>& triangles);

    /// The triangles that ways between some places can go through, and some beside them. Where triangles are long
    /// and lie askew most have boxes that meet, so that places that lie together had better be seen at once.
    std::vector<int> near(const Points& places) const;

    /// The winding number at `to` less that at `from`, which are among the places. Nothing where rounding does not let
    /// tell whether a triangle is gone through, as at its edges.
    std::optional<int> along(const Vec3& from, const Vec3& to, const std::vector<int>& near) const;

  private:
    const Points& points_;
    const std::vector<Triangle>& triangles_;
    Bvh tree_;
    LeafCorners corners_;
    double extent_; ///< no two points of the surface are farther apart
};

} // namespace sinew::solver
