// What is drawn of tets and fibres keeps to the flesh, thick or thin, and moves with it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/flesh.h"

#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "tests/viewer/runs.h"
#include "tools/viewer/collect.h"
#include "tools/viewer/shot_overlays.h"

#include <catch2/catch.hpp>

using namespace sinew;
using namespace sinew::viewer;
using solver::Vec3;

namespace {

ViewScene collect(const std::string& text) {
    engine::Evaluator evaluator({}, 1);
    Evaluation e;
    e.graph = engine::read_graph(nodes::make_registry(), text, "g.json").graph;
    e.evaluator = &evaluator, e.frames = {1, 4};
    return collect_graph(e);
}

std::string with_block(const std::string& size, const std::string& tets) {
    std::string text = test::muscle_graph_text();
    const std::string from = R"("width": 4, "height": 8, "depth": 4)", mesh = R"("zTissue", "inputs": {)";
    text.replace(text.find(from), from.size(), size);
    text.replace(text.find(mesh), mesh.size(), mesh + R"( "tets": { "from": "lattice.outTets" },)");
    const std::string nodes = R"("nodes": {)";
    text.replace(text.find(nodes), nodes.size(),
                 nodes + R"("lattice": { "type": "zTet", "inputs": { "mesh": { "from": "blockMesh.outMesh" }, )" +
                     tets + "} },");
    return text;
}

Vec3 point(const Coordinates& c, std::size_t i) {
    return Vec3(static_cast<double>(c[3 * i]), static_cast<double>(c[3 * i + 1]), static_cast<double>(c[3 * i + 2]));
}

/// How far a point lies outside of the box of these half sides.
double outside(const Vec3& p, const Vec3& half) { return (p.cwiseAbs() - half).cwiseMax(0).norm(); }

} // namespace

TEST_CASE("tet vertices beside the flesh are drawn at the place of its skin next to them, the others where they are") {
    const Vec3 half(2, 4, 2);
    const ViewScene scene = collect(with_block(R"("width": 4, "height": 8, "depth": 4)", R"("tetSize": 3)"));
    const ViewBody& block = scene.bodies.at(2);
    const Coordinates drawn = drawn_lattice(block, 0);
    std::size_t moved = 0;
    for (std::size_t v = 0; v < drawn.size() / 3; ++v) {
        const Vec3 rest = point(block.lattice->rest, v), nearest = rest.cwiseMax(-half).cwiseMin(half);
        CHECK((point(drawn, v) - nearest).norm() < 1e-5);
        moved += outside(rest, half) > 0.1;
    }
    CHECK(moved > 10);
    // Where the flesh has moved to, they are on its skin: the block's upper end is held by a plate at y = 4.2 that
    // turns.
    const Coordinates later = drawn_lattice(block, 1);
    double top = -1e9, corner_top = -1e9;
    for (std::size_t v = 0; v < later.size() / 3; ++v) top = std::max(top, point(later, v).y());
    for (std::size_t v = 0; v < block.vertex_count(); ++v)
        corner_top = std::max(corner_top, static_cast<double>(vertex_position(block, 1, v)[1]));
    CHECK(top <= corner_top + 1e-5);
    CHECK(top > corner_top - 0.2);
}

TEST_CASE("what was found out about shapes at rest is found once, whatever the muscles do") {
    const ViewScene scene = collect(with_block(R"("width": 4, "height": 8, "depth": 4)", R"("tetSize": 3)"));
    const ViewBody& block = scene.bodies.at(2);
    REQUIRE(block.fibres.size() == 1);
    FleshMemory memory;
    const auto kept = [&](ViewBody body, FleshMemory* with) {
        body.lattice->skin.clear();
        keep_to_flesh(body, with);
        return body;
    };
    const auto same = [](const ViewBody& a, const ViewBody& b) {
        bool out = a.lattice->skin.size() == b.lattice->skin.size() && a.fibres[0].tets == b.fibres[0].tets &&
                   a.fibres[0].centre == b.fibres[0].centre && a.fibres[0].reach == b.fibres[0].reach;
        for (std::size_t i = 0; out && i < a.lattice->skin.size(); ++i)
            out = a.lattice->skin[i].vertex == b.lattice->skin[i].vertex &&
                  a.lattice->skin[i].host == b.lattice->skin[i].host;
        return out;
    };
    const ViewBody alone = kept(block, nullptr), first = kept(block, &memory);
    CHECK(same(alone, first));
    // Another excitation, the same shapes: it keeps its own.
    ViewBody excited = block;
    for (float& e : excited.fibres[0].excitation) e = 0.75f;
    const ViewBody again = kept(excited, &memory);
    CHECK(same(again, alone));
    CHECK(again.fibres[0].excitation == excited.fibres[0].excitation);
    // Another shape, or flesh that is no longer known to have an inside, is found out anew.
    ViewBody wider = block;
    for (std::size_t i = 0; i < wider.rest.size(); i += 3) wider.rest[i] *= 0.8f;
    CHECK(same(kept(wider, &memory), kept(wider, nullptr)));
    CHECK_FALSE(same(kept(wider, &memory), alone));
    ViewBody open = block;
    open.volume.clear();
    CHECK(kept(open, &memory).lattice->skin.empty());
    CHECK(same(kept(block, &memory), alone));
}

TEST_CASE("lines of fibres begin and end in the flesh, also where it is thinner than a tet") {
    for (const auto& [size, tets, half] :
         {std::tuple(R"("width": 4, "height": 8, "depth": 4)", R"("tetSize": 3)", Vec3(2, 4, 2)),
          std::tuple(R"("width": 0.3, "height": 8, "depth": 4)", R"("tetSize": 2)", Vec3(0.15, 4, 2)),
          std::tuple(R"("width": 0.3, "height": 8, "depth": 0.2)", R"("tetSize": 2)", Vec3(0.15, 4, 0.1))}) {
        INFO(size);
        const ViewScene scene = collect(with_block(size, tets));
        const ViewFibres& fibres = scene.bodies.at(2).fibres.at(0);
        REQUIRE(fibres.tets.size() >= 4);
        CHECK(fibres.centre.size() == 4 * fibres.tets.size());
        const auto lines = overlay_segments(scene, 0, {"fibers"});
        REQUIRE(lines.size() == fibres.tets.size());
        double longest = 0, farthest = 0;
        for (const render::Segment& s : lines) {
            farthest = std::max({farthest, outside(s.from, half), outside(s.to, half)});
            longest = std::max(longest, (s.to - s.from).norm());
            // From one end of the muscle to the other, as the end points are painted.
            if ((s.to - s.from).norm() > 0.1) CHECK(std::abs((s.to - s.from).normalized().y()) > 0.7);
        }
        CHECK(farthest < 0.05);
        CHECK(longest > 0.3);
    }
}
