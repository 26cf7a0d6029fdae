// Graph files: every diagnostic with its line and column, all problems at once, and what is written reads
// back.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/json_text.h"
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <unistd.h>

using namespace toys;

namespace {

const std::shared_ptr<const Registry>& types() {
    static const std::shared_ptr<const Registry> r = registry();
    return r;
}

std::vector<Diagnostic> problems_of(const std::string& text) {
    try {
        read_graph(types(), text, "t.json");
    } catch (const Failure& f) {
        return {f.diagnostics().begin(), f.diagnostics().end()};
    }
    return {};
}

// "DG011@7:25 …"
std::string places(const std::vector<Diagnostic>& all) {
    std::string out;
    for (const Diagnostic& d : all) {
        out += (out.empty() ? "" : " ") + d.code;
        if (d.spot) out += "@" + std::to_string(d.spot->line) + ":" + std::to_string(d.spot->column);
    }
    return out;
}

std::string in_document(const std::string& nodes) {
    return "{\"format\": \"sinew 1\", \"nodes\": {\n" + nodes + "\n}}";
}

// One input of a node of type "number", on line 2; its value begins in column 50.
std::string with_input(const std::string& name, const std::string& value) {
    std::string line = R"("n": {"type": "number", "inputs": {")" + name + "\": ";
    line.insert(line.size(), 49 - line.size(), ' ');
    return in_document(line + value + "}}");
}

std::string input_problem(const std::string& name, const std::string& value) {
    return places(problems_of(with_input(name, value)));
}

std::string hint_of(const std::string& text) {
    const auto all = problems_of(text);
    return all.empty() ? "" : all[0].hint;
}

} // namespace

TEST_CASE("syntax errors have line and column") {
    CHECK(places(problems_of("")) == "DG001@1:1");
    CHECK(places(problems_of("{\n  \"format\": \"sinew 1\",\n  \"nodes\": {,}\n}")) == "DG001@3:13");
    CHECK(places(problems_of("{\"format\": \"sinew 1\" \"nodes\": {}}")) == "DG001@1:22");
    CHECK(places(problems_of("[1, 2")) == "DG001@1:6");
    CHECK(places(problems_of("{\"a\": tru}")) == "DG001@1:7");
    CHECK(places(problems_of("{\"a\": \"x\ny\"}")) == "DG001@1:9");
    CHECK(places(problems_of("{\"a\": \"\\q\"}")) == "DG001@1:9");
    CHECK(places(problems_of("{\"a\": \"\\ud800\"}")) == "DG001@1:14");
    CHECK(places(problems_of("{\"a\": 01}")) == "DG001@1:8");
    CHECK(places(problems_of("{\"a\": 1.}")) == "DG001@1:9");
    CHECK(places(problems_of("{} {}")) == "DG001@1:4");
    CHECK(places(problems_of("{\"a\": \"\xff\"}")) == "DG001@1:8");
    CHECK(places(problems_of("{\"ö\": }")) == "DG001@1:7"); // columns count characters, not bytes
    CHECK(problems_of("{\"a\": nul}")[0].message == "expected a value, found \"n\"");
}

TEST_CASE("columns count characters of two, three and four bytes as one") {
    CHECK(places(problems_of("{\"\u20ac\": }")) == "DG001@1:7");
    CHECK(places(problems_of("{\"\U0001f600\": }")) == "DG001@1:7");
    CHECK(places(problems_of("{\"\u00f6\u20ac\U0001f600\": }")) == "DG001@1:9");
}

TEST_CASE("escapes in strings and pointers stand for their characters") {
    const JsonDocument text =
        parse_json(R"(["\ud83d\ude00", "\u20ac", "\u00f6", "\u0041", "\ud800\udc00", "\udbff\udfff"])");
    REQUIRE(text.problems.empty());
    const char* expected[] = {"\xF0\x9F\x98\x80", "\xE2\x82\xAC",    "\xC3\xB6", "A",
                              "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF"}; // UTF-8, RFC 3629
    const auto& list = *text.root.as<Json::List>();
    for (std::size_t i = 0; i < list.size(); ++i) CHECK(*list[i].as<std::string>() == expected[i]);
    // RFC 6901: ~1 is a slash and ~0 a tilde.
    const JsonDocument object = parse_json(R"({"a/b": {"c~d": 7, "c": 8}, "a": 9})");
    CHECK(*object.root.nearest("/a~1b/c~0d").as<std::int64_t>() == 7);
    CHECK(*object.root.nearest("/a~1b/c").as<std::int64_t>() == 8);
}

TEST_CASE("duplicate keys, depth and huge numbers are errors") {
    CHECK(places(problems_of("{\"format\": \"sinew 1\",\n \"nodes\": {\"a\": 1,\n \"a\": 2}, \"format\": 3}")) ==
          "DG002@3:2 DG002@3:11");
    CHECK(places(problems_of(std::string(100, '['))) == "DG003@1:66");
    CHECK(places(problems_of("{\"a\": 1e999}")) == "DG027@1:7");
    CHECK(problems_of("{\"format\": \"sinew 1\", \"nodes\": {}, \"editor\": {\"tiny\": 1e-999}}").empty());
}

TEST_CASE("the format must be there and known") {
    CHECK(places(problems_of("{\"nodes\": {}}")) == "DG004@1:1");
    CHECK(places(problems_of("[]")) == "DG004@1:1");
    CHECK(places(problems_of("{\"format\": \"zgraph 1\"}")) == "DG004@1:12");
    CHECK(places(problems_of("{\"format\": 1}")) == "DG004@1:12");
    CHECK(places(problems_of("{\"format\": \"sinew 1x\"}")) == "DG004@1:12");
    CHECK(places(problems_of("{\"format\": \"sinew 0\"}")) == "DG006@1:12");
    const auto newer = problems_of("{\"format\": \"sinew 7\", \"whatever\": 1}");
    CHECK(places(newer) == "DG005@1:12");
    CHECK(newer[0].message == "the file has format 7, this program reads up to 1");
}

TEST_CASE("the document's own keys are checked") {
    CHECK(places(problems_of("{\"format\": \"sinew 1\", \"node\": {},\n \"nodes\": {}}")) == "DG007@1:23");
    CHECK(hint_of("{\"format\": \"sinew 1\", \"node\": {}, \"nodes\": {}}") == "did you mean \"nodes\"?");
    CHECK(places(problems_of("{\"format\": \"sinew 1\"}")) == "DG008@1:1");
    CHECK(places(problems_of("{\"format\": \"sinew 1\", \"nodes\": []}")) == "DG008@1:32");
    CHECK(places(problems_of(in_document("\"a\": 3, \"b\": {\"inputs\": {}}, \"c\": {\"type\": 4}"))) ==
          "DG008@2:6 DG008@2:9 DG008@2:44");
    CHECK(places(problems_of(in_document("\"a\": {\"type\": \"number\", \"inputs\": [], \"colour\": 1}"))) ==
          "DG007@2:39 DG008@2:35");
    CHECK(places(problems_of(in_document("\"a.b\": {\"type\": \"number\"}, \"\": {\"type\": \"number\"}"))) ==
          "DG028@2:1 DG028@2:28");
    CHECK(places(problems_of("{\"format\": \"sinew 1\", \"nodes\": {}, \"editor\": 3}")) == "DG008@1:46");
}

TEST_CASE("timing is checked") {
    const auto timing = [](const std::string& t) {
        return places(problems_of("{\"format\": \"sinew 1\", \"nodes\": {},\n\"timing\": " + t + "}"));
    };
    CHECK(timing("{\"fps\": 25, \"start\": 5, \"end\": 5}").empty());
    CHECK(timing("{\"fps\": 0}") == "DG009@2:19");
    CHECK(timing("{\"fps\": \"24\"}") == "DG008@2:19");
    CHECK(timing("{\"start\": 1.5}") == "DG009@2:21");
    CHECK(timing("{\"start\": 9, \"end\": 3}") == "DG009@2:31");
    CHECK(timing("{\"end\": 3, \"begin\": 2}") == "DG007@2:22");
    CHECK(timing("[]") == "DG008@2:11");
    // A step of a billion seconds, a film of eleven hours, frames that no number tells apart.
    CHECK(timing("{\"fps\": 0.001}").empty());
    CHECK(timing("{\"fps\": 1e6}").empty());
    CHECK(timing("{\"fps\": 0.0009}") == "DG009@2:19");
    CHECK(timing("{\"fps\": 1000001}") == "DG009@2:19");
    CHECK(timing("{\"start\": -4, \"end\": 999995}").empty());
    CHECK(timing("{\"start\": -4, \"end\": 999996}") == "DG009@2:32");
    CHECK(timing("{\"start\": -999999999, \"end\": 999999999}") == "DG009@2:40");
    CHECK(timing("{\"end\": 1e9}") == "DG009@2:19");
    const auto said = [](const std::string& t) {
        const Diagnostic d = problems_of("{\"format\": \"sinew 1\", \"nodes\": {}, \"timing\": " + t + "}").at(0);
        return d.message + " | " + d.hint;
    };
    CHECK(said("{\"start\": 9, \"end\": 3}") ==
          "the end 3 comes before the start 9 | write \"start\": 3, \"end\": 9 if they are the wrong way round");
    CHECK(said("{\"end\": 1000001}") ==
          "1000001 frames from 1 to 1000001; a million are possible | write the last frame that is wanted");
    CHECK(said("{\"end\": 1e18}") == "frame 1e+18 is too far from 0; frames lie within a billion | ");
    CHECK(said("{\"fps\": \"24\"}") == "expected a number, found text | write 24 without quotes");
}

TEST_CASE("inputs: unknown name, wrong type, limits, options") {
    const auto unknown = problems_of(in_document(R"("n": {"type": "number", "inputs": {"vaule": 3}})"));
    CHECK(places(unknown) == "DG011@2:36");
    CHECK(to_text(unknown[0]) == "t.json:2:36: error [DG011] n.vaule: no such input on number\n  hint: did "
                                 "you mean \"value\"?\n  at /nodes/n/inputs/vaule");
    CHECK(input_problem("value", "\"3\"") == "DG012@2:50");
    CHECK(input_problem("value", "null") == "DG012@2:50");
    CHECK(input_problem("value", "[3]") == "DG012@2:50");
    CHECK(input_problem("value", "{}") == "DG012@2:50");
    CHECK(input_problem("times", "1.5") == "DG012@2:50");
    CHECK(input_problem("times", "2.0").empty());
    CHECK(input_problem("negate", "1") == "DG012@2:50");
    CHECK(input_problem("mode", "true") == "DG012@2:50");
    CHECK(input_problem("value", "-1") == "DG013@2:50");
    CHECK(input_problem("value", "{\"value\": -1}") == "DG013@2:60");
    CHECK(problems_of(with_input("value", "-1"))[0].message == "-1 is outside [0, 1e+09] Pa");
    CHECK(input_problem("times", "0") == "DG013@2:50");
    CHECK(input_problem("mode", "\"doubel\"") == "DG014@2:50");
    CHECK(hint_of(with_input("mode", "\"doubel\"")) == "did you mean \"double\"? options: plain or double");
    CHECK(input_problem("weights", "[0.5, 2, 1]") == "DG013@2:56");
    CHECK(input_problem("weights", "[0.5, \"x\"]") == "DG012@2:56");
    CHECK(input_problem("weights", "0.5").empty());
    CHECK(input_problem("axis", "[1, 2]") == "DG012@2:50");
    CHECK(input_problem("matrix", "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]").empty());
    CHECK(input_problem("matrix", "[1, 2, 3]") == "DG012@2:50");
    CHECK(input_problem("value", "{\"value\": 1, \"vlaue\": 2}") == "DG007@2:72");
    CHECK(input_problem("value", "{\"value\": 1, \"keys\": []}") == "DG012@2:71");
}

TEST_CASE("units are converted and their dimension is checked") {
    const auto value = [](const std::string& name, const std::string& json) {
        const auto g = read_graph(types(), with_input(name, json), "t.json").graph;
        return std::get<Value>(g->find("n")->inputs.at(name));
    };
    CHECK(value("value", "{\"value\": 12, \"unit\": \"kPa\"}").as<double>() == 12000);
    CHECK(value("value", "{\"value\": 3, \"unit\": \"N/cm^2\"}").as<double>() == Approx(30000).epsilon(1e-15));
    CHECK(value("axis", "{\"value\": [1, 2, 3], \"unit\": \"mm\"}").as<Vec3>() == Vec3{0.001, 0.002, 0.003});
    CHECK(input_problem("value", "{\"value\": 1, \"unit\": \"cm\"}") == "DG015@2:71");
    CHECK(hint_of(with_input("value", "{\"value\": 1, \"unit\": \"cm\"}")) == "usual units here: Pa, kPa or MPa");
    CHECK(input_problem("value", "{\"value\": 1, \"unit\": \"parsec\"}") == "DG015@2:71");
    CHECK(input_problem("value", "{\"value\": 1, \"unit\": 3}") == "DG015@2:71");
    CHECK(input_problem("times", "{\"value\": 1, \"unit\": \"m\"}") == "DG015@2:71");
    CHECK(value("value", "{\"preset\": \"fat\"}").as<double>() == 500);
    CHECK(input_problem("value", "{\"preset\": \"fatt\"}") == "DG016@2:61");
    CHECK(input_problem("times", "{\"preset\": \"fat\"}") == "DG016@2:61");
    CHECK(input_problem("value", "{\"preset\": \"fat\", \"unit\": \"Pa\"}") == "DG015@2:76");
}

TEST_CASE("keyframes are checked") {
    CHECK(input_problem("value", "{\"keys\": [[1, 2], [5, 3, {\"in\": 0, \"out\": 1}]], \"interp\": \"smooth\"}")
              .empty());
    CHECK(input_problem("value", "{\"keys\": []}") == "DG017@2:59");
    CHECK(input_problem("value", "{\"keys\": 3}") == "DG012@2:59");
    CHECK(input_problem("value", "{\"keys\": [[1, 2], [1, 3]]}") == "DG017@2:68");
    CHECK(input_problem("value", "{\"keys\": [[5, 2], [1, 3]]}") == "DG017@2:68");
    CHECK(input_problem("value", "{\"keys\": [[1, 2], [2]]}") == "DG017@2:68");
    CHECK(input_problem("value", "{\"keys\": [[1, 2], [2, \"x\"]]}") == "DG016@2:72");
    CHECK(input_problem("value", "{\"keys\": [[1, 2], [2, -7]]}") == "DG013@2:72");
    CHECK(input_problem("value", "{\"keys\": [[1, 2]], \"interp\": \"cubic\"}") == "DG017@2:79");
    CHECK(input_problem("value", "{\"keys\": [[1, 2, {\"in\": 1}]]}") == "DG017@2:67");
    CHECK(input_problem("value", "{\"keys\": [[1, 2, {\"inn\": 1}]], \"interp\": \"smooth\"}") == "DG007@2:75");
    CHECK(input_problem("mode", "{\"keys\": [[1, \"plain\"], [4, \"double\"]]}").empty());
    CHECK(input_problem("mode", "{\"keys\": [[1, \"plain\"], [4, \"duoble\"]]}") == "DG014@2:78");
    CHECK(input_problem("mode", "{\"keys\": [[1, 0]]}") == "DG012@2:64");
    CHECK(input_problem("mode", "{\"keys\": [[1, \"plain\"]], \"interp\": \"linear\"}") == "DG017@2:85");
    CHECK(input_problem("times", "{\"keys\": [[1, 2], [3, 4]]}").empty());
    CHECK(input_problem("times", "{\"keys\": [[1, 2.5]]}") == "DG012@2:64");
    CHECK(input_problem("times", "{\"keys\": [[1, 2]], \"interp\": \"linear\"}") == "DG017@2:79");
    CHECK(input_problem("negate", "{\"keys\": [[1, true], [4, false]]}").empty());
    CHECK(input_problem("axis", "{\"keys\": [[1, [0, 1, 2]], [4, [1, 1]]]}") == "DG017@2:76");
    CHECK(input_problem("axis", "{\"keys\": [[1, [0, 1, 2]]], \"unit\": \"cm\"}").empty());
}

TEST_CASE("connections are checked") {
    const auto relay = [](const std::string& in) {
        return problems_of(in_document("\"number1\": {\"type\": \"number\"}, \"s\": {\"type\": \"sum\", "
                                       "\"inputs\": {\"terms\": [{\"from\": \"number1.out\"}]}},\n"
                                       "\"r\": {\"type\": \"relay\", \"inputs\": {\"in\": " +
                                       in + "}}"));
    };
    CHECK(places(relay("{\"from\": \"number1.out\"}")).empty());
    CHECK(places(relay("{\"from\": \"nubmer1.out\"}")) == "DG022@3:50");
    CHECK(relay("{\"from\": \"nubmer1.out\"}")[0].hint == "did you mean \"number1\"?");
    CHECK(places(relay("{\"from\": \"number1.in\"}")) == "DG023@3:50");
    CHECK(relay("{\"from\": \"number1.in\"}")[0].hint == "outputs: out");
    CHECK(places(relay("{\"from\": \"s.text\"}")) == "DG024@3:50");
    CHECK(relay("{\"from\": \"s.text\"}")[0].message == "takes number, but s.text is text");
    CHECK(places(relay("{\"from\": \"number1\"}")) == "DG025@3:50");
    CHECK(places(relay("{\"from\": 3}")) == "DG025@3:50");
    CHECK(places(relay("3")) == "DG026@3:41");
    CHECK(places(relay("{\"value\": 3}")) == "DG026@3:51");
    CHECK(places(relay("[{\"from\": \"number1.out\"}]")) == "DG020@3:41");
    const auto sum = [](const std::string& terms) {
        return places(problems_of(in_document(
            "\"n\": {\"type\": \"number\"},\n\"s\": {\"type\": \"sum\", \"inputs\": {\"terms\": " + terms + "}}")));
    };
    CHECK(sum("{\"from\": \"n.out\"}") == "DG020@3:42");
    CHECK(sum("[]") == "DG021@3:42");
    CHECK(sum("[{\"from\": \"n.out\"}, 4]") == "DG025@3:62");
    CHECK(sum("[{\"from\": \"n.out\"}, {\"from\": \"m.out\"}]") == "DG022@3:71");
    CHECK(input_problem("value", "{\"from\": \"n.out\"}") == "DG030@2:1");
}

TEST_CASE("required inputs, start frames and sub-steps") {
    CHECK(places(problems_of(in_document(
              "\"r\": {\"type\": \"relay\"}, \"s\": {\"type\": \"sum\", \"inputs\": {}}"))) == "DG019@2:1 DG019@2:25");
    CHECK(places(problems_of(in_document("\"f\": {\"type\": \"fileSize\"}"))) == "DG019@2:1");
    CHECK(places(problems_of(in_document("\"f\": {\"type\": \"fileSize\", \"inputs\": {\"file\": \"\"}}"))) ==
          "DG019@2:46");
    CHECK(places(problems_of(in_document("\"n\": {\"type\": \"number\"},\n\"sim\": {\"type\": \"sim\", "
                                         "\"inputs\": {\"startFrame\": {\"from\": \"n.out\"}}}"))) == "DG029@3:49");
    CHECK(places(problems_of(in_document(
              "\"sim\": {\"type\": \"sim\", \"inputs\": {\"startFrame\": {\"keys\": [[1, 1]]}}}"))) == "DG018@2:49");
    const auto half =
        read_graph(types(), in_document("\"sim\": {\"type\": \"sim\", \"inputs\": {\"startFrame\": 1.5}}"), "t.json")
            .graph;
    Evaluator e;
    CHECK(codes_of([&] { e.pull({half, {"sim", "out"}, 3, {}}); }) == "DG107");
}

TEST_CASE("files must exist, paths start at the graph's folder") {
    const auto folder = std::filesystem::temp_directory_path() / ("sinew_engine_paths_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder / "meshes");
    std::ofstream(folder / "meshes" / "a.obj") << "hello";
    const auto load = [&](const std::string& path) {
        std::ofstream(folder / "graph.json")
            << in_document("\"f\": {\"type\": \"fileSize\", \"inputs\": {\"file\": \"" + path + "\"}}");
        return load_graph(types(), (folder / "graph.json").string());
    };
    const auto g = load("./meshes/../meshes/a.obj").graph;
    Evaluator e;
    CHECK(number(e, g, {"f", "out"}, 1) == 5);
    CHECK(write_graph(*g).find("\"file\": \"meshes/a.obj\"") != std::string::npos);
    CHECK(codes_of([&] { load("meshes/b.obj"); }) == "IO401");
    CHECK(codes_of([&] { load("meshes"); }) == "IO402");
    CHECK(codes_of([&] { load_graph(types(), (folder / "none.json").string()); }) == "IO401");
    CHECK(codes_of([&] { load_graph(types(), folder.string()); }) == "IO402");

    for (const char* name : {"skin.0009.obj", "skin.0010.obj", "skin.10.obj", "bone_8.obj", "bone_12.obj"})
        std::ofstream(folder / "meshes" / name) << "hello";
    const auto hint_of = [&](const std::string& path) {
        try {
            load(path);
        } catch (const Failure& e) {
            return e.diagnostics().front().code + " " + e.diagnostics().front().hint;
        }
        return std::string();
    };
    const std::string why = "? A # stands for each digit of numbers with zeros in front";
    CHECK(hint_of("meshes/skin.####.obj").empty());
    CHECK(hint_of("meshes/skin.######.obj") == "IO401 did you mean \"meshes/skin.####.obj\"" + why);
    CHECK(hint_of("meshes/bone_####.obj") == "IO401 did you mean \"meshes/bone_#.obj\"" + why);
    CHECK(hint_of("meshes/none_####.obj").starts_with("IO401 looked for "));
    std::filesystem::remove_all(folder);
}

TEST_CASE("a cycle is reported as a path, at one of its nodes") {
    const auto all =
        problems_of(in_document("\"n\": {\"type\": \"number\"},\n\"a\": {\"type\": \"sum\", \"inputs\": {\"terms\": "
                                "[{\"from\": \"n.out\"}, {\"from\": \"b.out\"}]}},\n"
                                "\"b\": {\"type\": \"relay\", \"inputs\": {\"in\": {\"from\": \"c.out\"}}},\n\"c\": "
                                "{\"type\": \"relay\", \"inputs\": {\"in\": {\"from\": \"a.out\"}}}"));
    CHECK(places(all) == "DG030@3:1");
    CHECK(all[0].message == "connections form a cycle: a.out -> c.in -> c.out -> b.in -> b.out -> a.terms -> a");
}

TEST_CASE("all problems are reported at once") {
    const auto all = problems_of(in_document(
        "\"a\": {\"type\": \"number\", \"inputs\": {\"value\": -1, \"mode\": \"x\", \"foo\": 1}},\n"
        "\"b\": {\"type\": \"relay\", \"inputs\": {\"in\": {\"from\": \"nowhere.out\"}}},\n\"c\": {\"type\": "
        "\"relay\"}"));
    CHECK(places(all) == "DG013@2:45 DG014@2:57 DG011@2:62 DG022@3:50 DG019@4:1");
}

TEST_CASE("an unknown type is kept as it is, with a note") {
    const std::string odd = R"({ "type": "numbr",   "inputs": {"from": 1, "b": [1,{"x":"é"}]}, "extra": null })";
    const Loaded l =
        read_graph(types(),
                   in_document("\"odd\": " + odd +
                               ",\n\"r\": {\"type\": \"relay\", \"inputs\": {\"in\": {\"from\": \"odd.thing\"}}}"),
                   "t.json");
    REQUIRE(l.notes.size() == 1);
    CHECK(places(l.notes) == "DG010@2:18");
    CHECK(l.notes[0].severity == Severity::warning);
    CHECK(l.notes[0].hint == "did you mean \"number\"?");
    CHECK(l.graph->find("odd")->raw_json == odd);
    CHECK(write_graph(*l.graph).find("\"odd\": " + odd) != std::string::npos);
    CHECK(write_graph(*read_graph(types(), write_graph(*l.graph), "t.json").graph) == write_graph(*l.graph));
}

TEST_CASE("what is written reads back as the same graph") {
    const std::string text = R"({
  "format": "sinew 1",
  "timing": { "fps": 23.976, "start": -5, "end": 128 },
  "nodes": {
    "zebra \"1\"": { "type": "number", "inputs": {
        "value": { "keys": [[1, 0.1], [5.5, 3, { "in": 0.25, "out": -1e-09 }]], "interp": "smooth" },
        "axis": { "keys": [[0, [1, 2, 3]], [4, [0.1, 0.2, 0.30000000000000004]]], "interp": "linear" },
        "times": { "keys": [[1, 2], [9, 3]], "interp": "step" },
        "negate": { "keys": [[1, true], [2, false]], "interp": "step" }
      } },
    "apple": { "type": "number", "inputs": {
        "weights": [0, 0.5, 1],
        "value": 0.1,
        "mode": "double",
        "matrix": [1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
      } },
    "plain": { "type": "number" },
    "s": { "type": "sum", "inputs": {
        "terms": [ { "from": "apple.out" },
          { "from": "plain.out" } ]
      } }
  },
  "editor": {"positions": {"s": [1, 2]}, "note": "ä"}
}
)";
    const auto g = read_graph(types(), text, "t.json").graph;
    CHECK(write_graph(*g) == text);
    CHECK(g->node_names() == std::vector<std::string>{"zebra \"1\"", "apple", "plain", "s"});
    CHECK(g->timing().fps == 23.976);
    CHECK(g->spot("apple", "value")->line == 13);
    CHECK(g->spot("apple", "value")->pointer == "/nodes/apple/inputs/value");
    CHECK_FALSE(g->spot("plain", "value"));
    Evaluator e;
    const auto again = read_graph(types(), write_graph(*g), "t.json").graph;
    CHECK(number(e, g, {"zebra \"1\"", "out"}, 3) == number(e, again, {"zebra \"1\"", "out"}, 3));
}

TEST_CASE("values that equal the default are not written") {
    const auto g =
        read_graph(types(), with_input("value", "1, \"mode\": \"plain\", \"axis\": [0, 1, 0], \"times\": 2"), "t.json")
            .graph;
    const std::string text = write_graph(*g);
    CHECK(text.find("value") == std::string::npos);
    CHECK(text.find("axis") == std::string::npos);
    CHECK(text.find("\"times\": 2") != std::string::npos);
}

TEST_CASE("the schema is JSON and knows every type and input") {
    const auto schema = nlohmann::json::parse(graph_schema(*types()));
    CHECK(schema["$schema"] == "https://json-schema.org/draft/2020-12/schema");
    CHECK(schema["properties"]["format"]["const"] == "sinew 1");
    CHECK(schema["required"] == nlohmann::json::parse(R"(["format", "nodes"])"));
    for (const std::string& name : types()->names()) {
        const auto& node = schema["$defs"].at("node_" + name);
        CHECK(node["properties"]["type"]["const"] == name);
        for (const AttributeInfo& a : types()->find(name)->inputs)
            CHECK(node["properties"]["inputs"]["properties"].contains(std::string(a.name)));
    }
    const auto& inputs = schema["$defs"]["node_number"]["properties"]["inputs"]["properties"];
    CHECK(inputs["value"]["anyOf"][0] == nlohmann::json::parse(R"({"type": "number", "minimum": 0, "maximum": 1e9})"));
    CHECK(inputs["mode"]["anyOf"][0]["enum"] == nlohmann::json::parse(R"(["plain", "double"])"));
    CHECK(inputs["axis"]["anyOf"][0]["minItems"] == 3);
    CHECK(inputs["axis"]["default"] == nlohmann::json::parse("[0, 1, 0]"));
    CHECK(inputs["value"]["anyOf"][2]["properties"]["preset"]["enum"] == nlohmann::json::parse(R"(["fat", "muscle"])"));
    CHECK(schema["$defs"]["node_relay"]["required"] == nlohmann::json::parse(R"(["type", "inputs"])"));
    CHECK(schema["$defs"]["node_sum"]["properties"]["inputs"]["properties"]["terms"]["minItems"] == 1);
    CHECK(schema["properties"]["nodes"]["additionalProperties"]["oneOf"].size() == types()->names().size());
}
