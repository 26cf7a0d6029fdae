// Springs by what their ends ride on: all of them, each once.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"
#include "solver/terms/attachment/spring_bundles.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>
#include <functional>
#include <set>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

/// A large plate in the plane x = 0.
Points wall() { return {{0, -1, -1}, {0, 2, -1}, {0, 2, 2}, {0, -1, 2}}; }
std::shared_ptr<BoneRest> wall_bone() { return bone(wall(), {{0, 2, 1}, {0, 3, 2}}); }

std::vector<double> paint(const Points& points, const std::function<bool(const Vec3&)>& where) {
    std::vector<double> out(points.size(), 0.0);
    for (const int v : vertices_where(points, where)) out[static_cast<std::size_t>(v)] = 1;
    return out;
}

} // namespace

TEST_CASE("bundles have every spring once, with those that ride on the same vertices") {
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        auto below = tissue(box_mesh({0.3, 0.1, 0.1}, 4, 2, 2), ElasticLaw::stvk);
        below->element = kind;
        auto above = tissue(box_mesh({0.3, 0.15, 0.1}, 3, 2, 2), ElasticLaw::stvk);
        for (Points* points : {&above->tets.vertices, &above->surface})
            for (Vec3& x : *points) x += Vec3(0.05, -0.02, 0.11);
        AttachmentRest to_bone, to_tissue, bones;
        to_bone.source = 0, to_bone.target = 2, to_tissue.source = 0, to_tissue.target = 1;
        bones.source = 3, bones.target = 2;
        to_bone.source_weights = paint(below->surface, [](const Vec3& x) { return x.x() < 1e-9; });
        to_tissue.source_weights = paint(below->surface, [](const Vec3& x) { return x.z() > 0.09; });
        const Scene scene({{below, above, wall_bone(), wall_bone()}, {to_bone, bones, to_tissue}});
        StepInputs in = still_inputs();
        in.bodies = {material(3e5, 0.3, 1000), material(3e5, 0.3, 1000), BoneInputs{wall()}, BoneInputs{wall()}};
        in.attachments = {{1e6, 1, 0}, {1e6, 1, 0}, {1e6, 1, 0}};
        const State s = initial_state(scene, in);
        const AttachmentView kept = attachments_kept(s.memories);
        const SpringBundles bundles(scene, kept.anchors);

        REQUIRE(bundles.spring_count() == kept.anchors[0].size() + kept.anchors[2].size());
        std::set<std::pair<int, int>> met;
        std::set<std::pair<int, std::vector<int>>> kinds_met;
        std::size_t number = 0;
        int last = 0;
        for (std::size_t b = 0; b < bundles.count(); ++b) {
            const int attachment = bundles.attachment(b);
            CHECK(attachment >= last);
            last = attachment;
            const std::span<const int> vertices = bundles.vertices(b);
            CHECK(kinds_met.insert({attachment, {vertices.begin(), vertices.end()}}).second);
            bundles.for_each_spring(b, [&](const SpringBundles::Spring& spring) {
                CHECK(spring.number == number++);
                CHECK(met.insert({attachment, spring.anchor}).second);
                const Anchor& anchor =
                    kept.anchors[static_cast<std::size_t>(attachment)][static_cast<std::size_t>(spring.anchor)];
                CHECK(spring.area_weight == anchor.area_weight);
                // As the ends themselves say where they are.
                Vec3 expected = modelled_point(scene, 0, anchor.source), there = Vec3::Zero();
                if (attachment == 2) expected -= modelled_point(scene, 1, anchor.target);
                for (std::size_t i = 0; i < vertices.size(); ++i)
                    there += spring.coefficients[i] * position(s, vertices[i]);
                CHECK((there - expected).norm() < 1e-12);
            });
        }
        CHECK(number == bundles.spring_count());
        CHECK(bundles.count() < bundles.spring_count()); // what they are for
    }
}
