// The scene in the form that steps run on: element batches, numbering of unknowns, where element entries add up. Made
// from the description once, read by the potential.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/cut_tets.h"
#include "solver/element/quadratic_tets.h"
#include "solver/fiber/active_stress.h"
#include "solver/numbering.h"
#include "solver/scene.h"

namespace sinew::solver {

/// The batches of one tissue.
struct TissueBatches {
    int body = -1;
    ElasticLaw law = ElasticLaw::stvk;
    ElementKind kind = ElementKind::linear;
    std::size_t first_batch = 0, batch_count = 0, tet_count = 0;
    std::size_t first_edge_batch = 0;            ///< quadratic only
    std::size_t deformable = 0;                  ///< place among the scene's deformables
    std::vector<std::vector<FiberBatch>> fibers; ///< [fibre field][batch within the tissue]
    std::vector<Anisotropy> anisotropy;          ///< per batch for that law: directions, root 1
    CutElements cut;                             ///< tets that are solid in part

    int nodes() const { return kind == ElementKind::linear ? 4 : quadratic_nodes; }
    int points() const { return kind == ElementKind::linear ? 1 : quadratic_points; }
    int pairs() const { return kind == ElementKind::linear ? 10 : quadratic_pairs; }
    /// Where the entries of batch i of this tissue start, in doubles, among those of all elements.
    std::size_t first_gradient = 0, first_hessian = 0, first_strain = 0;
    std::size_t gradient_at(std::size_t i) const {
        return first_gradient + i * static_cast<std::size_t>(nodes() * 3 * lanes);
    }
    std::size_t strain_at(std::size_t i) const {
        return first_strain + i * static_cast<std::size_t>(points() * solver::strain_size);
    }
    std::size_t hessian_at(std::size_t i) const {
        return first_hessian + i * static_cast<std::size_t>(pairs() * 9 * lanes);
    }
};

struct Scene::System {
    std::vector<TetBatch> batches;
    std::vector<EdgeBatch> edge_batches;
    std::vector<TissueBatches> tissues;
    std::size_t gradient_size = 0, hessian_size = 0, strain_size = 0; ///< doubles that all elements' entries take
    Numbering numbering;
    /// Per body with quadratic tets: the vertices at the middles of each tet's edges. Empty otherwise.
    std::vector<std::vector<std::array<int, 6>>> edge_vertices;
    /// Element nodes that meet at each unknown, in fixed order: where the first component of their gradient stands; the
    /// others follow at distances of `lanes`.
    std::vector<int> node_start, nodes;

    /// Vertices of node n (0…3 corners, then edges) of batch i of a tissue.
    const int* node(const TissueBatches& t, std::size_t i, int n) const {
        return n < 4 ? batches[t.first_batch + i].vertex[n] : edge_batches[t.first_edge_batch + i].vertex[n - 4];
    }
};

} // namespace sinew::solver
