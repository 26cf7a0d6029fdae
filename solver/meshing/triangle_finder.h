// Which of a solid's triangles touch a tet.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/index.h"
#include "solver/mesh/bvh.h"
#include "solver/meshing/tet_share.h"

#include <algorithm>

namespace sinew::solver {

/// Finds them by their boxes, then exactly. The solid must outlive it.
class TriangleFinder {
  public:
    explicit TriangleFinder(const Solid& solid)
        : solid_(solid) {
        for (std::size_t t = 0; t < solid.triangles.size(); ++t) numbers_.push_back(static_cast<int>(t));
        build();
    }
    /// Over some of the triangles only.
    TriangleFinder(const Solid& solid, std::vector<int> triangles)
        : solid_(solid)
        , numbers_(std::move(triangles)) {
        build();
    }

    /// Those that touch the tet, in increasing order.
    std::vector<int> touching(const std::array<Vec3, 4>& corners) const {
        Vec3 low = corners[0], high = corners[0];
        for (const Vec3& c : corners) low = low.cwiseMin(c), high = high.cwiseMax(c);
        const Vec3 margin = Vec3::Constant(4 * touch_slack * (high - low).maxCoeff());
        std::vector<int> found;
        for (const int item : items_near(bvh_, low - margin, high + margin)) found.push_back(numbers_[at(item)]);
        std::sort(found.begin(), found.end());
        return touching_triangles(solid_, corners, found);
    }

  private:
    void build() {
        Points low, high;
        for (const int number : numbers_) {
            const Triangle& t = solid_.triangles[at(number)];
            const Vec3 &a = solid_.points[at(t[0])], &b = solid_.points[at(t[1])], &c = solid_.points[at(t[2])];
            low.push_back(a.cwiseMin(b).cwiseMin(c));
            high.push_back(a.cwiseMax(b).cwiseMax(c));
        }
        bvh_ = build_bvh(low, high);
    }
    const Solid& solid_;
    std::vector<int> numbers_;
    Bvh bvh_;
};

inline std::array<Vec3, 4> corners_of(const Points& vertices, const Tet& tet) {
    std::array<Vec3, 4> out;
    for (std::size_t c = 0; c < 4; ++c) out[c] = vertices[at(tet[c])];
    return out;
}

} // namespace sinew::solver
