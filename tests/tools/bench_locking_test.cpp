// Nearly incompressible bodies on the work-precision plots, and what each lever gives: errors, counts and files, never
// times.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/bench_support.h"
#include "tests/tools/program.h"
#include "tools/bench/beams.h"
#include "tools/bench/cantilever.h"
#include "tools/bench/hessian_choice.h"
#include "tools/bench/levers.h"
#include "tools/bench/locking.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

using namespace sinew;
using namespace sinew::test;

TEST_CASE("nearly incompressible bodies: linear tets lock, patches and quadratic tets do not", "[tools]") {
    const auto points = bench::run_locking(quick());
    REQUIRE(points.size() == 16);
    std::map<std::string, std::map<std::string, bench::LockingPoint>> finest; // problem, element
    for (const bench::LockingPoint& p : points) {
        INFO(p.problem << ", " << p.element << ", " << p.mesh);
        CHECK(p.unconverged == 0);
        CHECK(p.error == Approx(std::abs(p.value - p.converged) / std::abs(p.converged)));
        CHECK(p.converged_error < 0.02 * std::abs(p.converged));
        finest[p.problem][p.element] = p;
    }
    REQUIRE(finest.size() == 4);
    for (const char* problem : {"Cook's panel, nu 0.49", "Cook's panel, nu 0.499"}) {
        CHECK(finest[problem]["linear"].error > 0.5);
        CHECK(finest[problem]["linear + volumeConservation"].error < 0.3);
        CHECK(finest[problem]["quadratic"].error < 0.05);
        CHECK(finest[problem]["quadratic"].tets == 96);
    }
    // Volume conservation does not stiffen either element beyond what it is without.
    for (const char* element : {"linear", "quadratic"})
        CHECK(finest["cantilever, volumeConservation 1000 E"][element].error <
              finest["cantilever, no volumeConservation"][element].error + 0.01);
    CHECK(finest["cantilever, volumeConservation 1000 E"]["quadratic"].error < 0.02);
    // The incompressible body bends less than the catalogue's at nu 0.4, by up to the ratio of their Young's moduli.
    const double ratio = finest["cantilever, volumeConservation 1000 E"]["linear"].converged /
                         finest["cantilever, no volumeConservation"]["linear"].converged;
    CHECK(ratio < 1);
    CHECK(ratio > 1.4 / 1.5);

    const std::string csv = bench::as_csv(bench::locking_json(points));
    CHECK(std::count(csv.begin(), csv.end(), '\n') == 17);
    CHECK(csv.starts_with("problem,element,mesh,tets,"));
    const auto plots = bench::locking_plots(points);
    REQUIRE(plots.size() == 4);
    for (const bench::NamedPlot& p : plots) {
        const std::string svg = bench::draw(p.plot);
        CHECK(well_formed(svg));
        for (const char* part : {"10 % off", "Pareto line", "wall time [s]", ">quadratic<"})
            CHECK(svg.find(part) != std::string::npos);
    }
    CHECK(bench::draw(plots[0].plot).find(">96<") != std::string::npos);
    auto many = points;
    many[3].tets = 5001;
    CHECK(bench::modest_ones(many).size() == 15);
}

TEST_CASE("work-precision writes the files of what it ran, and no others", "[tools]") {
    const TemporaryFolder folder;
    const Said said = run_program(
        {"bench", "work-precision", "--quick", "--only", "nu 0.499", "--json", "-o", folder.path().string()});
    REQUIRE(said.code == 0);
    const auto line = nlohmann::json::parse(said.out);
    CHECK(line["rows"].empty());
    CHECK(line["locking"].size() == 5);
    std::set<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        files.insert(entry.path().filename().string());
    CHECK(files == std::set<std::string>{"work_precision_locking.csv", "work_precision_locking.json",
                                         "work_precision_cook_499.svg"});
    CHECK(nlohmann::json::parse(read_text(folder / "work_precision_locking.json")).size() == 5);
}

TEST_CASE("levers leave the result, or say by how much they change it", "[tools]") {
    const auto levers = bench::run_levers(quick());
    std::vector<std::string> names;
    for (const bench::Lever& l : levers) {
        INFO(l.name << ", " << l.without.choice << ", " << l.with.choice);
        names.push_back(l.name);
        CHECK(l.without.converged);
        CHECK(l.with.converged);
        CHECK(l.ratio > 0);
        CHECK(l.turns == 1);
        if (l.name == "threads") CHECK(l.without.digest == l.with.digest);
        if (l.name == "element")
            CHECK(l.with.error < l.without.error);
        else
            CHECK(l.with.value == Approx(l.without.value).epsilon(1e-4));
        if (l.name == "Hessian") CHECK(l.with.newton < l.without.newton);
    }
    CHECK(names == std::vector<std::string>{"linear method", "linear method", "linear method", "threads", "Hessian",
                                            "Hessian", "element"});
    CHECK(bench::levers_table(levers).rows.size() == 7);
    CHECK(bench::levers_json(levers)[0]["without"]["digest"].get<std::string>().size() == 32);
    CHECK(bench::run_levers(quick("threads")).size() == 1);
}

TEST_CASE("the Newton method that counts Hessians solves the solver's own step", "[tools]") {
    auto rest = std::make_shared<solver::TissueRest>(bench::cantilever_rest(8, solver::ElasticLaw::neo_hookean));
    solver::StepInputs in = bench::tight_inputs();
    in.step_size = 1.0 / 48, in.gravity = solver::Vec3(0, -9.81, 0);
    in.bodies = {bench::material(1e5, 0.45)};
    for (const solver::Integrator integrator : {solver::Integrator::backward_euler, solver::Integrator::quasi_static}) {
        in.integrator = integrator;
        bench::Simulation sim({{rest}, {}}, in);
        const bench::HessianRun exact = bench::solve_step(sim.scene(), sim.state, in, false),
                                projected = bench::solve_step(sim.scene(), sim.state, in, true);
        sim.step();
        CHECK(exact.converged);
        CHECK(projected.converged);
        CHECK(exact.newton < projected.newton);
        double farthest = 0;
        for (std::size_t i = 0; i < exact.x.size(); ++i)
            farthest =
                std::max({farthest, std::abs(exact.x[i] - sim.state.x[i]), std::abs(projected.x[i] - sim.state.x[i])});
        CHECK(farthest < 1e-8); // of a metre of bar
    }
}
