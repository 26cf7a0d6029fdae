// Where two edges are nearest to each other.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <algorithm>

namespace sinew::solver {

/// Shares along the two edges, 0 and 1 at their ends to the last bit, and the way from the second one's place to the
/// first one's.
struct SegmentPair {
    double s = 0, t = 0;
    Vec3 away = Vec3::Zero();
};

/// After Ericson, "Real-Time Collision Detection" (2005), 5.1.9. Of parallel edges one of the nearest pairs.
inline SegmentPair closest_of_segments(const Vec3& p0, const Vec3& p1, const Vec3& q0, const Vec3& q1) {
    constexpr double parallel = 1e-12; // squared sine
    const Vec3 u = p1 - p0, v = q1 - q0, w = p0 - q0;
    const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
    SegmentPair out;
    const double det = uu * vv - uv * uv;
    if (det > parallel * uu * vv) out.s = std::clamp((uv * vw - uw * vv) / det, 0.0, 1.0);
    out.t = vv > 0 ? (uv * out.s + vw) / vv : 0;
    if (!(out.t > 0 && out.t < 1)) {
        out.t = out.t >= 1 ? 1 : 0;
        out.s = uu > 0 ? std::clamp((out.t * uv - uw) / uu, 0.0, 1.0) : 0;
    }
    out.away = w + out.s * u - out.t * v;
    return out;
}

} // namespace sinew::solver
