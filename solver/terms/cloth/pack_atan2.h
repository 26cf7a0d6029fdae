// The angle of four points in the plane, in (-pi, pi], within two roundings: an arc tangent of at most a quarter of a
// right angle, whose polynomial is the interpolation at Chebyshev's nodes of (atan t - t)/t^3 in t^2, and what symmetry
// makes of it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/simd.h"

namespace sinew::solver {

/// 0 at the origin.
inline Pack atan2(Pack y, Pack x) {
    constexpr double terms[] = {-0.3333333333333333,  0.1999999999999552,   -0.14285714284666534, 0.11111111015255669,
                                -0.09090904578095735, 0.07692183190171728,  -0.06664511438164644, 0.05858148832731273,
                                -0.05085449318930035, 0.039231646190551486, -0.019176872294336067};
    constexpr double eighth = 0.41421356237309503, pi = 3.141592653589793; // the tangent of pi/8
    const Pack zero(0.0), across = abs(x), up = abs(y);
    const Pack low = select(across < up, across, up), high = select(across < up, up, across);
    const Pack::Mask wide = low > Pack(eighth) * high;
    const Pack above = select(wide, low - high, low), below = select(wide, low + high, high);
    const Pack t = above / max(below, Pack(1e-300)), z = t * t;
    Pack sum(terms[10]);
    for (int k = 9; k >= 0; --k) sum = sum * z + Pack(terms[k]);
    Pack angle = t + t * (z * sum);
    angle = select(wide, angle + Pack(pi / 4), angle);
    angle = select(up > across, Pack(pi / 2) - angle, angle);
    angle = select(x < zero, Pack(pi) - angle, angle);
    return select(y < zero, -angle, angle);
}

} // namespace sinew::solver
