// Edits: a new snapshot and its inverse; the base stays; all problems of an edit at once.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>

using namespace toys;

namespace {

constexpr const char* scene = R"("a": {"type": "number", "inputs": {"times": 2, "value": 3}},
    "b": {"type": "number", "inputs": {"value": {"keys": [[1, 2], [5, 3]], "interp": "smooth"}}},
    "s": {"type": "sum", "inputs": {"terms": [{"from": "a.out"}, {"from": "b.out"}, {"from": "a.out"}]}},
    "r": {"type": "relay", "inputs": {"in": {"from": "a.out"}}},
    "odd": {"type": "mystery", "inputs": {"x": [{"from": "a.out"}, {"from": "ab.out"}]}})";

// Commits, checks that the base is untouched, that the inverse restores it and that the inverse's inverse
// repeats it.
std::shared_ptr<const Graph> there_and_back(const std::shared_ptr<const Graph>& base, const Edit& edit) {
    const std::string before = write_graph(*base);
    const Edit::Done done = edit.commit();
    CHECK(write_graph(*base) == before);
    const Edit::Done undone = done.inverse->commit();
    CHECK(write_graph(*undone.graph) == before);
    CHECK(write_graph(*undone.inverse->commit().graph) == write_graph(*done.graph));
    return done.graph;
}

} // namespace

TEST_CASE("every kind of edit has an inverse") {
    const auto g = graph(registry(), scene);
    Evaluator e;
    CHECK(there_and_back(g, Edit(g).add_node("new", "clock"))->find("new")->type_name == "clock");
    CHECK(number(e, there_and_back(g, Edit(g).set_json({"a", "value"}, "{\"value\": 1, \"unit\": \"kPa\"}")),
                 {"a", "out"}, 1) == 2000);
    CHECK(number(e, there_and_back(g, Edit(g).set({"a", "value"}, Value::of<std::int64_t>(7))), {"a", "out"}, 1) == 14);
    CHECK(number(e, there_and_back(g, Edit(g).set({"a", "value"}, Plug{"b", "out"})), {"a", "out"}, 1) == 4);
    CHECK(number(e, there_and_back(g, Edit(g).reset({"a", "times"})), {"a", "out"}, 1) == 3);
    CHECK(number(e, there_and_back(g, Edit(g).set_key({"b", "value"}, 3, 9)), {"b", "out"}, 3) == 9);
    CHECK(number(e, there_and_back(g, Edit(g).set_key({"b", "value"}, 5, 8)), {"b", "out"}, 6) == 8);
    CHECK(number(e, there_and_back(g, Edit(g).set_key({"a", "value"}, 3, 9)), {"a", "out"}, 100) == 18);
    CHECK(there_and_back(g, Edit(g).set_editor_json("{\"x\": 1}"))->editor_json() == "{\"x\": 1}");
    CHECK(there_and_back(g, Edit(g).set_timing({30, 2, 9}))->timing().fps == 30);
    there_and_back(g, Edit(g)
                          .remove_node("a")
                          .add_node("a", "clock")
                          .rename_node("b", "c")
                          .set_json({"c", "value"}, "4")
                          .reset({"s", "terms"}));
}

TEST_CASE("a removed node leaves no connection behind and comes back with all of them") {
    const auto g = graph(registry(), scene);
    const auto without = there_and_back(g, Edit(g).remove_node("a"));
    CHECK(without->node_names() == std::vector<std::string>{"b", "s", "r", "odd"});
    CHECK(std::get<std::vector<Plug>>(without->find("s")->inputs.at("terms")) == std::vector<Plug>{{"b", "out"}});
    CHECK(without->find("r")->inputs.empty());
}

TEST_CASE("connections follow a rename, in nodes of unknown type too") {
    const auto g = graph(registry(), scene);
    const auto renamed = there_and_back(g, Edit(g).rename_node("a", "first"));
    CHECK(std::get<Plug>(renamed->find("r")->inputs.at("in")).node == "first");
    CHECK(std::get<std::vector<Plug>>(renamed->find("s")->inputs.at("terms"))[2].node == "first");
    CHECK(renamed->find("odd")->raw_json ==
          R"({"type": "mystery", "inputs": {"x": [{"from": "first.out"}, {"from": "ab.out"}]}})");
    CHECK(renamed->node_names()[0] == "first");
    CHECK(renamed->spot("first", "value")->pointer == "/nodes/a/inputs/value"); // where it stands in the file
}

TEST_CASE("snapshots share the nodes that an edit does not touch") {
    const auto g = graph(registry(), scene);
    const auto edited = Edit(g).set_json({"a", "value"}, "4").commit().graph;
    CHECK(edited->find("a") != g->find("a"));
    CHECK(edited->find("b") == g->find("b"));
    CHECK(edited->find("s") == g->find("s"));
}

TEST_CASE("an inverse can be applied to a later snapshot") {
    const auto g = graph(registry(), scene);
    const Edit::Done first = Edit(g).set_json({"a", "value"}, "5").commit();
    const auto second = Edit(first.graph).set_json({"a", "times"}, "10").commit().graph;
    const auto undone = first.inverse->rebased(second).commit().graph;
    Evaluator e;
    CHECK(number(e, undone, {"a", "out"}, 1) == 30);
}

TEST_CASE("all problems of an edit come at once and the base stays") {
    const auto g = graph(registry(), scene);
    const auto codes = [](const Edit& e) { return codes_of([&] { e.commit(); }); };
    CHECK(codes(Edit(g)
                    .remove_node("x")
                    .rename_node("y", "z")
                    .add_node("a", "clock")
                    .add_node("n", "clokc")
                    .add_node("a.b", "clock")) == "DG040 DG040 DG041 DG010 DG028");
    CHECK(codes(Edit(g).set_json({"a", "valeu"}, "3").set_json({"a", "value"}, "-3").set_json({"b", "mode"}, "{")) ==
          "DG011 DG001 DG013");
    CHECK(codes(Edit(g).set({"a", "value"}, Value::of<std::string>("x"))) == "DG012");
    CHECK(codes(Edit(g).set({"a", "value"}, Value::of<double>(std::numeric_limits<double>::infinity()))) == "DG027");
    CHECK(codes(Edit(g).set({"a", "value"}, Plug{"s", "text"})) == "DG024");
    CHECK(codes(Edit(g).set({"a", "value"}, Curve{})) == "DG017");
    CHECK(codes(Edit(g).set({"r", "in"}, std::vector<Plug>{{"a", "out"}})) == "DG020");
    CHECK(codes(Edit(g).set({"s", "terms"}, Plug{"a", "out"})) == "DG020");
    CHECK(codes(Edit(g).set_key({"r", "in"}, 1, 1)) == "DG042");
    CHECK(codes(Edit(g).set_key({"a", "mode"}, 1, 2)) == "DG014");
    CHECK(codes(Edit(g).set({"odd", "x"}, Value::of<double>(1))) == "DG101");
    CHECK(codes(Edit(g).set_editor_json("[]").set_timing({0, 5, 1})) == "DG008 DG009 DG009");
    CHECK(codes(Edit(g).set({"a", "value"}, Plug{"r", "out"})) == "DG030");
    CHECK(codes(Edit(g).rename_node("a", "b")) == "DG041");
    CHECK(codes(Edit(g)).empty());
}

TEST_CASE("bool and integer inputs take stepped keys") {
    const auto g = graph(registry(), scene);
    const auto keyed = Edit(g)
                           .set_key({"a", "negate"}, 1, 0)
                           .set_key({"a", "negate"}, 10, 1)
                           .set_key({"a", "times"}, 5, 4)
                           .commit()
                           .graph;
    Evaluator e;
    CHECK(number(e, keyed, {"a", "out"}, 9.9) == 12);
    CHECK(number(e, keyed, {"a", "out"}, 10) == -12);
}

TEST_CASE("an edit of the timing as if it were a node is told where that stands") {
    const auto g = graph(registry(), R"("n": {"type": "number"})");
    try {
        Edit(g).set_json({"timing", "end"}, "5").commit();
        FAIL("it was set");
    } catch (const Failure& f) {
        CHECK(f.diagnostics().front().code == "DG040");
        CHECK(f.diagnostics().front().hint == "it is no node: write \"timing\": { \"end\": … } in the graph file");
    }
}
