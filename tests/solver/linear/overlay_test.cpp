// Overlays: couplings outside of a matrix's pattern take part in products and are solved for by iterations.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/linear_solver.h"
#include "tests/support/grid_matrix.h"

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>
#include <tbb/global_control.h>

using namespace sinew::solver;
using namespace sinew::test;
using Catch::Detail::Approx;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A spring of the given matrix between a point that a row carries and the middle of three others, as blocks.
Overlay::Blocks spring(const Mat3& k) {
    const double w[4] = {1, -1.0 / 3, -1.0 / 3, -1.0 / 3};
    Overlay::Blocks out;
    std::size_t entry = 0;
    for (int c = 0; c < 4; ++c)
        for (int d = c; d < 4; ++d) out[entry++] = w[c] * w[d] * k;
    return out;
}

} // namespace

TEST_CASE("an overlay adds the sum of its elements to products", "[linear]") {
    const BlockPattern pattern = make_pattern(6, {{0, 1}});
    BlockMatrix a(pattern);
    const std::vector<double> numbers = random_numbers(9, 1);
    const Mat3 half = Eigen::Map<const Mat3>(numbers.data()), k = half + half.transpose();
    // Point: .25 of row 0 and .75 of row 4; corners: rows 1, 2 and 2 again.
    const Overlay::Carrier carriers[] = {{0, 0, .25}, {0, 4, .75}, {1, 1, 1}, {2, 2, 1}, {3, 2, 1}};
    a.overlay.add(carriers, spring(k));
    a.overlay.add(carriers, spring(2 * k));
    a.overlay.finish(6);
    MatrixXd way = MatrixXd::Zero(3, 18);
    const double shares[] = {.25, -1.0 / 3, -2.0 / 3, 0, .75, 0};
    for (int r = 0; r < 6; ++r) way.block<3, 3>(0, 3 * r) = shares[r] * Mat3::Identity();
    const MatrixXd expected = 3 * way.transpose() * k * way;
    CHECK((dense(a) - expected).norm() < 1e-14 * expected.norm());
    const std::vector<double> x = random_numbers(18, 2);
    std::vector<double> y(18);
    multiply(a, x.data(), y.data());
    CHECK((as_vector(y) - expected * as_vector(x)).norm() < 1e-14 * expected.norm() * as_vector(x).norm());
    a.overlay.clear();
    CHECK(a.overlay.empty());
    CHECK(dense(a).norm() == 0);
}

TEST_CASE("every method solves with an overlay, at the same bits for any number of threads", "[linear]") {
    // Two grids of 343 rows that only the overlay ties together.
    const int n = 7, rows = n * n * n;
    const GridMatrix grid(n);
    std::vector<std::pair<int, int>> couplings;
    for (int i = 0; i < rows; ++i)
        for (int e = grid.pattern.row_start[std::size_t(i)]; e < grid.pattern.row_start[std::size_t(i) + 1]; ++e)
            for (const int shift : {0, rows})
                couplings.emplace_back(i + shift, grid.pattern.column[std::size_t(e)] + shift);
    const BlockPattern pattern = make_pattern(2 * rows, couplings);
    BlockMatrix a(pattern);
    std::copy(grid.a.values.begin(), grid.a.values.end(), a.values.begin());
    std::copy(grid.a.values.begin(), grid.a.values.end(), a.values.begin() + std::ptrdiff_t(grid.a.values.size()));
    UnknownPlaces places = grid.places(1);
    places.points.insert(places.points.end(), places.points.begin(), places.points.begin() + rows);
    places.body.resize(places.points.size(), 1);
    places.spacing = {1, 1};
    const double stiffness = 3;
    for (int i = 0; i < n * n - n - 1; ++i) {
        const Overlay::Carrier carriers[] = {{0, i, 1}, {1, rows + i, 1}, {2, rows + i + 1, 1}, {3, rows + i + n, 1}};
        a.overlay.add(carriers, spring(stiffness * Mat3::Identity()));
    }
    a.overlay.finish(2 * rows);
    const std::vector<double> b = random_numbers(std::size_t(6 * rows), 4);
    const VectorXd exact = dense(a).llt().solve(as_vector(b));
    for (const LinearMethod method :
         {LinearMethod::automatic, LinearMethod::direct, LinearMethod::iterative, LinearMethod::plain}) {
        INFO(static_cast<int>(method));
        std::vector<std::vector<double>> found;
        for (const std::size_t threads : {1, 2}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            LinearSolver solver(pattern, places);
            LinearMemory memory;
            std::vector<double> x;
            const LinearSolver::Outcome outcome = solver.solve(method, a, b, x, 1e-4, 0, true, memory);
            CHECK(outcome.definite);
            CHECK(outcome.iterations > 1);
            found.push_back(x);
        }
        CHECK((as_vector(found[0]) - exact).norm() < 2e-4 * exact.norm());
        CHECK(found[0] == found[1]);
    }
    SECTION("a stiff one, too: what the factor does not know takes iterations, not accuracy") {
        a.overlay.clear();
        for (int i = 0; i < n * n - n - 1; ++i) {
            const Overlay::Carrier carriers[] = {
                {0, i, 1}, {1, rows + i, 1}, {2, rows + i + 1, 1}, {3, rows + i + n, 1}};
            a.overlay.add(carriers, spring(1e4 * Mat3::Identity()));
        }
        a.overlay.finish(2 * rows);
        const VectorXd stiff = dense(a).llt().solve(as_vector(b));
        LinearSolver solver(pattern, places);
        LinearMemory memory;
        std::vector<double> x;
        CHECK(solver.solve(LinearMethod::direct, a, b, x, 1e-6, 0, true, memory).definite);
        CHECK((as_vector(x) - stiff).norm() < 1e-3 * stiff.norm());
    }
}

TEST_CASE("an overlay gives rows that are held nothing, and others what they had among themselves", "[linear]") {
    const BlockPattern pattern = make_pattern(6, {{0, 1}});
    BlockMatrix a(pattern);
    const Overlay::Carrier first[] = {{0, 0, .25}, {0, 4, .75}, {1, 1, 1}, {2, 2, 1}, {3, 5, 1}},
                           second[] = {{0, 3, 1}, {1, 4, 1}, {2, 4, 1}, {3, 4, 1}},
                           third[] = {{0, 4, 1}, {1, 1, 1}, {2, 3, 1}, {3, 0, 1}},
                           last[] = {{0, 5, 1}, {1, 4, 1}, {2, 2, 2}, {3, 1, 1}};
    const Mat3 one = Mat3::Identity();
    // What is left of the third between rows that move is no block at all.
    a.overlay.add_across(third, {one, one, one});
    a.overlay.add(first, spring(Mat3(Vec3(1, 2, 3).asDiagonal())));
    a.overlay.add(second, spring(5 * one));
    a.overlay.add_across(third, {one, one, one});
    a.overlay.add_across(last, {one, 7 * one, one});
    BlockMatrix whole(a);
    whole.overlay.finish(6);
    a.overlay.hold({0, 1, 0, 0, 1, 0});
    a.overlay.finish(6);
    MatrixXd expected = dense(whole);
    for (const Eigen::Index held : {1, 4})
        expected.middleRows(3 * held, 3).setZero(), expected.middleCols(3 * held, 3).setZero();
    CHECK(expected(0, 0) == Approx(0.0625));
    CHECK(expected(9, 9) == Approx(5));
    CHECK(expected(15, 6) == Approx(14 + 1.0 / 9));
    CHECK((dense(a) - expected).norm() < 1e-14);
    CHECK(a.overlay.rows() == std::vector<int>{0, 2, 3, 5});
    // By rows, as smoothers read it.
    MatrixXd by_rows = MatrixXd::Zero(18, 18);
    std::size_t visited = 0;
    for (const int row : a.overlay.rows())
        a.overlay.visit_row(row, [&](int column, double factor, const Mat3& block, bool transposed) {
            by_rows.block<3, 3>(3 * row, 3 * column) += factor * (transposed ? Mat3(block.transpose()) : block);
            ++visited;
        });
    CHECK((by_rows - expected).norm() < 1e-14);
    CHECK(visited == 9 + 1 + 2);
    std::vector<std::pair<int, int>> couplings;
    a.overlay.visit_couplings([&](int i, int j) { couplings.emplace_back(i, j); });
    CHECK(couplings == std::vector<std::pair<int, int>>{{0, 0}, {0, 2}, {0, 5}, {3, 3}, {5, 5}, {5, 2}});
    SECTION("where nothing is left it is empty") {
        a.overlay.clear();
        a.overlay.add_across(third, {one, one, one});
        a.overlay.hold({0, 1, 0, 0, 1, 0});
        a.overlay.finish(6);
        CHECK(a.overlay.empty());
        CHECK(a.overlay.rows().empty());
    }
}
