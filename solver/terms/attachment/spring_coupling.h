// What springs do between vertices: the constant Hessian of a stage, a number for each pair of vertices.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"
#include "solver/scene.h"
#include "solver/terms/attachment/spring_bundles.h"
#include "solver/terms/attachment/spring_patches.h"
#include "solver/types.h"

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace sinew::solver {

/// Stiffness per area of one attachment in a stage [N/m^3].
struct SpringPull {
    double stiffness = 0, viscous = 0; ///< viscous = damping x velocity factor
};

class SpringCoupling {
  public:
    /// Nodes are the vertices that springs reach, by rising number.
    struct Node {
        int vertex, body;
    };
    /// Where a node stands: a bundle, and which of its vertices it is.
    struct Place {
        int bundle, vertex;
    };

    void make(const Scene& scene, const SpringBundles& bundles, const SpringPatches& patches);
    const std::vector<Node>& nodes() const { return nodes_; }
    /// By rising bundles, and so by rising attachments.
    std::span<const Place> places(std::size_t node) const {
        return std::span(places_).subspan(at(first_place_[node]), at(first_place_[node + 1] - first_place_[node]));
    }
    void add_couplings(std::vector<std::pair<int, int>>& couplings) const;
    void set_pattern(const BlockPattern& pattern, const std::vector<int>& unknown);
    /// Takes the stage's stiffnesses, one an attachment for single springs, then one an attachment for means of
    /// patches.
    void set_pulls(const std::vector<SpringPull>& pulls);
    void add_hessian(BlockMatrix& a) const;
    /// What add_hessian adds to the diagonals of the pattern's blocks, a number each [N/m].
    void add_springs(std::span<double> blocks) const;
    /// (Stiffness times a move of every node) at a node [N]: of all, or without the viscous part.
    Vec3 product(std::size_t node, const std::vector<Vec3>& moves) const { return times(values_, node, moves); }
    Vec3 elastic_product(std::size_t node, const std::vector<Vec3>& moves) const {
        return times(elastic_values_.empty() ? values_ : elastic_values_, node, moves);
    }
    void add_squared_stiffnesses(std::vector<double>& of_body) const;

  private:
    void find_places(const SpringBundles& bundles, const std::vector<int>& node_of);
    /// A stiffness of the stage times this goes to the diagonal of a block.
    struct Share {
        int pull;       ///< of set_pulls
        double product; ///< sum of area x coefficients of the block's row and column [m^2]
    };
    /// How much area of an attachment pulls at a vertex [m^2].
    struct Load {
        int attachment;
        double area;
    };
    Vec3 times(const std::vector<double>& values, std::size_t node, const std::vector<Vec3>& moves) const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t e = row_start_[node]; e < row_start_[node + 1]; ++e)
            sum += values[e] * moves[static_cast<std::size_t>(column_[e])];
        return sum;
    }

    std::vector<Node> nodes_;
    std::vector<int> first_place_; ///< per node and one past the end
    std::vector<Place> places_;
    std::vector<std::size_t> row_start_; ///< per node and one past the end: of its entries
    std::vector<int> column_;            ///< per entry: a node
    std::vector<int> first_share_;       ///< per entry and one past the end
    std::vector<Share> shares_;
    std::vector<std::size_t> first_load_; ///< per node and one past the end
    std::vector<Load> loads_;
    // Of the stage:
    std::vector<double> values_;           ///< per entry [N/m]
    std::vector<double> elastic_values_;   ///< likewise; empty where nothing is damped and they are the same
    std::vector<double> square_stiffness_; ///< per node, of its loads [N^2/m^2]
    // Of the pattern:
    std::vector<std::pair<int, int>> blocks_; ///< of the pattern's upper triangle, and whose entry
};

} // namespace sinew::solver
