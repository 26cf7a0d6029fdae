// The Hessian of what presses on a carried surface, gathered by its points before it goes to what carries them: many
// presses on few points cost little.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"
#include "solver/numbering.h"
#include "solver/term/carried_surface.h"
#include "solver/term/point_triangle.h"

#include <utility>
#include <vector>

namespace sinew::solver {

/// Adds a factor times the nine numbers of a block as they lie in memory: the matrix keeps its blocks by rows, Mat3
/// by columns.
inline void add_scaled(double factor, const Mat3& block, double* to) { Eigen::Map<Mat3>(to) += factor * block; }

class SurfaceHessian {
  public:
    /// Of a surface that deforms, which outlives it.
    explicit SurfaceHessian(const CarriedSurface& surface);
    /// Vertices that must be coupled: those that carry points of one triangle.
    void add_couplings(std::vector<std::pair<int, int>>& couplings) const {
        couplings.insert(couplings.end(), couplings_.begin(), couplings_.end());
    }
    /// Finds where entries go, in fixed order; the pattern couples all of them.
    void bind(const Numbering& numbering, const BlockPattern& pattern);

    void clear();
    /// Adds the blocks of corners 1 to 3 times a factor, which are those of a triangle.
    void add(int triangle, const PointTriangleBlocks& blocks, double factor);
    void add_to(BlockMatrix& a) const;

  private:
    /// Two points of a triangle, the lower first, or one twice.
    struct Pair {
        int first, second;
    };
    struct Entry {
        int block;
        double weight;
        bool transposed; ///< of the pair's block
    };
    const CarriedSurface& surface_;
    std::vector<Pair> pairs_;
    std::vector<std::pair<int, int>> couplings_;  ///< each once
    std::vector<std::array<int, 6>> of_triangle_; ///< pairs of corners (1,1) (1,2) (1,3) (2,2) (2,3) (3,3)
    std::vector<std::size_t> first_entry_;        ///< per pair and one past the end
    std::vector<Entry> entries_;
    std::vector<Mat3> sums_; ///< per pair
    std::vector<char> used_;
};

} // namespace sinew::solver
