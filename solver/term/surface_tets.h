// The tets of one kind under layered surfaces, as stencils of their nodes: what acts on a surface by its pieces acts on
// these.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/layered_surfaces.h"
#include "solver/term/stencils.h"

namespace sinew::solver {

/// Tets of N = 4 or 10 nodes; 3: triangles of cloth. Those with more pieces come first, so that the lanes of a batch
/// have about as many.
template <int N>
struct SurfaceTets {
    std::vector<PointWeights> points; ///< one a node and surface, which it is carried by alone
    std::vector<std::array<int, N>> stencils;
    std::vector<std::vector<int>> stencil_of_piece; ///< per surface; empty for surfaces on tets of another kind
    std::vector<std::size_t> surface;               ///< per stencil
    std::vector<std::size_t> point_surface;         ///< per point

    explicit SurfaceTets(const LayeredSurfaces& surfaces);
    /// What stencils are made from; takes points and stencils away.
    Stencils<N> take_stencils(const Numbering& numbering);
};

extern template struct SurfaceTets<3>;
extern template struct SurfaceTets<4>;
extern template struct SurfaceTets<quadratic_nodes>;

} // namespace sinew::solver
