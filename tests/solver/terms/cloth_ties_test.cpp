// Cloth with others: attachments from and to it, sliding, contact of its points with solids, fields.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/contact.h"
#include "solver/terms/hold/hold.h"
#include "tests/support/fields.h"
#include "tests/support/sheets.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <span>

using namespace sinew::solver;
using namespace sinew::test;
using Catch::Detail::Approx;

namespace {

constexpr double density = 0.3, length = 0.4, width = 0.2;

std::shared_ptr<ClothRest> strip(double z = 0, Weave weave = Weave::crossed) {
    Sheet sheet = make_sheet(evenly(0, length, 6), width, 3, weave);
    for (Vec3& p : sheet.points) p.z() += z;
    return cloth(sheet.points, sheet.triangles);
}

/// A flat bone that is larger than the strip.
std::shared_ptr<BoneRest> plate(double z) {
    return bone({{-2, -2, z}, {3, -2, z}, {3, 3, z}, {-2, 3, z}}, {{0, 1, 2}, {0, 2, 3}});
}

std::shared_ptr<BoneRest> floor_below(double top, double thickness) {
    TetMesh mesh = box_mesh({4, 4, thickness}, 1, 1, 1);
    for (Vec3& p : mesh.vertices) p += Vec3(-2, -2, top - thickness);
    const auto t = tissue(mesh, ElasticLaw::stvk);
    return bone(t->surface, t->triangles);
}

struct Run {
    SceneDescription description;
    StepInputs in = still_inputs();
    std::shared_ptr<const Scene> scene = {};
    std::unique_ptr<Workspace> workspace = {};
    State state = {};

    int add(const BodyRest& body, const BodyInputs& values) {
        description.bodies.push_back(body), in.bodies.push_back(values);
        return static_cast<int>(description.bodies.size()) - 1;
    }
    int add_strip(double z = 0) { return add(strip(z), cloth_material(500, 100, 1e-3, density)); }
    int add_bone(const std::shared_ptr<BoneRest>& b) { return add(b, BoneInputs{b->surface}); }
    void tie(int source, int target, double stiffness, AttachmentMode mode = AttachmentMode::fixed) {
        AttachmentRest rest;
        rest.source = source, rest.target = target;
        description.attachments.push_back(rest);
        AttachmentInputs values;
        values.stiffness = stiffness, values.set_mode(mode);
        in.attachments.push_back(values);
    }
    void collide(int body, double stiffness, bool is_volume) {
        auto rest = std::make_shared<ContactRest>();
        rest->is_volume = is_volume;
        description.parts.push_back({&contact_type, {body}, rest});
        ContactValues values;
        values.stiffness = stiffness;
        in.parts.emplace_back(contact_type.values.size());
        put_fields(values, std::span(in.parts.back()));
    }
    void start() {
        scene = std::make_shared<const Scene>(description);
        workspace = std::make_unique<Workspace>(scene);
        state = initial_state(*scene, in);
    }
    void step(int count, double step_size) {
        if (!workspace) start();
        in.step_size = step_size;
        for (int i = 0; i < count; ++i) {
            state = advance(*workspace, state, std::span(&in, 1));
            REQUIRE(state.record.converged);
        }
    }
    Points places(int body) const { return surface_positions(*scene, state, body); }
    Vec3 moved(int body) const {
        Vec3 sum = Vec3::Zero();
        const Points now = places(body), &then = scene->surface(body);
        for (std::size_t v = 0; v < now.size(); ++v) sum += now[v] - then[v];
        return sum / double(now.size());
    }
};

} // namespace

TEST_CASE("cloth: a strip on a bed of springs sinks by its weight over their stiffness, whichever end starts them") {
    for (const bool from_cloth : {true, false}) {
        Run r;
        const int sheet = r.add_strip(), base = r.add_bone(plate(from_cloth ? 0 : 0));
        if (from_cloth) {
            r.tie(sheet, base, 1e3);
        } else {
            // A source of the strip's own size, so that all of it is under the strip.
            const auto below = strip();
            r.description.bodies[std::size_t(base)] = bone(below->surface, below->triangles);
            r.in.bodies[std::size_t(base)] = BoneInputs{below->surface};
            r.tie(base, sheet, 1e3);
        }
        r.in.gravity = Vec3(0, 0, -9.8);
        r.step(60, 0.1);
        for (const Vec3& d : r.places(sheet))
            CHECK(-d.z() == Approx(density * 9.8 / 1e3).epsilon(from_cloth ? 1e-3 : 1e-3));
    }
}

TEST_CASE("cloth: it follows a bone that turns, at the distance that it had, from either end") {
    for (const bool from_cloth : {true, false}) {
        Run r;
        const int sheet = r.add_strip(0.05), base = r.add_bone(plate(0));
        if (!from_cloth) {
            const auto below = strip();
            r.description.bodies[std::size_t(base)] = bone(below->surface, below->triangles);
            r.in.bodies[std::size_t(base)] = BoneInputs{below->surface};
        }
        r.tie(from_cloth ? sheet : base, from_cloth ? base : sheet, 1e6);
        r.start();
        const Points modelled = std::get<BoneInputs>(r.in.bodies[std::size_t(base)]).positions;
        const auto turn = [](double share) { return Eigen::AngleAxisd(share * M_PI / 2, Vec3::UnitX()); };
        for (int i = 1; i <= 50; ++i) {
            Points& now = std::get<BoneInputs>(r.in.bodies[std::size_t(base)]).positions;
            for (std::size_t v = 0; v < now.size(); ++v) now[v] = turn(std::min(1.0, i / 30.0)) * modelled[v];
            r.step(1, 0.2);
        }
        const Points places = r.places(sheet), &rest = r.scene->surface(sheet);
        for (std::size_t v = 0; v < places.size(); ++v) CHECK((places[v] - turn(1) * rest[v]).norm() < 1e-3);
    }
}

TEST_CASE("cloth: tied to a tissue or another cloth, what acts on both changes their momentum and nothing else does") {
    for (const bool to_cloth : {true, false})
        for (const bool from_strip : {true, false}) {
            Run r;
            const int sheet = r.add_strip(0.13);
            const int other = to_cloth ? r.add(strip(0.1), cloth_material(800, 100, 1e-3, 0.5))
                                       : r.add(tissue(box_mesh({length, width, 0.1}, 4, 2, 1), ElasticLaw::stvk),
                                               material(1e4, 0.3, 100));
            r.tie(from_strip ? sheet : other, from_strip ? other : sheet, 1e4);
            r.start();
            const double load = 0.02;
            const std::size_t count = r.scene->vertex_count(sheet);
            std::get<ClothInputs>(r.in.bodies[std::size_t(sheet)])
                .forces.assign(count, Vec3(load, -load / 2, load / 3));
            const int steps = 10;
            const double h = 0.01;
            r.step(steps, h);
            // Masses by free fall's own: the weight that the scene says.
            Vec3 momentum = Vec3::Zero();
            const double mass_sheet = density * length * width,
                         mass_other = to_cloth ? 0.5 * length * width : 100 * length * width * 0.1;
            // Lumped masses: those of the strip by its triangles, of the other likewise.
            const auto add = [&](int body, double mass) {
                const std::size_t first = std::size_t(r.scene->first_vertex(body));
                std::vector<double> weight(r.scene->vertex_count(body), 0.0);
                if (const TissueRest* t = r.scene->tissue(body)) {
                    for (const Tet& tet : t->tets.tets)
                        for (const int v : tet) weight[std::size_t(v)] += 1;
                } else {
                    const std::vector<double> areas = vertex_areas(r.scene->surface(body), r.scene->triangles(body));
                    weight = areas;
                }
                double all = 0;
                for (const double w : weight) all += w;
                for (std::size_t v = 0; v < weight.size(); ++v)
                    momentum += mass * weight[v] / all * Eigen::Map<const Vec3>(r.state.v.data() + 3 * (first + v));
            };
            add(sheet, mass_sheet), add(other, mass_other);
            const Vec3 expected = double(count) * steps * h * Vec3(load, -load / 2, load / 3);
            CHECK((momentum - expected).norm() < 1e-6 * expected.norm());
            CHECK((r.moved(sheet) - r.moved(other)).norm() < 0.05);
        }
}

TEST_CASE("cloth: on a sliding attachment it goes down a slope without friction, as deep as its weight presses") {
    Run r;
    const int sheet = r.add_strip(), base = r.add_bone(plate(0));
    r.tie(sheet, base, 1e4, AttachmentMode::sliding);
    const double slope = M_PI / 6;
    r.in.gravity = 9.8 * Vec3(std::sin(slope), 0, -std::cos(slope));
    const int steps = 40;
    const double h = 0.01;
    r.step(steps, h);
    CHECK(r.moved(sheet).x() == Approx(9.8 * std::sin(slope) * h * h * steps * (steps + 1) / 2).epsilon(1e-6));
    for (const Vec3& p : r.places(sheet)) CHECK(-p.z() == Approx(density * 9.8 * std::cos(slope) / 1e4).epsilon(0.02));
}

TEST_CASE("cloth: it lies on a solid as deep as its weight over the contact's stiffness") {
    Run r;
    const int sheet = r.add_strip(0.001), base = r.add_bone(floor_below(0, 0.3));
    r.collide(sheet, 1e4, false), r.collide(base, 3e4, true);
    r.in.gravity = Vec3(0, 0, -9.8);
    r.step(100, 0.02);
    const double stiffness = 2 * 1e4 * 3e4 / 4e4;
    for (const Vec3& p : r.places(sheet)) CHECK(-p.z() == Approx(density * 9.8 / stiffness).epsilon(1e-3));
    CHECK(value_of(r.state.record.measured, "contact", "force_N") ==
          Approx(density * length * width * 9.8).epsilon(1e-3));
}

TEST_CASE("cloth: it is caught by a thin solid, however fast it comes") {
    Run r;
    const int sheet = r.add_strip(0.5), base = r.add_bone(floor_below(0, 0.01));
    r.collide(sheet, 1e7, false), r.collide(base, 1e7, true);
    r.start();
    for (std::size_t v = 0; v < r.scene->vertex_count(sheet); ++v) r.state.v[3 * v + 2] = -100;
    r.in.stiffness_damping = 0.01;
    r.step(40, 0.01);
    for (const Vec3& p : r.places(sheet)) CHECK(p.z() > -0.005);
}

TEST_CASE("cloth: a field is a force per area on it, or by mass where it acts by mass") {
    for (const FieldKind kind : {FieldKind::uniform, FieldKind::gravity}) {
        Run r;
        const int sheet = r.add_strip();
        TestField field(kind, 2);
        field.towards({0, 0, 1});
        auto rest = std::make_shared<FieldRest>(field.rest);
        r.description.parts.push_back({&field_type, {sheet}, rest});
        r.in.parts.push_back(field.numbers());
        r.step(10, 0.01);
        const double acceleration = kind == FieldKind::uniform ? 2 / density : 2;
        CHECK(r.moved(sheet).z() == Approx(acceleration * 1e-4 * 10 * 11 / 2).epsilon(1e-6));
    }
}

TEST_CASE("cloth: what is held stays exactly, and carries the weight") {
    Run r;
    const int sheet = r.add_strip();
    auto held = std::make_shared<HoldRest>();
    std::vector<double> weights;
    for (const Vec3& p : r.description.bodies.empty() ? Points() : strip()->surface) weights.push_back(p.x() < 1e-9);
    held->part = painted_vertices(strip()->triangles, weights);
    r.description.parts.push_back({&hold_type, {sheet}, held});
    HoldValues values;
    values.set_motion({});
    r.in.parts.emplace_back(hold_type.values.size());
    put_fields(values, std::span(r.in.parts.back()));
    r.in.gravity = Vec3(9.8, 0, 0);
    r.step(60, 0.05);
    const Points places = r.places(sheet), &rest = r.scene->surface(sheet);
    for (std::size_t v = 0; v < places.size(); ++v)
        if (weights[v] > 0) CHECK(places[v] == rest[v]);
    CHECK(value_of(r.state.record.measured, "hold", "force_x_N", 0) ==
          Approx(-density * length * width * 9.8).epsilon(1e-4));
}
