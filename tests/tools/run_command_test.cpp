// `sinew run` from the outside: what is written, what is said, and what stays when something goes wrong.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/glb_checker.h"
#include "tests/tools/program.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <set>
#include <thread>

using namespace sinew::test;
namespace fs = std::filesystem;
using nlohmann::json;

namespace {

std::set<std::string> names_in(const fs::path& folder) {
    std::set<std::string> out;
    if (fs::is_directory(folder))
        for (const auto& entry : fs::directory_iterator(folder)) out.insert(entry.path().filename().string());
    return out;
}

std::vector<std::string> digests(const Said& said) {
    std::vector<std::string> out;
    for (const json& line : said.lines())
        if (line.at("event") == "frame") out.push_back(line.at("digest"));
    return out;
}

std::set<std::string> keys(const json& object) {
    std::set<std::string> out;
    for (const auto& [key, value] : object.items()) out.insert(key);
    return out;
}

/// The upper plate leaves for infinity after frame 3.
json graph_that_fails_at_frame_4() {
    json graph = small_graph();
    graph["nodes"]["upperMove"]["inputs"]["scale"] =
        json::parse(R"({ "keys": [[1, [1, 1, 1]], [3, [1, 1, 1]], [4, [1e53, 1e53, 1e53]]], "interp": "step" })");
    graph["nodes"]["upperMove"]["inputs"]["translate"] =
        json::parse(R"({ "keys": [[1, [0, 4.5, 0]], [3, [0, 4.5, 0]], [4, [1e53, 1e53, 1e53]]], "interp": "step" })");
    graph["nodes"]["plateMesh"]["inputs"]["width"] = 1e9;
    return graph;
}

} // namespace

TEST_CASE("a run writes every body of every frame, named after its node", "[tools]") {
    const TemporaryFolder folder;
    const std::string out = (folder / "out").string();
    const Said said = run_program({"run", write_graph(folder, small_graph()), "--out", out, "--format", "obj,ply,glb",
                                   "--report", out + "/report.json"});
    INFO(said.err);
    REQUIRE(said.code == 0);
    CHECK(names_in(out) == std::set<std::string>{"obj", "ply", "report.json", "small.glb"});
    std::set<std::string> wanted;
    for (const std::string body : {"block", "lower", "upper"})
        for (int frame = 1; frame <= 6; ++frame) wanted.insert(body + ".000" + std::to_string(frame) + ".obj");
    CHECK(names_in(folder / "out/obj") == wanted);
    CHECK(names_in(folder / "out/ply").size() == 18);

    // Polygons stay polygons: the block is 2 x 4 x 2 quads.
    const std::string obj = read_text(folder / "out/obj/block.0006.obj");
    CHECK(obj.starts_with("# sinew: tissue, y up, 100 units a metre\n"));
    std::istringstream lines(obj);
    int quads = 0;
    for (std::string line; std::getline(lines, line);)
        quads += line.starts_with("f ") && std::count(line.begin(), line.end(), ' ') == 4;
    CHECK(quads == 2 * (2 * 4 + 2 * 4 + 2 * 2));

    const Glb glb(read_text(folder / "out/small.glb"));
    CHECK(glb.problems() == std::vector<std::string>{});
    CHECK(glb.document.at("meshes").size() == 3);
    // In metres: the lower plate is 6 cm wide.
    const auto& accessor = glb.document.at("accessors")
                               .at(glb.document.at("meshes")
                                       .at(0)
                                       .at("primitives")
                                       .at(0)
                                       .at("attributes")
                                       .at("POSITION")
                                       .get<std::size_t>());
    CHECK(accessor.at("max").at(0).get<double>() - accessor.at("min").at(0).get<double>() ==
          Approx(0.06).epsilon(1e-5));
}

TEST_CASE("the report says for every frame how it went", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = (folder / "r.json").string();
    REQUIRE(run_program({"run", write_graph(folder, small_graph()), "--report", file, "--frames", "1-4", "--quiet",
                         "--threads", "1"})
                .code == 0);
    const json report = json::parse(read_text(file));
    CHECK(keys(report) == std::set<std::string>{"version", "machine", "blas", "numerics", "threads", "graph", "totals",
                                                "warnings", "computed", "frames", "size"});
    CHECK(report.at("threads") == 1);
    CHECK(report.at("totals").at("frames_simulated") == 4);
    CHECK(report.at("totals").at("frames_reused") == 0);
    CHECK(report.at("totals").at("peak_bytes") > 1'000'000);
    REQUIRE(report.at("frames").size() == 4);
    const json& last = report.at("frames").at(3);
    for (const char* key : {"frame", "reused", "wall_s", "phases", "substeps", "newton", "linear_iterations",
                            "factorizations", "residual", "converged", "energy", "min_J", "inverted", "terms"})
        CHECK(last.contains(key));
    // Nothing finds contacts, so nothing is said about them.
    CHECK(keys(last.at("phases")) == std::set<std::string>{"assembly", "factor", "solve", "other"});
    for (const char* key : {"contacts", "max_penetration_m"}) CHECK_FALSE(last.contains(key));
    CHECK(last.at("frame") == 4);
    CHECK(last.at("converged") == true);
    CHECK(last.at("newton") >= 1);
    CHECK(last.at("inverted") == 0);
    CHECK(last.at("phases").at("assembly") > 0);
    CHECK(report.at("size").at("bodies") == 3);
    CHECK(report.at("size").at("tets") > 0);
    CHECK(report.at("size").at("attachments") == 2);
}

TEST_CASE("the report counts what nodes of each type computed: what stands still once", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = (folder / "r.json").string();
    json graph = small_graph();
    graph["nodes"]["still"] = json::parse(
        R"({ "type": "transform", "inputs": { "mesh": { "from": "blockMesh.outMesh" }, "rotate": [0, 5, 0] } })");
    graph["nodes"]["tets"] =
        json::parse(R"({ "type": "zTet", "inputs": { "mesh": { "from": "still.outMesh" }, "tetSize": 2 } })");
    graph["nodes"]["block"]["inputs"]["mesh"] = {{"from", "still.outMesh"}};
    graph["nodes"]["block"]["inputs"]["tets"] = {{"from", "tets.outTets"}};
    for (const char* node : {"top", "bottom"}) graph["nodes"][node]["inputs"]["mesh"] = {{"from", "still.outMesh"}};
    const Said said = run_program({"run", write_graph(folder, graph), "--frames", "1-5", "--report", file});
    REQUIRE(said.code == 0);
    const json computed = json::parse(read_text(file)).at("computed");
    CHECK(computed.at("zTet").at("count") == 1);
    CHECK(computed.at("zTet").at("wall_s") > 0);
    CHECK(computed.at("weights").at("count") == 2);
    CHECK(computed.at("zTissue").at("count") == 1);
    // still, lowerMove once, upperMove at five frames; upper follows it, lower and the hold below stand.
    CHECK(computed.at("transform").at("count") == 2 + 5);
    CHECK(computed.at("zBone").at("count") == 1 + 5);
    CHECK(computed.at("zAttachment").at("count") == 1 + 5);
    CHECK(computed.at("zSolver").at("count") == 5);
}

TEST_CASE("a learning graph with nothing but constant transforms meshes once", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = (folder / "r.json").string();
    REQUIRE(run_program({"run", std::string(SINEW_SOURCE_DIR) + "/graphs/learn/06_wrap_polygons.json", "--frames",
                         "1-3", "--no-cache", "--report", file})
                .code == 0);
    const json computed = json::parse(read_text(file)).at("computed");
    for (const char* type : {"zIsoMesh", "zTet", "weights", "zTissue", "zAttachment"}) {
        INFO(type);
        CHECK(computed.at(type).at("count") == 1);
    }
    CHECK(computed.at("transform").at("count") == 5);
}

TEST_CASE("a shot from frame 1001 is not simulated from frame 1", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["timing"] = {{"fps", 24}, {"start", 1001}, {"end", 1003}};
    for (const char* input : {"translate", "rotate"}) {
        json& keys = graph["nodes"]["upperMove"]["inputs"][input]["keys"];
        keys[0][0] = 998, keys[1][0] = 1003;
    }
    const Said said = run_program({"run", write_graph(folder, graph), "--json"});
    CHECK(said.code == 0);
    CHECK(said.err.empty());
    CHECK(said.lines().back().at("frames_simulated") == 3);
    graph["nodes"]["solver"]["inputs"]["startFrame"] = 999;
    graph["nodes"]["solver"]["inputs"]["framesPerSecond"] = 30;
    const Said early = run_program({"run", write_graph(folder, graph)});
    CHECK(early.code == 0);
    CHECK(early.err.find("DG031") != std::string::npos);
    CHECK(early.err.find("solver.startFrame") != std::string::npos);
    CHECK(early.err.find("2 frames before the graph's first") != std::string::npos);
    CHECK(early.err.find("solver.framesPerSecond") != std::string::npos);
    CHECK(early.out.find("5 simulated") != std::string::npos);
    // What --set repairs is not complained about, what it breaks is.
    const std::string file = write_graph(folder, graph);
    CHECK(run_program({"run", file, "--set", "solver.startFrame=1001", "--set", "solver.framesPerSecond=24"})
              .beside_work() == "");
    CHECK(run_program({"run", file, "--set", "solver.startFrame=1000", "--set", "solver.framesPerSecond=24"})
              .err.find("1 frame before") != std::string::npos);
}

TEST_CASE("one and two threads give the same bits where subtissues of one limb slide, and are slid on", "[tools]") {
    const auto from = [](const std::string& plug) { return nlohmann::json{{"from", plug}}; };
    const auto node = [](const char* type, nlohmann::json inputs) {
        return nlohmann::json{{"type", type}, {"inputs", std::move(inputs)}};
    };
    nlohmann::json nodes;
    nodes["flesh"] = node("zMaterial", {{"youngsModulus", 3e4}});
    const nlohmann::json flesh = nlohmann::json::array({from("flesh.outMaterial")});
    nodes["limbMesh"] = node("polyCube", {{"width", 24}, {"height", 6}, {"depth", 6}});
    nodes["limbTets"] = node("zTet", {{"mesh", from("limbMesh.outMesh")}, {"tetSize", 1.5}});
    nodes["ball"] = node("polySphere", {{"radius", 2.2}});
    nodes["slabMesh"] = node("polyCube", {{"width", 12}, {"height", 1.6}, {"depth", 6}});
    nodes["slabPlace"] = node("transform", {{"mesh", from("slabMesh.outMesh")}, {"translate", {0, 4, 0}}});
    nodes["slabTets"] = node("zTet", {{"mesh", from("slabPlace.outMesh")}, {"tetSize", 1.5}});
    nodes["slab"] = node(
        "zTissue", {{"mesh", from("slabPlace.outMesh")}, {"tets", from("slabTets.outTets")}, {"materials", flesh}});
    nodes["floorMesh"] = node("polyCube", {{"width", 26}, {"height", 1}, {"depth", 8}});
    nodes["floorMove"] = node("transform", {{"translate", {{"keys", {{1, {0, -3.5, 0}}, {5, {1, -2.8, 0}}}}}}});
    nodes["floor"] = node("zBone", {{"mesh", from("floorMesh.outMesh")}, {"matrix", from("floorMove.outMatrix")}});
    nlohmann::json bodies = {from("limb.outBody"), from("slab.outBody"), from("floor.outBody")}, ties, inner;
    for (const char* side : {"left", "right"}) {
        const std::string name = side;
        const int sign = name == "left" ? -1 : 1;
        nodes[name + "Mesh"] =
            node("transform", {{"mesh", from("ball.outMesh")}, {"translate", {3 * sign, 0, 0}}, {"scale", {2, 1, 1}}});
        nodes[name] = node("zSubtissue", {{"mesh", from(name + "Mesh.outMesh")}, {"materials", flesh}});
        inner.push_back(from(name + ".outBody")), bodies.push_back(from(name + ".outBody"));
        nodes[name + "Paint"] = node(
            "weights",
            {{"mesh", from("slabPlace.outMesh")}, {"mode", "ramp"}, {"axis", "x"}, {"start", -sign}, {"end", sign}});
        nodes[name + "Under"] = node("zAttachment", {{"source", from("slab.outBody")},
                                                     {"target", from(name + ".outBody")},
                                                     {"weights", from(name + "Paint.outWeights")},
                                                     {"attachmentMode", "sliding"},
                                                     {"stiffness", 1e7}});
        nodes[name + "Over"] = node("zAttachment", {{"source", from(name + ".outBody")},
                                                    {"target", from("floor.outBody")},
                                                    {"attachmentMode", "sliding"},
                                                    {"stiffness", 1e7}});
        ties.push_back(from(name + "Under.outAttachment")), ties.push_back(from(name + "Over.outAttachment"));
    }
    nodes["limb"] = node("zTissue", {{"mesh", from("limbMesh.outMesh")},
                                     {"tets", from("limbTets.outTets")},
                                     {"materials", flesh},
                                     {"subtissues", inner}});
    nodes["solver"] = node("zSolver", {{"bodies", bodies}, {"attachments", ties}, {"scale", 100}});
    const TemporaryFolder folder;
    const std::string graph = write_graph(
        folder, {{"format", "sinew 1"}, {"timing", {{"fps", 24}, {"start", 1}, {"end", 5}}}, {"nodes", nodes}});
    const auto one = digests(run_program({"run", graph, "--json", "--threads", "1"}));
    REQUIRE(one.size() == 5);
    CHECK(std::set<std::string>(one.begin(), one.end()).size() == 5);
    for (int i = 0; i < 2; ++i) CHECK(digests(run_program({"run", graph, "--json", "--threads", "2"})) == one);
}

TEST_CASE("one and two threads give the same bits, and so does a run of the last frame alone", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph());
    const auto one = digests(run_program({"run", graph, "--json", "--threads", "1"}));
    const auto two = digests(run_program({"run", graph, "--json", "--threads", "2"}));
    REQUIRE(one.size() == 6);
    CHECK(one == two);
    CHECK(std::set<std::string>(one.begin(), one.end()).size() == 6);
    // More than there are cores: asked for, so had, and without a word of the library's.
    const std::string cores = std::to_string(2 * std::max(1u, std::thread::hardware_concurrency()));
    const Said many = run_program({"run", graph, "--json", "--no-cache", "--threads", cores});
    CHECK(digests(many) == one);
    CHECK(many.err.empty());
    const Said last = run_program({"run", graph, "--json", "--frames", "6"});
    CHECK(digests(last) == std::vector<std::string>{one.back()});
    CHECK(last.lines().back().at("frames_simulated") == 6);
}

TEST_CASE("frames that are asked for in any order are run in that of time, and counted with those on the way",
          "[tools]") {
    const TemporaryFolder folder;
    const std::string file = (folder / "r.json").string(), graph = write_graph(folder, small_graph());
    const Said said = run_program({"run", graph, "--frames", "5,2", "--json", "--report", file});
    REQUIRE(said.code == 0);
    std::vector<int> frames;
    for (const json& line : said.lines())
        if (line.at("event") == "frame") frames.push_back(line.at("frame"));
    CHECK(frames == std::vector{2, 5});
    const json report = json::parse(read_text(file));
    CHECK(report.at("totals").at("frames_simulated") == 5); // the start, 2, and 3 to 5
    CHECK(report.at("totals").at("frames_reused") == 0);
    CHECK(report.at("frames").size() == 2);
    CHECK(report.at("frames").at(0).at("frame") == 2);
    // What comes before the start is the start: nothing is simulated for it twice.
    REQUIRE(run_program({"run", graph, "--frames=-1-2", "--quiet", "--report", file}).code == 0);
    const json early = json::parse(read_text(file));
    CHECK(early.at("totals").at("frames_simulated") == 2);
    CHECK(early.at("totals").at("frames_reused") == 2);
}

TEST_CASE("without --out nothing is written", "[tools]") {
    const TemporaryFolder folder;
    const Said said = run_program({"run", write_graph(folder, small_graph()), "--frames", "1-2"});
    CHECK(said.code == 0);
    CHECK(said.out.find("nothing was written") != std::string::npos);
    CHECK(names_in(folder.path()) == std::set<std::string>{"small.json"});
}

TEST_CASE("logs get one line a frame, --quiet nothing", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph());
    const Said lines = run_program({"run", graph, "--frames", "2-4"});
    for (const char* frame : {"frame    2", "frame    3", "frame    4"})
        CHECK(lines.out.find(frame) != std::string::npos);
    CHECK(lines.out.find('\r') == std::string::npos);
    const Said quiet = run_program({"run", graph, "--frames", "2-4", "--quiet"});
    CHECK(quiet.out.empty());
    CHECK(quiet.err.empty());
}

TEST_CASE("a --set changes the result, and a wrong one is the graph's error", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph());
    const auto plain = digests(run_program({"run", graph, "--json", "--frames", "3"}));
    CHECK(digests(run_program({"run", graph, "--json", "--frames", "3", "--set", "flesh.youngsModulus=40000"})) !=
          plain);
    CHECK(digests(run_program({"run", graph, "--json", "--frames", "3", "--set", "block.material=NeoHookean"})) !=
          plain);
    CHECK(digests(run_program({"run", graph, "--json", "--frames", "3", "--set",
                               R"(flesh.youngsModulus={"value": 20, "unit": "kPa"})"})) == plain);
    const Said wrong = run_program({"run", graph, "--set", "flesh.youngsModulus=-1"});
    CHECK(wrong.code == 1);
    CHECK(wrong.err.find("DG013") != std::string::npos);
    CHECK(run_program({"run", graph, "--set", "flesh=1"}).code == 2);
    CHECK(run_program({"run", graph, "--set", "flesh.youngsModulus"}).code == 2);
}

TEST_CASE("a frame's digest is that of all that is pulled", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph());
    const auto of = [&](const std::string& setting) {
        std::vector<std::string> words{
            "run", graph, "--json", "--frames", "2", "--pull", "lowerMove.outMatrix", "--pull", "upperMove.outMatrix"};
        if (!setting.empty()) words.insert(words.end(), {"--set", setting});
        return digests(run_program(words));
    };
    const auto plain = of("");
    REQUIRE(plain.size() == 1);
    CHECK(of("") == plain);
    CHECK(of("lowerMove.translate=[0, 1, 0]") != plain);
    CHECK(of("upperMove.translate=[0, 1, 0]") != plain);
}

TEST_CASE("numbers that are pulled are printed, files that are pulled are written", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["nodes"]["write"] = json::parse(
        R"({ "type": "meshWriter", "inputs": { "meshes": { "from": "solver.outMeshes" }, "format": "off" } })");
    const std::string file = write_graph(folder, graph), out = (folder / "out").string();
    const Said numbers = run_program({"run", file, "--pull", "upperMove.outMatrix", "--frames", "1,6", "--json"});
    REQUIRE(numbers.code == 0);
    int values = 0;
    for (const json& line : numbers.lines())
        if (line.at("event") == "value") {
            ++values;
            CHECK(line.at("value").at(1).at(3) == (line.at("frame") == 1 ? 4.5 : 4.7));
        }
    CHECK(values == 2);
    REQUIRE(run_program({"run", file, "--pull", "write.outFile", "--frames", "1-2", "--out", out}).code == 0);
    CHECK(names_in(out) == std::set<std::string>{"write.0001.off", "write.0002.off"});
    CHECK(read_text(folder / "out/write.0002.off").starts_with("OFF"));
}

TEST_CASE("a frame that fails keeps the frames before it, with report and animation", "[tools]") {
    const TemporaryFolder folder;
    const std::string out = (folder / "out").string();
    const Said said = run_program({"run", write_graph(folder, graph_that_fails_at_frame_4()), "--out", out, "--format",
                                   "glb,obj", "--report", out + "/r.json"});
    INFO(said.out << said.err);
    CHECK((said.code == 1 || said.code == 3));
    CHECK(said.err.find("error [") != std::string::npos);
    CHECK(names_in(folder / "out/obj").size() == 9);
    CHECK(names_in(folder / "out/obj").contains("block.0003.obj"));
    const json report = json::parse(read_text(folder / "out/r.json"));
    CHECK(report.at("frames").size() == 3);
    CHECK(report.at("error").at("frame") == 4);
    CHECK_FALSE(report.at("error").at("message").get<std::string>().empty());
    CHECK(names_in(out) == std::set<std::string>{"obj", "r.json", "small.glb"}); // the report says it, so no mark
    const Glb glb(read_text(folder / "out/small.glb"));
    CHECK(glb.problems() == std::vector<std::string>{});
    const json& samplers = glb.document.at("animations").at(0).at("samplers");
    CHECK(glb.floats(samplers.at(0).at("input")).size() == 3);
}

TEST_CASE("a cancelled run says so, keeps its frames, and leaves nothing half-made", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["timing"]["end"] = 30000;
    const std::string out = (folder / "out").string();
    for (const int signal : {SIGINT, SIGTERM}) {
        fs::remove_all(out);
        Program program(
            {"run", write_graph(folder, graph), "--out", out, "--format", "glb,obj", "--report", out + "/r.json"});
        for (int waited = 0; waited < 12000 && names_in(folder / "out/obj").size() < 9; ++waited)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        program.signal(signal);
        CHECK(program.exit_code() == 4);
        CHECK(program.err().find("cancelled") != std::string::npos);
        const std::set<std::string> files = names_in(folder / "out/obj");
        CHECK(files.size() % 3 == 0);
        for (const std::string& name : files) {
            CHECK(name.ends_with(".obj"));
            CHECK(read_text(folder / ("out/obj/" + name)).ends_with("\n"));
        }
        CHECK(names_in(out) == std::set<std::string>{"obj", "r.json", "small.glb"});
        CHECK(Glb(read_text(folder / "out/small.glb")).problems() == std::vector<std::string>{});
        CHECK(json::parse(read_text(folder / "out/r.json")).at("frames").size() == files.size() / 3);
    }
}

TEST_CASE("the report tells what bits hang on, kernels by name and features of the processor", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = (folder / "r.json").string(), graph = write_graph(folder, small_graph());
    const char* before = std::getenv("OPENBLAS_CORETYPE");
    const std::string kept = before ? before : "";
    std::set<std::string> seen;
    for (const char* kernel : {"Nehalem", "Haswell"}) {
        setenv("OPENBLAS_CORETYPE", kernel, 1);
        REQUIRE(run_program({"run", graph, "--report", file, "--frames", "1", "--quiet"}).code == 0);
        const json report = json::parse(read_text(file));
        const auto blas = report.at("blas").get<std::string>(), all = report.at("numerics").get<std::string>();
        CHECK(all.starts_with(blas));
        const std::set<std::string> features{"", " avx2", " fma", " avx2 fma", " avx2 fma avx512f"};
        CHECK(features.count(all.substr(blas.size())) == 1);
        seen.insert(all);
    }
    before ? setenv("OPENBLAS_CORETYPE", kept.c_str(), 1) : unsetenv("OPENBLAS_CORETYPE");
    CHECK(seen.size() <= 2); // one of a build of OpenBLAS with one kernel
    if (seen.size() == 2) CHECK(seen.begin()->starts_with("Haswell"));
}

TEST_CASE("a place that cannot be written to is found before anything is simulated", "[tools]") {
    const TemporaryFolder folder;
    write_text(folder / "file", "x");
    const Said said = run_program({"run", write_graph(folder, small_graph()), "--out", (folder / "file/out").string()});
    CHECK(said.code == 1);
    CHECK(said.err.find("IO405") != std::string::npos);
    CHECK(said.out.empty());
}

TEST_CASE("a report or picture that cannot be written is found before anything is simulated", "[tools]") {
    const TemporaryFolder folder;
    write_text(folder / "file", "x");
    const std::string graph = write_graph(folder, small_graph());
    for (const std::string& bad :
         {(folder / "file/r.json").string(), folder.path().string(), std::string("/dev/null/r")})
        for (const char* command : {"run", "view", "snapshot"}) {
            INFO(command << " " << bad);
            const char* flag = command == std::string("run") ? "--report" : "--output";
            const Said said = run_program({command, graph, flag, bad});
            CHECK((said.code == 1 || said.code == 2));
            CHECK((said.err.find("IO405") != std::string::npos ||
                   said.err.find("names the folder") != std::string::npos));
            CHECK(said.out.empty()); // no frame was evaluated
        }
    // Nothing is made for a graph that is wrong.
    const Said wrong = run_program({"run", graph, "--set", "solver.attachments=[]", "--set",
                                    "solver.integrator=QuasiStatic", "--out", (folder / "new/out").string()});
    CHECK(wrong.code != 0);
    CHECK_FALSE(fs::exists(folder / "new"));
    REQUIRE(run_program({"run", graph, "--frames", "1", "--report", (folder / "new/deep/r.json").string()}).code == 0);
    CHECK(fs::exists(folder / "new/deep/r.json"));
}

TEST_CASE("a disk without room is found before anything is simulated", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph());
    // A limit of file sizes refuses the first byte, as a full disk does; what is said goes through a pipe.
    const auto said_of = [&](const std::string& words) {
        const std::string said = (folder / "said").string();
        const std::string line = "(trap '' XFSZ; ulimit -f 0; " SINEW_PROGRAM " " + words +
                                 " --no-cache; echo code $?) 2>&1 | cat >'" + said + "'";
        CHECK(std::system(line.c_str()) == 0);
        return read_text(said);
    };
    for (const std::string& words : {"run " + graph + " --report " + (folder / "r.json").string(),
                                     "run " + graph + " --out " + (folder / "out").string(),
                                     "view " + graph + " --output " + (folder / "v.html").string(),
                                     "snapshot " + graph + " --output " + (folder / "s.png").string()}) {
        CAPTURE(words);
        const std::string said = said_of(words);
        CHECK(said.find("error [IO405] cannot write ") != std::string::npos);
        CHECK(said.find(": File too large\n") != std::string::npos);
        CHECK(said.find("frame ") == std::string::npos);
        CHECK(said.ends_with("code 1\n"));
    }
}

TEST_CASE("frames that have not converged are counted, and --strict makes them a failure", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = write_graph(folder, small_graph());
    const std::vector<std::string> words{"run", graph, "--json", "--set", "solver.maxNewtonIterations=1"};
    const Said lax = run_program(words);
    CHECK((lax.code == 0 && lax.lines().back().at("unconverged") > 0));
    std::vector<std::string> strict = words;
    strict.emplace_back("--strict");
    CHECK(run_program(strict).code == 3);
    strict.insert(strict.end(), {"--frames", "2"}); // one is enough
    const Said single = run_program(strict);
    CHECK((single.code == 3 && single.lines().back().at("unconverged") == 1));
    CHECK(single.err.ends_with("sinew run: 1 frame has not converged (--strict)\n"));
}

TEST_CASE("a frame that converges with inverted tets is warned about, and the report says where", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = (folder / "r.json").string();
    json graph = small_graph();
    // The upper plate jumps far into the block.
    graph["nodes"]["upperMove"]["inputs"] = json::parse(
        R"({ "translate": { "keys": [[1, [0, 4.5, 0]], [2, [0, 4.5, 0]], [3, [0, -2, 0]]], "interp": "step" } })");
    graph["nodes"]["block"]["inputs"]["material"] = "Corotational";
    graph["nodes"]["solver"]["inputs"]["maxNewtonIterations"] = 200;
    const std::string path = write_graph(folder, graph);
    const Said said = run_program({"run", path, "--report", file});
    REQUIRE(said.code == 0);
    const json report = json::parse(read_text(file));
    int inverted = 0;
    for (const json& frame : report.at("frames")) {
        if (frame.at("inverted") == 0 || frame.at("converged") == false) continue;
        ++inverted;
        const json& where = frame.at("where").at("min_J");
        CHECK(where.at("tissue") == "block");
        CHECK(where.at("tet") >= 0);
        // The block is 4 x 8 x 4 about the origin; what is left of it lies between the plates.
        CHECK(std::abs(where.at("at").at(0).get<double>()) < 6);
        CHECK(frame.at("min_J") < 0);
    }
    REQUIRE(inverted > 0);
    CHECK(said.err.find("FE306") != std::string::npos);
    CHECK(said.err.find("of block, near (") != std::string::npos);
    CHECK(said.out.find(std::to_string(inverted) + " frame" + (inverted == 1 ? "" : "s") +
                        " converged with INVERTED tets") != std::string::npos);
    CHECK(said.out.find("of block\n") != std::string::npos);
    CHECK(run_program({"run", path, "--json"}).lines().back().at("inverted") == inverted);
    CHECK(run_program({"run", path, "--quiet", "--strict"}).code == 3);
    // A sound run says nothing of it, and names the attachment that gives most.
    const Said sound = run_program({"run", write_graph(folder, small_graph()), "--report", file});
    CHECK(sound.err.find("FE306") == std::string::npos);
    CHECK(sound.out.find("INVERTED") == std::string::npos);
    const json last = json::parse(read_text(file)).at("frames").back();
    const json& stretch = last.at("where").at("max_stretch_m");
    CHECK((stretch.at("attachment") == "holdTop" || stretch.at("attachment") == "holdBottom"));
    CHECK(stretch.at("body") == "block");
    CHECK((stretch.at("vertex") >= 0 && stretch.at("vertex") < 50));
}

TEST_CASE("the report names the body that is farthest from balance", "[tools]") {
    const TemporaryFolder folder;
    const std::string file = (folder / "r.json").string();
    json graph = small_graph();
    json& nodes = graph["nodes"];
    // A second block that nothing moves, before and behind the first one in the list.
    nodes["aside"] = json::parse(
        R"({ "type": "transform", "inputs": { "mesh": { "from": "blockMesh.outMesh" }, "translate": [30, 0, 0] } })");
    nodes["idle"] = nodes["block"];
    nodes["idle"]["inputs"]["mesh"]["from"] = "aside.outMesh";
    nodes["solver"]["inputs"]["gravity"] = {0, 0, 0};
    nodes["solver"]["inputs"]["maxNewtonIterations"] = 1;
    nodes["solver"]["inputs"]["stepHalvings"] = 0;
    for (const bool first : {true, false}) {
        json& bodies = nodes["solver"]["inputs"]["bodies"] = json::array();
        for (const char* name : {"lower", "upper", "block"})
            bodies.push_back(json::object({{"from", name + std::string(".outBody")}}));
        bodies.insert(first ? bodies.begin() : bodies.end(), json::object({{"from", "idle.outBody"}}));
        const Said said = run_program({"run", write_graph(folder, graph), "--frames", "1-3", "--report", file});
        INFO(said.err);
        REQUIRE(said.code == 0);
        const json frames = json::parse(read_text(file)).at("frames");
        CHECK_FALSE(frames.at(0).at("where").contains("residual")); // nothing was solved for the start frame
        for (const std::size_t f : {1, 2}) {
            REQUIRE(frames.at(f).at("converged") == false);
            CHECK(frames.at(f).at("where").at("residual").at("body") == "block");
        }
        CHECK(said.err.find("of block after 1 Newton iterations") != std::string::npos);
    }
}

TEST_CASE("several solvers without --pull are an error that lists them", "[tools]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["nodes"]["second"] = graph["nodes"]["solver"];
    const Said said = run_program({"run", write_graph(folder, graph)});
    CHECK(said.code == 2);
    CHECK(said.err.find("solver.outMeshes") != std::string::npos);
    CHECK(said.err.find("second.outMeshes") != std::string::npos);
    // Of layers the last one is meant.
    graph["nodes"]["pick"] = {{"type", "pickMesh"},
                              {"inputs", {{"meshes", {{"from", "solver.outMeshes"}}}, {"index", 0}}}};
    graph["nodes"]["layer"] = {{"type", "zBone"}, {"inputs", {{"mesh", {{"from", "pick.outMesh"}}}}}};
    graph["nodes"]["second"]["inputs"]["bodies"].push_back({{"from", "layer.outBody"}});
    const std::string report = (folder.path() / "report.json").string();
    const auto frame_of = [&](const std::string& pull) {
        CHECK(run_program({"run", write_graph(folder, graph), "--frames", "1-3", "--quiet", "--no-cache", "--report",
                           report, "--pull", pull})
                  .code == 0);
        return json::parse(std::ifstream(report))["frames"][2];
    };
    // The second is the first beside a bone that does nothing.
    const json both = frame_of("second.outMeshes"), first = frame_of("solver.outMeshes");
    CHECK(both["newton"].get<int>() == 2 * first["newton"].get<int>());
    CHECK((first["newton"].get<int>() > 0 && both["min_J"] == first["min_J"]));
    CHECK(run_program({"run", write_graph(folder, graph), "--frames", "1-2", "--quiet"}).code == 0);
    graph["nodes"].erase("second"), graph["nodes"].erase("layer"), graph["nodes"].erase("pick");
    graph["nodes"].erase("solver");
    CHECK(run_program({"run", write_graph(folder, graph)}).code == 2);
}
