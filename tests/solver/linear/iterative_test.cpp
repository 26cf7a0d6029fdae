// Conjugate gradients and multigrid, on matrices whose solutions and condition numbers are known.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/conjugate_gradients.h"
#include "tests/support/grid_matrix.h"

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>
#include <tbb/global_control.h>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

const ConjugateGradients::Preconditioner nothing = [](const std::vector<double>& r, std::vector<double>& z) { z = r; };

struct Solved {
    ConjugateGradients::Result result;
    std::vector<double> x;
};

Solved by_gradients(const GridMatrix& grid, const std::vector<double>& b, double tolerance, int most = 1000) {
    ConjugateGradients cg(grid.pattern);
    cg.set(grid.a);
    Solved out{{}, std::vector<double>(b.size())};
    out.result = cg.solve(b.data(), out.x.data(), tolerance, most, nothing);
    return out;
}

Solved by_multigrid(const GridMatrix& grid, const std::vector<double>& b, double tolerance) {
    ConjugateGradients cg(grid.pattern);
    cg.set(grid.a);
    Multigrid multigrid(cg.matrix(), grid.places());
    REQUIRE(multigrid.set_values());
    Solved out{{}, std::vector<double>(b.size())};
    out.result =
        cg.solve(b.data(), out.x.data(), tolerance, 200, [&](const auto& r, auto& z) { multigrid.apply(r, z); });
    return out;
}

} // namespace

TEST_CASE("conjugate gradients end after as many iterations as there are different eigenvalues", "[linear]") {
    // Diagonal blocks alone, with the values 1, 2 and 5: in exact arithmetic three iterations are the solution.
    const BlockPattern pattern = make_pattern(40, std::vector<std::pair<int, int>>{});
    BlockMatrix a(pattern);
    const double values[] = {1, 2, 5};
    for (std::size_t i = 0; i < 40; ++i)
        for (int c = 0; c < 3; ++c) a.block(i)[4 * c] = values[(i + std::size_t(c)) % 3];
    ConjugateGradients cg(pattern);
    cg.set(a);
    const std::vector<double> b = random_numbers(120, 2);
    std::vector<double> x(120);
    CHECK_FALSE(cg.solve(b.data(), x.data(), 1e-6, 2, nothing).converged);
    const auto three = cg.solve(b.data(), x.data(), 1e-6, 3, nothing);
    CHECK(three.converged);
    CHECK(three.iterations == 3);
    for (std::size_t i = 0; i < 120; ++i) CHECK(x[i] == Approx(b[i] / a.block(i / 3)[4 * (i % 3)]).margin(1e-5));
}

TEST_CASE("conjugate gradients take no more iterations than the condition number allows, and more on finer grids",
          "[linear]") {
    int before = 0;
    for (const int n : {8, 16, 32}) {
        const GridMatrix grid(n, Eigen::Matrix3d::Identity());
        const std::vector<double> b = random_numbers(std::size_t(3 * n * n * n), 4);
        const Solved s = by_gradients(grid, b, 1e-4);
        REQUIRE(s.result.converged);
        const double condition = grid.eigenvalue(n, n, n) / grid.eigenvalue(1, 1, 1);
        // |e| in the matrix's norm falls by 2 ((sqrt k - 1)/(sqrt k + 1))^i; the residual's is at most sqrt k larger.
        const double rate = (std::sqrt(condition) - 1) / (std::sqrt(condition) + 1);
        CHECK(s.result.iterations <= std::ceil(std::log(1e-4 / (2 * std::sqrt(condition))) / std::log(rate)));
        CHECK(s.result.iterations > 1.5 * before);
        before = s.result.iterations;
        std::vector<double> ax(b.size());
        multiply(grid.a, s.x.data(), ax.data());
        CHECK((as_vector(ax) - as_vector(b)).norm() < 2e-4 * as_vector(b).norm());
    }
}

TEST_CASE("with the inverse as preconditioner one iteration is enough", "[linear]") {
    const GridMatrix grid(5);
    const Eigen::LDLT<Eigen::MatrixXd> inverse(dense(grid.a));
    ConjugateGradients cg(grid.pattern);
    cg.set(grid.a);
    const std::vector<double> b = random_numbers(375, 8);
    std::vector<double> x(375);
    const auto r = cg.solve(b.data(), x.data(), 1e-5, 10, [&](const auto& in, auto& out) {
        Eigen::Map<Eigen::VectorXd>(out.data(), 375) = inverse.solve(as_vector(in));
    });
    CHECK(r.converged);
    CHECK(r.iterations == 1);
    CHECK((as_vector(x) - inverse.solve(as_vector(b))).norm() < 1e-5 * as_vector(x).norm());
}

TEST_CASE("a direction of negative curvature is reported, not followed", "[linear]") {
    GridMatrix grid(6);
    for (int c = 0; c < 3; ++c) grid.a.block(std::size_t(grid.pattern.row_start[100]))[4 * c] = -40;
    const Solved s = by_gradients(grid, random_numbers(648, 9), 1e-8);
    CHECK_FALSE(s.result.definite);
    CHECK_FALSE(s.result.converged);
}

TEST_CASE("with multigrid the iterations do not grow with the grid, and the solution is the known wave", "[linear]") {
    std::vector<int> iterations;
    for (const int n : {10, 20, 40}) {
        const GridMatrix grid(n);
        const std::vector<double> rough = random_numbers(std::size_t(3 * n * n * n), 10);
        const Solved s = by_multigrid(grid, rough, 1e-6);
        REQUIRE(s.result.converged);
        iterations.push_back(s.result.iterations);

        const Eigen::Vector3d v(1, 0.5, -1);
        const std::vector<double> b = grid.wave(1, 2, 1, grid.k * v),
                                  expected = grid.wave(1, 2, 1, v / grid.eigenvalue(1, 2, 1));
        const Solved smooth = by_multigrid(grid, b, 1e-7);
        REQUIRE(smooth.result.converged);
        CHECK((as_vector(smooth.x) - as_vector(expected)).norm() < 1e-5 * as_vector(expected).norm());
    }
    CAPTURE(iterations);
    CHECK(iterations.back() <= iterations.front() + 4);
    CHECK(iterations.back() <= 20);
}

TEST_CASE("one multigrid cycle is symmetric and positive, whatever the order of the unknowns", "[linear]") {
    const GridMatrix grid(14); // more rows than a chunk of a sweep
    ConjugateGradients cg(grid.pattern);
    cg.set(grid.a);
    Multigrid multigrid(cg.matrix(), grid.places());
    REQUIRE(multigrid.level_count() > 2);
    REQUIRE(multigrid.set_values());
    const std::size_t count = 3 * 14 * 14 * 14;
    for (unsigned seed = 20; seed < 25; ++seed) {
        const std::vector<double> r = random_numbers(count, seed), s = random_numbers(count, seed + 100);
        std::vector<double> mr(count), ms(count);
        multigrid.apply(r, mr);
        multigrid.apply(s, ms);
        const double one = as_vector(s).dot(as_vector(mr)), other = as_vector(r).dot(as_vector(ms));
        CHECK(std::abs(one - other) < 1e-5 * as_vector(s).norm() * as_vector(mr).norm());
        CHECK(as_vector(r).dot(as_vector(mr)) > 0);
    }
}

TEST_CASE("few unknowns are solved exactly by the coarsest level", "[linear]") {
    const GridMatrix grid(4); // 64 rows
    ConjugateGradients cg(grid.pattern);
    cg.set(grid.a);
    Multigrid multigrid(cg.matrix(), grid.places());
    REQUIRE(multigrid.level_count() == 1);
    REQUIRE(multigrid.set_values());
    const std::vector<double> r = random_numbers(192, 30);
    std::vector<double> z(192);
    multigrid.apply(r, z);
    const Eigen::VectorXd expected = dense(grid.a).ldlt().solve(as_vector(r));
    // Its diagonal is raised by 1e-5, which the smallest eigenvalue feels 6 / eigenvalue(1, 1, 1) = 5 times as much.
    CHECK((as_vector(z) - expected).norm() < 1e-4 * expected.norm());
    CHECK((as_vector(z) - expected).norm() > 1e-7 * expected.norm());
}

TEST_CASE("bodies share no coarse unknowns: what pulls at one leaves the other alone", "[linear]") {
    // Two grids in the same place.
    const GridMatrix grid(8);
    const int rows = grid.pattern.rows;
    std::vector<std::pair<int, int>> couplings;
    for (int i = 0; i < rows; ++i)
        for (int e = grid.pattern.row_start[std::size_t(i)]; e < grid.pattern.row_start[std::size_t(i) + 1]; ++e)
            for (const int shift : {0, rows})
                couplings.emplace_back(i + shift, grid.pattern.column[std::size_t(e)] + shift);
    const BlockPattern pattern = make_pattern(2 * rows, couplings);
    BlockMatrix a(pattern);
    std::copy(grid.a.values.begin(), grid.a.values.end(), a.values.begin());
    std::copy(grid.a.values.begin(), grid.a.values.end(),
              a.values.begin() + static_cast<std::ptrdiff_t>(grid.a.values.size()));
    UnknownPlaces places = grid.places();
    places.points.insert(places.points.end(), places.points.begin(), places.points.begin() + rows);
    places.body.resize(places.points.size(), 1);
    places.spacing = {0.01, 0.01};
    ConjugateGradients cg(pattern);
    cg.set(a);
    Multigrid multigrid(cg.matrix(), places);
    REQUIRE(multigrid.level_count() > 1);
    REQUIRE(multigrid.set_values());
    std::vector<double> r = random_numbers(std::size_t(6 * rows), 40), z(r.size());
    std::fill(r.begin() + 3 * rows, r.end(), 0.0);
    multigrid.apply(r, z);
    CHECK(as_vector(z).head(3 * rows).norm() > 0);
    CHECK(as_vector(z).tail(3 * rows).norm() == 0);
}

TEST_CASE("multigrid refuses a diagonal block that is not positive definite, and takes the next values", "[linear]") {
    GridMatrix grid(8);
    ConjugateGradients cg(grid.pattern);
    Multigrid multigrid(cg.matrix(), grid.places());
    double& entry = grid.a.block(std::size_t(grid.pattern.row_start[77]))[0];
    const double good = entry;
    entry = -1;
    cg.set(grid.a);
    CHECK_FALSE(multigrid.set_values());
    entry = good;
    cg.set(grid.a);
    CHECK(multigrid.set_values());
}

TEST_CASE("iterative solutions have the same bits on one thread and on two", "[linear]") {
    const GridMatrix grid(24);
    const std::vector<double> b = random_numbers(3 * 24 * 24 * 24, 50);
    std::vector<std::vector<double>> x;
    for (const std::size_t threads : {1, 2}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        x.push_back(by_multigrid(grid, b, 1e-6).x);
    }
    CHECK(x[0] == x[1]);
}
