// The facade for hosts: bodies by name, what was sent keyed by content, frames kept for later processes, cancelling.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/register_all.h"
#include "tests/tools/temporary_folder.h"
#include "tools/embed/host_types.h"
#include "tools/embed/session.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

using namespace sinew;
using embed::Counts;
using embed::Frame;
using embed::HostValue;
using embed::Misuse;
using embed::Session;
using embed::Setting;

namespace {

const std::string hanging =
    R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 9}, "nodes": {
    "cube": {"type": "polyCube", "inputs": {"width": 6, "depth": 6}},
    "plate": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}}},
    "ball": {"type": "polySphere", "inputs": {"radius": 2}}, "flesh": {"type": "zMaterial"},
    "hung": {"type": "zTissue", "inputs": {"mesh": {"from": "ball.outMesh"},
             "materials": [{"from": "flesh.outMaterial"}]}},
    "tie": {"type": "zAttachment", "inputs": {"source": {"from": "hung.outBody"}, "target": {"from": "plate.outBody"}}},
    "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "hung.outBody"}, {"from": "plate.outBody"}],
               "attachments": [{"from": "tie.outAttachment"}]}},
    "skin": {"type": "zEmbedder", "inputs": {"solved": {"from": "solver.outSolved"}, "body": {"from": "hung.outBody"},
             "meshes": [{"from": "ball.outMesh"}]}}}})";

std::vector<double> lifted(double y) { return {1, 0, 0, 0, 0, 1, 0, y, 0, 0, 1, 0, 0, 0, 0, 1}; }

void send(Session& s, double frame, double y) {
    const Setting setting{{"plate", "matrix"}, lifted(y)};
    s.set_at(frame, {&setting, 1});
}

void set(Session& s, const char* node, const char* attribute, HostValue value) {
    const Setting setting{{node, attribute}, std::move(value)};
    s.set({&setting, 1});
}

std::string code(const std::function<void()>& call, bool* misuse = nullptr) {
    try {
        call();
    } catch (const engine::Failure& f) {
        if (misuse) *misuse = dynamic_cast<const Misuse*>(&f) != nullptr;
        return f.diagnostics().front().code;
    }
    return "";
}

} // namespace

TEST_CASE("bodies are found by name in whatever is evaluated", "[embed]") {
    Session s;
    s.load_text(hanging);
    const Frame solved = s.evaluate(2);
    CHECK(solved.names == std::vector<std::string>{"hung", "plate"});
    CHECK(solved.find("plate") == 1);
    CHECK_FALSE(solved.find("ball"));
    const Frame carried = s.evaluate(2, "skin.outMeshes");
    CHECK(carried.names == std::vector<std::string>{"ball"});
    CHECK(carried.bodies == std::vector<std::string>{"hung", "plate"});
    const Frame plain = s.evaluate(2, "cube.outMesh");
    CHECK(plain.names == std::vector<std::string>{"cube"});
    CHECK(plain.report_json() == "{}");
    // The skin is the tissue's own mesh, so it is where the tissue is.
    CHECK(s.counts().simulated == 2);
    for (std::size_t v = 0; v < carried.meshes[0].points->size(); ++v)
        CHECK(((*carried.meshes[0].points)[v] - (*solved.meshes[0].points)[v]).norm() < 1e-12);
}

TEST_CASE("bodies of included graphs are found and sent to by prefix and name", "[embed]") {
    const test::TemporaryFolder folder;
    test::write_text(folder / "part.json", hanging);
    test::write_text(folder / "top.json", R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 9},
        "includes": {"a": {"file": "part.json"}}, "nodes": {}})");
    Session alone, included;
    alone.load_text(hanging);
    included.load_file((folder / "top.json").string());
    send(alone, 2, 1);
    const Setting setting{{"a.plate", "matrix"}, lifted(1)};
    included.set_at(2, {&setting, 1});
    const Frame one = alone.evaluate(2), two = included.evaluate(2);
    CHECK(two.names == std::vector<std::string>{"a.hung", "a.plate"});
    REQUIRE(two.meshes.size() == one.meshes.size());
    CHECK(two.meshes[1].points->at(0).y() == Approx(one.meshes[1].points->at(0).y()).margin(0));
    CHECK(*two.meshes[0].points == *one.meshes[0].points);
}

TEST_CASE("a frame's report is that of the program, with names", "[embed]") {
    Session s;
    s.load_text(hanging);
    const auto report = nlohmann::json::parse(s.evaluate(3, "skin.outMeshes").report_json());
    CHECK(report.at("frame") == 3);
    CHECK(report.at("converged") == true);
    CHECK(report.at("size").at("bodies") == 2);
    CHECK(report.at("size").at("attachments") == 1);
    CHECK(report.at("where").at("max_stretch_m").at("attachment") == "tie");
    CHECK(report.at("where").at("min_J").at("tissue") == "hung");
    CHECK(report.at("terms").at("attachment").at("max_stretch_m").get<double>() > 0);
}

TEST_CASE("only what was sent anew runs again, and what is sent back is found", "[embed]") {
    Session s;
    s.load_text(hanging);
    for (int frame = 1; frame <= 5; ++frame) {
        send(s, frame, 0.1 * frame);
        s.evaluate(frame);
        CHECK(s.counts().simulated == frame);
    }
    const engine::Digest fifth = s.evaluate(5).value.digest();
    send(s, 4, 0.1);
    s.evaluate(5);
    CHECK(s.counts().simulated == 7);
    send(s, 4, 0.1 * 4);
    CHECK(s.evaluate(5).value.digest() == fifth);
    CHECK(s.counts().simulated == 7);
    CHECK(s.is_ready(5));
    CHECK_FALSE(s.is_ready(6));
    CHECK(s.explain(6).first_frame == 6);
    // Display and names change nothing.
    set(s, "hung", "appearance", std::string("fat"));
    s.evaluate(5);
    CHECK(s.counts().simulated == 7);
    // The same graph loaded again finds its frames too.
    const auto text = s.graph();
    s.load_text(hanging);
    for (int frame = 1; frame <= 5; ++frame) send(s, frame, 0.1 * frame);
    CHECK(s.evaluate(5).value.digest() == fifth);
    CHECK(s.counts().simulated == 7);
}

TEST_CASE("frames kept in a folder are found by the next session", "[embed]") {
    const test::TemporaryFolder folder;
    embed::Options options;
    options.cache_folder = folder.path().string();
    engine::Digest fourth;
    {
        Session s(options);
        s.load_text(hanging);
        fourth = s.evaluate(4).value.digest();
        CHECK(s.counts().simulated == 4);
    }
    Session s(options);
    s.load_text(hanging);
    CHECK(s.evaluate(4).value.digest() == fourth);
    CHECK(s.counts().simulated == 0);
    s.evaluate(6);
    CHECK(s.counts().simulated == 2);
}

TEST_CASE("a session with a root opens nothing elsewhere", "[embed]") {
    const test::TemporaryFolder folder;
    const std::string cube = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    std::filesystem::create_directory(folder / "in");
    test::write_text(folder / "in/m.obj", cube);
    test::write_text(folder / "out.obj", cube);
    embed::Options options;
    options.root_folder = (folder / "in").string();
    const auto code = [](const auto& does) -> std::string {
        try {
            does();
            return "";
        } catch (const engine::Failure& f) {
            return f.diagnostics()[0].code + " " + f.diagnostics()[0].node + "." + f.diagnostics()[0].attribute;
        }
    };
    Session s(options);
    const auto load = [&](const std::string& mesh) {
        s.load_text(R"({"format": "sinew 1", "nodes": {"m": {"type": "meshFile", "inputs": {"file": ")" + mesh +
                        R"("}}}})",
                    (folder / "in/g.json").string());
    };
    CHECK(code([&] { load("m.obj"), s.evaluate(1, "m.outMesh"); }) == "");
    CHECK(code([&] { s.set_json({"m", "file"}, "\"../out.obj\""); }) == "IO410 m.file");
    CHECK(code([&] { set(s, "m", "file", (folder / "out.obj").string()), s.evaluate(1, "m.outMesh"); }) ==
          "IO410 m.file");
    CHECK(code([&] { load("../out.obj"); }) == "IO410 m.file");
    CHECK(code([&] { s.load_file((folder / "g.json").string()); }) == "IO410 .");
    options.cache_folder = (folder / "cache").string();
    CHECK(code([&] { Session other(options); }) == "IO410 .");
    options.root_folder = (folder / "none").string();
    CHECK(code([&] { Session other(options); }) == "IO411 .");
}

TEST_CASE("numbers and texts become what the attribute takes, or are refused with the count that fits", "[embed]") {
    Session s;
    s.load_text(hanging);
    set(s, "solver", "substeps", std::vector<double>{2});
    set(s, "solver", "enable", std::vector<double>{0});
    set(s, "flesh", "youngsModulus", std::string("30 kPa"));
    set(s, "hung", "material", std::string("NeoHookean"));
    const auto literal = [&](const char* node, const char* attribute) {
        return std::get<engine::Value>(s.graph()->find(node)->inputs.find(attribute)->second);
    };
    CHECK(literal("solver", "substeps").as<std::int64_t>() == 2);
    CHECK(literal("solver", "enable").as<bool>() == false);
    CHECK(literal("flesh", "youngsModulus").as<double>() == 30000);
    bool misuse = false;
    CHECK(code([&] { set(s, "solver", "enable", std::vector<double>{2}); }, &misuse) == "DG123");
    CHECK(misuse);
    CHECK(code([&] { set(s, "solver", "gravity", std::vector<double>{2}); }) == "DG123");
    CHECK(code([&] { set(s, "plate", "matrix", std::vector<double>(12)); }) == "DG123");
    CHECK(code([&] { set(s, "flesh", "youngsModulus", std::vector<double>{1, 2}); }) == "DG123");
    CHECK(code([&] { set(s, "flesh", "youngsModulus", std::vector<double>{-1}); }, &misuse) == "DG013");
    CHECK_FALSE(misuse);
    CHECK(code([&] { set(s, "solver", "substeps", std::vector<double>{1.5}); }) == "DG012");
    CHECK(code([&] { set(s, "hung", "material", std::string("Rubber")); }) == "DG014");
    CHECK(literal("hung", "material").as<std::string>() == "NeoHookean");
    // Texts for numbers frame by frame, too.
    const Setting quantity{{"flesh", "youngsModulus"}, std::string("12 kPa")};
    s.set_at(2, {&quantity, 1});
    const auto sent = std::get<engine::Curve>(s.graph()->find("flesh")->inputs.find("youngsModulus")->second);
    CHECK(sent.keys.back().value == engine::KeyNumbers{12000});
}

TEST_CASE("what to evaluate must be clear", "[embed]") {
    Session s;
    s.load_text(R"({"format": "sinew 1", "nodes": {"cube": {"type": "polyCube"}}})");
    CHECK(code([&] { s.evaluate(1); }) == "DG126");
    const std::string body = R"({"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}}})";
    const std::string solver = R"({"type": "zSolver", "inputs": {"bodies": [{"from": "bone.outBody"}]}})";
    s.load_text(R"({"format": "sinew 1", "nodes": {"cube": {"type": "polyCube"}, "bone": )" + body + R"(, "s": )" +
                solver + R"(, "t": )" + solver + "}}");
    bool misuse = false;
    CHECK(code([&] { s.evaluate(1); }, &misuse) == "DG126");
    CHECK(misuse);
    CHECK(s.evaluate(1, "t.outMeshes").names == std::vector<std::string>{"bone"});
}

TEST_CASE("what an observer throws comes out of the evaluation, and finished frames stay", "[embed]") {
    struct Thrower : engine::Observer {
        bool at_step = false, at_end = false;
        void stepped(const std::string&, double frame, double) override {
            if (at_step && frame == 3) throw std::runtime_error("of the host");
        }
        void ends(const std::string&, double frame) override {
            if (at_end && frame == 3) throw 42;
        }
    } thrower;
    Session s({}, &thrower);
    s.load_text(hanging);
    thrower.at_step = true;
    CHECK_THROWS_WITH(s.evaluate(5), "of the host");
    CHECK(s.is_ready(3));
    CHECK_FALSE(s.is_ready(4));
    thrower.at_step = false;
    s.evaluate(5);
    CHECK(s.counts().simulated == 5);
    Session other({}, &thrower);
    other.load_text(hanging);
    thrower.at_end = true;
    CHECK_THROWS_AS(other.evaluate(5), int);
    thrower.at_end = false;
    other.evaluate(5);
    CHECK(other.counts().simulated == 5);
}

TEST_CASE("a session that is called from its own callback refuses, and does not wait for itself", "[embed]") {
    struct Caller : engine::Observer {
        Session* session = nullptr;
        std::vector<std::string> codes;
        void stepped(const std::string&, double frame, double) override {
            if (frame != 2) return;
            for (const std::function<void()>& call : std::vector<std::function<void()>>{
                     [&] { session->evaluate(3); }, [&] { session->is_ready(1); },
                     [&] { set(*session, "plate", "matrix", lifted(1)); }, [&] { session->load_text(hanging); }}) {
                bool misuse = false;
                codes.push_back(code(call, &misuse));
                CHECK(misuse);
            }
            CHECK(session->counts().simulated >= 1);
            CHECK(session->graph()->find("plate"));
        }
    } caller;
    Session s({}, &caller);
    caller.session = &s;
    s.load_text(hanging);
    const auto tip = s.evaluate(2).meshes[0].points->back();
    CHECK(caller.codes == std::vector<std::string>(4, "DG140"));
    CHECK(s.evaluate(2).meshes[0].points->back() == tip);
    // What is refused and not caught comes out of the call that called back.
    struct Naive : engine::Observer {
        Session* session = nullptr;
        void stepped(const std::string&, double, double) override { session->evaluate(1); }
    } naive;
    Session other({}, &naive);
    naive.session = &other;
    other.load_text(hanging);
    bool misuse = false;
    CHECK(code([&] { other.evaluate(2); }, &misuse) == "DG140");
    CHECK(misuse);
}

TEST_CASE("a session has at most as many threads as there may be", "[embed]") {
    for (const int threads : {-1, 1025, 2'000'000'000}) {
        bool misuse = false;
        CHECK(code([&] { Session s({.threads = threads}); }, &misuse) == "DG123");
        CHECK(misuse);
    }
    CHECK(code([] { Session s({.threads = 3}); }).empty());
}

TEST_CASE("a session does not wait for itself within a change or a node of it", "[embed]") {
    auto registry = std::make_shared<engine::Registry>();
    nodes::register_all(*registry);
    const engine::Output<double> out_value{.name = "outValue", .doc = "What it asked for."};
    Session* asked = nullptr;
    engine::NodeType type;
    type.name = "asks", type.doc = "Evaluates a session.", type.revision = "1";
    type.outputs = {engine::describe(out_value)};
    type.compute = [&](const engine::Reads&, engine::Writes& out) {
        out.set(out_value, asked->evaluate(1, "other.outValue").value.as<double>());
    };
    embed::add_host_type(*registry, type);
    engine::NodeType plain = type;
    plain.name = "plain";
    plain.compute = [&](const engine::Reads&, engine::Writes& out) { out.set(out_value, 4.0); };
    embed::add_host_type(*registry, plain);
    const std::string text = R"({"format": "sinew 1", "nodes": {"own": {"type": "asks"}, "other": {"type": "plain"}}})";
    Session s({.registry = registry}), another({.registry = registry});
    s.load_text(text), another.load_text(text);
    asked = &s;
    CHECK(code([&] { s.evaluate(1, "own.outValue"); }) == "DG140");
    CHECK(s.evaluate(1, "other.outValue").value.as<double>() == 4);
    asked = &another;
    s.load_text(R"({"format": "sinew 1", "nodes": {"own": {"type": "asks"}}})");
    CHECK(s.evaluate(1, "own.outValue").value.as<double>() == 4);
    CHECK(code([&] { s.edit([&](engine::Edit&) { s.load_text(text); }); }) == "DG140");
    CHECK(code([&] { s.edit([&](engine::Edit&) { s.set_json({"own", "x"}, "1"); }); }) == "DG140");
    s.edit([](engine::Edit& e) { e.add_node("later", "plain"); });
    CHECK(s.evaluate(1, "later.outValue").value.as<double>() == 4);
}

TEST_CASE("a mesh of a host's node type that is none is told of", "[embed]") {
    auto registry = std::make_shared<engine::Registry>();
    nodes::register_all(*registry);
    const engine::Input<std::int64_t> points{.name = "points", .def = 0, .doc = "How many; 0: no mesh."};
    const engine::Output<nodes::Mesh> out_mesh{.name = "outMesh", .doc = "A mesh."};
    engine::NodeType type;
    type.name = "made", type.doc = "Makes a mesh.", type.revision = "1";
    type.inputs = {engine::describe(points)}, type.outputs = {engine::describe(out_mesh)};
    type.compute = [&](const engine::Reads& in, engine::Writes& out) {
        if (in[points] == 0) return out.set(out_mesh, nodes::Mesh());
        const auto cube = nodes::Mesh::from(solver::SurfaceMesh::from_triangles(
            {solver::Vec3(0, 0, 0), solver::Vec3(1, 0, 0), solver::Vec3(0, 1, 0)}, {{0, 1, 2}}));
        out.set(out_mesh,
                cube.with_points(solver::Points(static_cast<std::size_t>(in[points]), solver::Vec3(1, 2, 3))));
    };
    embed::add_host_type(*registry, type);
    Session s({.registry = registry});
    const auto made = [&](int count) {
        s.load_text(R"({"format": "sinew 1", "nodes": {"m": {"type": "made", "inputs": {"points": )" +
                    std::to_string(count) + "}}}}");
        return code([&] { s.evaluate(1, "m.outMesh"); });
    };
    CHECK(made(0) == "DG127");
    CHECK(made(2) == "DG127");
    CHECK(made(3).empty());
}

TEST_CASE("a host's node type that does not write what it declares is told of", "[embed]") {
    const engine::Output<double> out_value{.name = "outValue", .doc = "A number."},
        other{.name = "other", .doc = "None."};
    const engine::Output<std::string> out_text{.name = "outValue", .doc = "A text."};
    const auto told = [&](const std::function<void(engine::Writes&)>& writes) -> std::string {
        auto registry = std::make_shared<engine::Registry>();
        nodes::register_all(*registry);
        engine::NodeType type;
        type.name = "writes", type.doc = "Writes.", type.revision = "1", type.outputs = {engine::describe(out_value)};
        type.compute = [&](const engine::Reads&, engine::Writes& out) { writes(out); };
        embed::add_host_type(*registry, type);
        Session s({.registry = registry});
        s.load_text(R"({"format": "sinew 1", "nodes": {"w": {"type": "writes"}}})");
        try {
            s.evaluate(1, "w.outValue");
        } catch (const engine::Failure& f) {
            const engine::Diagnostic& d = f.diagnostics().front();
            return d.code + " " + d.node + ": " + d.message;
        }
        return "";
    };
    CHECK(told([](engine::Writes&) {}) == "DG127 w: writes did not write output \"outValue\"");
    CHECK(told([&](engine::Writes& out) { out.set(out_text, std::string("one")); }) ==
          "DG127 w: writes wrote another type to output \"outValue\"");
    CHECK(told([&](engine::Writes& out) { out.set(out_value, 1.0), out.set(other, 1.0); }) ==
          "DG127 w: writes wrote the undeclared output \"other\"");
    CHECK(told([&](engine::Writes& out) { out.set(out_value, 1.0); }).empty());
}

TEST_CASE("a wrong first mesh of a host is replaced by one of another count of points", "[embed]") {
    Session s;
    s.load_text(R"({"format": "sinew 1", "nodes": {"m": {"type": "hostMesh"}}})");
    const std::vector<double> points{0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5};
    const std::vector<int> corners{0, 1, 2};
    s.set_mesh("m", 1, {points, {}, corners});
    s.set_mesh("m", 1, {std::span(points).first(9), {}, corners});
    CHECK(s.evaluate(1, "m.outMesh").meshes[0].points->size() == 3);
    CHECK(s.evaluate(9, "m.outMesh").meshes[0].points->size() == 3);
}

TEST_CASE("faces that are none of the points are refused at once, and the mesh before stays", "[embed]") {
    Session s;
    s.load_text(R"({"format": "sinew 1", "nodes": {"m": {"type": "hostMesh"}}})");
    const std::vector<double> points{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    const std::vector<int> good{0, 1, 2};
    s.set_mesh("m", 1, {points, {}, good});
    const auto told = [&](std::span<const double> at, std::vector<int> sizes, std::vector<int> corners) {
        try {
            s.set_mesh("m", 1, {at, sizes, corners});
        } catch (const Misuse& wrong) {
            const engine::Diagnostic& d = wrong.diagnostics().front();
            CHECK(s.evaluate(1, "m.outMesh").meshes[0].topology->triangles.size() == 1);
            return d.code + " " + d.node + ": " + d.message;
        }
        return std::string();
    };
    CHECK(told(points, {}, {0, 1, 2, 1, 3, 4}) ==
          "DG125 m: corner 2 of face 1 is vertex 4; there are 4 vertices, counted from 0");
    CHECK(told(points, {4}, {0, 1, -3, 2}) ==
          "DG125 m: corner 2 of face 0 is vertex -3; there are 4 vertices, counted from 0");
    CHECK(told(points, {}, {0, 1, 2, 3}) == "DG125 m: 4 corners are no list of triangles");
    CHECK(told(points, {3, 2}, {0, 1, 2, 2, 3}) == "DG125 m: face 1 has 2 corners");
    CHECK(told(points, {3, 4}, {0, 1, 2, 1, 3}) == "DG125 m: the 5 corners end within face 1 of 2");
    CHECK(told(points, {3}, {0, 1, 2, 3}) == "DG125 m: 4 corners, but the faces have 3");
    CHECK(told(std::span(points).first(10), {}, {0, 1, 2}) == "DG125 m: 10 numbers are no list of points");
    CHECK(told(points, {3, 3}, {0, 1, 2, 1, 3, 2}).empty());
    CHECK(s.evaluate(1, "m.outMesh").meshes[0].topology->triangles.size() == 2);
}

TEST_CASE("names and frames that are not there are misuse, values are not", "[embed]") {
    Session s;
    s.load_text(hanging);
    const double never = std::nan("");
    bool misuse = false;
    const auto refused = [&](const std::function<void()>& call, const char* with) {
        misuse = false;
        CHECK(code(call, &misuse) == with);
        CHECK(misuse);
    };
    refused([&] { set(s, "nope", "matrix", lifted(1)); }, "DG040");
    refused([&] { set(s, "plate", "nope", lifted(1)); }, "DG011");
    refused([&] { s.evaluate(1, "hung.nope"); }, "DG102");
    refused([&] { s.evaluate(never); }, "DG104");
    refused([&] { s.is_ready(never); }, "DG104");
    CHECK(code([&] { s.set_json({"solver", "substeps"}, "-1"); }, &misuse) == "DG013");
    CHECK_FALSE(misuse);
    const std::vector<double> points{0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::vector<int> corners{0, 1, 2};
    try {
        s.set_mesh("nope", 1, {points, {}, corners});
        FAIL("a mesh was taken by no node");
    } catch (const Misuse& told) { // once, not for each of the inputs that a mesh is made of
        REQUIRE(told.diagnostics().size() == 1);
        CHECK(told.diagnostics().front().code == "DG040");
    }
}

TEST_CASE("sessions in threads give the bits that one alone gives", "[embed]") {
    const auto run = [] {
        embed::Options options;
        options.threads = 1;
        Session s(options);
        s.load_text(hanging);
        for (int frame = 1; frame <= 4; ++frame) send(s, frame, 0.2 * frame), s.evaluate(frame);
        return s.evaluate(4).value.digest();
    };
    const engine::Digest alone = run();
    std::vector<engine::Digest> found(3);
    std::vector<std::thread> threads;
    for (engine::Digest& d : found) threads.emplace_back([&] { d = run(); });
    for (std::thread& t : threads) t.join();
    for (const engine::Digest& d : found) CHECK(d == alone);
}
