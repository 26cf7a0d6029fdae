// Stiff springs on some unknowns: which of them leave the grids, and what conjugate gradients take with and without.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/conjugate_gradients.h"
#include "solver/linear/held_block.h"
#include "tests/support/grid_matrix.h"

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

/// A grid whose first layer has a spring in the midst of each edge along y, to something fixed: each pulls at the
/// edge's two points, so that points that go to and fro along a line hardly feel any. Attachments on a skin inside tets
/// leave stiff and soft moves of the same points likewise.
struct HeldGrid {
    GridMatrix grid;
    std::vector<double> springs;
    BlockMatrix a;
    HeldGrid(int n, double stiffness)
        : grid(n, Eigen::Matrix3d::Identity())
        , springs(grid.pattern.block_count(), 0.0)
        , a(grid.pattern) {
        const std::vector<double> places = random_numbers(std::size_t(n * n), 9);
        a = grid.a;
        for (int y = 0; y + 1 < n; ++y)
            for (int z = 0; z < n; ++z) {
                const double t = 0.5 + 0.2 * std::tanh(places[std::size_t(y * n + z)]);
                add_spring(grid.point(0, y, z), grid.point(0, y + 1, z), t, stiffness);
            }
    }
    void add(int i, int j, double value) {
        const int e = grid.pattern.find(std::min(i, j), std::max(i, j));
        REQUIRE(e >= 0);
        springs[std::size_t(e)] += value;
        for (int c = 0; c < 3; ++c) a.block(std::size_t(e))[4 * c] += value;
    }
    void add_spring(int i, int j, double t, double k) {
        add(i, i, k * (1 - t) * (1 - t)), add(j, j, k * t * t), add(i, j, k * t * (1 - t));
    }
    std::vector<double> elastic() const { return std::vector<double>(std::size_t(grid.pattern.rows), 6.0); }
    HeldRows held() const { return find_held_rows(grid.pattern, springs, elastic(), grid.places()); }
};

int iterations_with_block(const HeldGrid& g, const std::vector<double>& b, std::vector<double>& x) {
    ConjugateGradients cg(g.grid.pattern);
    cg.set(g.a);
    const HeldRows held = g.held();
    UnknownPlaces places = g.grid.places();
    places.body = held.grid_of;
    for (const Held h : held.rows) places.left_out.push_back(h == Held::pinned);
    Multigrid grids(cg.matrix(), places);
    HeldBlock block(g.grid.pattern, cg.matrix(), held);
    REQUIRE(grids.set_values());
    REQUIRE(block.set_values(g.a));
    const auto r =
        cg.solve(b.data(), x.data(), 1e-6, 500, [&](const auto& in, auto& out) { block.apply(grids, in, out); });
    REQUIRE(r.converged);
    return r.iterations;
}

int iterations_without(const HeldGrid& g, const std::vector<double>& b) {
    ConjugateGradients cg(g.grid.pattern);
    cg.set(g.a);
    Multigrid grids(cg.matrix(), g.grid.places());
    REQUIRE(grids.set_values());
    std::vector<double> x(b.size());
    const auto r = cg.solve(b.data(), x.data(), 1e-6, 500, [&](const auto& in, auto& out) { grids.apply(in, out); });
    return r.converged ? r.iterations : 500;
}

} // namespace

TEST_CASE("held rows: what is tied to something fixed is pinned, what is tied to another body shares its grid",
          "[linear]") {
    // Two bodies of three unknowns: 0-1-2 and 3-4-5. 0 hangs on a bone; 2 and 3, and 2 and 4, on each other.
    const BlockPattern pattern = make_pattern(6, {{0, 1}, {1, 2}, {3, 4}, {4, 5}, {2, 3}, {2, 4}});
    UnknownPlaces places;
    places.spacing = {1, 1};
    places.body = {0, 0, 0, 1, 1, 1};
    for (int i = 0; i < 6; ++i) places.points.push_back(Vec3(i, 0, 0));
    const std::vector<double> elastic(6, 10.0);
    std::vector<double> springs(pattern.block_count(), 0.0);
    const auto add = [&](int i, int j, double k) { springs[std::size_t(pattern.find(i, j))] += k; };
    SECTION("nothing springy") { CHECK(find_held_rows(pattern, springs, elastic, places).rows.empty()); }
    SECTION("softer than what it holds") {
        add(0, 0, 9.9);
        CHECK(find_held_rows(pattern, springs, elastic, places).rows.empty());
    }
    SECTION("stiffer") {
        add(0, 0, 10.1);
        add(2, 2, 30), add(3, 3, 20), add(4, 4, 10), add(2, 3, -20), add(2, 4, -10);
        const HeldRows h = find_held_rows(pattern, springs, elastic, places);
        CHECK(h.rows == std::vector{Held::pinned, Held::no, Held::tied, Held::tied, Held::no, Held::no});
        // As large a share of both bodies is tied: the first leads.
        CHECK(h.grid_of == std::vector{0, 0, 0, 0, 1, 1});
    }
    SECTION("the body of which more is tied leads") {
        add(2, 2, 40), add(3, 3, 20), add(4, 4, 20), add(2, 3, -20), add(2, 4, -20);
        const HeldRows h = find_held_rows(pattern, springs, elastic, places);
        CHECK(h.rows == std::vector{Held::no, Held::no, Held::tied, Held::tied, Held::tied, Held::no});
        CHECK(h.grid_of == std::vector{0, 0, 1, 1, 1, 1});
    }
}

TEST_CASE("held rows: iterations do not grow with what holds, where grids alone take more and more", "[linear]") {
    const int n = 16;
    const std::vector<double> b = random_numbers(std::size_t(3 * n * n * n), 4);
    std::vector<double> x(b.size());
    int with = 0, without = 0;
    for (const double k : {1e2, 1e3, 1e5}) {
        const HeldGrid g(n, k);
        const HeldRows held = g.held();
        CHECK(std::count(held.rows.begin(), held.rows.end(), Held::no) == n * n * (n - 1));
        with = iterations_with_block(g, b, x);
        without = iterations_without(g, b);
        CAPTURE(k, with, without);
        ComponentFactors factors(g.grid.pattern, Factoring::by_component);
        REQUIRE(factors.factorize(g.a));
        std::vector<double> solution(b.size());
        factors.solve(b.data(), solution.data());
        CHECK((as_vector(x) - as_vector(solution)).norm() < 1e-5 * as_vector(solution).norm());
    }
    CHECK(without > 10 * with);
}

TEST_CASE("held rows: the same bits for one and two threads", "[linear]") {
    const HeldGrid g(20, 1e4);
    const std::vector<double> b = random_numbers(std::size_t(3 * 20 * 20 * 20), 4);
    std::vector<std::vector<double>> x(2, std::vector<double>(b.size()));
    for (std::size_t t : {0, 1}) {
        const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, t + 1);
        iterations_with_block(g, b, x[t]);
    }
    CHECK(x[0] == x[1]);
}
