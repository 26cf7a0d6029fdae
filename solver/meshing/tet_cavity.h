// Tets taken out together and replaced by a star: tets from a new vertex to all faces around.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/tet_complex.h"

namespace sinew::solver {

/// A set of tets of a complex and the faces around it. Faces of the boundary are walls like all others, so a
/// star never changes the boundary.
class TetCavity {
  public:
    struct Wall {
        std::array<int, 3> face; ///< such that (face, p) is positively oriented for p within
        int owner;               ///< the tet of the cavity
        int beyond;              ///< the tet on the other side; -1 at the boundary
    };
    explicit TetCavity(TetComplex& complex)
        : complex_(complex) {}

    void start(int tet);
    void add(int tet);
    bool holds(int tet) const { return mark_[static_cast<std::size_t>(tet)] == round_; }
    const std::vector<int>& tets() const { return tets_; }
    std::vector<Wall> walls() const;
    /// Takes out tets until every wall sees p with at least a quality, as far as the rest still hangs together
    /// with the first tet. False if that tet itself would have to go.
    bool make_star_shaped(const Vec3& p, double least_quality);
    /// Grows by the tets behind the walls that see p worst, and stops where the star is best.
    /// \return its quality where that exceeds the present one, otherwise 0
    double grow_for(const Vec3& p, std::size_t most_tets);
    /// The worst quality of the star of p; 0 if a vertex of the cavity would be left without tets.
    double star_quality(const Vec3& p) const;
    /// The worst of the tets that would go.
    double present_quality() const;
    /// Replaces the tets by the star of vertex v; gives the numbers of the new ones.
    std::vector<int> fill(int v);

  private:
    double quality(const Wall& w, const Vec3& p) const;

    TetComplex& complex_;
    std::vector<int> tets_;
    std::vector<int> mark_;
    int round_ = 0;
};

} // namespace sinew::solver
