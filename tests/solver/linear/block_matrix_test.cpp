// Block matrices: the pattern that couplings make, products, and direct solution by components.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/cholesky.h"
#include "solver/linear/component_factors.h"
#include "tests/support/grid_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <limits>
#include <tbb/global_control.h>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

/// Five rows in two components, {0, 2, 4} and {1, 3}, with random symmetric positive definite values.
struct TwoComponents {
    BlockPattern pattern = make_pattern(5, {{4, 2}, {0, 2}, {2, 0}, {3, 1}, {2, 4}, {1, 1}});
    BlockMatrix a{pattern};
    TwoComponents() {
        const std::vector<double> numbers = random_numbers(a.values.size(), 3);
        a.values = numbers;
        for (int i = 0; i < pattern.rows; ++i) {
            double* d = a.block(std::size_t(pattern.row_start[std::size_t(i)]));
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < r; ++c) d[3 * r + c] = d[3 * c + r];
            for (int c = 0; c < 3; ++c) d[4 * c] += 12;
        }
    }
};

} // namespace

TEST_CASE("a pattern holds each coupling once, in the upper triangle, with every diagonal first", "[linear]") {
    const BlockPattern p = TwoComponents().pattern;
    CHECK(p.rows == 5);
    CHECK(p.row_start == std::vector<int>{0, 2, 4, 6, 7, 8});
    CHECK(p.column == std::vector<int>{0, 2, 1, 3, 2, 4, 3, 4});
    CHECK(p.lower_start == std::vector<int>{0, 0, 0, 1, 2, 3});
    CHECK(p.lower == std::vector<std::pair<int, int>>{{1, 0}, {3, 1}, {5, 2}});
    CHECK(p.find(0, 2) == 1);
    CHECK(p.find(2, 4) == 5);
    CHECK(p.find(0, 4) == -1);
    CHECK(p.find(3, 3) == 6);
}

TEST_CASE("a pattern of parts is that of all their couplings", "[linear]") {
    const CoupledRows one = coupled_rows(5, {{4, 2}, {2, 4}, {1, 1}, {3, 1}}),
                      other = coupled_rows(5, {{0, 2}, {4, 2}}), none = coupled_rows(5, {});
    CHECK(one.start == std::vector<int>{0, 0, 1, 2, 2, 2});
    CHECK(one.column == std::vector<int>{3, 4});
    CHECK(none.start == std::vector<int>(6, 0));
    const std::vector<CoupledRows> parts{one, none, other};
    const BlockPattern p = make_pattern(5, parts), all = TwoComponents().pattern;
    CHECK(p.rows == 5);
    CHECK(p.row_start == all.row_start);
    CHECK(p.column == all.column);
    CHECK(p.lower_start == all.lower_start);
    CHECK(p.lower == all.lower);
    CHECK(make_pattern(2, std::span<const CoupledRows>{}).column == std::vector<int>{0, 1});
}

TEST_CASE("products are those of the dense matrix, with the same bits on one thread and on two", "[linear]") {
    const TwoComponents small;
    const std::vector<double> x = random_numbers(15, 5);
    std::vector<double> y(15);
    multiply(small.a, x.data(), y.data());
    CHECK((as_vector(y) - dense(small.a) * as_vector(x)).norm() < 1e-14 * as_vector(y).norm());

    const GridMatrix grid(20);
    const std::vector<double> u = random_numbers(3 * 8000, 6);
    std::vector<double> one(u.size()), two(u.size());
    for (auto* out : {&one, &two}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, out == &one ? 1 : 2);
        multiply(grid.a, u.data(), out->data());
    }
    CHECK(one == two);
}

TEST_CASE("on waves a grid's matrix does what its eigenvalues say", "[linear]") {
    const GridMatrix grid(9);
    const Eigen::Vector3d v(1, -2, 0.5);
    const std::vector<double> x = grid.wave(1, 3, 7, v),
                              expected = grid.wave(1, 3, 7, grid.eigenvalue(1, 3, 7) * grid.k * v);
    std::vector<double> y(x.size());
    multiply(grid.a, x.data(), y.data());
    CHECK((as_vector(y) - as_vector(expected)).norm() < 1e-13 * as_vector(y).norm());
}

TEST_CASE("factors by component give the dense inverse, and see what is not positive definite", "[linear]") {
    TwoComponents small;
    const std::vector<double> b = random_numbers(15, 7);
    const Eigen::VectorXd expected = dense(small.a).ldlt().solve(as_vector(b));
    for (const Factoring how : {Factoring::by_component, Factoring::plain}) {
        ComponentFactors factors(small.pattern, how);
        CHECK(factors.count() == (how == Factoring::plain ? 1u : 2u));
        std::vector<double> x(15);
        REQUIRE(factors.factorize(small.a));
        factors.solve(b.data(), x.data());
        CHECK((as_vector(x) - expected).norm() < 1e-13 * expected.norm());

        BlockMatrix bad = small.a;
        bad.block(std::size_t(small.pattern.row_start[3]))[0] = -1; // a negative diagonal entry in the small component
        CHECK_FALSE(factors.factorize(bad));
        bad = small.a;
        bad.block(0)[4] = std::numeric_limits<double>::quiet_NaN();
        CHECK_FALSE(factors.factorize(bad));
        REQUIRE(factors.factorize(small.a)); // and goes on with the next one
        std::vector<double> again(15);
        factors.solve(b.data(), again.data());
        CHECK(again == x);
    }
}

TEST_CASE("a grid's direct solution is the wave divided by its eigenvalue", "[linear]") {
    const GridMatrix grid(12);
    const Eigen::Vector3d v(0.3, 1, -0.7);
    const std::vector<double> b = grid.wave(2, 5, 1, grid.k * v),
                              expected = grid.wave(2, 5, 1, v / grid.eigenvalue(2, 5, 1));
    Cholesky factor(grid.pattern);
    REQUIRE(factor.factorize(grid.a));
    std::vector<double> x(b.size());
    factor.solve(b.data(), x.data());
    CHECK((as_vector(x) - as_vector(expected)).norm() < 1e-12 * as_vector(expected).norm());
}
