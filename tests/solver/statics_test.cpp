// Equilibrium against values that this code did not compute: patch test, the gravity cantilever on the same meshes,
// a block on a spring bed, fibres, momentum balance.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/mesh_files.h"
#include "solver/terms/attachment/anchors.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

struct Simulation {
    std::shared_ptr<const Scene> scene;
    Workspace workspace;
    explicit Simulation(SceneDescription d)
        : scene(std::make_shared<const Scene>(std::move(d)))
        , workspace(scene) {}
};

SceneDescription one_body(std::shared_ptr<const TissueRest> t) {
    SceneDescription d;
    d.bodies = {std::move(t)};
    return d;
}

StepInputs quasi_static(TissueInputs tissue) {
    StepInputs in = still_inputs();
    in.integrator = Integrator::quasi_static;
    in.bodies = {std::move(tissue)};
    return in;
}

} // namespace

TEST_CASE("patch test: with an affine border every inner vertex follows to 1e-10") {
    TetMesh mesh = box_mesh({1, 0.8, 0.6}, 4, 4, 4);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> shift(-0.03, 0.03);
    const auto on_border = [](const Vec3& p) {
        return p.x() < 1e-9 || p.x() > 1 - 1e-9 || p.y() < 1e-9 || p.y() > 0.8 - 1e-9 || p.z() < 1e-9 ||
               p.z() > 0.6 - 1e-9;
    };
    for (Vec3& p : mesh.vertices)
        if (!on_border(p)) p += Vec3(shift(random), shift(random), shift(random)); // an irregular inside
    Mat3 f;
    f << 1.2, 0.1, 0, -0.05, 0.9, 0.2, 0.1, 0, 1.1;
    for (const ElasticLaw law : {ElasticLaw::stvk, ElasticLaw::neo_hookean, ElasticLaw::corotational}) {
        auto t = tissue(mesh, law);
        t->fixed_vertices = vertices_where(mesh.vertices, on_border);
        Simulation sim(one_body(t));
        const StepInputs in = quasi_static(material(1000, 0.3));
        State s = initial_state(*sim.scene, in);
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
            set_position(s, static_cast<int>(v),
                         f * mesh.vertices[v] + (on_border(mesh.vertices[v])
                                                     ? Vec3(0, 0, 0)
                                                     : Vec3(shift(random), shift(random), shift(random))));
        s = settle(sim.workspace, s, in);
        double worst = 0;
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
            worst = std::max(worst, (position(s, static_cast<int>(v)) - f * mesh.vertices[v]).norm());
        CHECK(worst < 1e-10);
    }
}

TEST_CASE("the gravity cantilever equals the reference on the same mesh, vertex by vertex") {
    const std::pair<ElasticLaw, const char*> laws[] = {
        {ElasticLaw::stvk, "stvk"}, {ElasticLaw::neo_hookean, "snh"}, {ElasticLaw::corotational, "corot"}};
    const nlohmann::json p1 = accuracy()["cantilever_gravity"]["p1_same_mesh"];
    for (const auto& [file, stem] :
         {std::pair{"bar08_16x2x2.mesh", "bar08_16x2x2"}, {"bar08_32x4x4.vtk", "bar08_32x4x4"}}) {
        const TetMesh mesh = read_tets(data_file(file));
        for (const auto& [law, name] : laws) {
            INFO(stem << ", " << name);
            auto t = tissue(mesh, law);
            t->fixed_vertices = vertices_where(mesh.vertices, [](const Vec3& p) { return p.x() < 1e-9; });
            Simulation sim(one_body(t));
            StepInputs in = quasi_static(material(1e6, 0.4));
            State s = initial_state(*sim.scene, in);
            for (const double load : {0.25, 0.5, 0.75, 1.0}) { // the way to the solution is ours; the solution is not
                in.gravity = Vec3(0, 0, -9.81 * load);
                s = settle(sim.workspace, s, in);
            }
            const Points expected =
                read_positions(data_file(std::string(stem) + ".cant_grav." + name + ".expected_positions.txt"));
            REQUIRE(expected.size() == mesh.vertices.size());
            double worst = 0;
            for (std::size_t v = 0; v < expected.size(); ++v)
                worst = std::max(worst, (position(s, static_cast<int>(v)) - expected[v]).norm());
            CHECK(worst < 1e-5 * 0.8);
            const int tip = vertices_where(mesh.vertices, [](const Vec3& p) {
                                return (p - Vec3(0.8, 0.05, 0.05)).norm() < 1e-9;
                            }).at(0);
            const double uz = position(s, tip).z() - 0.05;
            CHECK(uz == Approx(double(p1[name][stem][2])).epsilon(1e-4));
        }
    }
}

TEST_CASE("a block that hangs from a spring bed extends it by rho g V / (k A) exactly") {
    const TetMesh mesh = box_mesh({0.2, 0.1, 0.3}, 3, 2, 4);
    const double k = 4e5, density = 1100, g = 9.81;
    for (const ElasticLaw law : {ElasticLaw::stvk, ElasticLaw::neo_hookean, ElasticLaw::corotational}) {
        auto t = tissue(mesh, law);
        const Points plate = {{-1, -1, 0.3}, {2, -1, 0.3}, {2, 2, 0.3}, {-1, 2, 0.3}};
        SceneDescription d = one_body(t);
        d.bodies.push_back(bone(plate, {{0, 1, 2}, {0, 2, 3}}));
        AttachmentRest a;
        a.source = 0, a.target = 1;
        // Areas of the top face alone: the mesh's border triangles there, a third to each corner.
        std::vector<Triangle> top;
        for (const Triangle& tri : t->triangles)
            if (std::all_of(tri.begin(), tri.end(),
                            [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)].z() > 0.3 - 1e-9; }))
                top.push_back(tri);
        t->triangles = top;
        a.source_weights.assign(mesh.vertices.size(), 0);
        for (const int v : vertices_where(mesh.vertices, [](const Vec3& p) { return p.z() > 0.3 - 1e-9; }))
            a.source_weights[static_cast<std::size_t>(v)] = 1;
        d.attachments = {a};
        Simulation sim(d);
        StepInputs in = quasi_static(material(2e5, 0.4, density));
        in.bodies.push_back(BoneInputs{plate});
        in.attachments = {{k, 1, 0}};
        in.gravity = Vec3(0, 0, -g);
        State s = settle(sim.workspace, initial_state(*sim.scene, in), in);
        const std::vector<double> areas = vertex_areas(mesh.vertices, top);
        double weighted = 0, area = 0;
        for (std::size_t v = 0; v < areas.size(); ++v) {
            weighted += areas[v] * (mesh.vertices[v].z() - position(s, static_cast<int>(v)).z());
            area += areas[v];
        }
        CHECK(area == Approx(0.02));
        CHECK(weighted / area == Approx(density * g * 0.006 / (k * 0.02)).epsilon(1e-6));
    }
}

TEST_CASE("a free bar under fibre stress shortens to the trusted lengths, whatever the mesh") {
    const nlohmann::json results = accuracy()["muscle"]["results"]["stvk"]["spring"];
    const TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 4, 2, 2);
    for (const auto& [title, expected] : results.items()) {
        double k = 0, limit = 0;
        REQUIRE(std::sscanf(title.c_str(), "excitation*strength=%lf,contractionLimit=%lf", &k, &limit) == 2);
        auto t = tissue(mesh, ElasticLaw::stvk);
        t->fibers = {{Points(mesh.tets.size(), Vec3(1, 0, 0)), std::vector<double>(mesh.tets.size(), 1.0)}};
        // Held against rigid motion only: one vertex, and one more that may only slide by symmetry.
        t->fixed_vertices = {0};
        Simulation sim(one_body(t));
        TissueInputs values = material(12000, 0.45);
        values.fibers = {{k / 0.5, limit, 0.5, 1}};
        StepInputs in = still_inputs();
        in.bodies = {values};
        in.step_size = 1; // long steps of backward Euler: damped to rest
        State s = initial_state(*sim.scene, in);
        for (int i = 0; i < 40; ++i) s = settle(sim.workspace, s, in);
        const int far = vertices_where(mesh.vertices, [](const Vec3& p) {
                            return p.x() > 0.3 - 1e-9 && p.y() < 1e-9 && p.z() < 1e-9;
                        }).at(0);
        const int side = vertices_where(mesh.vertices, [](const Vec3& p) {
                             return p.x() < 1e-9 && p.y() > 0.1 - 1e-9 && p.z() < 1e-9;
                         }).at(0);
        INFO(title);
        CHECK((position(s, far) - position(s, 0)).norm() / 0.3 ==
              Approx(double(expected["lambda_fibre"])).epsilon(1e-6));
        CHECK((position(s, side) - position(s, 0)).norm() / 0.1 ==
              Approx(double(expected["lambda_perp"])).epsilon(1e-6));
    }
}

TEST_CASE("isometric fibre force is area x strength x excitation x (1 - contraction limit)") {
    const TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 3, 2, 2);
    auto t = tissue(mesh, ElasticLaw::corotational);
    t->fibers = {{Points(mesh.tets.size(), Vec3(1, 0, 0)), std::vector<double>(mesh.tets.size(), 1.0)}};
    SceneDescription d = one_body(t);
    const Points plate = {{0.3, -1, -1}, {0.3, 2, -1}, {0.3, 2, 2}, {0.3, -1, 2}};
    d.bodies.push_back(bone(plate, {{0, 1, 2}, {0, 2, 3}}));
    // Every vertex of the far half is glued to a bone by very stiff springs; the near face is held. The bar then keeps
    // its length, and the springs' stretch x stiffness is the end force.
    t->fixed_vertices = vertices_where(mesh.vertices, [](const Vec3& p) { return p.x() < 0.3 - 1e-9; });
    AttachmentRest a;
    a.source = 0, a.target = 1;
    a.source_weights.assign(mesh.vertices.size(), 0);
    for (const int v : vertices_where(mesh.vertices, [](const Vec3& p) { return p.x() > 0.3 - 1e-9; }))
        a.source_weights[static_cast<std::size_t>(v)] = 1;
    d.attachments = {a};
    std::vector<Triangle> end;
    for (const Triangle& tri : t->triangles)
        if (std::all_of(tri.begin(), tri.end(),
                        [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)].x() > 0.3 - 1e-9; }))
            end.push_back(tri);
    t->triangles = end;
    Simulation sim(d);
    TissueInputs values = material(12000, 0);
    values.fibers = {{40000, 0.6, 0.5, 1}};
    StepInputs in = quasi_static(values);
    in.bodies.push_back(BoneInputs{plate});
    const double k = 1e12;
    in.attachments = {{k, 1, 0}};
    in.tolerance_factor = 1e-3; // springs this stiff turn rounding into forces
    const State s = settle(sim.workspace, initial_state(*sim.scene, in), in);
    const std::vector<double> areas = vertex_areas(mesh.vertices, end);
    double force = 0;
    for (std::size_t v = 0; v < areas.size(); ++v)
        force += k * areas[v] * (mesh.vertices[v].x() - position(s, static_cast<int>(v)).x());
    CHECK(force == Approx(0.01 * 40000 * 0.5 * (1 - 0.6)).epsilon(1e-4));
}

TEST_CASE("attachment forces between two free tissues keep momentum and angular momentum") {
    const TetMesh mesh = box_mesh({0.1, 0.1, 0.1}, 2, 2, 2);
    TetMesh other = box_mesh({0.13, 0.1, 0.1}, 2, 1, 2);
    for (Vec3& p : other.vertices) p += Vec3(0.12, 0.02, 0.01); // a gap of 2 cm
    SceneDescription d;
    d.bodies = {tissue(mesh, ElasticLaw::neo_hookean), tissue(other, ElasticLaw::stvk)};
    for (const bool offset : {true, false}) {
        AttachmentRest a;
        a.source = 0, a.target = 1, a.maintain_offset = offset;
        a.source_weights.assign(mesh.vertices.size(), 0);
        for (const int v : vertices_where(mesh.vertices, [](const Vec3& p) { return p.x() > 0.1 - 1e-9; }))
            a.source_weights[static_cast<std::size_t>(v)] = 1;
        d.attachments = {a};
        Simulation sim(d);
        StepInputs in = still_inputs();
        in.bodies = {material(5e3, 0.3, 1000), material(8e3, 0.4, 700)};
        in.attachments = {{1e5, 1, 200}};
        in.step_size = 0.01;
        State s = initial_state(*sim.scene, in);
        std::mt19937 random(4);
        std::normal_distribution<double> normal;
        for (double& v : s.v) v = 0.3 * normal(random);
        const std::vector<double> before_x = s.x, before_v = s.v;
        // Lumped masses of both meshes, vertex by vertex.
        std::vector<double> mass(s.x.size() / 3, 0.0);
        const auto add_mass = [&](const TetMesh& m, int first, double density) {
            for (const Tet& tet : m.tets) {
                const double w = tet_volume(m.vertices[static_cast<std::size_t>(tet[0])],
                                            m.vertices[static_cast<std::size_t>(tet[1])],
                                            m.vertices[static_cast<std::size_t>(tet[2])],
                                            m.vertices[static_cast<std::size_t>(tet[3])]) *
                                 density / 4;
                for (const int v : tet) mass[static_cast<std::size_t>(first + v)] += w;
            }
        };
        add_mass(mesh, sim.scene->first_vertex(0), 1000);
        add_mass(other, sim.scene->first_vertex(1), 700);
        const auto momentum = [&](const State& state) {
            Vec3 p = Vec3::Zero();
            for (std::size_t v = 0; v < mass.size(); ++v)
                p += mass[v] * Vec3(state.v[3 * v], state.v[3 * v + 1], state.v[3 * v + 2]);
            return p;
        };
        const Vec3 start = momentum(s);
        for (int i = 0; i < 10; ++i) s = settle(sim.workspace, s, in);
        CHECK((momentum(s) - start).norm() < 1e-9 * start.norm() + 1e-9);
    }
}

TEST_CASE("a body at rest without forces stays at rest in one look") {
    auto t = tissue(box_mesh({1, 1, 1}, 3, 3, 3), ElasticLaw::stvk);
    Simulation sim(one_body(t));
    StepInputs in = still_inputs();
    in.tolerance_factor = 1;
    in.bodies = {material(1e4, 0.45)};
    State s = initial_state(*sim.scene, in);
    const State after = advance(sim.workspace, s, std::span(&in, 1));
    CHECK(after.record.converged);
    CHECK(after.record.newton_iterations == 0);
    CHECK(after.x == s.x);
    CHECK(after.record.min_j == Approx(1));
}

TEST_CASE("scrambled and mirrored free bodies come back to their rest shape") {
    const TetMesh mesh = box_mesh({1, 1, 1}, 2, 2, 2);
    for (const ElasticLaw law : {ElasticLaw::stvk, ElasticLaw::neo_hookean, ElasticLaw::corotational})
        for (const bool mirrored : {false, true}) {
            Simulation sim(one_body(tissue(mesh, law)));
            TissueInputs values = material(1e4, 0.4);
            values.compression_resistance = 20000;
            StepInputs in = still_inputs();
            in.tolerance_factor = 1;
            in.max_newton_iterations = 100;
            in.step_size = 10;
            in.bodies = {values};
            State s = initial_state(*sim.scene, in);
            std::mt19937 random(9);
            std::uniform_real_distribution<double> jitter(-0.4, 0.4); // cells are 0.5 wide: a third of the tets invert
            for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
                set_position(s, static_cast<int>(v),
                             mirrored ? Vec3(-mesh.vertices[v].x(), mesh.vertices[v].y(), mesh.vertices[v].z())
                                      : mesh.vertices[v] + Vec3(jitter(random), jitter(random), jitter(random)));
            for (int i = 0; i < 40; ++i) s = advance(sim.workspace, s, std::span(&in, 1));
            double worst = 0;
            for (std::size_t a = 0; a < mesh.vertices.size(); ++a)
                for (std::size_t b = 0; b < a; ++b)
                    worst = std::max(
                        worst, std::abs((position(s, static_cast<int>(a)) - position(s, static_cast<int>(b))).norm() -
                                        (mesh.vertices[a] - mesh.vertices[b]).norm()));
            INFO("law " << static_cast<int>(law) << " mirrored " << mirrored << " energy " << s.record.energy);
            CHECK(s.record.converged);
            CHECK(worst < 1e-5);
            CHECK(s.record.min_j > 0.999);
        }
}

TEST_CASE("quadratic tets glued to a bone are as stiff as clamped ones") {
    const TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 3, 1, 1);
    const auto at_end = [](const Vec3& p) { return p.x() < 1e-9; };
    const auto sag = [&](bool glued) {
        auto t = tissue(mesh, ElasticLaw::neo_hookean);
        t->element = ElementKind::quadratic;
        SceneDescription d;
        d.bodies = {t};
        StepInputs in = still_inputs();
        in.integrator = Integrator::quasi_static;
        in.gravity = Vec3(0, 0, -9.8);
        in.max_newton_iterations = 40;
        in.tolerance_factor = 1;
        in.bodies = {material(1e5, 0.4)};
        double area = 0;
        if (glued) {
            const Points wall{{0, -1, -1}, {0, 2, -1}, {0, 2, 2}, {0, -1, 2}};
            d.bodies.push_back(bone(wall, {{0, 2, 1}, {0, 3, 2}}));
            in.bodies.push_back(BoneInputs{wall});
            AttachmentRest a;
            a.source = 0, a.target = 1;
            a.source_weights.assign(t->surface.size(), 0.0);
            for (const int v : vertices_where(t->surface, at_end)) a.source_weights[static_cast<std::size_t>(v)] = 1;
            d.attachments = {a};
            in.attachments = {{1e10, 1, 0}};
        } else {
            Points nodes = mesh.vertices;
            for (const auto& [a, b] : edges_of(mesh.tets))
                nodes.push_back(
                    0.5 * (mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)]));
            t->fixed_vertices = vertices_where(nodes, at_end);
        }
        const auto scene = std::make_shared<const Scene>(d);
        State s = initial_state(*scene, in);
        const AttachmentView kept = attachments_kept(s.memories);
        for (const auto& list : kept.anchors)
            for (const Anchor& a : list) area += a.area_weight;
        if (glued) CHECK(area == Approx(0.01)); // the end's own: paint does not run around the edges
        Workspace w(scene);
        s = settle(w, s, in);
        return position(s, static_cast<int>(mesh.vertices.size()) - 1).z() - 0.1;
    };
    const double clamped = sag(false);
    CHECK(clamped < -0.02);
    CHECK(sag(true) == Approx(clamped).epsilon(2e-3));
}
