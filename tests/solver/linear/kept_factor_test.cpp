// Factors that outlive their frame: what the next frame gives depends on its state alone, not on what a solver holds.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/linear_solver.h"
#include "tests/support/grid_matrix.h"

#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

constexpr int side = 9; // points

/// Two grids that nothing couples, each a body.
struct TwoGrids {
    GridMatrix grid{side};
    int half = grid.pattern.rows;
    BlockPattern pattern;
    UnknownPlaces places = grid.places();
    TwoGrids() {
        std::vector<std::pair<int, int>> couplings;
        for (int i = 0; i < half; ++i)
            for (int e = grid.pattern.row_start[std::size_t(i)]; e < grid.pattern.row_start[std::size_t(i) + 1]; ++e) {
                const int j = grid.pattern.column[std::size_t(e)];
                couplings.emplace_back(i, j), couplings.emplace_back(half + i, half + j);
            }
        pattern = make_pattern(2 * half, couplings);
        const Points points = places.points;
        for (const Vec3& p : points) places.points.push_back(p + Vec3(1, 0, 0));
        places.body.resize(std::size_t(2 * half), 1);
        places.spacing = {0.01, 0.01};
    }
    /// The grids' matrix, of which the diagonal of every third row is stiffer by `more`.
    BlockMatrix matrix(double more) const {
        BlockMatrix a(pattern);
        for (int i = 0; i < pattern.rows; ++i)
            for (int e = pattern.row_start[std::size_t(i)]; e < pattern.row_start[std::size_t(i) + 1]; ++e) {
                const bool diagonal = pattern.column[std::size_t(e)] == i;
                const double l = diagonal ? (i % 3 == 0 ? 6 + more : 6) : -1;
                for (int c = 0; c < 9; ++c) a.block(std::size_t(e))[c] = l * grid.k(c / 3, c % 3);
            }
        return a;
    }
};

struct Solved {
    LinearSolver::Outcome outcome;
    std::vector<double> x;
};

/// A frame of one linear system; the body of `resting` has nothing to do in it.
Solved frame(LinearSolver& solver, const BlockMatrix& a, LinearMemory& memory, const std::vector<char>& resting = {}) {
    solver.begin_frame(memory);
    solver.begin_step({}, {});
    solver.rest(resting);
    Solved s;
    std::vector<double> b = random_numbers(std::size_t(3 * a.pattern->rows), 1);
    for (std::size_t i = 0; i < b.size(); ++i)
        if (!resting.empty() && resting[i < b.size() / 2 ? 0 : 1]) b[i] = 0;
    s.outcome = solver.solve(LinearMethod::automatic, a, b, s.x, 1e-3, 0, false, memory);
    REQUIRE(s.outcome.definite);
    solver.end_frame(memory);
    return s;
}

/// Of a state that has gone over to kept factors.
LinearMemory with_factors() {
    LinearMemory memory;
    memory.factor_steps_left = 24;
    return memory;
}

} // namespace

TEST_CASE("a factor serves the next frames until they take as many iterations as a quarter of it costs", "[linear]") {
    const TwoGrids grids;
    LinearSolver solver(grids.pattern, grids.places);
    LinearMemory memory = with_factors();
    CHECK(frame(solver, grids.matrix(0), memory).outcome.factors == 1);
    REQUIRE(memory.factor);
    CHECK(memory.factor->values.size() == 9 * grids.pattern.block_count());
    const auto first = memory.factor;
    const Solved near = frame(solver, grids.matrix(1), memory);
    CHECK(near.outcome.factors == 0);
    CHECK(near.outcome.iterations > 2);
    CHECK(memory.late_iterations == near.outcome.iterations - 2);
    CHECK(memory.factor == first); // one for all frames that it serves
    // The residual is what was asked for: of the first direction of a step a thousandth.
    std::vector<double> ax(near.x.size());
    multiply(grids.matrix(1), near.x.data(), ax.data());
    const std::vector<double> b = random_numbers(ax.size(), 1);
    CHECK((as_vector(ax) - as_vector(b)).norm() < 3e-3 * as_vector(b).norm());
    // It grows old: each frame adds to what it has cost, and at last the next one begins without.
    int frames = 2;
    for (; memory.factor && frames < 100; ++frames) CHECK(frame(solver, grids.matrix(1), memory).outcome.factors == 0);
    CHECK(frames > 2);
    CHECK(frames < 100);
    CHECK(memory.late_iterations == 0);
    CHECK(frame(solver, grids.matrix(1), memory).outcome.factors == 1);
}

TEST_CASE("a frame that begins with a factor has the same bits in a solver that holds it, another one, or none",
          "[linear]") {
    const TwoGrids grids;
    LinearSolver holds(grids.pattern, grids.places);
    LinearMemory memory = with_factors();
    frame(holds, grids.matrix(0), memory);
    REQUIRE(memory.factor);
    LinearMemory again = memory, other_memory = with_factors(), of_other = memory;
    const Solved expected = frame(holds, grids.matrix(0.1), memory);
    REQUIRE(expected.outcome.factors == 0);

    LinearSolver fresh(grids.pattern, grids.places), other(grids.pattern, grids.places);
    const Solved made = frame(fresh, grids.matrix(0.1), again);
    CHECK(made.x == expected.x);
    CHECK(made.outcome.iterations == expected.outcome.iterations);
    CHECK(made.outcome.factors == 0); // it is no work of this frame
    CHECK(again.late_iterations == memory.late_iterations);

    frame(other, grids.matrix(2), other_memory);
    const Solved taken = frame(other, grids.matrix(0.1), of_other);
    CHECK(taken.x == expected.x);
    CHECK(taken.outcome.factors == 0);
    // A copy, as it comes from a file.
    of_other.factor = std::make_shared<const FactorSource>(*memory.factor);
    of_other.late_iterations = memory.late_iterations;
    CHECK(frame(other, grids.matrix(0.2), of_other).x == frame(holds, grids.matrix(0.2), memory).x);
}

TEST_CASE("a factor of another pattern, or of a body that rested, is none", "[linear]") {
    const TwoGrids grids;
    LinearSolver solver(grids.pattern, grids.places);
    LinearMemory memory = with_factors();
    SECTION("another pattern") {
        frame(solver, grids.matrix(0), memory);
        const GridMatrix single(side);
        LinearSolver less(single.pattern, single.places());
        CHECK(frame(less, single.a, memory).outcome.factors == 1);
    }
    SECTION("as many blocks, in other places") {
        frame(solver, grids.matrix(0), memory);
        FactorSource spoiled = *memory.factor;
        ++spoiled.pattern;
        memory.factor = std::make_shared<const FactorSource>(std::move(spoiled));
        CHECK(frame(solver, grids.matrix(0), memory).outcome.factors == 1);
    }
    SECTION("numbers that no factor can be made of") {
        frame(solver, grids.matrix(0), memory);
        FactorSource spoiled = *memory.factor;
        for (float& v : spoiled.values) v = -v;
        memory.factor = std::make_shared<const FactorSource>(std::move(spoiled));
        CHECK(frame(solver, grids.matrix(0), memory).outcome.factors == 1);
    }
    SECTION("a body that rested while it was made") {
        frame(solver, grids.matrix(0), memory); // so that it holds one of both
        memory = with_factors();
        const std::vector<char> second_rests{0, 1};
        CHECK(frame(solver, grids.matrix(0.5), memory, second_rests).outcome.factors == 1);
        REQUIRE(memory.factor);
        CHECK(memory.factor->without.size() == std::size_t(grids.pattern.rows));
        CHECK(memory.factor->without.front() == 0);
        CHECK(memory.factor->without.back() == 1);
        LinearMemory same = memory;
        LinearSolver fresh(grids.pattern, grids.places);
        // While it rests the other one's serves; where it wakes up a new one is made, whatever the solver held.
        CHECK(frame(solver, grids.matrix(0.4), memory, second_rests).outcome.factors == 0);
        const Solved one = frame(solver, grids.matrix(0.3), memory);
        CHECK(frame(fresh, grids.matrix(0.4), same, second_rests).outcome.factors == 0);
        const Solved two = frame(fresh, grids.matrix(0.3), same);
        CHECK(one.outcome.factors == 1);
        CHECK(two.outcome.factors == 1);
        CHECK(one.x == two.x);
    }
}
