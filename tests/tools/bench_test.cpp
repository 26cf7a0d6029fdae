// The cantilever benchmark: the mesh that the peers were measured on, and a run that repeats to the bit.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/tet_mesh.h"
#include "tools/bench/cantilever.h"

#include <catch2/catch.hpp>
#include <tbb/task_arena.h>

using namespace sinew;

TEST_CASE("the cantilever has the peers' vertices, tets, volume and fixed end", "[tools]") {
    const solver::TissueRest rest = bench::cantilever_rest(24, solver::ElasticLaw::neo_hookean);
    CHECK(rest.tets.vertices.size() == 1225);
    CHECK(rest.tets.tets.size() == 5184);
    CHECK(rest.fixed_vertices.size() == 49);
    double volume = 0, least = 1;
    for (const auto& [a, b, c, d] : rest.tets.tets) {
        const auto at = [&](int v) { return rest.tets.vertices[static_cast<std::size_t>(v)]; };
        const double v = solver::tet_volume(at(a), at(b), at(c), at(d));
        volume += v, least = std::min(least, v);
    }
    CHECK(volume == Approx(1.0 / 16).epsilon(1e-12));
    CHECK(least > 0);
    CHECK(solver::is_closed(rest.triangles));
    CHECK(bench::cantilever_rest(40, rest.law).tets.tets.size() == 24000);
}

TEST_CASE("a small cantilever sags, converges, and gives the same bits on one and two threads", "[tools]") {
    const bench::CantileverOptions options{
        .n = 8, .youngs_modulus = 1e5, .law = solver::ElasticLaw::neo_hookean, .steps = 6};
    bench::CantileverResult one, two;
    tbb::task_arena(1).execute([&] { one = bench::run_cantilever(options); });
    tbb::task_arena(2).execute([&] { two = bench::run_cantilever(options); });
    CHECK(one.tip_y < -0.02);
    CHECK(one.tip_y > -0.5);
    CHECK(one.unconverged == 0);
    CHECK(one.newton_per_step >= 1);
    CHECK(one.digest == two.digest);
    CHECK(one.tip_y == two.tip_y);
}
