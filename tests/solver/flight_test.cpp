// Bodies that fly free beside others that do not.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/sheets.h"
#include "tests/support/solver_scenes.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

TEST_CASE("what flies free beside a body that hangs falls as if it were alone, and holds nobody up") {
    auto beam = tissue(box_mesh({0.4, 0.1, 0.1}, 8, 2, 2), ElasticLaw::stvk);
    beam->fixed_vertices = vertices_where(beam->tets.vertices, [](const Vec3& p) { return p.x() < 1e-9; });
    Sheet sheet = make_sheet(evenly(0, 0.3, 6), 0.3, 6, Weave::diagonal);
    for (Vec3& p : sheet.points) p += Vec3(0, 5, 0);
    StepInputs in = still_inputs();
    in.gravity = Vec3(0, -9.81, 0);
    in.step_size = 1.0 / 24;
    constexpr int steps = 12;
    const auto run = [&](bool with_sheet) {
        SceneDescription description{{beam}, {}};
        in.bodies = {material(1e6, 0.45)};
        if (with_sheet) {
            description.bodies.push_back(cloth(sheet.points, sheet.triangles));
            in.bodies.push_back(cloth_material(500, 50, 1e-5, 0.2));
        }
        const auto scene = std::make_shared<const Scene>(description);
        Workspace w(scene);
        State s = initial_state(*scene, in);
        int iterations = 0;
        for (int i = 0; i < steps; ++i) {
            s = advance(w, s, std::span(&in, 1));
            REQUIRE(s.record.converged);
            iterations += s.record.newton_iterations;
        }
        return std::pair(s, iterations);
    };
    const auto [alone, iterations_alone] = run(false);
    const auto [beside, iterations] = run(true);
    CAPTURE(iterations_alone, iterations);
    CHECK(iterations <= iterations_alone + steps / 2);
    double apart = 0, off = 0;
    const auto hanging = static_cast<int>(beam->tets.vertices.size());
    for (int v = 0; v < hanging; ++v) apart = std::max(apart, (position(beside, v) - position(alone, v)).norm());
    CHECK(apart < 1e-6);
    // Backward Euler: g h^2 (1 + 2 + ... + n).
    const Vec3 fall(0, -9.81 * in.step_size * in.step_size * steps * (steps + 1) / 2, 0);
    for (std::size_t v = 0; v < sheet.points.size(); ++v)
        off = std::max(off, (position(beside, hanging + static_cast<int>(v)) - sheet.points[v] - fall).norm());
    CHECK(off < 1e-9);
}
