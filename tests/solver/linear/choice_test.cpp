// Which way Auto goes, before anything has been tried: what is counted to cost less.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/linear_solver.h"
#include "tests/support/grid_matrix.h"

#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

/// A grid of n x n x n points, of which those of the first `layers` layers hang on springs of 100 times the grid's own
/// stiffness.
LinearSolver::Outcome first_solve(int n, int layers, LinearMemory& memory) {
    const GridMatrix grid(n, Eigen::Matrix3d::Identity());
    BlockMatrix a = grid.a;
    std::vector<double> springs(grid.pattern.block_count(), 0.0);
    for (int x = 0; x < layers; ++x)
        for (int y = 0; y < n; ++y)
            for (int z = 0; z < n; ++z) {
                const auto d = std::size_t(grid.pattern.row_start[std::size_t(grid.point(x, y, z))]);
                springs[d] = 600;
                for (int c = 0; c < 3; ++c) a.block(d)[4 * c] += 600;
            }
    LinearSolver solver(grid.pattern, grid.places());
    solver.begin_frame(memory);
    solver.begin_step(springs, std::vector<double>(std::size_t(grid.pattern.rows), 6.0));
    std::vector<double> x;
    const std::vector<double> b = random_numbers(std::size_t(3 * grid.pattern.rows), 1);
    const LinearSolver::Outcome outcome = solver.solve(LinearMethod::automatic, a, b, x, 1e-3, 0, false, memory);
    REQUIRE(outcome.definite);
    return outcome;
}

} // namespace

TEST_CASE("Auto iterates with grids where those are cheaper than a factor, and else keeps to one from the start",
          "[linear]") {
    LinearMemory memory;
    SECTION("a box: the factor's flops grow with the square of its rows") {
        CHECK(first_solve(20, 0, memory).factors == 0);
        CHECK(memory.factor_steps_left == 0);
    }
    SECTION("springs on most of a small one: a block to factor in any case, and more iterations") {
        CHECK(first_solve(10, 5, memory).factors == 1);
        CHECK(memory.factor_steps_left > 0);
    }
}
