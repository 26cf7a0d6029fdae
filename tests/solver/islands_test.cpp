// Bodies that nothing ties together: what is in balance is left alone while the others go on.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/islands.h"

#include "solver/index.h"
#include "solver/newton/potential.h"
#include "solver/system.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

/// Three boxes side by side, the second and the third tied to each other by springs.
SceneDescription three_boxes(ElementKind kind) {
    SceneDescription description;
    for (int i = 0; i < 3; ++i) {
        TetMesh mesh = box_mesh({0.1, 0.1, 0.3}, 2, 2, 4 + i);
        for (Vec3& p : mesh.vertices) p.x() += 0.1 * i;
        auto rest = tissue(mesh, ElasticLaw::neo_hookean);
        rest->element = kind;
        rest->fixed_vertices = vertices_where(mesh.vertices, [](const Vec3& p) { return p.z() < 1e-9; });
        description.bodies.push_back(rest);
    }
    AttachmentRest tie;
    tie.source = 1, tie.target = 2;
    const auto& surface = std::get<std::shared_ptr<const TissueRest>>(description.bodies[1])->surface;
    for (const Vec3& p : surface) tie.source_weights.push_back(p.x() > 0.2 - 1e-9 ? 1 : 0);
    description.attachments.push_back(tie);
    return description;
}

StepInputs values_of(const SceneDescription& description) {
    StepInputs in;
    in.integrator = Integrator::quasi_static;
    for (std::size_t i = 0; i < description.bodies.size(); ++i)
        in.bodies.push_back(material(1e5 * static_cast<double>(1 + i), 0.3));
    in.attachments.push_back({1e6, 1, 0});
    return in;
}

/// x with the deformables that have a flag moved, each vertex elsewhere.
std::vector<double> moved(const Scene& scene, std::vector<double> x, const std::vector<char>& flags) {
    for (std::size_t d = 0; d < flags.size(); ++d) {
        const Deformable& body = scene.numbering().deformables[d];
        for (std::size_t k = 3 * body.first_vertex; k < 3 * (body.first_vertex + body.vertex_count); ++k)
            if (flags[d]) x[k] += 2e-3 * std::sin(static_cast<double>(7 * k));
    }
    return x;
}

} // namespace

TEST_CASE("islands are what springs tie together, and rest as a whole") {
    const Scene scene(three_boxes(ElementKind::linear));
    const StepInputs in = values_of(three_boxes(ElementKind::linear));
    const State state = initial_state(scene, in);
    Potential potential(scene);
    potential.take(state, in);
    Islands islands(scene.numbering(), potential.pattern());
    CHECK(islands.count() == 2);
    std::vector<char> flags{1, 1, 0};
    CHECK(islands.keep_whole(flags));
    CHECK(flags == std::vector<char>{1, 0, 0});
    flags = {0, 1, 1};
    CHECK(islands.keep_whole(flags));
    CHECK(flags == std::vector<char>{0, 1, 1});
    flags = {0, 0, 1};
    CHECK_FALSE(islands.keep_whole(flags));
}

TEST_CASE("what rests keeps its energy and its forces, and the others do not see that it does") {
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic})
        for (const double conservation : {0.0, 5e6})
            for (const std::vector<char>& resting : {std::vector<char>{1, 0, 0}, std::vector<char>{0, 1, 1}}) {
                const SceneDescription description = three_boxes(kind);
                const Scene scene(description);
                StepInputs in = values_of(description);
                in.stiffness_damping = 0.01;
                for (auto& body : in.bodies)
                    std::get<TissueInputs>(body).layers.front().volume_conservation = conservation;
                const State state = initial_state(scene, in);
                Potential potential(scene), awake(scene);
                ImplicitForm form;
                quasi_static_form(state, form);
                for (Potential* p : {&potential, &awake}) {
                    p->take(state, in);
                    p->begin_step(state, in);
                    p->begin_stage(state, form, state.bones);
                }
                const std::vector<double> here = moved(scene, state.x, {1, 1, 1});
                std::vector<char> others;
                for (const char r : resting) others.push_back(!r);
                const std::vector<double> there = moved(scene, here, others);

                std::vector<double> gradient, expected;
                std::vector<BodyForces> forces, expected_forces;
                potential.evaluate(here, &gradient, &forces);
                potential.rest(resting);
                BlockMatrix a(potential.pattern()), whole(awake.pattern());
                potential.assemble(here, false, a); // as Newton's method does before it looks elsewhere
                const double energy = potential.evaluate(there, &gradient, &forces);
                CHECK(energy == awake.evaluate(there, &expected, &expected_forces));
                potential.assemble(there, false, a);
                awake.assemble(there, false, whole);
                for (std::size_t d = 0; d < resting.size(); ++d) {
                    CHECK(forces[d].sum == expected_forces[d].sum);
                    CHECK(forces[d].at_work == expected_forces[d].at_work);
                    const Deformable& body = scene.numbering().deformables[d];
                    for (std::size_t u = body.first_unknown; u < body.first_unknown + body.unknown_count; ++u) {
                        for (std::size_t c = 0; c < 3; ++c)
                            REQUIRE(gradient[3 * u + c] == (resting[d] ? 0 : expected[3 * u + c]));
                        const auto first = at(a.pattern->row_start[u]), end = at(a.pattern->row_start[u + 1]);
                        for (std::size_t e = first; e < end; ++e)
                            for (int k = 0; k < 9; ++k)
                                REQUIRE(a.block(e)[k] == (!resting[d]                ? whole.block(e)[k]
                                                          : e == first && k % 4 == 0 ? 1.0
                                                                                     : 0.0));
                    }
                }
                potential.rest({});
                CHECK(potential.evaluate(there, &gradient, &forces) == energy);
                CHECK(gradient == expected);
            }
}

TEST_CASE("a body in balance keeps its bits while another one still moves") {
    // Both boxes hang to rest; then the first is made softer.
    const SceneDescription description = three_boxes(ElementKind::linear);
    const auto scene = std::make_shared<const Scene>(description);
    StepInputs in = values_of(description);
    in.max_newton_iterations = 60;
    Workspace workspace(scene);
    const State first = advance(workspace, initial_state(*scene, in), std::span(&in, 1));
    REQUIRE(first.record.converged);
    std::get<TissueInputs>(in.bodies[0]) = material(5e4, 0.3);
    const State second = advance(workspace, first, std::span(&in, 1));
    REQUIRE(second.record.converged);
    CHECK(second.record.newton_iterations >= 3);
    CHECK(second.record.residual <= 1e-6);
    for (std::size_t d = 0; d < 3; ++d) {
        const Deformable& body = scene->numbering().deformables[d];
        const std::size_t begin = 3 * body.first_vertex, end = begin + 3 * body.vertex_count;
        double change = 0;
        for (std::size_t k = begin; k < end; ++k) change = std::max(change, std::abs(second.x[k] - first.x[k]));
        if (d == 0)
            CHECK(change > 1e-2);
        else
            CHECK(change == 0);
    }
}
