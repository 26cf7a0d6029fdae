// The accuracy benchmark: small cases pass, wrong values fail, and what is not modelled never counts as passed.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"
#include "tools/bench/accuracy.h"
#include "tools/bench/bar_release.h"
#include "tools/bench/studies.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace sinew;
using namespace sinew::test;
using bench::CaseKind;
using bench::CaseStatus;

TEST_CASE("every accuracy case of a quick run passes, and what is missing is listed as such", "[tools]") {
    bench::RunOptions options;
    options.quick = true;
    const std::vector<bench::CaseResult> results = bench::run_accuracy(options);
    int passed = 0, missing = 0;
    for (const bench::CaseResult& r : results) {
        INFO(r.section << " " << r.name << ", " << r.setting << ", " << r.quantity << ": " << r.value << " against "
                       << r.reference << ", error " << r.error << " of " << r.tolerance << " " << r.note);
        CHECK(r.status != CaseStatus::fail);
        CHECK_FALSE(r.section.empty());
        passed += r.status == CaseStatus::pass;
        missing += r.status == CaseStatus::not_modelled;
        if (r.status == CaseStatus::not_modelled)
            CHECK(r.note.starts_with("needs "));
        else if (r.name != "Hertz: sphere on a plane") // so coarse it is only asked to find balance
            CHECK(r.tolerance <= (r.kind == CaseKind::exact       ? 1e-6
                                  : r.kind == CaseKind::same_mesh ? 1e-4
                                                                  : 1e-3)); // no orders in quick runs
    }
    CHECK(passed > 600);
    CHECK(missing > 0);
    const nlohmann::ordered_json rows = bench::accuracy_json(results);
    CHECK(rows.size() == results.size());
    CHECK(bench::accuracy_table(results).rows.size() == results.size());
    CHECK(bench::accuracy_summary(results).find(std::to_string(passed) + " passed, 0 failed") == 0);
}

TEST_CASE("a value outside its tolerance, a step that did not converge and a flat error are failures", "[tools]") {
    bench::Book book;
    book.open("0", "made up");
    book.compare(CaseKind::exact, "a", "x", 1 + 2e-8, 1, 1e-8);
    book.compare(CaseKind::exact, "b", "x", 1 + 0.5e-8, 1, 1e-8);
    bench::Work unfinished;
    unfinished.unconverged = 1;
    book.compare(CaseKind::exact, "c", "x", 1, 1, 1e-8, unfinished);
    book.converge("d", "x", {0.2, 0.1, 0.05}, {1.16, 1.04, 1.01}, 1, 1.5);
    book.converge("e", "x", {0.2, 0.1, 0.05}, {1.16, 1.08, 1.04}, 1, 1.5);
    book.converge("f", "x", {0.2, 0.1, 0.05}, {1.005, 1.04, 1.01}, 1, 1.5);
    book.slope("g", "x", 1e-3, 1.9, 1.8);
    book.slope("h", "x", 1e-3, 1.7, 1.8);
    book.compare(CaseKind::exact, "i", "x", std::numeric_limits<double>::quiet_NaN(), 1, 1e-8);
    book.converge("j", "x", {0.2, 0.1, 0.05}, {1.16, 1.12, 1.08}, 1, 1, {}, true); // locks
    book.converge("k", "x", {0.2, 0.1, 0.05}, {1.16, 1.12, 1.12}, 1, 1, {}, true); // comes no nearer
    book.converge("l", "x", {0.2, 0.1, 0.05}, {1.16, 1.12, 1.08}, 1, 1, unfinished, true);
    std::string verdicts;
    for (const bench::CaseResult& r : book.results) verdicts += name_of(r.status)[0];
    CHECK(verdicts == "FpFpFFpFFlFF");
    CHECK(bench::accuracy_summary(book.results) == "3 passed, 8 failed, 1 lock, 0 not yet modelled");
    CHECK(bench::in_locking_range(solver::ElementKind::linear, 0.49));
    CHECK_FALSE(bench::in_locking_range(solver::ElementKind::linear, 0.45));
    CHECK_FALSE(bench::in_locking_range(solver::ElementKind::quadratic, 0.499));
    CHECK(book.results[3].order == Approx(2));
    CHECK(book.results[4].order == Approx(1));
    CHECK(book.results[2].note.find("did not converge") != std::string::npos);
}

TEST_CASE("natural frequencies of a bar scale with the root of stiffness over density", "[tools]") {
    auto rest = bench::make_tissue(bench::box_mesh({0, 0, 0}, {0.4, 0.1, 0.1}, 4, 1, 1), solver::ElasticLaw::stvk);
    rest->fixed_vertices = bench::vertices_where(rest->tets.vertices, [](const solver::Vec3& p) { return p.x() == 0; });
    const auto soft = bench::natural_frequencies(*rest, bench::material(1e4, 0.3, 1000), 4);
    const auto hard = bench::natural_frequencies(*rest, bench::material(4e4, 0.3, 1000), 4);
    const auto heavy = bench::natural_frequencies(*rest, bench::material(1e4, 0.3, 4000), 4);
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(hard[i] == Approx(2 * soft[i]).epsilon(1e-7));
        CHECK(heavy[i] == Approx(0.5 * soft[i]).epsilon(1e-7));
        if (i) CHECK(soft[i] >= soft[i - 1]);
    }
}

TEST_CASE("a uniform traction gives its whole force to either element", "[tools]") {
    for (const solver::ElementKind kind : {solver::ElementKind::linear, solver::ElementKind::quadratic}) {
        const auto rest = bench::make_tissue(bench::cook_mesh(4, 4, 2), solver::ElasticLaw::stvk, kind);
        const solver::Points loads = bench::traction_loads(
            *rest, [](const solver::Vec3& p) { return p.x() > 0.48 - 1e-9; }, solver::Vec3(0, 3125, 0));
        CHECK(loads.size() == bench::nodes_of(*rest).size());
        solver::Vec3 sum = solver::Vec3::Zero();
        for (const solver::Vec3& f : loads) sum += f;
        CHECK((sum - solver::Vec3(0, 3125 * 0.16 * 0.1, 0)).norm() < 1e-9);
    }
}

TEST_CASE("sinew bench accuracy prints a table or JSON, and says what it does not know", "[tools]") {
    const Said table = run_program({"bench", "accuracy", "--quick", "--only", "free fall"});
    CHECK(table.code == 0);
    CHECK(table.out.find("verdict") == 0);
    CHECK(table.out.find("BDF2, dt=1/48") != std::string::npos);
    const Said json = run_program({"bench", "accuracy", "--quick", "--only", "free fall", "--json"});
    const auto line = nlohmann::json::parse(json.out);
    CHECK(line["bench"] == "accuracy");
    CHECK_FALSE(line["machine"].get<std::string>().empty());
    CHECK(line["date"].get<std::string>().size() == 10);
    CHECK(line["rows"].size() > 10);
    for (const auto& row : line["rows"])
        for (const char* key :
             {"section", "case", "setting", "quantity", "kind", "value", "reference", "error", "allowed", "verdict"})
            CHECK(row.contains(key));
    CHECK(run_program({"bench", "accuracy", "--only", "no such case"}).code == 2);
    const Said typo = run_program({"bench", "acuracy"});
    CHECK(typo.code == 2);
    CHECK(typo.err.find("accuracy") != std::string::npos);
}
