// Masses of a scene: lumped on the vertices of linear tets, consistent on quadratic ones, whose loads and inertia would
// not fit together otherwise (a lumped quadratic tet bends in free fall or under its own weight). Of tets that are
// solid in part the part inside counts, where it lies: linear ones are lumped by its centroid. Numbers on the pattern
// of the stiffness matrix, each standing for itself times the 3x3 identity.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"
#include "solver/system.h"

#include <span>

namespace sinew::solver {

class MassMatrix {
  public:
    /// Begins anew with no mass; terms add theirs. Numbering and pattern must outlive this.
    void start(const Numbering& numbering, const BlockPattern& pattern);
    /// The tets of a scene. `of_tet`: mass of every slot of every batch [kg].
    void add_tets(const Scene::System& system, const std::vector<double>& of_tet);
    /// A mass that moves with one vertex [kg].
    void add_lumped(int vertex, double mass);
    /// An entry of a consistent mass matrix, and of its transpose where the vertices differ [kg].
    void add(int vertex, int other, double mass);

    /// Sum of each vertex's row, held vertices too: what weighs there [kg]. Negative at corners of quadratic tets.
    const std::vector<double>& weight() const { return weight_; }
    /// out = M u, 3 numbers an unknown.
    void multiply(const std::vector<double>& u, std::vector<double>& out) const;
    /// Solves M u = f, 3 numbers an unknown.
    void solve(const std::vector<double>& f, std::vector<double>& u) const;
    void add_to(BlockMatrix& a, double factor) const;

    /// Entries between unknowns and held vertices, of consistent masses.
    struct Held {
        int unknown, vertex;
        double mass;
    };
    const std::vector<Held>& held() const { return held_; }
    /// Adds M h to m_u, h what held vertices do, 3 a vertex (read where held() names it). Returns u . M h.
    double add_held(const std::vector<double>& h, const std::vector<double>& u, std::vector<double>& m_u) const;
    /// Adds `factor` times the rows of M (u + h) that belong to held vertices, 3 a vertex. `u`: 3 an unknown; `h`: 3 a
    /// vertex, read at held ones.
    void add_held_rows(double factor, const std::vector<double>& u, const std::vector<double>& h,
                       std::span<double> out) const;

  private:
    const Numbering* numbering_ = nullptr;
    const BlockPattern* pattern_ = nullptr;
    bool diagonal_ = true; ///< every mass is lumped
    std::vector<Held> held_;
    struct HeldPair {
        int vertex, other;
        double mass;
    };
    std::vector<HeldPair> held_pairs_;   ///< entries between held vertices, one for both of a pair
    std::vector<double> weight_, value_; ///< per vertex; per block of the pattern
};

} // namespace sinew::solver
