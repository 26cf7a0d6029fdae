// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/surface/carrier_tets.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {
namespace {

constexpr double floor_share = 0.25;

struct Corners {
    Vec3 p[4];
    Corners(const TetMesh& mesh, std::size_t tet) {
        for (std::size_t k = 0; k < 4; ++k) p[k] = mesh.vertices[static_cast<std::size_t>(mesh.tets[tet][k])];
    }
    double longest_edge() const {
        double longest = 0;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < i; ++j) longest = std::max(longest, (p[i] - p[j]).norm());
        return longest;
    }
    double height(int corner) const {
        const Vec3 &a = p[(corner + 1) % 4], &b = p[(corner + 2) % 4], &c = p[(corner + 3) % 4];
        const double area = (b - a).cross(c - a).norm();
        return area > 0 ? std::abs((p[corner] - a).dot((b - a).cross(c - a))) / area : 0;
    }
};

} // namespace

CarrierTets::CarrierTets(const TetMesh& mesh)
    : mesh_(mesh)
    , locator_(mesh)
    , floor_(mesh.tets.size())
    , least_width_(1e300) {
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const Corners corners(mesh, t);
        floor_[t] = floor_share * corners.longest_edge();
        // A tet's least extent is between two faces or edges; half of the least height is below both.
        double height = 1e300;
        for (int k = 0; k < 4; ++k) height = std::min(height, corners.height(k));
        least_width_ = std::min(least_width_, std::max(floor_[t], 0.5 * height));
    }
}

double CarrierTets::width(const Vec3& p, const Vec3& unit_direction) const {
    std::array<double, 4> b;
    const auto tet = static_cast<std::size_t>(locator_.locate(p, b));
    const Corners corners(mesh_, tet);
    double low = 1e300, high = -1e300, outside = 0;
    for (int k = 0; k < 4; ++k) {
        const double along = unit_direction.dot(corners.p[k]);
        low = std::min(low, along), high = std::max(high, along);
        if (b[static_cast<std::size_t>(k)] < 0)
            outside = std::max(outside, -b[static_cast<std::size_t>(k)] * corners.height(k));
    }
    return std::max({high - low, floor_[tet], outside});
}

} // namespace sinew::solver
