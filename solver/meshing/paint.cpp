// Where and how far a lattice is refined.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/paint.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/meshing/lattice_cells.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sinew::solver {
namespace {

/// Products like 0.1 * 30 may exceed their whole number by rounding.
constexpr double rounding = 1e-9;

int round_up(double levels) { return static_cast<int>(std::ceil(std::min(levels, 64.0) - rounding)); }

} // namespace

Paint::Paint(const Solid& solid, const std::vector<double>& levels, double propagation)
    : solid_(solid)
    , propagation_(propagation) {
    const std::size_t count = solid.points.size();
    if (levels.size() > 1 && levels.size() != count)
        throw Error("FE204",
                    std::to_string(levels.size()) + " refinement levels for a mesh of " + std::to_string(count) +
                        " vertices",
                    "give one per vertex, one for all, or none");
    if (!(propagation >= 0 && propagation <= 1))
        throw Error("FE222", "the refinement's propagation must lie in 0 to 1");
    for (double l : levels)
        if (!(l >= 0) || !std::isfinite(l)) throw Error("FE222", "refinement levels must be finite and not negative");
    if (levels.empty()) return;
    levels_.assign(count, 0.0);
    for (std::size_t v = 0; v < count; ++v) {
        double& place = levels_[at(solid.place[v])];
        place = std::max(place, levels.size() == 1 ? levels[0] : levels[v]);
    }
    for (const Triangle& t : solid.triangles)
        for (int v : t) highest_ = std::max(highest_, round_up(levels_[at(v)]));
}

bool Paint::wants_more(int level, int triangle, const BarycentricTriangle& in_tet) const {
    if (level >= highest_) return false;
    const Triangle& corners = solid_.triangles[at(triangle)];
    const double threshold = level + rounding;
    std::array<double, 3> above;
    int count = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        above[c] = levels_[at(corners[c])] - threshold;
        count += above[c] > 0;
    }
    if (count == 0) return false;
    if (count == 3) return touches_tet(in_tet, touch_slack);
    // The part of the triangle above the threshold: a triangle, or a quadrangle as two.
    std::array<std::array<double, 4>, 4> part;
    std::size_t size = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t next = (c + 1) % 3;
        if (above[c] > 0) part[size++] = in_tet[c];
        if ((above[c] > 0) == (above[next] > 0)) continue;
        const double t = above[c] / (above[c] - above[next]);
        for (std::size_t k = 0; k < 4; ++k) part[size][k] = in_tet[c][k] + t * (in_tet[next][k] - in_tet[c][k]);
        ++size;
    }
    return touches_tet({part[0], part[1], part[2]}, touch_slack) ||
           (size == 4 && touches_tet({part[0], part[2], part[3]}, touch_slack));
}

int Paint::level_inside(double levels) const {
    return static_cast<int>(std::floor(propagation_ * round_up(levels) + 0.5 + rounding));
}

bool Paint::wants_more_inside(int level, const Vec3& middle) const {
    if (highest_inside() <= level) return false;
    const ClosestPoint nearest = solid_.tree.closest(middle);
    const Triangle& corners = solid_.triangles[at(nearest.triangle)];
    double levels = 0;
    for (int c = 0; c < 3; ++c) levels += nearest.barycentric[c] * levels_[at(corners[at(c)])];
    return level_inside(levels) > level;
}

int Paint::least_inside(int level, const Vec3& middle, double radius) const {
    if (highest_inside() <= level) return level;
    // A place of the ball is at most the radius farther from the triangle that is closest to the middle, and the one
    // closest to the place by as much again nearer to it. Mixing a triangle's levels may round them down.
    double least = highest_;
    for (const int t : solid_.tree.all_closest(middle, 2.001 * radius))
        for (const int v : solid_.triangles[at(t)]) least = std::min(least, levels_[at(v)] - 1e-12);
    return std::max(level, level_inside(std::max(least, 0.0)));
}

} // namespace sinew::solver
