// Dense kernels on one block column of a factor in single precision. Supernodes of muscles are some fifteen columns
// wide and some hundreds of rows high; BLAS packs its operands before it multiplies, which at such widths takes longer
// than to multiply, and a call of it for a vector takes as long as the vector. These read columns where they stand.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/float8.h"

namespace sinew::solver {

/// `rows` x `columns` numbers, column by column, `stride` from one column to the next; the first `columns` rows are a
/// lower triangle (what is above it is not read), with the inverses of its diagonal. `columns` is a multiple of three.
struct BlockColumn {
    float* values;
    float* inverse_diagonal;
    int rows, columns, stride;
};

/// From columns of a matrix to those of its Cholesky factor, in place. The least pivot, which is what is left of a
/// diagonal entry; not above zero: the first such, the matrix is not positive definite, and no factor was made.
float make_factor(const BlockColumn& l);

/// out (m x n, column by column) = A Bᵀ, where A (m x k) and B (n x k) are rows of one block column of `stride` rows, A
/// from `above` rows further down on; of that only the lower triangle, the rows of B or below (some more are made,
/// others left as they are). n is a multiple of three.
void multiply_transposed(const float* a, const float* b, int stride, int m, int n, int k, int above, float* out);

/// The same as it is kept for solves: in 16 bits, and each column padded with zeros to `stride` numbers, a multiple of
/// eight. A solve reads the factor twice and does little else, so bytes are what it takes; and as a preconditioner the
/// factor takes as many iterations with three digits as with seven.
struct ShortColumn {
    const Short* values;
    const float* inverse_diagonal;
    int rows, columns;
    static int stride(int rows) { return (rows + 7) / 8 * 8; }
};

/// Rounds the factor's columns to those that are kept.
void shorten(const BlockColumn& l, Short* out);
/// x has stride(rows) numbers: the right side's, then what is known of later rows (zero, say). Its first `columns`
/// become the solution's, and what these stand for in later rows is taken off the others.
void solve_down(const ShortColumn& l, float* x);
/// x has stride(rows) numbers: the right side's, the solution's of later rows, then zeros. Its first `columns` become
/// the solution's.
void solve_up(const ShortColumn& l, float* x);

} // namespace sinew::solver
