// Chains that an edited graph takes over, and those that it must not.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/carry_chains.h"
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <limits>
#include <unistd.h>

using namespace toys;

namespace {

constexpr double always = std::numeric_limits<double>::infinity();
constexpr const char* scene = R"("n": {"type": "number", "inputs": {"value": {"keys": [[1, 1], [10, 2], [20, 3]]}}},
    "p": {"type": "place"}, "sim": {"type": "sim", "inputs": {"target": {"from": "n.out"},
    "stiffness": {"keys": [[1, 1], [30, 2], [40, 4], [50, 2]], "interp": "smooth"}}})";

} // namespace

TEST_CASE("two snapshots are the same until the first key that differs", "[carry]") {
    const auto g = graph(registry(), scene);
    const auto until = [&](const Edit& edit) { return same_until(*g, *edit.commit().graph); };
    CHECK(until(Edit(g)) == always);
    CHECK(until(Edit(g).set_key({"n", "value"}, 20, 3)) == always);
    CHECK(until(Edit(g).set_key({"n", "value"}, 20, 4)) == 10);
    CHECK(until(Edit(g).set_key({"n", "value"}, 30, 3)) == 20);
    CHECK(until(Edit(g).set_key({"n", "value"}, 1, 3)) == -always);
    CHECK(until(Edit(g).set_key({"sim", "stiffness"}, 50, 3)) == 30); // the tangent at 40 looks at 50
    CHECK(until(Edit(g).set_key({"sim", "stiffness"}, 50, 3).set_key({"n", "value"}, 20, 4)) == 10);
    CHECK(until(Edit(g).set_json({"n", "times"}, "2")) == -always);
    CHECK(until(Edit(g).set({"sim", "target"}, Plug{"p", "out"})) == -always);
    CHECK(until(Edit(g).rename_node("p", "q")) == -always);
    CHECK(until(Edit(g).set_timing({25, 1, 100})) == -always);
    const auto sent = Edit(g).set_input({"p", "translate"}, 8, Value::of<Vec3>({1, 2, 3})).commit().graph;
    CHECK(same_until(*g, *sent) == -always); // a literal became a curve; from then on keys are compared
    CHECK(same_until(*sent, *Edit(sent).set_input({"p", "translate"}, 9, Value::of<Vec3>({1, 2, 4})).commit().graph) ==
          8);
}

TEST_CASE("frames before the first difference are carried over, no others", "[carry]") {
    const auto g = graph(registry(), scene);
    const auto carried = [&](const std::shared_ptr<const Graph>& edited) {
        Program before(g), after(edited);
        const int sim = after.find("sim");
        before.cone(sim);
        for (std::uint64_t f = 1; f <= 60; ++f) before.place(sim).chain.push_back({f, f});
        carry_chains(before, after, sim);
        for (std::size_t i = 0; i < after.place(sim).chain.size(); ++i)
            CHECK(after.place(sim).chain[i] == before.place(sim).chain[i]);
        return after.place(sim).chain.size();
    };
    CHECK(carried(Edit(g).set_key({"n", "value"}, 20, 4).commit().graph) == 10);
    CHECK(carried(Edit(g).set_key({"n", "value"}, 30, 4).commit().graph) == 20);
    CHECK(carried(Edit(g).set_editor_json("{\"x\": 1}").commit().graph) == 60);
    CHECK(carried(Edit(g).set_json({"n", "times"}, "2").commit().graph) == 0);
    CHECK(carried(Edit(g).set_json({"sim", "startFrame"}, "3").commit().graph) == 0);
}

TEST_CASE("a file that changes between two edits is seen", "[carry]") {
    const auto path = std::filesystem::temp_directory_path() / ("sinew_carry_chains_" + std::to_string(::getpid()));
    const auto write = [&](const std::string& text) { std::ofstream(path) << text; };
    write("abc");
    auto counts = std::make_shared<Counts>();
    const std::string nodes = R"("f": {"type": "fileSize", "inputs": {"file": ")" + path.string() + R"("}},
        "sim": {"type": "sim", "inputs": {"target": {"from": "f.out"}, "stiffness": {"keys": [[1, 1], [9, 1]]}}})";
    const auto g = graph(registry(counts), nodes);
    Evaluator e({}, 1);
    number(e, g, {"sim", "out"}, 8);
    CHECK(counts->advances == 7);
    const auto later = Edit(g).set_key({"sim", "stiffness"}, 20, 2).commit().graph;
    number(e, later, {"sim", "out"}, 8);
    CHECK(counts->advances == 7);
    write("a longer text");
    const auto again = Edit(later).set_key({"sim", "stiffness"}, 30, 2).commit().graph;
    const double changed = number(e, again, {"sim", "out"}, 8);
    CHECK(counts->advances == 14);
    Evaluator fresh({}, 1);
    CHECK(changed == number(fresh, again, {"sim", "out"}, 8));
    std::filesystem::remove(path);
}
