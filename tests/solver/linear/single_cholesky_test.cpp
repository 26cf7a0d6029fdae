// The factor in single precision that preconditions iterations.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/cholesky.h"
#include "solver/linear/component_factors.h"
#include "solver/linear/conjugate_gradients.h"
#include "solver/linear/linear_costs.h"
#include "solver/linear/single_cholesky.h"
#include "tests/support/grid_matrix.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <tbb/global_control.h>

using namespace sinew::solver;
using namespace sinew::test;

TEST_CASE("what solves keep of a factor gives a grid's solution, the wave divided by its eigenvalue, to three digits",
          "[linear]") {
    const GridMatrix grid(12);
    const Eigen::Vector3d v(0.3, 1, -0.7);
    const std::vector<double> b = grid.wave(2, 5, 1, grid.k * v),
                              expected = grid.wave(2, 5, 1, v / grid.eigenvalue(2, 5, 1));
    SingleCholesky factor(grid.pattern);
    CHECK(factor.factor_operations() == Cholesky(grid.pattern).factor_operations());
    REQUIRE(factor.factorize(grid.a));
    std::vector<double> x(b.size());
    factor.solve(b.data(), x.data());
    CHECK((as_vector(x) - as_vector(expected)).norm() < 5e-4 * as_vector(expected).norm());
    // Right sides of any size.
    std::vector<double> small(b), y(b.size());
    for (double& s : small) s *= 1e-60;
    factor.solve(small.data(), y.data());
    for (double& s : y) s *= 1e60;
    CHECK((as_vector(y) - as_vector(x)).norm() < 1e-6 * as_vector(x).norm());
    const std::vector<double> zero(b.size(), 0.0);
    factor.solve(zero.data(), y.data());
    CHECK(as_vector(y).norm() == 0);
}

TEST_CASE("large matrices go through tiles and subtrees, with the same bits on one thread and on two", "[linear]") {
    const GridMatrix grid(18);
    const std::vector<double> b = random_numbers(3 * 18 * 18 * 18, 9);
    std::vector<double> one(b.size()), two(b.size());
    for (auto* x : {&one, &two}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, x == &one ? 1 : 2);
        SingleCholesky factor(grid.pattern);
        REQUIRE(factor.factorize(grid.a));
        factor.solve(b.data(), x->data());
    }
    CHECK(one == two);
    std::vector<double> back(b.size());
    multiply(grid.a, one.data(), back.data());
    CHECK((as_vector(back) - as_vector(b)).norm() < 1.5e-3 * as_vector(b).norm());
}

TEST_CASE("stiff unknowns do not spoil a factor in single precision, and it preconditions in an iteration or two",
          "[linear]") {
    GridMatrix grid(10);
    for (std::size_t i = 0; i < 1000; i += 7) {
        double* d = grid.a.block(std::size_t(grid.pattern.row_start[i]));
        for (int c = 0; c < 3; ++c) d[4 * c] *= 1e8;
    }
    const std::vector<double> b = random_numbers(3000, 11);
    ComponentFactors exact(grid.pattern), single(grid.pattern, Factoring::single);
    REQUIRE(exact.factorize(grid.a));
    REQUIRE(single.factorize(grid.a));
    std::vector<double> x(b.size()), expected(b.size());
    exact.solve(b.data(), expected.data());
    single.solve(b.data(), x.data());
    CHECK((as_vector(x) - as_vector(expected)).norm() < 5e-4 * as_vector(expected).norm());
    ConjugateGradients iterations(grid.pattern);
    iterations.set(grid.a);
    const auto result =
        iterations.solve(b.data(), x.data(), 1e-4, 10, [&](const std::vector<double>& in, std::vector<double>& out) {
            single.solve(in.data(), out.data());
        });
    CHECK(result.converged);
    CHECK(result.iterations <= 2);
}

TEST_CASE("a factor in single precision sees what is not positive definite, and goes on with the next", "[linear]") {
    const GridMatrix grid(6);
    SingleCholesky factor(grid.pattern);
    REQUIRE(factor.factorize(grid.a));
    const std::vector<double> b = random_numbers(3 * 216, 12);
    std::vector<double> x(b.size()), again(b.size());
    factor.solve(b.data(), x.data());
    BlockMatrix bad = grid.a;
    bad.block(std::size_t(grid.pattern.row_start[100]))[4] = -1;
    CHECK_FALSE(factor.factorize(bad));
    CHECK(factor.surely_indefinite());
    bad = grid.a;
    bad.block(std::size_t(grid.pattern.row_start[100]))[8] *= 1e-3; // positive, and yet less than its neighbours allow
    CHECK_FALSE(factor.factorize(bad));
    CHECK(factor.surely_indefinite());
    bad = grid.a;
    bad.block(std::size_t(grid.pattern.row_start[100]) + 1)[1] = std::numeric_limits<double>::quiet_NaN();
    CHECK_FALSE(factor.factorize(bad));
    CHECK_FALSE(factor.surely_indefinite()); // nothing is known of it
    REQUIRE(factor.factorize(grid.a));
    factor.solve(b.data(), again.data());
    CHECK(again == x);
}

TEST_CASE("what is indefinite by less than rounding is refused as unclear, and by more as indefinite, on any threads",
          "[linear]") {
    // A grid less its own least eigenvalue is singular; a little more or less of it decides.
    const GridMatrix grid(18);
    const double least = grid.eigenvalue(1, 1, 1);
    for (const double share : {1 + 1e-7, 3.0}) {
        BlockMatrix a = grid.a;
        for (std::size_t i = 0; i < std::size_t(grid.pattern.rows); ++i)
            for (int c = 0; c < 9; ++c)
                a.block(std::size_t(grid.pattern.row_start[i]))[c] -= share * least * grid.k(c / 3, c % 3);
        for (const std::size_t threads : {1, 2}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            ComponentFactors factors(grid.pattern, Factoring::single);
            CHECK_FALSE(factors.factorize(a));
            CHECK(factors.surely_indefinite() == (share > 2));
        }
    }
}

TEST_CASE("a factor that gave its memory back takes it again, with the same bits", "[linear]") {
    const GridMatrix grid(20);
    const std::vector<double> b = random_numbers(3 * 20 * 20 * 20, 5);
    for (const Factoring how : {Factoring::by_component, Factoring::single}) {
        ComponentFactors factors(grid.pattern, how);
        std::vector<double> first(b.size()), again(b.size());
        REQUIRE(factors.factorize(grid.a));
        factors.solve(b.data(), first.data());
        factors.release_if_large();
        REQUIRE(factors.factorize(grid.a));
        factors.solve(b.data(), again.data());
        CHECK(again == first);
    }
    Cholesky exact(grid.pattern);
    SingleCholesky single(grid.pattern);
    for (SparseFactor* factor : {static_cast<SparseFactor*>(&exact), static_cast<SparseFactor*>(&single)}) {
        REQUIRE(factor->factorize(grid.a));
        // A factor has more entries than a triangle of the matrix, 4 or 8 bytes each.
        CHECK(factor->bytes() > 4 * 9 * grid.pattern.block_count());
        factor->release();
        CHECK(factor->bytes() == 0);
    }
}

TEST_CASE("components that are made in the same memory, one after another, have the bits of each alone", "[linear]") {
    const GridMatrix small(7), large(9);
    const int first = 343, rows = 343 + 729;
    std::vector<std::pair<int, int>> couplings;
    for (const GridMatrix* grid : {&small, &large})
        for (int i = 0; i < grid->pattern.rows; ++i)
            for (int e = grid->pattern.row_start[std::size_t(i)]; e < grid->pattern.row_start[std::size_t(i) + 1]; ++e)
                couplings.emplace_back((grid == &large ? first : 0) + i,
                                       (grid == &large ? first : 0) + grid->pattern.column[std::size_t(e)]);
    const BlockPattern both = make_pattern(rows, couplings);
    BlockMatrix a(both);
    std::copy(small.a.values.begin(), small.a.values.end(), a.values.begin());
    std::copy(large.a.values.begin(), large.a.values.end(), a.values.begin() + std::ptrdiff_t(small.a.values.size()));
    const std::vector<double> b = random_numbers(std::size_t(3 * rows), 8);
    std::vector<double> expected(b.size()), x(b.size());
    SingleCholesky of_small(small.pattern), of_large(large.pattern);
    REQUIRE((of_small.factorize(small.a) && of_large.factorize(large.a)));
    of_small.solve(b.data(), expected.data());
    of_large.solve(b.data() + 3 * first, expected.data() + 3 * first);
    std::vector<char> second(std::size_t(rows), 0);
    std::fill(second.begin() + first, second.end(), char{1});
    for (const std::size_t most_beside : {std::size_t{0}, std::size_t{1} << 40}) {
        ComponentFactors factors(both, Factoring::single, most_beside);
        REQUIRE(factors.count() == 2);
        REQUIRE(factors.factorize(a));
        factors.solve(b.data(), x.data());
        CHECK(x == expected);
        // What one of them finds does not spoil the other.
        BlockMatrix bad = a;
        bad.block(std::size_t(both.row_start[first + 40]))[4] = -1;
        CHECK_FALSE(factors.factorize(bad));
        CHECK(factors.surely_indefinite());
        CHECK(factors.rows_without() == second);
        factors.solve(b.data(), x.data(), second);
        CHECK(std::equal(x.begin(), x.begin() + 3 * first, expected.begin()));
    }
}

TEST_CASE("a factor's memory is counted before it is made, and a cycle's cost grows with the matrix without leaps",
          "[linear]") {
    const GridMatrix grid(16);
    SingleCholesky factor(grid.pattern);
    REQUIRE(factor.factorize(grid.a));
    const double counted = linear_costs(grid.pattern).factor_bytes;
    // 45 entries a row to the power of 4/3, four bytes each while the factor is made and two for solves.
    CHECK(counted == Approx(6 * 45 * std::pow(16, 4)));
    // Meshes of tets, which that number is of, fill in more than a grid does.
    CHECK(static_cast<double>(factor.bytes()) < 1.5 * counted);
    CHECK(static_cast<double>(factor.bytes()) > 0.4 * counted);
    // Matrices of 23 and 34 rows a side fill caches of 8 and 24 MB.
    for (const int n : {22, 33}) {
        const double here = linear_costs(GridMatrix(n).pattern).cycle,
                     next = linear_costs(GridMatrix(n + 1).pattern).cycle;
        CHECK(next / here == Approx(std::pow((n + 1.0) / n, 3)).epsilon(0.08));
    }
}

TEST_CASE("a component that rests keeps its factor, and one that never had any is not taken for made", "[linear]") {
    // Two chains of blocks that nothing couples: rows 0 to 2 and 3 to 5.
    const BlockPattern pattern = make_pattern(6, {{0, 1}, {1, 2}, {3, 4}, {4, 5}});
    BlockMatrix a(pattern), other(pattern);
    for (int i = 0; i < 6; ++i)
        for (int e = pattern.row_start[std::size_t(i)]; e < pattern.row_start[std::size_t(i) + 1]; ++e)
            for (int c = 0; c < 3; ++c) {
                const bool diagonal = pattern.column[std::size_t(e)] == i;
                a.block(std::size_t(e))[4 * c] = diagonal ? 4 : -1;
                other.block(std::size_t(e))[4 * c] = diagonal ? 10 : -1;
            }
    const std::vector<double> b = random_numbers(18, 3);
    std::vector<char> first(6, 0);
    std::fill_n(first.begin(), 3, char{1});
    for (const Factoring how : {Factoring::by_component, Factoring::single}) {
        ComponentFactors factors(pattern, how), of_a(pattern, how), of_other(pattern, how);
        REQUIRE((of_a.factorize(a) && of_other.factorize(other)));
        std::vector<double> by_a(18), by_other(18), x(18);
        of_a.solve(b.data(), by_a.data());
        of_other.solve(b.data(), by_other.data());

        REQUIRE(factors.factorize(other, first));
        CHECK(factors.is_made(first));
        CHECK_FALSE(factors.is_made({}));
        factors.solve(b.data(), x.data(), first);
        for (std::size_t i = 0; i < 18; ++i) CHECK(x[i] == (i < 9 ? b[i] : by_other[i]));

        REQUIRE(factors.factorize(a));
        CHECK(factors.is_made({}));
        REQUIRE(factors.factorize(other, first)); // the first three rows keep the factor of a
        factors.solve(b.data(), x.data());
        for (std::size_t i = 0; i < 18; ++i) CHECK(x[i] == (i < 9 ? by_a[i] : by_other[i]));
    }
    // The whole at once rests only as a whole.
    ComponentFactors plain(pattern, Factoring::plain);
    REQUIRE(plain.factorize(a, first));
    CHECK(plain.is_made({}));
}
