// A sparse factor of each connected component of a matrix, made side by side: muscles that no spring ties together have
// nothing to do with each other.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/sparse_factor.h"

#include <memory>
#include <span>
#include <vector>

namespace sinew::solver {

/// by_component: in double precision. single: likewise in single precision, to precondition with. plain: the whole
/// matrix at once, and CHOLMOD may open threads of its own.
enum class Factoring { by_component, single, plain };

class ComponentFactors {
  public:
    /// One symbolic analysis per component.
    /// \param most_beside where components in single precision take more bytes than this while they are made, all
    /// together, the large ones are made one after another, by all threads and in the same memory
    explicit ComponentFactors(const BlockPattern& pattern, Factoring factoring = Factoring::by_component,
                              std::size_t most_beside = std::size_t{64} << 20);
    std::size_t count() const { return parts_.size(); }
    /// False if a component is not positive definite. Components whose rows all have a flag in `resting` (empty: none
    /// has) keep the factor they have, if any.
    bool factorize(const BlockMatrix& a, std::span<const char> resting = {});
    /// The same in single precision, of a matrix with such numbers, 9 a block of the pattern.
    bool factorize(std::span<const float> rounded, std::span<const char> resting = {});
    /// No component has one any more; their memory stays.
    void forget();
    /// Flags of the rows whose component has none; empty: all have one.
    std::vector<char> rows_without() const;
    /// Whether all components have one but those that rest.
    bool is_made(std::span<const char> resting) const;
    /// Of a matrix that factorize refused: whether a component is not positive definite by more than rounding.
    bool surely_indefinite() const { return surely_indefinite_; }
    /// Gives the memory of large factors back; the next factorize takes it again.
    void release_if_large();
    /// out = A^-1 in, 3 numbers a row; in components that rest out = in.
    void solve(const double* in, double* out, std::span<const char> resting = {});

  private:
    struct Part {
        std::vector<int> rows;   ///< of the whole, ascending
        BlockPattern pattern;    ///< without the lists that products with it would read
        std::vector<int> source; ///< per block of the part: the block of the whole
        std::unique_ptr<SparseFactor> factor;
        bool made = false;        ///< the factor is one of a positive definite matrix
        bool in_one_room = false; ///< it is made in the memory of others, one after another
        std::vector<double> in, out;
    };
    static bool rests(const Part& part, std::span<const char> resting);
    template <class Whole>
    bool factorize_whole(const Whole& a, std::span<const char> resting);
    bool surely_indefinite_ = false;
    std::vector<std::unique_ptr<Part>> parts_; ///< the largest first, so that threads end together
};

} // namespace sinew::solver
