// Masses of a scene: lumped on the vertices of linear tets, consistent on quadratic ones, whose loads and inertia would
// not fit together otherwise (a lumped quadratic tet bends in free fall or under its own weight). Numbers on the
// pattern of the stiffness matrix, each standing for itself times the 3x3 identity.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"
#include "solver/system.h"

namespace sinew::solver {

class MassMatrix {
  public:
    /// `of_tet`: mass of every slot of every batch [kg]. The pattern must outlive this.
    void set(const Scene::System& system, const BlockPattern& pattern, const std::vector<double>& of_tet);
    /// Sum of each vertex's row, held vertices too: what weighs there [kg]. Negative at corners of quadratic tets.
    const std::vector<double>& weight() const { return weight_; }
    /// out = M u, 3 numbers an unknown.
    void multiply(const std::vector<double>& u, std::vector<double>& out) const;
    /// Solves M u = f, 3 numbers an unknown.
    void solve(const std::vector<double>& f, std::vector<double>& u) const;
    void add_to(BlockMatrix& a, double factor) const;

  private:
    const BlockPattern* pattern_ = nullptr;
    bool diagonal_ = true;               ///< all tets are linear
    std::vector<double> weight_, value_; ///< per vertex; per block of the pattern
};

} // namespace sinew::solver
