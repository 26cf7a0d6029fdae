// Promises of every node type: it is listed, documented, and its declared inputs, all of them, enter its key.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "solver/linear/blas_kernel.h"

#include <cctype>
#include <cmath>
#include <set>
#include <utility>

using namespace bench;

namespace {

const std::vector<std::string> all_types = {
    "aim",          "airField",        "combineWeights",  "contactWriter",   "curve",        "dragField",
    "endPoints",    "gravityField",    "hostMesh",        "meshFile",        "meshSequence", "meshWriter",
    "muscleCurve",  "newtonField",     "pickMesh",        "polyCube",        "polyCylinder", "polyHelix",
    "polyPlane",    "polySphere",      "radialField",     "skinCluster",     "tetMeshFile",  "tetWriter",
    "trackChannel", "transferWeights", "transform",       "turbulenceField", "uniformField", "volumeAxisField",
    "vortexField",  "weights",         "zAttachment",     "zBone",           "zCloth",       "zDelaunayTetMesh",
    "zEmbedder",    "zFiber",          "zGoalAttachment", "zHold",           "zIsoMesh",     "zLineOfAction",
    "zMaterial",    "zRestShape",      "zRivetToBone",    "zSolver",         "zSubtissue",   "zTet",
    "zTissue"};

/// Numbers that have no unit because they count frames or recorded things, not lengths in the scene.
const std::set<std::string_view> counted = {"trackOffset", "trackRate", "offset",      "rate",
                                            "inMin",       "inMax",     "outMin",      "outMax",
                                            "startFrame",  "coils",     "frameOffset", "frameRate"};

const std::string track_text = R"({"frames": [
  {"frame": 1, "angle": 0, "bones": {"ulna": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "hand": [1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1]}},
  {"frame": 2, "angle": 9, "bones": {"ulna": [1,0,0,2, 0,1,0,0, 0,0,1,0, 0,0,0,1], "hand": [1,0,0,3, 0,1,0,0, 0,0,1,0, 0,0,0,1]}},
  {"frame": 9, "angle": 5, "bones": {"ulna": [1,0,0,7, 0,1,0,0, 0,0,1,0, 0,0,0,1], "hand": [1,0,0,5, 0,1,0,0, 0,0,1,0, 0,0,0,1]}}]})";

/// The smallest graph around a node "n" of each type that can be pulled.
std::map<std::string, std::string> smallest_graphs(const Folder& folder) {
    const std::string obj =
        folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    const std::string tets =
        folder.write("t.mesh", "MeshVersionFormatted 1\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n"
                               "0 1 0 0\n0 0 1 0\nTetrahedra\n1\n1 2 3 4 0\nEnd\n");
    for (const char* name : {"s.01.obj", "s.02.obj", "s.03.obj", "s.04.obj"})
        std::filesystem::copy_file(obj, folder.path(name));
    const std::string track = folder.write("track.json", track_text);
    const std::string base = R"(
        "cube": {"type": "polyCube"}, "far": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [0, 1.2, 0]}},
        "flesh": {"type": "zMaterial"}, "bone": {"type": "zBone", "inputs": {"mesh": {"from": "far.outMesh"}}},
        "tissue": {"type": "zTissue", "inputs": {"mesh": {"from": "cube.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}},
        "tie": {"type": "zAttachment", "inputs": {"source": {"from": "tissue.outBody"}, "target": {"from": "bone.outBody"}}},
        "half": {"type": "weights", "inputs": {"mesh": {"from": "cube.outMesh"}, "mode": "ramp", "start": -0.5, "end": 0.5}},
        "rest": {"type": "weights", "inputs": {"mesh": {"from": "cube.outMesh"}, "mode": "ramp", "start": 0.5, "end": -0.5}},
        "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "bone.outBody"}, {"from": "tissue.outBody"}],
                                                 "attachments": [{"from": "tie.outAttachment"}]}},)";
    const auto node = [&](const std::string& type, const std::string& inputs) {
        return base + R"("n": {"type": ")" + type + R"(", "inputs": {)" + inputs + "}}";
    };
    return {
        {"aim", node("aim", "")},
        {"combineWeights",
         node("combineWeights", R"("weights": [{"from": "half.outWeights"}, {"from": "rest.outWeights"}],
             "mesh": {"from": "cube.outMesh"})")},
        {"contactWriter", node("contactWriter", R"("contacts": {"from": "solver.outContacts"})")},
        {"curve", node("curve", R"("points": [0,0,0, 1,0,0])")},
        {"endPoints", node("endPoints", R"("mesh": {"from": "cube.outMesh"}, "source": {"from": "half.outWeights"},
                                               "sink": {"from": "rest.outWeights"})")},
        {"hostMesh", node("hostMesh", R"("points": [0,0,0, 1,0,0, 0,1,0], "faceVertices": [0, 1, 2])")},
        {"meshFile", node("meshFile", R"("file": ")" + obj + "\"")},
        {"meshSequence", node("meshSequence", R"("file": ")" + folder.path("s.##.obj") + "\"")},
        {"pickMesh", node("pickMesh", R"("meshes": {"from": "solver.outMeshes"}, "index": 1)")},
        {"skinCluster",
         node("skinCluster", R"("mesh": {"from": "cube.outMesh"}, "joints": [{"from": "j.outMatrix"}])") +
             R"(, "j": {"type": "transform"})"},
        {"meshWriter", node("meshWriter", R"("mesh": {"from": "cube.outMesh"})")},
        {"polyCube", node("polyCube", "")},
        {"polyCylinder", node("polyCylinder", "")},
        {"polyHelix", node("polyHelix", "")},
        {"polyPlane", node("polyPlane", "")},
        {"polySphere", node("polySphere", "")},
        {"tetMeshFile", node("tetMeshFile", R"("file": ")" + tets + "\"")},
        {"tetWriter", base + R"("fill": {"type": "zTet", "inputs": {"mesh": {"from": "cube.outMesh"}}},
                   "n": {"type": "tetWriter", "inputs": {"tets": {"from": "fill.outTets"}}})"},
        {"trackChannel", node("trackChannel", R"("channel": "angle", "inMax": 10, "file": ")" + track + "\"")},
        {"transferWeights",
         node("transferWeights", R"("oldMesh": {"from": "cube.outMesh"}, "newMesh": {"from": "far.outMesh"},
                                    "weights": {"from": "half.outWeights"})")},
        {"transform",
         node("transform", R"("mesh": {"from": "cube.outMesh"}, "trackName": "ulna", "track": ")" + track + "\"")},
        {"weights", node("weights", R"("mesh": {"from": "cube.outMesh"})")},
        {"airField", node("airField", "")},
        {"dragField", node("dragField", "")},
        {"gravityField", node("gravityField", "")},
        {"newtonField", node("newtonField", "")},
        {"radialField", node("radialField", "")},
        {"turbulenceField", node("turbulenceField", "")},
        {"uniformField", node("uniformField", "")},
        {"volumeAxisField", node("volumeAxisField", "")},
        {"vortexField", node("vortexField", "")},
        {"zAttachment",
         node("zAttachment", R"("source": {"from": "tissue.outBody"}, "target": {"from": "bone.outBody"})")},
        {"zGoalAttachment",
         node("zGoalAttachment", R"("source": {"from": "tissue.outBody"}, "target": {"from": "bone.outBody"})")},
        {"zBone", node("zBone", R"("mesh": {"from": "cube.outMesh"})")},
        {"zCloth", node("zCloth", R"("mesh": {"from": "cube.outMesh"}, "materials": [{"from": "flesh.outMaterial"}])")},
        {"zEmbedder", node("zEmbedder", R"("solved": {"from": "solver.outSolved"}, "body": {"from": "tissue.outBody"},
                                               "meshes": [{"from": "cube.outMesh"}])")},
        {"zFiber", node("zFiber", "")},
        {"zHold", node("zHold", R"("tissue": {"from": "tissue.outBody"})")},
        {"zDelaunayTetMesh", base + R"("skin": {"type": "zIsoMesh", "inputs": {"meshes": [{"from": "cube.outMesh"}]}},
                   "n": {"type": "zDelaunayTetMesh", "inputs": {"mesh": {"from": "skin.outMesh"}}})"},
        {"muscleCurve", node("muscleCurve", R"("mesh": {"from": "cube.outMesh"}, "endPoints": [0,0,0,0, 1,1,1,1])")},
        {"zRestShape", node("zRestShape", R"("target": {"from": "far.outMesh"})")},
        {"zLineOfAction", base + R"("path": {"type": "curve", "inputs": {"points": [0,0,0, 1,0,0]}},
                   "n": {"type": "zLineOfAction", "inputs": {"curves": [{"from": "path.outCurve"}]}})"},
        {"zRivetToBone", base + R"("path": {"type": "curve", "inputs": {"points": [0,0.7,0, 1,1.2,0]}},
                   "n": {"type": "zRivetToBone", "inputs": {"curve": {"from": "path.outCurve"},
                                                            "bone": {"from": "bone.outBody"}}})"},
        {"zIsoMesh", node("zIsoMesh", R"("meshes": [{"from": "cube.outMesh"}])")},
        {"zMaterial", node("zMaterial", "")},
        {"zSolver", node("zSolver", R"("bodies": [{"from": "bone.outBody"}, {"from": "tissue.outBody"}],
                                           "attachments": [{"from": "tie.outAttachment"}])")},
        {"zSubtissue",
         node("zSubtissue", R"("mesh": {"from": "cube.outMesh"}, "materials": [{"from": "flesh.outMaterial"}])")},
        {"zTet", node("zTet", R"("mesh": {"from": "cube.outMesh"})")},
        {"zTissue",
         node("zTissue", R"("mesh": {"from": "cube.outMesh"}, "materials": [{"from": "flesh.outMaterial"}])")}};
}

/// Another value that the attribute allows; empty if there is none to be made up (files).
std::string another(const engine::AttributeInfo& a) {
    if (a.def.is<bool>()) return a.def.as<bool>() ? "false" : "true";
    if (a.def.is<std::int64_t>()) return std::to_string(a.def.as<std::int64_t>() + 1);
    if (a.def.is<double>()) {
        const double def = a.def.as<double>();
        return std::to_string(def + 0.25 < a.limits.max ? def + 0.25 : def - 0.25);
    }
    if (a.def.is<std::string>() && a.options.empty()) return "\"hand\"";
    if (a.def.is<std::string>())
        return "\"" + std::string(a.def.as<std::string>() == a.options.back() ? a.options.front() : a.options.back()) +
               "\"";
    if (a.def.is<engine::Vec3>()) return "[0.5, 0.25, 0.125]";
    if (a.def.is<engine::Matrix4>()) return "[1,0,0,5, 0,1,0,0, 0,0,1,0, 0,0,0,1]";
    if (a.def.is<engine::NumberList>()) return "[0.75]";
    return "";
}

} // namespace

TEST_CASE("nodes that factor have the kernels' names in their keys", "[nodes]") {
    const auto types = nodes::make_registry();
    for (const char* name : {"zSolver", "zTissue"})
        CHECK(types->find(name)->machine.starts_with(solver::blas_kernel()));
    CHECK(types->find("polyCube")->machine.empty());
}

TEST_CASE("the registry holds exactly the listed node types", "[nodes]") {
    CHECK(nodes::make_registry()->names() == all_types);
}

TEST_CASE("every node type has its place in nodes/README.md", "[nodes]") {
    std::ifstream in(std::string(SINEW_SOURCE_DIR) + "/nodes/README.md");
    REQUIRE(in);
    std::set<std::string> first_cells; // words of the first column
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] != '|') continue;
        std::string word;
        for (const char c : line.substr(1, line.find('|', 1) - 1) + ",")
            if (std::isalnum(static_cast<unsigned char>(c)))
                word += c;
            else if (!word.empty())
                first_cells.insert(std::exchange(word, ""));
    }
    for (const std::string& name : all_types) {
        INFO(name);
        CHECK(first_cells.contains(name));
    }
}

TEST_CASE("every node type, input and output is documented, every number with its unit", "[nodes]") {
    const auto registry = nodes::make_registry();
    for (const std::string& name : registry->names()) {
        const engine::NodeType* type = registry->find(name);
        INFO(name);
        CHECK(type->doc.ends_with('.'));
        for (const auto* list : {&type->inputs, &type->outputs})
            for (const engine::AttributeInfo& a : *list) {
                INFO(a.name);
                CHECK(a.doc.ends_with('.'));
                const bool number =
                    a.kind == engine::AttributeKind::literal && (a.def.is<double>() || a.def.is<engine::Vec3>());
                // Lengths in the scene have no unit that could be converted; then the words must say what
                // they are.
                if (number && a.unit.empty() && !counted.contains(a.name))
                    CHECK(a.doc.find("cene unit") != std::string_view::npos);
            }
    }
}

TEST_CASE("every number has a lower and an upper end", "[nodes]") {
    const auto registry = nodes::make_registry();
    for (const std::string& name : registry->names())
        for (const engine::AttributeInfo& a : registry->find(name)->inputs) {
            const bool numbers = a.def.is<double>() || a.def.is<std::int64_t>() || a.def.is<engine::Vec3>() ||
                                 a.def.is<engine::NumberList>();
            if (a.kind != engine::AttributeKind::literal || !numbers) continue;
            INFO(name << "." << a.name);
            CHECK(std::abs(a.limits.min) <= 1e60);
            CHECK(std::abs(a.limits.max) <= 1e60);
        }
}

TEST_CASE("every type computes in its smallest graph, and a change of any input enters its key", "[nodes]") {
    const Folder folder;
    const auto registry = nodes::make_registry();
    const auto graphs = smallest_graphs(folder);
    for (const std::string& name : registry->names()) {
        INFO(name);
        REQUIRE(graphs.contains(name));
        Session s(graphs.at(name));
        const engine::NodeType* type = registry->find(name);
        const engine::Plug plug{"n", std::string(type->outputs.front().name)};
        const double frame = 3;
        REQUIRE(s.evaluator.pull({s.graph, plug, frame}));
        CHECK(s.evaluator.explain({s.graph, plug, frame}).readiness == engine::Readiness::ready);
        for (const engine::AttributeInfo& a : type->inputs) {
            if (a.kind != engine::AttributeKind::literal || another(a).empty()) continue;
            if (name == "zSolver" && a.name == "startFrame") continue; // tested with the frames it moves
            if (!a.names_entry_of.empty()) continue;                   // a name enters as the place that it stands for
            INFO(a.name << " = " << another(a));
            const auto is_ready = [&](const std::shared_ptr<const engine::Graph>& graph) {
                const auto edited = engine::Edit(graph).set_json({"n", std::string(a.name)}, another(a)).commit().graph;
                return s.evaluator.explain({edited, plug, frame}).readiness == engine::Readiness::ready;
            };
            CHECK(is_ready(s.graph) == (a.affects == engine::Affects::nothing || !a.when.empty()));
            if (a.when.empty()) continue;
            const auto on = engine::Edit(s.graph).set_json({"n", std::string(a.when)}, "true").commit().graph;
            s.evaluator.pull({on, plug, frame});
            CHECK_FALSE(is_ready(on)); // off it changes nothing, on it does
        }
        CHECK(s.counter.warnings.empty());
    }
}
