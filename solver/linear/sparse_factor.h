// What a factor of a symmetric positive definite matrix can do, however it is made.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"

#include <cstddef>
#include <span>

namespace sinew::solver {

/// A matrix as factors read it: the blocks of a pattern, wherever they stand.
struct BlockView {
    const BlockPattern* pattern;
    std::span<const double> values;
    std::span<const float> rounded; ///< in place of `values`, if there are any
    std::span<const int> source;    ///< per block of the pattern: its number among the values; empty: the same
    BlockView(const BlockMatrix& a)
        : pattern(a.pattern)
        , values(a.values) {}
    /// A part of a larger matrix.
    BlockView(const BlockPattern& part, const BlockMatrix& whole, std::span<const int> source)
        : pattern(&part)
        , values(whole.values)
        , source(source) {}
    BlockView(const BlockPattern& part, std::span<const float> whole, std::span<const int> source)
        : pattern(&part)
        , rounded(whole)
        , source(source) {}
    std::size_t place(std::size_t index) const {
        return 9 * (source.empty() ? index : static_cast<std::size_t>(source[index]));
    }
    /// Where nothing is rounded.
    const double* block(std::size_t index) const { return values.data() + place(index); }
    /// Number k of a block, row by row.
    double number(std::size_t index, std::size_t k) const {
        return rounded.empty() ? values[place(index) + k] : static_cast<double>(rounded[place(index) + k]);
    }
    /// LAPACK kernels differ in whether they notice a NaN among their pivots.
    bool finite() const;
};

class SparseFactor {
  public:
    virtual ~SparseFactor() = default;
    /// False if the matrix is not positive definite (or not finite).
    virtual bool factorize(const BlockView& a) = 0;
    /// Of a matrix that factorize refused: whether it is not positive definite by more than rounding can make it seem.
    virtual bool surely_indefinite() const = 0;
    /// Solves A x = b with the last factor; 3 numbers a row.
    virtual void solve(const double* b, double* x) = 0;
    /// Gives the numbers' memory back and keeps the analysis; the next factorize takes it again.
    virtual void release() = 0;
    virtual std::size_t bytes() const = 0; ///< that the numbers take now
    /// Floating-point operations of one factorisation, as the analysis counts them.
    virtual double factor_operations() const = 0;
};

} // namespace sinew::solver
