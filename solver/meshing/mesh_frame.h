// The coordinates in which a mesh is made: about the surface's middle, in its size. So the same surface gives the same
// triangles and tets wherever it stands and in whatever unit, as far as rounding there changes it by less than the
// steps that coordinates are rounded to; and far from the origin or from size 1 nothing is lost or overflows.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <cmath>

namespace sinew::solver {

struct MeshFrame {
    Vec3 middle = Vec3::Zero();
    double size = 1;
    double farthest = 0; ///< largest coordinate of the surface, as given

    double in(double length) const {
        int exponent = 0;
        const double digits = std::frexp(length / size, &exponent);
        return std::ldexp(std::round(digits * steps), exponent) / steps;
    }
    Vec3 in(const Vec3& p) const {
        return ((p - middle) / size).unaryExpr([](double x) { return std::round(x * steps) / steps; });
    }
    double out(double length) const { return length * size; }
    Vec3 out(const Vec3& p) const { return p * size + middle; }

  private:
    static constexpr double steps = 0x1p40;
};

} // namespace sinew::solver
