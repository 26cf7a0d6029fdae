// How far what is near may still move before it can press: most that a search finds does not, and near a solution
// hardly moves. Bounds are conservative, so that leaving something out by them changes no bit.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

/// As far as two sides are from pressing where they were looked at last, in the sum of what both have moved since, each
/// by its corner that has moved farthest [m]. Not positive: they have to be looked at.
class Standoff {
  public:
    /// Takes a move off; whether that is all that there is to know.
    bool outlasts(double moved) {
        const double left = static_cast<double>(left_) - moved;
        // Rounded down.
        left_ = static_cast<float>((1 - 2e-7) * left);
        return left > 0;
    }
    void set(double left) { left_ = static_cast<float>((1 - 2e-7) * left); }
    void forget() { left_ = 0; }

  private:
    float left_ = 0;
};

/// How far one side stands off the plane in which it would meet the other, and how soon that turns.
struct PlaneStandoff {
    double height = 0; ///< of the side's first corner [m]; not positive: it is in the plane or beyond
    double lever = 0;  ///< from there to where the plane is held [m]
    double reach = 0;  ///< sum of the lengths of the two vectors that span the plane [m]
    double area = 0;   ///< their cross product's length [m^2]

    /// Moves of this sum leave the side on its side. The plane's normal n = u x v changes by at most 2 m (|u| + |v|) +
    /// 4 m^2 for corners that move by m, its direction by twice that over |n|, and the height by that times the lever
    /// more than by the moves themselves.
    double left() const {
        if (!(height > 0)) return 0;
        return std::min(height / (1 + 8 * lever * reach / area), 0.5 * reach);
    }
};

/// How far two sides may move before they press.
/// \param distance between them, or less.
/// \param range from which on they press.
/// \param by_plane what is left until they may have gone through, as they are on the side of each other on which they
/// were.
/// \param way a function, for it is seldom asked for: the farthest that a corner of one has gone since the start of the
/// step as a corner of the other sees it. Sides that are farther apart than that have not met on the way.
template <class Way>
double standoff(double distance, double range, double by_plane, const Way& way) {
    constexpr double rounding = 1e-6; // what may_have_met lets pass, and more
    double left = distance - range;
    if (by_plane < left) left = std::min(left, std::max(by_plane, 0.5 * ((1 - rounding) * distance - way())));
    return (1 - rounding) * left - 1e-9 * range;
}

} // namespace sinew::solver
