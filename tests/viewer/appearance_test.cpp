// How bodies look: as the graph says, not as they are called, and the same again from the files of a run.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "tests/viewer/runs.h"
#include "tools/cli/body_files.h"
#include "tools/cli/glb.h"
#include "tools/viewer/collect.h"
#include "tools/viewer/collect_glb.h"

#include <catch2/catch.hpp>

using namespace sinew;
using namespace sinew::viewer;

namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

/// The block of the test graph, with further inputs and under another name.
ViewBody block_with(const std::string& inputs, const std::string& name = "block") {
    std::string text =
        replaced(test::muscle_graph_text(), R"("zTissue", "inputs": {)", R"("zTissue", "inputs": {)" + inputs);
    text = replaced(replaced(text, "\"block\"", "\"" + name + "\""), "\"block.", "\"" + name + ".");
    engine::Evaluator evaluator({}, 1);
    Evaluation e;
    e.graph = engine::read_graph(nodes::make_registry(), text, "g.json").graph;
    e.evaluator = &evaluator, e.frames = {1}, e.with_lattices = false;
    return collect_graph(e).bodies.at(2);
}

Eigen::Vector3f srgb_of(const ViewBody& body) {
    const Eigen::Vector3f& c = body.look.colour;
    return {render::to_srgb(c[0]), render::to_srgb(c[1]), render::to_srgb(c[2])};
}

} // namespace

TEST_CASE("a tissue looks as its appearance says, whatever it is called") {
    const ViewBody plain = block_with("");
    CHECK(plain.matter == nodes::Matter::muscle);
    for (const char* name : {"tendonOfFat", "skin", "liver ligament"}) {
        const ViewBody named = block_with("", name);
        CHECK(named.name == name);
        CHECK(named.matter == nodes::Matter::muscle);
        CHECK(named.look.colour == plain.look.colour);
    }
    const ViewBody fat = block_with(R"("appearance": "fat",)");
    CHECK(fat.matter == nodes::Matter::fat);
    CHECK(fat.look.stripes == 0);
    CHECK(srgb_of(fat)[1] > 0.7f); // yellow: fat is not red
    CHECK(srgb_of(plain)[1] < 0.3f);
    CHECK(block_with(R"("appearance": "tendon",)").look.colour != fat.look.colour);
}

TEST_CASE("a colour of one's own is taken as it is written, and leaves grain and gloss") {
    const ViewBody own = block_with(R"("colour": [0.25, 0.5, 0.75],)");
    CHECK((srgb_of(own) - Eigen::Vector3f(0.25f, 0.5f, 0.75f)).cwiseAbs().maxCoeff() < 1e-5f);
    CHECK(own.look.stripes == block_with("").look.stripes);
    CHECK_THROWS_AS(block_with(R"("colour": [0.25, 0.5, 75],)"), engine::Failure);
    CHECK_THROWS_AS(block_with(R"("appearance": "muskle",)"), engine::Failure);
}

TEST_CASE("another look computes nothing again") {
    const auto graph = test::muscle_graph();
    engine::Evaluator evaluator({}, 1);
    const engine::Plug plug{"solver", "outMeshes"};
    REQUIRE(evaluator.pull({graph, plug, 2.0}));
    const auto ready = [&](const char* node, const char* attribute, const char* value) {
        const auto edited = engine::Edit(graph).set_json({node, attribute}, value).commit().graph;
        return evaluator.explain({edited, plug, 2.0}).readiness == engine::Readiness::ready;
    };
    CHECK(ready("block", "appearance", R"("fat")"));
    CHECK(ready("block", "colour", "[0.1, 0.2, 0.3]"));
    CHECK(ready("lower", "appearance", R"("cartilage")"));
    CHECK_FALSE(ready("block", "compressionResistance", "1000"));
}

TEST_CASE("looks come back from OBJ and GLB files") {
    const test::TemporaryFolder folder;
    render::Appearance tendon{nodes::Matter::tendon, {}}, blue{{}, Eigen::Vector3f(0, 51.0f / 255, 1)};
    const cli::BodyLabel first{"a", render::BodyKind::tissue, tendon}, second{"b", render::BodyKind::tissue, blue};
    nodes::Mesh mesh =
        engine::Evaluator({}, 1).pull({test::muscle_graph(), {"blockMesh", "outMesh"}, 1.0}).as<nodes::Mesh>();
    for (const auto& label : {first, second}) cli::write_body(folder.path(), "obj", label, mesh, 1, {100, 'y'});
    const std::string text = test::read_text(folder / "obj/b.0001.obj");
    CHECK(text.starts_with("# sinew: tissue, y up, 100 units a metre\n# sinew looks: muscle, #0033ff\n"));
    for (const cli::BodySequence& s : cli::find_sequences(folder.path()).bodies) {
        INFO(s.label.name);
        CHECK(s.label.appearance.matter == (s.label.name == "a" ? nodes::Matter::tendon : nodes::Matter::muscle));
        CHECK(s.label.appearance.colour == (s.label.name == "a" ? std::optional<Eigen::Vector3f>() : blue.colour));
    }
    // A head that somebody spoiled says nothing.
    std::filesystem::create_directories(folder / "odd/obj");
    test::write_text(folder / "odd/obj/a.0001.obj",
                     "# sinew: tissue, y up, 100 units a metre\n# sinew looks: gold,\n" + test::cube_obj(0));
    const auto odd = cli::find_sequences(folder / "odd").bodies;
    REQUIRE(odd.size() == 1);
    CHECK_FALSE(odd[0].label.appearance.matter);
    CHECK_FALSE(odd[0].label.appearance.colour);

    cli::GlbFile run(folder / "run.glb", {});
    for (const cli::BodyLabel& label : {first, second})
        run.add_pose(run.add_body(label.name, label.kind, mesh.topology->triangles, mesh.points, label.appearance), 1,
                     mesh.points);
    REQUIRE(run.finish());
    std::vector<ViewNote> notes;
    const std::vector<ViewBody> bodies = GlbRun(folder / "run.glb").bodies({1}, notes);
    REQUIRE(bodies.size() == 2);
    CHECK(bodies[0].matter == nodes::Matter::tendon);
    CHECK(bodies[0].look.colour == render::look_of(render::BodyKind::tissue, tendon, 0).colour);
    CHECK(bodies[1].matter == nodes::Matter::muscle);
    CHECK((srgb_of(bodies[1]) - *blue.colour).cwiseAbs().maxCoeff() < 1e-5f);
}

TEST_CASE("colours are written and read as #rrggbb, and nothing else is one") {
    CHECK(render::hex_of({1, 0.5f, 0}) == "#ff8000");
    CHECK(render::colour_of("#ff8000")->isApprox(Eigen::Vector3f(1, 128.0f / 255, 0)));
    for (const char* text : {"", "#ff80", "ff8000", "#ff80gg", "#ff80000", "# f8000"})
        CHECK_FALSE(render::colour_of(text));
}
