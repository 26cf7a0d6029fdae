// What triangles add to winding numbers: one by one from near, in groups from afar, and at many points at
// once.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <vector>

namespace sinew::solver {

/// What a group of triangles looks like from far away (the idea of Barill et al. 2018, section 3): the first
/// three terms of the expansion of its solid angle about `centre`. With n dA the vector area and d = x -
/// centre, they are the integrals of n, of n d^T and of n (d d^T).
struct FarField {
    Vec3 centre = Vec3::Zero();
    double radius = 0;              ///< of the ball about `centre` that holds the triangles
    Vec3 dipole = Vec3::Zero();     ///< integral of n
    Mat3 quadrupole = Mat3::Zero(); ///< integral of n d^T
    /// The third term is needed as a cubic form alone, integral of (n . r)(d . r)^2, …
    struct Cubic {
        double xxx = 0, yyy = 0, zzz = 0, xxy = 0, xxz = 0, yyx = 0, yyz = 0, zzx = 0, zzy = 0, xyz = 0;
    } cubic;
    Vec3 trace = Vec3::Zero(); ///< … and by its trace, integral of 2 (n . d) d + n d^2

    /// Adds the triangle with these corners.
    void add(const std::array<Vec3, 3>& corners);
    /// Adds a group with another centre.
    void add(const FarField& part);
    /// Winding number at p, which must be outside of the ball.
    double winding(const Vec3& p) const;

  private:
    void add_cubic(const Vec3& a, const Vec3& b, const Vec3& c, double factor);
};

/// Sums of what groups and triangles add at several points. The loops run over the points, so that they
/// become vector instructions.
class WindingSums {
  public:
    explicit WindingSums(const Points& points);
    void add(const FarField& group);
    void add(const std::array<Vec3, 3>& corners);
    std::vector<double> finish();

  private:
    void add_one_by_one();
    void take_products();

    std::size_t count_;
    std::array<std::vector<double>, 3> coordinates_;
    std::vector<double> sums_; ///< times 4 pi
    /// Half solid angles add up as the arguments of a product of complex numbers 1 + i tan, so that the slow
    /// arc tangent is taken of whole products only. A product must not reach pi; an argument is at most its
    /// tangent, and those are summed.
    std::vector<double> cosines_, sines_;
    double tangent_sum_ = 0;
    std::vector<double> tangents_, divisors_; ///< of the triangle at hand
};

} // namespace sinew::solver
