// Graphs that include graphs: names, overrides, places of what is wrong, edits, and what is written back.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/engine_toys.h"
#include "tests/tools/temporary_folder.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace toys;
using sinew::test::read_text;
using sinew::test::TemporaryFolder;
using sinew::test::write_text;

namespace {

/// A folder of graph files, the outermost of which is "top.json".
struct Files {
    TemporaryFolder folder;
    std::shared_ptr<const Registry> types = registry();

    void put(const std::string& name, const std::string& nodes, const std::string& includes = {},
             const std::string& more = {}) {
        const auto path = folder / name;
        std::filesystem::create_directories(path.parent_path());
        write_text(path, "{ \"format\": \"sinew 1\",\n" + more +
                             (includes.empty() ? "" : "\"includes\": {\n" + includes + "\n},\n") + "\"nodes\": {\n" +
                             nodes + "\n} }\n");
    }
    std::string path(const std::string& name = "top.json") const { return (folder / name).string(); }
    Loaded load() const { return load_graph(types, path()); }
    std::shared_ptr<const Graph> graph() const { return load().graph; }
    std::vector<Diagnostic> problems() const {
        try {
            load();
        } catch (const Failure& f) {
            return {f.diagnostics().begin(), f.diagnostics().end()};
        }
        return {};
    }
    /// "CODE node.attribute file:line:column <- including file:line:column …", one a line.
    std::string places() const { return places(problems()); }
    std::string places(const std::vector<Diagnostic>& all) const {
        std::string out;
        const auto spot = [&](const SourceSpot& s) {
            return std::filesystem::path(s.file).lexically_relative(folder.path()).generic_string() + ":" +
                   std::to_string(s.line) + ":" + std::to_string(s.column);
        };
        for (const Diagnostic& d : all) {
            out += (out.empty() ? "" : "\n") + d.code + " " + d.node + (d.attribute.empty() ? "" : "." + d.attribute);
            if (!d.spot) continue;
            out += " " + spot(*d.spot);
            for (const SourceSpot& s : d.spot->included_by) out += " <- " + spot(s);
        }
        return out;
    }
};

double at(const std::shared_ptr<const Graph>& g, const Plug& plug, double frame = 1) {
    Evaluator e;
    return number(e, g, plug, frame);
}

const std::string pair_of_numbers = R"("a": { "type": "number", "inputs": { "value": 3 } },
"b": { "type": "relay", "inputs": { "in": { "from": "a.out" } } })";

} // namespace

TEST_CASE("an included graph stands under its prefix, wired into and out of") {
    Files f;
    f.put("parts/pair.json", pair_of_numbers);
    f.put("top.json", R"("eight": { "type": "number", "inputs": { "value": 8 } },
"all": { "type": "sum", "inputs": { "terms": [ { "from": "x.b.out" }, { "from": "y.b.out" } ] } })",
          R"("x": { "file": "parts/pair.json" },
"y": { "file": "parts/pair.json", "overrides": { "b.in": { "from": "eight.out" } } })");
    const auto g = f.graph();
    CHECK(g->node_names() == std::vector<std::string>{"x.a", "x.b", "y.a", "y.b", "eight", "all"});
    CHECK(at(g, {"x.b", "out"}) == 4); // a relay adds 1
    CHECK(at(g, {"y.b", "out"}) == 9);
    CHECK(at(g, {"all", "out"}) == 13);
}

TEST_CASE("an override takes the place of a value, of keys and of what a nested include says") {
    Files f;
    f.put("inner.json", pair_of_numbers);
    f.put("middle.json", R"("c": { "type": "relay", "inputs": { "in": { "from": "deep.b.out" } } })",
          R"("deep": { "file": "inner.json", "overrides": { "a.value": 5 } })");
    f.put("top.json", R"("d": { "type": "relay", "inputs": { "in": { "from": "m.c.out" } } })",
          R"("m": { "file": "middle.json" },
"n": { "file": "middle.json", "overrides": { "deep.a.value": { "keys": [[1, 6], [3, 10]], "interp": "linear" } } })");
    const auto g = f.graph();
    CHECK(at(g, {"m.deep.b", "out"}) == 6);
    CHECK(at(g, {"d", "out"}) == 8);       // three relays
    CHECK(at(g, {"n.c", "out"}, 2) == 10); // halfway between the keys, two relays
}

TEST_CASE("paths start at the folder of the file that they stand in") {
    Files f;
    f.put("parts/size.json", R"("s": { "type": "fileSize", "inputs": { "file": "data.txt" } })");
    f.put("top.json", "", R"("x": { "file": "parts/size.json" },
"y": { "file": "parts/../parts/size.json", "overrides": { "s.file": "data.txt" } })");
    write_text(f.folder / "parts/data.txt", "12345");
    write_text(f.folder / "data.txt", "12");
    const auto g = f.graph();
    CHECK(at(g, {"x.s", "out"}) == 5);
    CHECK(at(g, {"y.s", "out"}) == 2);
}

TEST_CASE("what is missing in an included graph may be connected from outside") {
    Files f;
    f.put("part.json", R"("b": { "type": "relay" })");
    f.put("top.json", R"("a": { "type": "number", "inputs": { "value": 4 } })",
          R"("x": { "file": "part.json", "overrides": { "b.in": { "from": "a.out" } } })");
    CHECK(at(f.graph(), {"x.b", "out"}) == 5);
    f.put("top.json", "", R"("x": { "file": "part.json" })");
    CHECK(f.places() == "DG019 x.b.in part.json:3:1 <- top.json:3:1");
    CHECK(f.problems()[0].hint.find("override \"b.in\"") != std::string::npos);
    CHECK_THROWS_AS(load_graph(f.types, f.path("part.json")), Failure); // not on its own
}

TEST_CASE("the timing of the outermost graph counts, and other frames a second are warned about") {
    Files f;
    f.put("part.json", R"("s": { "type": "sim" })", {}, "\"timing\": { \"fps\": 30, \"start\": 7, \"end\": 9 },\n");
    f.put("top.json", "", R"("x": { "file": "part.json" })",
          "\"timing\": { \"fps\": 25, \"start\": 2, \"end\": 4 },\n");
    const Loaded l = f.load();
    CHECK(l.graph->timing().start == 2);
    CHECK(f.places(l.notes) == "DG136 x top.json:4:16");
    f.put("part.json", R"("s": { "type": "sim" })", {}, "\"timing\": { \"start\": 7, \"end\": 9 },\n");
    CHECK(f.load().notes.empty());
}

TEST_CASE("problems in an included file are told with that file, its place and who includes it") {
    Files f;
    f.put("inner.json", R"("a": { "type": "number", "inputs": { "valu": 1,
"times": 0 } },
"r": { "type": "relay", "inputs": { "in": { "from": "nobody.out" } } })");
    f.put("middle.json", "", R"("deep": { "file": "inner.json" })");
    f.put("top.json", "", R"("m": { "file": "middle.json" },
"again": { "file": "inner.json" })");
    const std::string chain = " <- middle.json:3:1 <- top.json:3:1";
    CHECK(f.places() == "DG011 m.deep.a.valu inner.json:3:38" + chain + "\nDG013 m.deep.a.times inner.json:4:10" +
                            chain + "\nDG022 m.deep.r.in inner.json:5:53" + chain);
    const Diagnostic d = f.problems()[0];
    CHECK(d.spot->pointer == "/nodes/a/inputs/valu");
    CHECK(d.spot->included_by[0].pointer == "/includes/deep");
    CHECK(to_text(d).find("\n  included by " + f.path("middle.json") + ":3:1 at /includes/deep\n  included by " +
                          f.path() + ":3:1 at /includes/m") != std::string::npos);
    const auto json = nlohmann::json::parse(to_json(d));
    CHECK(json["included_by"].size() == 2);
    CHECK(json["included_by"][1]["pointer"] == "/includes/m");
    f.put("inner.json", R"("a": { "type": number })");
    CHECK(f.places() == "DG001  inner.json:3:16" + chain);
}

TEST_CASE("a warning of an included file has its place, too") {
    Files f;
    f.put("part.json", R"("odd": { "type": "numbr" })");
    f.put("top.json", "", R"("x": { "file": "part.json" })");
    const Loaded l = f.load();
    CHECK(f.places(l.notes) == "DG010 x.odd part.json:3:18 <- top.json:3:1");
    f.put("top.json", "", R"("x": { "file": "part.json", "overrides": { "odd.value": 3 } })");
    CHECK(f.places().rfind("DG101 x.odd.value top.json:3:44", 0) == 0);
}

TEST_CASE("includes that cannot be read say why, where they are included") {
    Files f;
    const auto said = [&](const std::string& includes) {
        f.put("top.json", R"("r": { "type": "relay", "inputs": { "in": { "from": "x.a.out" } } })", includes);
        return f.places();
    };
    write_text(f.folder / "mesh.obj", "v 0 0 0\n");
    f.put("part.json", pair_of_numbers);
    CHECK(said(R"("x": { "file": "none.json" })") == "IO401 x top.json:3:16");
    CHECK(f.problems()[0].message == "there is no such graph file: " + f.path("none.json"));
    CHECK(said(R"("x": { "file": "." })") == "IO402 x top.json:3:16");
    CHECK(said(R"("x": { "file": "mesh.obj" })") == "DG004 x top.json:3:16");
    CHECK(said(R"("x": {})") == "DG130 x top.json:3:6");
    CHECK(said(R"("x": { "file": "" })") == "DG130 x top.json:3:16");
    CHECK(said(R"("x": { "file": 3 })") == "DG130 x top.json:3:16");
    CHECK(said(R"("x": "part.json")") == "DG008 x top.json:3:6");
    CHECK(said(R"("x": { "file": "part.json", "override": {} })") == "DG007 x top.json:3:29");
    CHECK(said(R"("x": { "file": "part.json", "overrides": [] })") == "DG008 x top.json:3:42");
    CHECK(said(R"("x": { "file": "part.json" }, "x": { "file": "part.json" })") == "DG002  top.json:3:31");
    write_text(f.folder / "top.json", R"({ "format": "sinew 1", "includes": [], "nodes": {} })");
    CHECK(f.places() == "DG008  top.json:1:36");
}

TEST_CASE("prefixes that cannot be used") {
    Files f;
    f.put("part.json", pair_of_numbers);
    const auto said = [&](const std::string& prefix) {
        f.put("top.json", "\"n\": { \"type\": \"number\" }", "\"" + prefix + "\": { \"file\": \"part.json\" }");
        return f.places();
    };
    CHECK(said("n") == "DG131 n top.json:3:1");
    CHECK(said("") == "DG131  top.json:3:1");
    CHECK(said("x.y") == "DG131 x.y top.json:3:1");
    CHECK(said("x\\u0007") == "DG131 x\a top.json:3:1");
    CHECK(said("x y").empty());
}

TEST_CASE("overrides are checked like inputs, at their own place") {
    Files f;
    f.put("part.json", pair_of_numbers);
    const auto said = [&](const std::string& override_text) {
        f.put("top.json", "", "\"x\": { \"file\": \"part.json\", \"overrides\": {\n" + override_text + " } }");
        return f.places();
    };
    CHECK(said(R"("c.value": 3)") == "DG133 x.c top.json:4:1");
    CHECK(said(R"("a.valeu": 3)") == "DG011 x.a.valeu top.json:4:1");
    CHECK(f.problems()[0].hint == "did you mean \"value\"?");
    CHECK(said(R"("value": 3)") == "DG134 x top.json:4:1");
    CHECK(said(R"("a.value": -3)") == "DG013 x.a.value top.json:4:12");
    CHECK(said(R"("a.value": "3 kg")") == "DG015 x.a.value top.json:4:12");
    CHECK(said(R"("b.in": { "from": "b.out" })") == "DG022 x.b.in top.json:4:19"); // names are those of this file
    CHECK(said(R"("b.in": { "from": "x.b.out" })") == "DG030 x.b part.json:4:1 <- top.json:3:1");
    CHECK(said(R"("b.in": 3)") == "DG026 x.b.in top.json:4:9");
}

TEST_CASE("graphs that include each other in a circle are refused") {
    Files f;
    f.put("a.json", "", R"("b": { "file": "b.json" })");
    f.put("b.json", "", R"("a": { "file": "./a.json" })");
    f.put("top.json", "", R"("a": { "file": "a.json" })");
    CHECK(f.places() == "DG132 a.b.a b.json:3:16 <- a.json:3:1 <- top.json:3:1");
    CHECK(f.problems()[0].message.find("a.json -> ") != std::string::npos);
    // Paths as they were named, not where they lead.
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(f.folder.path());
    try {
        load_graph(registry(), "top.json");
        FAIL("it was read");
    } catch (const Failure& failure) {
        CHECK(failure.diagnostics()[0].message ==
              "these graphs include each other in a circle: a.json -> b.json -> a.json");
    }
    std::filesystem::current_path(before);
    f.put("top.json", "", R"("me": { "file": "top.json" })");
    CHECK(f.places() == "DG132 me top.json:3:17");
    std::filesystem::create_symlink(f.path(), f.path("other_name.json"));
    f.put("top.json", "", R"("me": { "file": "other_name.json" })");
    CHECK(f.places() == "DG132 me top.json:3:17");
}

TEST_CASE("includes without an end are refused before memory runs out") {
    Files f;
    const auto name = [](int i) { return std::to_string(i) + ".json"; };
    f.put(name(0), R"("n": { "type": "number" })");
    // Each file includes the one before it twice: 2^i nodes.
    for (int i = 1; i <= 30; ++i)
        f.put(name(i), "",
              "\"l\": { \"file\": \"" + name(i - 1) + "\" },\n\"r\": { \"file\": \"" + name(i - 1) + "\" }");
    f.put("top.json", "", R"("all": { "file": "9.json" })");
    CHECK(f.graph()->node_names().size() == 512);
    f.put("top.json", "", R"("all": { "file": "30.json" })");
    const auto many = f.problems();
    REQUIRE(many.size() == 1);
    CHECK(many[0].code == "DG135");
    CHECK(many[0].message == "more than 1000000 nodes are included");
    f.put(name(0), "", R"("n": { "file": "40.json" })");
    for (int i = 40; i < 80; ++i) f.put(name(i), "", "\"n\": { \"file\": \"" + name(i + 1) + "\" }");
    f.put("top.json", "", R"("n": { "file": "40.json" })");
    const auto deep = f.problems();
    REQUIRE(deep.size() == 1);
    CHECK(deep[0].code == "DG135");
    CHECK(deep[0].message == "more than 32 graphs are included one inside the other");
}

TEST_CASE("written back, includes stay includes with what the graph says of them") {
    Files f;
    f.put("parts/pair.json", pair_of_numbers);
    const std::string text = R"({
  "format": "sinew 1",
  "timing": { "fps": 24, "start": 1, "end": 1 },
  "includes": {
    // the first
    "x": { "file": "parts/pair.json", "comment": "as it is" },
    "y": { "file": "parts/pair.json", "overrides": {
        "b.in": { "from": "eight.out" },
        // the default, where the file has another
        "a.value": 1
      } }
    // no more
  },
  "nodes": {
    "eight": { "type": "number", "inputs": {
        "value": 8
      } }
  },
  "editor": {}
}
)";
    write_text(f.folder / "top.json", text);
    const auto g = f.graph();
    CHECK(write_graph(*g) == text);

    const auto done =
        Edit(g).set({"x.a", "value"}, Value::of(7.0)).reset({"y.a", "value"}).rename_node("eight", "acht").commit();
    CHECK(at(done.graph, {"x.b", "out"}) == 8);
    CHECK(at(done.graph, {"y.a", "out"}) == 3); // back to what its file says
    const std::string changed = write_graph(*done.graph);
    CHECK(changed.find(R"("x": { "file": "parts/pair.json", "comment": "as it is", "overrides": {
        "a.value": 7
      } })") != std::string::npos);
    CHECK(changed.find(R"("b.in": { "from": "acht.out" })") != std::string::npos);
    CHECK(changed.find("\"x.a\"") == std::string::npos);
    write_text(f.folder / "top.json", changed);
    CHECK(write_graph(*f.graph()) == changed);
    const auto back = done.inverse->commit().graph;
    CHECK(at(back, {"x.b", "out"}) == 4);
    CHECK(at(back, {"y.a", "out"}) == 1);
    CHECK(at(back, {"y.b", "out"}) == 9);
    // Comments of an override that is taken back and set again do not matter for values.
    CHECK(write_graph(*back).find("\"x\": { \"file\": \"parts/pair.json\", \"comment\": \"as it is\" }") !=
          std::string::npos);
}

TEST_CASE("edits leave the nodes of included graphs where they are") {
    Files f;
    f.put("pair.json", pair_of_numbers);
    f.put("top.json", R"("n": { "type": "number", "inputs": { "value": 2 } })",
          R"("x": { "file": "pair.json", "overrides": { "b.in": { "from": "n.out" } } })");
    const auto g = f.graph();
    CHECK(codes_of([&] { Edit(g).remove_node("x.a").commit(); }) == "DG137");
    CHECK(codes_of([&] { Edit(g).rename_node("x.a", "y").commit(); }) == "DG137");
    CHECK(codes_of([&] { Edit(g).add_node("x", "number").commit(); }) == "DG041");
    CHECK(codes_of([&] { Edit(g).rename_node("n", "x").commit(); }) == "DG041");
    CHECK(codes_of([&] { Edit(g).add_node("x.c", "number").commit(); }) == "DG028");
    CHECK(codes_of([&] { Edit(g).set({"x.a", "value"}, Value::of(-1.0)).commit(); }) == "DG013");
    // The node that an override reads goes: the file's own connection is there again; and the way back.
    const auto done = Edit(g).remove_node("n").commit();
    CHECK(at(done.graph, {"x.b", "out"}) == 4);
    CHECK(write_graph(*done.graph).find("overrides") == std::string::npos);
    const auto back = done.inverse->commit().graph;
    CHECK(at(back, {"x.b", "out"}) == 3);
    CHECK(write_graph(*back) == write_graph(*g));
}

TEST_CASE("places of included nodes are those of their files") {
    Files f;
    f.put("pair.json", pair_of_numbers);
    f.put("top.json", "", R"("x": { "file": "pair.json", "overrides": {
"a.value": 9 } })");
    const auto g = f.graph();
    const auto spot = g->spot("x.b", "in");
    REQUIRE(spot);
    CHECK(spot->file == f.path("pair.json"));
    CHECK(spot->line == 4);
    REQUIRE(spot->included_by.size() == 1);
    CHECK(spot->included_by[0].file == f.path());
    CHECK(g->spot("x.a", "value")->file == f.path());
    CHECK(g->spot("x.a", "value")->pointer == "/includes/x/overrides/a.value");
    CHECK(g->spot("x.a", "value")->line == 4);
    CHECK_FALSE(g->spot("x.a", "times"));
    const auto edited = Edit(g).set({"x.a", "value"}, Value::of(1.0)).commit().graph;
    CHECK_FALSE(edited->spot("x.a", "value"));
    CHECK(edited->spot("x.a")->file == f.path("pair.json"));
}

TEST_CASE("two includes of one graph are computed once, and an override only where it counts") {
    Files f;
    auto counts = std::make_shared<Counts>();
    f.types = registry(counts);
    f.put("pair.json", pair_of_numbers);
    f.put("top.json",
          R"("all": { "type": "sum", "inputs": { "terms": [ { "from": "x.b.out" }, { "from": "y.b.out" } ] } })",
          R"("x": { "file": "pair.json" }, "y": { "file": "pair.json" })");
    Evaluator e;
    CHECK(number(e, f.graph(), {"all", "out"}, 1) == 8);
    CHECK(counts->computes == 3); // a, b and the sum: names are no part of keys
    f.put("top.json",
          R"("all": { "type": "sum", "inputs": { "terms": [ { "from": "x.b.out" }, { "from": "y.b.out" } ] } })",
          R"("x": { "file": "pair.json" }, "y": { "file": "pair.json", "overrides": { "a.value": 4 } })");
    CHECK(number(e, f.graph(), {"all", "out"}, 1) == 9);
    CHECK(counts->computes == 6); // y.a, y.b and the sum
}

TEST_CASE("where a node is missing that an include has, it is named with its prefix before what is spelt alike") {
    Files f;
    const std::string flag = R"("flag": { "type": "number" }, "edge": { "type": "relay", "inputs": {
"in": { "from": "flag.out" } } }, "pole": { "type": "relay", "inputs": { "in": { "from": "flag.out" } } })";
    f.put("part.json", flag);
    f.put("middle.json", "", R"("deep": { "file": "part.json" })");
    const auto hints = [&](const std::string& includes) {
        f.put("top.json", R"("flagg": { "type": "number" })", includes);
        std::vector<std::string> out;
        for (const Diagnostic& d : f.problems()) out.push_back(d.code + ": " + d.hint);
        return out;
    };
    using Hints = std::vector<std::string>;
    const auto part = [](const std::string& prefix, const std::string& input, const std::string& from) {
        return "\"" + prefix + "\": { \"file\": \"part.json\", \"overrides\": { \"" + input + "\": { \"from\": \"" +
               from + "\" } } }";
    };
    CHECK(hints(part("a", "pole.in", "flag.out")) == Hints{R"(DG022: did you mean "a.flag"?)"});
    CHECK(hints(part("a", "pole.in", "edge.out")) == Hints{R"(DG022: did you mean "a.edge"?)"});
    // Of the same include where it is in several; of all that have it where that one has none but the node itself.
    const std::string more = R"(, "b": { "file": "part.json" }, "c": { "file": "middle.json" })";
    CHECK(hints(part("a", "pole.in", "flag.out") + more) == Hints{R"(DG022: did you mean "a.flag"?)"});
    CHECK(hints(part("a", "pole.in", "pole.out") + more) == Hints{R"(DG022: did you mean "b.pole" or "c.deep.pole"?)"});
    CHECK(hints(part("a", "pole.in", "flaggs.out")) == Hints{R"(DG022: did you mean "flagg"?)"});
    CHECK(hints(R"("m": { "file": "middle.json", "overrides": { "deep.pole.in": { "from": "edge.out" } } })") ==
          Hints{R"(DG022: did you mean "m.deep.edge"?)"});

    // An edit, as --set is one: all that have it.
    f.put("top.json", R"("flagg": { "type": "number" })", R"("a": { "file": "part.json" })" + more);
    const auto g = f.graph();
    const auto hint = [&](const Plug& plug) {
        try {
            Edit(g).set(plug, Value::of(1.0)).commit();
        } catch (const Failure& failure) {
            const Diagnostic& d = failure.diagnostics().front();
            return d.code + ": " + d.hint;
        }
        return std::string();
    };
    CHECK(hint({"flag", "value"}) == R"(DG040: did you mean "a.flag", "b.flag" or "c.deep.flag"?)");
    CHECK(hint({"deep.flag", "value"}) == R"(DG040: did you mean "c.deep.flag"?)");
    std::string eight;
    for (const char name : std::string("abcdefgh"))
        eight += (eight.empty() ? "\"" : ", \"") + std::string(1, name) + R"(": { "file": "part.json" })";
    CHECK(hints(eight + ", " + part("x", "pole.in", "edge.out")) == Hints{R"(DG022: did you mean "x.edge"?)"});
    f.put("top.json", R"("r": { "type": "relay", "inputs": { "in": { "from": "edge.out" } } })", eight);
    CHECK(f.problems().front().hint == R"(did you mean "a.edge", "b.edge", "c.edge", "d.edge", "e.edge", "f.edge" or )"
                                       "another include's?");
}
