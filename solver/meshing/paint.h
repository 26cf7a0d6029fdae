// Where and how far a lattice is refined: levels painted on the surface, and what the inside takes from them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/solid.h"
#include "solver/meshing/tet_share.h"

#include <vector>

namespace sinew::solver {

/// The level n of a point of the surface is its painted number of levels (linear on each triangle) rounded
/// up. A tet that the surface passes through is halved until its level is the highest n on its piece of the
/// surface. A tet inside is halved until its level is the whole number nearest to propagation * n of the
/// surface point closest to the tet's middle (halves round up).
class Paint {
  public:
    /// `levels`: per vertex of the mesh, one for all, or none for 0; vertices at the same place take the
    /// highest. Throws Error FE204 (count), FE222 (a number that is negative or not finite, propagation
    /// outside 0 to 1).
    Paint(const Solid& solid, const std::vector<double>& levels, double propagation);

    /// The highest n on the surface, at most 64; 0 without paint.
    int highest() const { return highest_; }
    /// Whether n exceeds `level` on the part of a triangle in the tet.
    bool wants_more(int level, int triangle, const BarycentricTriangle& in_tet) const;
    /// Whether a tet inside with this middle is to be finer than `level`.
    bool wants_more_inside(int level, const Vec3& middle) const;
    /// The highest level inside.
    int highest_inside() const { return level_inside(highest_); }
    /// A level that wants_more_inside is true below for all middles in a ball. At least `level`, and just that without
    /// much of a search where no tet may be finer.
    int least_inside(int level, const Vec3& middle, double radius) const;

  private:
    int level_inside(double levels) const;

    const Solid& solid_;
    std::vector<double> levels_; ///< by vertex; empty without paint
    double propagation_ = 0;
    int highest_ = 0;
};

} // namespace sinew::solver
