// What a point and a triangle write to the gradient: to what carries them, whichever bodies they are of.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/term/point_triangle_element.h"
#include "solver/terms/contact/collision_bodies.h"
#include "solver/terms/contact/contact.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

TEST_CASE("an element that is used again for a point and a triangle of the same numbers pulls at their bodies",
          "[contact]") {
    SceneDescription d;
    for (int i = 0; i < 3; ++i) {
        TetMesh mesh = box_mesh({1, 1, 1}, 1, 1, 1);
        for (Vec3& p : mesh.vertices) p.x() += 2.0 * i;
        d.bodies.emplace_back(tissue(mesh, ElasticLaw::stvk));
        d.parts.push_back({&contact_type, {i}, std::make_shared<ContactRest>()});
    }
    const Scene scene(d);
    const CollisionBodies bodies(scene);
    const Vec3 force(1, -2, 3);
    constexpr int point = 3, triangle = 5;
    PointTriangleElement element;
    // What each body feels, as bodies are paired by turns.
    const auto felt = [&](int source, int target) {
        element.set_nodes(bodies[source].free_ride(point), bodies[target], triangle, scene.numbering());
        std::vector<double> gradient(3 * scene.numbering().vertex_count(), 0.0);
        element.add_gradient({1, -0.5, -0.25, -0.25}, force, gradient.data());
        std::vector<Vec3> out(3, Vec3::Zero());
        const std::size_t each = scene.numbering().vertex_count() / 3;
        for (std::size_t v = 0; v < 3 * each; ++v) out[v / each] += Eigen::Map<Vec3>(gradient.data() + 3 * v);
        return out;
    };
    for (const auto& [source, target] : {std::pair{0, 1}, {1, 0}, {2, 0}, {2, 1}, {0, 1}}) {
        const std::vector<Vec3> by_body = felt(source, target);
        for (int b = 0; b < 3; ++b) {
            const Vec3 want = b == source ? force : b == target ? Vec3(-force) : Vec3(Vec3::Zero());
            INFO("pair " << source << ", " << target << ", body " << b);
            CHECK((by_body[std::size_t(b)] - want).norm() < 1e-15);
        }
    }
}
