// Fibres of a strip that begin on the whole of one of its sides, in closed form.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sinew::test {

/// A strip of length 4 about the origin, 1 high and deep. As many fibres begin everywhere on its lower side (y = -1/2),
/// end everywhere on the end x = 2, and pass no other side: X^2 / 2 - (1 - Y)^2 / 2 is harmonic, with X = x + 2 and
/// Y = y + 1/2, and its slope is 1 all over the lower side, 4 all over the end and 0 across the others.
inline solver::Vec3 side_fibre_gradient(const solver::Vec3& p) { return {p.x() + 2, 0.5 - p.y(), 0}; }

/// Root mean square over the strip of the angle between the tets' directions and the mean of the exact ones in what of
/// the tet lies in the strip [degrees].
inline double side_fibre_error(const solver::TetMesh& tets, const solver::Points& directions) {
    using solver::Vec3;
    constexpr int n = 12;
    double sum = 0, total = 0;
    for (std::size_t t = 0; t < tets.tets.size(); ++t) {
        const auto v = [&](std::size_t m) { return tets.vertices[static_cast<std::size_t>(tets.tets[t][m])]; };
        Vec3 mean = Vec3::Zero();
        for (int i = 0; i < n; ++i)
            for (int j = 0; i + j < n; ++j)
                for (int k = 0; i + j + k < n; ++k) {
                    const double a = (i + 0.25) / n, b = (j + 0.25) / n, c = (k + 0.25) / n;
                    const Vec3 p = a * v(0) + b * v(1) + c * v(2) + (1 - a - b - c) * v(3);
                    if (std::abs(p.x()) < 2 && std::abs(p.y()) < 0.5 && std::abs(p.z()) < 0.5)
                        mean += side_fibre_gradient(p).stableNormalized();
                }
        if (mean.isZero()) continue; // next to nothing is inside
        const double angle = std::acos(std::clamp(directions[t].dot(mean.normalized()), -1.0, 1.0)),
                     solid =
                         (tets.coverage.empty() ? 1 : tets.coverage[t]) * solver::tet_volume(v(0), v(1), v(2), v(3));
        sum += solid * angle * angle, total += solid;
    }
    return std::sqrt(sum / total) * 180 / std::numbers::pi;
}

} // namespace sinew::test
