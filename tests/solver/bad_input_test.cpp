// Input that is no number, meshes that are none: refused with the body they belong to, and nothing else is touched.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "tests/support/trial.h"

#include <catch2/catch.hpp>
#include <limits>

using namespace sinew::solver;
using namespace sinew::test;

TEST_CASE(
    "values that are no numbers are refused with the body they belong to, and the state goes on as if never asked") {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    using Break = std::function<void(StepInputs&, double)>;
    const auto tissue_of = [](StepInputs& in) -> TissueInputs& { return std::get<TissueInputs>(in.bodies[1]); };
    const std::pair<Break, int> breaks[] = {
        // and the body to blame; -1: the scene
        {[&](StepInputs& in, double v) { tissue_of(in).layers[0].youngs_modulus = v; }, 1},
        {[&](StepInputs& in, double v) { tissue_of(in).layers[0].poissons_ratio = v; }, 1},
        {[&](StepInputs& in, double v) { tissue_of(in).layers[0].mass_density = v; }, 1},
        {[&](StepInputs& in, double v) { tissue_of(in).layers[0].envelope = v; }, 1},
        {[&](StepInputs& in, double v) { tissue_of(in).layers[0].volume_conservation = v; }, 1},
        {[&](StepInputs& in, double v) { tissue_of(in).compression_resistance = v; }, 1},
        {[&](StepInputs& in, double v) { tissue_of(in).fibers[0].strength = v; }, 1},
        {[&](StepInputs& in, double v) { tissue_of(in).fibers[0].excitation = v; }, 1},
        {[&](StepInputs& in, double v) { tissue_of(in).fibers[0].contraction_limit = v; }, 1},
        {[&](StepInputs& in, double v) { tissue_of(in).fibers[0].envelope = v; }, 1},
        {[&](StepInputs& in, double v) { tissue_of(in).transverse_anisotropy = v; }, 1},
        {[&](StepInputs& in, double v) { tissue_of(in).forces[3].y() = v; }, 1},
        {[&](StepInputs& in, double v) { std::get<BoneInputs>(in.bodies[2]).positions[1].z() = v; }, 2},
        {[&](StepInputs& in, double v) { in.gravity.y() = v; }, -1},
        {[&](StepInputs& in, double v) { in.step_size = v; }, -1},
        {[&](StepInputs& in, double v) { in.mass_damping = v; }, -1},
        {[&](StepInputs& in, double v) { in.stiffness_damping = v; }, -1},
        {[&](StepInputs& in, double v) { in.tolerance_factor = v; }, -1},
        {[&](StepInputs& in, double v) { in.attachments[0].stiffness = v; }, 0},
        {[&](StepInputs& in, double v) { in.attachments[0].envelope = v; }, 0},
        {[&](StepInputs& in, double v) { in.attachments[1].damping = v; }, 1},
    };
    const TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 3, 1, 1);
    for (const ElementKind kind : kinds) {
        Trial t(mesh, ElasticLaw::neo_hookean, kind, nowhere, flesh(1e4, 0.4));
        t.rest->fibers = {{Points(mesh.tets.size(), Vec3(1, 0, 0)), std::vector<double>(mesh.tets.size(), 1.0)}};
        t.values().fibers = {{1e4, 0.5, 0.3, 1}};
        t.values().forces.assign(t.nodes.size(), Vec3::Zero());
        t.description.bodies.push_back(t.rest);
        t.in.bodies.push_back(t.in.bodies[0]);
        t.add_bone(root_plate());
        t.attach_root(0, 2, 1e8);
        t.attach_root(1, 2, 1e8);
        t.use_backward_euler(1.0 / 24);
        t.in.gravity = Vec3(0, -9.8, 0);
        t.start();
        CHECK(t.step());
        const std::vector<std::byte> before = save(t.state);
        Workspace fresh(t.scene);
        const std::vector<std::byte> next = save(advance(fresh, t.state, std::span(&t.in, 1)));
        for (const auto& [spoil, body] : breaks)
            for (const double v : {nan, inf}) {
                StepInputs bad = t.in;
                spoil(bad, v);
                INFO("break " << &spoil - &breaks[0].first << ", value " << v);
                try {
                    advance(*t.workspace, t.state, std::span(&bad, 1));
                    FAIL_CHECK("no error");
                } catch (const Error& e) {
                    CHECK((e.code == "FE304" || e.code == "FE202"));
                    CHECK(e.body == body);
                    CHECK_FALSE(std::string(e.what()).empty());
                }
                CHECK(save(t.state) == before);
                CHECK(save(advance(*t.workspace, t.state, std::span(&t.in, 1))) == next);
            }
        State spoilt = t.state;
        spoilt.x[5] = nan;
        CHECK_THROWS_AS(advance(*t.workspace, spoilt, std::span(&t.in, 1)), Error);
        CHECK(save(advance(*t.workspace, t.state, std::span(&t.in, 1))) == next);
    }
}

TEST_CASE("meshes that are empty, collapsed or no numbers are refused with the body they belong to") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 2, 1, 1);
    const std::pair<std::function<void(TissueRest&)>, const char*> breaks[] = {
        {[](TissueRest& t) { t.tets.tets.clear(); }, "FE201"},
        {[](TissueRest& t) { t.tets.vertices.clear(); }, "FE203"},
        {[&](TissueRest& t) { t.tets.vertices[2].x() = nan; }, "FE202"},
        {[](TissueRest& t) { t.tets.vertices[2].x() = std::numeric_limits<double>::infinity(); }, "FE202"},
        {[](TissueRest& t) {
             for (Vec3& p : t.tets.vertices) p.z() = 0;
         },
         "FE215"},
        {[](TissueRest& t) {
             for (Vec3& p : t.tets.vertices) p = Vec3(1, 2, 3);
         },
         "FE215"},
        {[](TissueRest& t) {
             for (Vec3& p : t.tets.vertices) p.x() = -p.x();
         },
         "FE215"},
        {[&](TissueRest& t) { t.tets.coverage[1] = nan; }, "FE202"},
        {[&](TissueRest& t) { t.layer_weights[0][1] = nan; }, "FE202"},
        {[&](TissueRest& t) { t.fibers[0].weights[1] = nan; }, "FE202"},
        {[&](TissueRest& t) { t.fibers[0].directions[1].y() = nan; }, "FE202"},
    };
    for (const ElementKind kind : kinds)
        for (const auto& [spoil, code] : breaks) {
            auto good = tissue(mesh, ElasticLaw::stvk);
            good->element = kind;
            good->fibers = {{Points(mesh.tets.size(), Vec3(1, 0, 0)), std::vector<double>(mesh.tets.size(), 1.0)}};
            CHECK_NOTHROW(Scene(SceneDescription{{good, good}, {}}));
            auto bad = std::make_shared<TissueRest>(*good);
            spoil(*bad);
            try {
                Scene(SceneDescription{{good, bad}, {}});
                FAIL_CHECK("no error for " << code);
            } catch (const Error& e) {
                CHECK(e.code == code);
                CHECK(e.body == 1);
            }
        }
}
