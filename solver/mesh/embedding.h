// Points that ride on a tet mesh by barycentric coordinates. Exact for affine motion.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"

#include <array>
#include <memory>
#include <vector>

namespace sinew::solver {

struct Embedding {
    std::vector<int> tet;                           ///< host tet of each point
    std::vector<std::array<double, 4>> barycentric; ///< sums to 1; negative where a point lies outside its host
    std::size_t size() const { return tet.size(); }
};

/// Each point in the tet that holds it, or extrapolated from the nearest tet. A point on a vertex of the mesh
/// gets exactly that vertex (coordinates 1 and 0).
Embedding embed(const TetMesh& mesh, const Points& points);
/// The same for points that are asked for one after the other. Immutable; queries are thread-safe. The mesh must
/// outlive it.
class TetLocator {
  public:
    explicit TetLocator(const TetMesh& mesh); ///< Throws Error FE201 (no tets).
    ~TetLocator();
    /// The tet of a point, and the point's coordinates in it.
    int locate(const Vec3& p, std::array<double, 4>& barycentric) const;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};
/// embed() with a locator that is there already.
Embedding embed(const TetLocator& locator, const Points& points);
/// How far each point lies outside of the tet that carries it, in widths (longest edges) of that tet: 0 inside, else at
/// most the distance to the tet. Beyond about 1, what is extrapolated swings about when the tet turns or shears.
std::vector<double> widths_outside(const TetMesh& mesh, const Embedding& e);
/// Positions of embedded points for tet vertex positions `x` (3 numbers a vertex).
void apply(const Embedding& e, const std::vector<Tet>& tets, const double* x, Points& out);

} // namespace sinew::solver
