// The benchmarks: the cantilever's mesh is the peers' and a run repeats to the bit; the meshing table says
// what came of each file.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "program.h"
#include "solver/error.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/primitives.h"
#include "solver/mesh/tet_mesh.h"
#include "temporary_folder.h"
#include "tools/bench/cantilever.h"
#include "tools/bench/meshing.h"

#include <algorithm>
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

TEST_CASE("the benchmark of graphs has a row a shape, with as many nodes as it says and the same result again",
          "[tools]") {
    const auto rows = [] {
        const test::Said said = test::run_program({"bench", "graphs", "--quick", "--json"});
        REQUIRE(said.code == 0);
        return said.lines().at(0).at("rows");
    };
    const auto once = rows(), again = rows();
    REQUIRE(once.size() == 3);
    const int nodes[] = {1000, 1000, 1001}; // 100 parts of 10, and what they are together
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(once[i]["nodes"] == nodes[i]);
        CHECK(once[i]["digest"] == again[i]["digest"]);
        CHECK(once[i]["digest"].get<std::string>().size() == 32);
    }
    CHECK(once[0]["digest"] != once[1]["digest"]);
}

TEST_CASE("the meshing benchmark measures each file in each fill mode, and a refusal is a row", "[tools]") {
    const test::TemporaryFolder folder;
    test::write_text(folder / "ball.obj", solver::write_obj(solver::make_sphere(1, 20, 20)));
    // An octahedron without one of its faces.
    test::write_text(folder / "open.obj", "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\nf 1 3 5\nf 3 2 5\n"
                                          "f 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\n");
    test::write_text(folder / "torn.ply", "ply\nnonsense\n");
    test::write_text(folder / "notes.txt", "no mesh");
    const test::Said said = test::run_program({"bench", "meshing", folder.path().string(), "--parts", "3.5", "--json"});
    CHECK(said.code == 0);
    const auto rows = said.lines();
    REQUIRE(rows.size() == 9);
    CHECK(rows[0].at("fill") == "SurfaceOnly");
    CHECK(rows[0].at("tets") == 600 - 168);
    CHECK(rows[1].at("fill") == "FilledCavities");
    CHECK(rows[1].at("tets") == 600);
    CHECK(rows[1].at("whole") == 168);
    CHECK(rows[1].at("border_edges") == 0);
    CHECK(rows[1].at("crossings") == 0);
    CHECK(rows[1].at("least_angle").get<double>() == Approx(60));
    CHECK(rows[1].at("most_angle").get<double>() == Approx(90));
    CHECK(rows[1].at("surface_volume").get<double>() == Approx(4.0948612));
    CHECK(rows[1].at("covered_volume").get<double>() == Approx(4.0948612).epsilon(1e-3));
    CHECK(rows[1].at("phases").size() == 4);
    CHECK(rows[4].at("tets").get<int>() > 100);
    CHECK(rows[4].at("border_edges") == 3);
    CHECK_FALSE(rows[4].contains("surface_volume")); // an eighth is missing: a large hole
    CHECK(rows[5].at("code") == "FE220");
    CHECK(rows[8].at("code") == "IO403");
    const test::Said table =
        test::run_program({"bench", "meshing", (folder / "ball.obj").string(), "--parts", "3.5,7"});
    CHECK(std::count(table.out.begin(), table.out.end(), '\n') == 2 + 6);
    CHECK(table.out.find("| 0 | 0 | FilledCavities | 3.5 | 0 | ok | 600 | 168 | 60-90 |") != std::string::npos);
    const auto refined = test::run_program({"bench", "meshing", (folder / "ball.obj").string(), "--parts", "3.5",
                                            "--refine", "1", "--json"})
                             .lines();
    CHECK(refined[1].at("refine") == 1);
    CHECK(refined[1].at("tets").get<int>() > 1500);
    CHECK(refined[1].at("least_angle").get<double>() > 29.9);
    CHECK(refined[1].at("most_angle").get<double>() > 100);
    CHECK(refined[1].at("phases").size() == 5);
    CHECK(test::run_program({"bench", "meshing", (folder / "none.obj").string()}).code != 0);
}

TEST_CASE("the meshing benchmark stops when asked", "[tools]") {
    const test::TemporaryFolder folder;
    test::write_text(folder / "ball.obj", solver::write_obj(solver::make_sphere(1, 20, 20)));
    std::stop_source stop;
    stop.request_stop();
    CHECK_THROWS_AS(
        bench::run_meshing((folder / "ball.obj").string(), solver::Fill::filled_cavities, 10, 0, stop.get_token()),
        solver::Stopped);
}
