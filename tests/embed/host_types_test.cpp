// Node types of a host: used like any other, found again by their revision, and told of when they fail.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "tests/tools/temporary_folder.h"
#include "tools/embed/host_types.h"
#include "tools/embed/session.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <cstring>
#include <functional>

using namespace sinew;

namespace {

/// The state of a simulation of the host's.
struct Count {
    double value = 0;
};

} // namespace

template <>
struct sinew::engine::ValueTraits<Count> {
    static constexpr std::string_view name = "count";
    static void hash(Hasher& h, const Count& c) { h.add(c.value); }
    static std::size_t bytes(const Count&) { return sizeof(Count); }
};

namespace {

const engine::Wire<nodes::Mesh> mesh{.name = "mesh", .doc = "The mesh to lift."};
const engine::Input<double> by{.name = "by", .def = 1, .limits = {.min = 0}, .doc = "How far, in scene units."};
const engine::Output<nodes::Mesh> out_mesh{.name = "outMesh", .doc = "The lifted mesh."};

engine::NodeType lift(const std::string& revision, std::atomic<int>* runs = nullptr) {
    engine::NodeType type;
    type.name = "lift";
    type.doc = "Lifts a mesh.";
    type.revision = revision;
    type.inputs = {engine::describe(mesh), engine::describe(by)};
    type.outputs = {engine::describe(out_mesh)};
    type.compute = [runs](const engine::Reads& in, engine::Writes& out) {
        if (runs) ++*runs;
        if (in[by] == 13) throw std::runtime_error("thirteen is not liked here");
        if (in[by] == 42) throw 42;
        solver::Points points = *in[mesh].points;
        for (solver::Vec3& p : points) p[1] += in[by];
        out.set(out_mesh, in[mesh].with_points(std::move(points)));
    };
    return type;
}

std::shared_ptr<const engine::Registry> types(const std::string& revision, std::atomic<int>* runs = nullptr) {
    auto registry = std::make_shared<engine::Registry>();
    nodes::register_all(*registry);
    embed::add_host_type(*registry, lift(revision, runs));
    return registry;
}

const std::string scene =
    R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 9}, "nodes": {
    "cube": {"type": "polyCube"},
    "lifted": {"type": "lift", "inputs": {"mesh": {"from": "cube.outMesh"}, "by": 2}},
    "plate": {"type": "zBone", "inputs": {"mesh": {"from": "lifted.outMesh"}}},
    "ball": {"type": "polySphere"}, "flesh": {"type": "zMaterial"},
    "hung": {"type": "zTissue", "inputs": {"mesh": {"from": "ball.outMesh"},
             "materials": [{"from": "flesh.outMaterial"}]}},
    "tie": {"type": "zAttachment", "inputs": {"source": {"from": "hung.outBody"}, "target": {"from": "plate.outBody"}}},
    "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "hung.outBody"}, {"from": "plate.outBody"}],
               "attachments": [{"from": "tie.outAttachment"}]}}}})";

std::vector<std::string> codes(const std::function<void()>& call, std::string* text = nullptr) {
    std::vector<std::string> out;
    try {
        call();
    } catch (const engine::Failure& f) {
        for (const auto& d : f.diagnostics()) out.push_back(d.code + " " + d.node);
        if (text) *text = f.what();
    }
    return out;
}

} // namespace

TEST_CASE("a host's node type works in a graph like any other", "[embed]") {
    embed::Session s({.registry = types("1")});
    s.load_text(scene);
    double low = 1e9;
    for (const solver::Vec3& p : *s.evaluate(3).meshes[1].points) low = std::min(low, p[1]);
    CHECK(low == 1.5);
    const embed::Setting wrong{{"lifted", "by"}, std::vector<double>{-1}};
    CHECK(codes([&] { s.set({&wrong, 1}); }) == std::vector<std::string>{"DG013 lifted"});
    // Sent from frame 3 on, it moves the bone from there, and the two frames before stay.
    const embed::Setting higher{{"lifted", "by"}, std::vector<double>{2.25}};
    s.set_at(3, {&higher, 1});
    s.evaluate(4);
    CHECK(s.counts().simulated == 3 + 2);
}

TEST_CASE("results of a host's type are found by its revision", "[embed]") {
    std::atomic<int> runs = 0;
    engine::Evaluator evaluator({}, 1);
    const auto pull = [&](const std::string& revision) {
        const auto graph = engine::read_graph(types(revision, &runs), scene, "test.json").graph;
        return evaluator.pull({graph, {"lifted", "outMesh"}, 1}).digest();
    };
    const engine::Digest first = pull("1");
    CHECK(runs == 1);
    CHECK(pull("1") == first);
    CHECK(runs == 1);
    CHECK(pull("2") == first); // other code, which happens to give the same
    CHECK(runs == 2);
    pull("1");
    CHECK(runs == 2);
}

TEST_CASE("another revision that gives the same bits leaves simulated frames alone", "[embed]") {
    struct Steps : engine::Observer {
        std::atomic<int> count = 0;
        void stepped(const std::string&, double, double) override { ++count; }
    } steps;
    engine::Evaluator evaluator({}, 1, &steps);
    std::atomic<int> runs = 0;
    for (const char* revision : {"1", "2"}) {
        const auto graph = engine::read_graph(types(revision, &runs), scene, "test.json").graph;
        evaluator.pull({graph, {"solver", "outMeshes"}, 3});
    }
    CHECK(runs == 2);
    CHECK(steps.count == 3);
}

TEST_CASE("what a host's type throws is a failure of its node, with its words", "[embed]") {
    embed::Session s({.registry = types("1")});
    s.load_text(scene);
    const embed::Setting thirteen{{"lifted", "by"}, std::vector<double>{13}};
    s.set({&thirteen, 1});
    std::string text;
    CHECK(codes([&] { s.evaluate(1); }, &text) == std::vector<std::string>{"DG127 lifted"});
    CHECK(text.find("thirteen is not liked here") != std::string::npos);
    const embed::Setting number{{"lifted", "by"}, std::vector<double>{42}};
    s.set({&number, 1});
    CHECK(codes([&] { s.evaluate(1); }, &text) == std::vector<std::string>{"DG127 lifted"});
    CHECK(text.find("no std::exception") != std::string::npos);
}

TEST_CASE("declarations of a host that cannot be are refused", "[embed]") {
    engine::Registry registry;
    nodes::register_all(registry);
    const auto refused = [&](const std::function<void(engine::NodeType&)>& spoil) {
        engine::NodeType type = lift("1");
        spoil(type);
        const auto found = codes([&] { embed::add_host_type(registry, type); });
        return found.size() == 1 && found[0].starts_with("DG128");
    };
    CHECK(refused([](engine::NodeType& t) { t.revision = ""; }));
    CHECK(refused([](engine::NodeType& t) { t.name = "zBone"; }));
    CHECK(refused([](engine::NodeType& t) { t.doc = ""; }));
    CHECK(refused([](engine::NodeType& t) { t.outputs.clear(); }));
    CHECK(refused([](engine::NodeType& t) { t.compute = {}; }));
    CHECK(refused([](engine::NodeType& t) { t.inputs.push_back(t.inputs.front()); }));
    CHECK_FALSE(refused([](engine::NodeType&) {}));
}

TEST_CASE("what a host's simulation throws at its kept states is told once, and the frames are made anew", "[embed]") {
    enum class Fault { none, loading, loading_odd, saving };
    const auto registry = [](Fault fault) {
        engine::SimulationType<Count> type;
        static const engine::Input<double> start{.name = "startFrame", .def = 1, .doc = "First.", .keyable = false};
        static const engine::Input<std::int64_t> substeps{
            .name = "substeps", .def = 1, .limits = {.min = 1}, .doc = "Steps a frame."};
        static const engine::Output<nodes::MeshList> out{.name = "outMeshes", .doc = "A triangle, higher each frame."};
        type.base.name = "counter", type.base.doc = "Counts.", type.base.revision = "1";
        type.base.inputs = {engine::describe(start), engine::describe(substeps)};
        type.base.outputs = {engine::describe(out)};
        type.initial = [](const engine::Reads&) { return Count{1}; };
        type.advance = [](const Count& before, std::span<const engine::SubstepReads>) {
            return Count{before.value + 1};
        };
        type.publish = [](const Count& now, const engine::Reads&, engine::Writes& writes) {
            writes.set(out, nodes::MeshList{{nodes::Mesh::from(solver::SurfaceMesh::from_triangles(
                                {{0, now.value, 0}, {1, now.value, 0}, {0, now.value, 1}}, {{0, 1, 2}}))}});
        };
        type.save = [fault](const Count& now) {
            if (fault == Fault::saving) throw std::runtime_error("no saving here");
            const auto bytes = std::as_bytes(std::span(&now.value, 1));
            return std::vector<std::byte>(bytes.begin(), bytes.end());
        };
        type.load = [fault](std::span<const std::byte> bytes) {
            if (fault == Fault::loading) throw std::runtime_error("no loading here");
            if (fault == Fault::loading_odd) throw 7;
            Count out;
            std::memcpy(&out.value, bytes.data(), sizeof out.value);
            return out;
        };
        auto all = std::make_shared<engine::Registry>();
        nodes::register_all(*all);
        embed::add_host_type(*all, engine::erase(type));
        return all;
    };
    struct Told : engine::Observer {
        std::vector<std::string> warnings;
        void warning(const engine::Diagnostic& d) override { warnings.push_back(d.code + ": " + d.message); }
    };
    const test::TemporaryFolder folder;
    const auto run = [&](Fault fault, double frame, std::int64_t simulated) {
        Told told;
        embed::Session s({.registry = registry(fault), .cache_folder = folder.path().string()}, &told);
        s.load_text(R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 9},
                        "nodes": {"rise": {"type": "counter"}}})");
        CHECK(s.evaluate(frame, "rise.outMeshes").meshes.at(0).points->at(0).y() == frame);
        CHECK(s.counts().simulated == simulated);
        return told.warnings;
    };
    const auto one_with = [](const std::vector<std::string>& warnings, const std::string& code, const char* words) {
        REQUIRE(warnings.size() == 1);
        CHECK(warnings[0].starts_with(code));
        CHECK(warnings[0].find(words) != std::string::npos);
    };
    one_with(run(Fault::saving, 2, 2), "IO407", "saving a state of counter: no saving here");
    CHECK(run(Fault::none, 3, 3).empty());
    CHECK(run(Fault::none, 4, 1).empty());
    one_with(run(Fault::loading, 5, 5), "IO406", "made anew: loading a state of counter: no loading here");
    one_with(run(Fault::loading_odd, 6, 6), "IO406", "loading a state of counter threw something");
    CHECK(run(Fault::loading, 6, 0).empty()); // its outputs are whole
}
