// The hard cases: the judge sees through false claims, outcomes are told apart, and the command says what came out.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "tests/tools/bench_support.h"
#include "tests/tools/program.h"
#include "tools/bench/hard.h"
#include "tools/bench/hard_judge.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <stdexcept>

using namespace sinew;
using namespace sinew::test;
using namespace sinew::solver;
using bench::Outcome;

namespace {

bool root(const Vec3& p) { return p.x() < 1e-9; }

/// A held beam in gravity after a few steps, and the state before the last one.
struct Beam {
    bench::HardTrial trial;
    State before;
    explicit Beam(const bench::HardSetting& setting)
        : trial(setting, {}) {
        TissueInputs values = bench::material(1e5, 0.3);
        trial.make(bench::box_mesh({0, 0, 0}, {0.3, 0.1, 0.1}, 3, 1, 1), values, root);
        trial.in.gravity = Vec3(0, 0, -9.8);
        trial.start();
        for (int i = 0; i < 4; ++i) {
            before = trial.state;
            trial.step();
        }
    }
    bench::StepCheck check(const State& after) {
        const Scene scene(trial.description);
        return bench::check_step(scene, before, trial.in, after);
    }
};

std::vector<bench::HardSetting> all_settings() {
    std::vector<bench::HardSetting> out;
    for (const auto& element : bench::elements)
        for (const auto& law : bench::all_laws)
            for (const auto& integrator : bench::all_integrators) out.push_back({law, element, integrator});
    return out;
}

Outcome outcome_of(void (*run)(bench::HardTrial&), std::string* why = nullptr) {
    const bench::HardCase c{"made up", "", "nothing", run};
    const bench::HardResult r = bench::run_case(c, {}, {});
    if (why) *why = r.why;
    return r.outcome;
}

void hang(bench::HardTrial& t) {
    t.make(bench::box_mesh({0, 0, 0}, {0.3, 0.1, 0.1}, 3, 1, 1), bench::material(1e5, 0.3), root);
    t.in.gravity = Vec3(0, 0, -9.8);
    t.start();
    t.run(1, 0.2);
}

} // namespace

TEST_CASE("the judge makes every step's equations again, and a step that did not solve them is seen", "[tools]") {
    for (const bench::HardSetting& setting : all_settings()) {
        Beam beam(setting);
        INFO(setting.element.word << " " << setting.law.word << " " << setting.integrator.word);
        const bench::StepCheck honest = beam.check(beam.trial.state);
        CHECK(honest.residual < 1e-5);
        CHECK(honest.move < 1e-6);
        CHECK(honest.definite);
        // A vertex that is off by a tenth of a millimetre is found to be off by that.
        State lie = beam.trial.state;
        const std::size_t v = beam.trial.rest->tets.vertices.size() - 1;
        lie.x[3 * v + 1] += 1e-4;
        if (setting.integrator.integrator == Integrator::tr_bdf2) { // its velocity goes with it
            const double half = 0.5 * tr_bdf2_gamma * beam.trial.in.step_size;
            lie.v[3 * v + 1] += 1e-4 / half;
        }
        const bench::StepCheck seen = beam.check(lie);
        CHECK(seen.residual > 1e-3);
        CHECK(seen.move == Approx(1e-4).epsilon(0.05));
        CHECK(bench::not_a_number(lie).empty());
        lie.v[5] = NAN;
        CHECK(bench::not_a_number(lie) == "a velocity is no number");
        lie.x[7] = INFINITY;
        CHECK(bench::not_a_number(lie) == "a position is no number");
        State bad_record = beam.trial.state;
        bad_record.record.energy = NAN;
        CHECK_FALSE(bench::not_a_number(bad_record).empty());
    }
}

TEST_CASE("the judge's least det F is that of the map", "[tools]") {
    for (const bench::ElementName& element : bench::elements) {
        bench::HardTrial t({bench::laws[0], element, bench::integrators[0]}, {});
        t.make(bench::box_mesh({0, 0, 0}, {1, 1, 1}, 2, 2, 2), bench::material(1e5, 0.3), root);
        t.start();
        const Scene scene(t.description);
        CHECK(bench::least_det(scene, t.state.x) == Approx(1));
        Mat3 map;
        map << 0.5, 0.1, 0, 0, -2, 0.3, 0.2, 0, 0.7;
        t.place([](const Vec3&) { return true; }, [&](const Vec3& p) { return Vec3(map * p); });
        CHECK(bench::least_det(scene, t.state.x) == Approx(map.determinant()));
        // x (1 + x): det F = 1 + 2 x, least at x = 0 where edges bend, 1 + 0.5 in straight tets of half the length.
        t.place([](const Vec3&) { return true; },
                [&](const Vec3& p) { return Vec3(p.x() * (1 + p.x()), p.y(), p.z()); });
        CHECK(bench::least_det(scene, t.state.x) == Approx(t.is_linear() ? 1.5 : 1.0));
    }
}

TEST_CASE("outcomes are told apart", "[tools]") {
    std::string why;
    CHECK(outcome_of([](bench::HardTrial& t) {
              hang(t);
              t.must(true, "anything");
          }) == Outcome::recovered);
    CHECK(outcome_of([](bench::HardTrial& t) {
              hang(t);
              t.come_to_rest();
              t.must(false, "off by a lot", bench::HardTrial::Equilibria::several);
          }) == Outcome::elsewhere);
    CHECK(outcome_of(
              [](bench::HardTrial& t) {
                  hang(t);
                  t.come_to_rest();
                  t.must(false, "off by a lot");
              },
              &why) == Outcome::wrong);
    CHECK(why.find("off by a lot") != std::string::npos);
    CHECK(outcome_of([](bench::HardTrial& t) { // it still swings: no equilibrium at all
              t.in.mass_damping = t.in.stiffness_damping = 0;
              hang(t);
              t.must(false, "swings", bench::HardTrial::Equilibria::several);
          }) == Outcome::wrong);
    CHECK(outcome_of(
              [](bench::HardTrial& t) {
                  t.in.max_newton_iterations = 1, t.in.max_halvings = 0;
                  hang(t);
                  t.must(true, "");
              },
              &why) == Outcome::stopped);
    CHECK(why == "FE301");
    const bench::HardCase never{"made up", "", "", [](bench::HardTrial& t) {
                                    t.in.max_newton_iterations = 1, t.in.max_halvings = 0;
                                    hang(t);
                                    t.in.gravity *= 1e3;
                                    for (int i = 0; i < 100; ++i) t.step();
                                }};
    const bench::HardResult given_up = bench::run_case(never, {}, {});
    CHECK(given_up.outcome == Outcome::stopped);
    CHECK(given_up.why == "FE301");
    CHECK(given_up.unconverged >= bench::HardTrial::most_in_a_row);
    CHECK(given_up.steps < 100);
    CHECK(outcome_of([](bench::HardTrial&) { throw Error("FE302", "flew apart", ""); }, &why) == Outcome::stopped);
    CHECK(why == "FE302");
    CHECK(outcome_of([](bench::HardTrial&) { throw std::out_of_range("oops"); }, &why) == Outcome::wrong);
    CHECK(why.find("oops") != std::string::npos);
    CHECK(outcome_of(
              [](bench::HardTrial& t) { // more energy than it was left with
                  hang(t);
                  t.in.gravity = Vec3::Zero();
                  t.leave_alone();
                  t.in.gravity = Vec3(0, 0, -9.8e4);
                  t.run(1, 0.2);
                  t.must(true, "");
              },
              &why) == Outcome::wrong);
    CHECK(why.find("energy") != std::string::npos);
    std::stop_source stop;
    stop.request_stop();
    CHECK_THROWS_AS(bench::run_case({"made up", "", "", hang}, {}, stop.get_token()), Stopped);
}

TEST_CASE("every hard case has a name of its own and says where it must end", "[tools]") {
    std::set<std::string> names, cases;
    for (const bench::HardCase& c : bench::hard_cases()) {
        CHECK(names.insert(std::string(c.name) + ", " + std::string(c.variant)).second);
        cases.insert(std::string(c.name));
        CHECK_FALSE(c.must.empty());
    }
    CHECK(cases.size() >= 15);
}

TEST_CASE("a bone that turns by 90 degrees in a frame carries its body along under every law and scheme", "[tools]") {
    const auto results = bench::run_hard(quick("turns by 90"));
    REQUIRE(results.size() == 8);
    for (const bench::HardResult& r : results) {
        INFO(r.setting.law.word << " " << r.setting.integrator.word << ": " << r.why);
        CHECK(r.outcome == Outcome::recovered);
        CHECK(r.unconverged == 0);
        CHECK(r.steps > 0);
    }
    CHECK(bench::hard_table(results).rows.size() == 2);
    const auto overview = bench::hard_overview(results);
    REQUIRE(overview.rows.size() == 1);
    CHECK(overview.rows[0][3] == "8");
    CHECK(bench::hard_faults(results).rows.empty());
}

TEST_CASE("a bone that crosses a body in a frame is caught, and what is called converged is", "[tools][contact]") {
    const auto results = bench::run_hard(quick("crosses a body"));
    REQUIRE(results.size() == 8);
    for (const bench::HardResult& r : results) {
        INFO(r.setting.law.word << " " << r.setting.integrator.word << ": " << r.why);
        CHECK(r.outcome != Outcome::wrong); // the judge asks for contacts and forces anew
        CHECK(r.steps > 4);
    }
}

TEST_CASE("sinew bench hard prints a table, JSON and an exit code", "[tools]") {
    const Said json = run_program({"bench", "hard", "--quick", "--only", "not a number", "--json"});
    CHECK(json.code == 0);
    const auto line = json.lines().at(0);
    CHECK(line.at("bench") == "hard");
    REQUIRE(line.at("rows").size() == 8);
    for (const auto& row : line.at("rows")) {
        CHECK(row.at("outcome") == "stopped");
        CHECK(row.at("why") == "FE202");
    }
    const Said table = run_program({"bench", "hard", "--quick", "--only", "not a number"});
    CHECK(table.code == 0);
    CHECK(table.out.find("stopped FE202  stopped FE202  stopped FE202  stopped FE202") != std::string::npos);
    CHECK(table.out.find("8 runs: 0 recovered, 0 elsewhere, 8 stopped, 0 wrong") != std::string::npos);
    CHECK(run_program({"bench", "hard", "--quick", "--only", "nothing of the kind"}).code == 2);
    CHECK(run_program({"bench", "hard", "--steps", "3"}).code == 2);
}

TEST_CASE("the table of hard cases has a column an integrator, and faults are listed", "[tools]") {
    const bench::HardCase one{"one", "a", "here", hang}, other{"other", "", "there", hang};
    std::vector<bench::HardResult> results;
    for (const bench::HardCase* c : {&one, &other})
        for (const bench::IntegratorName& i : bench::all_integrators)
            results.push_back({c, {bench::laws[1], bench::elements[1], i}, Outcome::recovered, "", 2, 1, 0, 10, 0.1});
    results[2].outcome = Outcome::wrong, results[2].why = "it lied";
    results[5].outcome = Outcome::stopped, results[5].why = "FE301";
    CHECK(bench::hard_table(results).rows ==
          std::vector<std::vector<std::string>>{
              {"one, a", "quadratic", "NeoHookean", "recovered", "recovered", "wrong", "recovered"},
              {"other", "quadratic", "NeoHookean", "recovered", "stopped FE301", "recovered", "recovered"}});
    CHECK(bench::hard_overview(results).rows ==
          std::vector<std::vector<std::string>>{{"one, a", "here", "4", "3", "0", "0", "1", "4 of 8", "5"},
                                                {"other", "there", "4", "3", "0", "1", "0", "4 of 8", "5"}});
    CHECK(bench::hard_faults(results).rows ==
          std::vector<std::vector<std::string>>{{"one, a", "quadratic", "NeoHookean", "TR-BDF2", "it lied"}});
}

TEST_CASE("a cloth under negative tension spreads as far as its closed form under every scheme with inertia",
          "[tools]") {
    const auto results = bench::run_hard(quick("cloth: tension"));
    REQUIRE(results.size() == bench::all_integrators.size()); // it has neither laws nor elements
    for (const bench::HardResult& r : results) {
        INFO(r.setting.integrator.word << ": " << r.why);
        if (r.setting.integrator.integrator == Integrator::quasi_static) { // nothing holds it
            CHECK(r.outcome == Outcome::stopped);
            CHECK(r.why == "FE302");
        } else {
            CHECK(r.outcome == Outcome::recovered);
            CHECK(r.unconverged == 0);
        }
    }
}
