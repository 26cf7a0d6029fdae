// Contact: a strip that lies on itself, sheets that are crossed fast, forces that do not depend on how finely surfaces
// are cut, and the same bits however many threads there are and whether the state was saved between.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"
#include "solver/terms/contact/contact.h"
#include "tests/support/term_checks.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <tbb/global_control.h>

using namespace sinew::solver;
using namespace sinew::test;
using Catch::Detail::Approx;

namespace {

std::shared_ptr<TissueRest> box(const Vec3& low, const Vec3& size, int nx, int ny, int nz) {
    TetMesh mesh = box_mesh(size, nx, ny, nz);
    for (Vec3& p : mesh.vertices) p += low;
    return tissue(mesh, ElasticLaw::neo_hookean);
}

/// The same box with n x n squares on each side of its surface, however coarse its tets are.
std::shared_ptr<TissueRest> box_with_skin(const Vec3& low, double size, int tets, int n) {
    auto out = box(low, Vec3::Constant(size), tets, tets, tets);
    const SurfaceMesh skin = make_cube(size, size, size, n, n, n);
    out->surface.clear();
    for (const Vec3& p : skin.points) out->surface.push_back(p + low + Vec3::Constant(0.5 * size));
    out->triangles = skin.triangles;
    out->embedding = embed(out->tets, out->surface);
    return out;
}

ContactValues with(double stiffness) {
    ContactValues v;
    v.stiffness = stiffness;
    return v;
}

struct Bodies {
    SceneDescription description;
    StepInputs in = still_inputs();
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    State state;

    int add(const std::shared_ptr<TissueRest>& t, const TissueInputs& values, const ContactValues& contact) {
        description.bodies.emplace_back(t);
        in.bodies.emplace_back(values);
        return collide(contact);
    }
    int add(const std::shared_ptr<BoneRest>& b, const ContactValues& contact) {
        description.bodies.emplace_back(b);
        in.bodies.emplace_back(BoneInputs{b->surface});
        return collide(contact);
    }
    int collide(const ContactValues& contact) {
        const int body = static_cast<int>(description.bodies.size()) - 1;
        description.parts.push_back({&contact_type, {body}, std::make_shared<ContactRest>()});
        put_fields(contact, std::span(in.parts.emplace_back(contact_type.values.size())));
        return body;
    }
    void start(const std::vector<InitialMotion>& motions = {}) {
        scene = std::make_shared<const Scene>(description);
        workspace = std::make_unique<Workspace>(scene);
        state = initial_state(*scene, in, motions);
    }
    void step(int count = 1) {
        for (int i = 0; i < count; ++i) {
            state = advance(*workspace, state, std::span(&in, 1));
            REQUIRE(state.record.converged);
        }
    }
    double measured(const char* name) const { return value_of(state.record.measured, "contact", name); }
    Points places(int body) const { return surface_positions(*scene, state, body); }
};

} // namespace

TEST_CASE("contact: a folded strip lies on itself, and without selfCollisions passes through", "[contact]") {
    // A hairpin: two arms one above the other and closer than three edges; the lower one is held, the upper one falls.
    constexpr double thick = 0.04, stiffness = 1e7;
    const auto fold = [&](bool itself) {
        Bodies b;
        ContactValues values = with(stiffness);
        values.collides_with_itself = itself ? 1 : 0;
        TetMesh mesh = box_mesh({0.6, 3 * thick, 0.16}, 12, 3, 4);
        std::erase_if(mesh.tets, [&](const Tet& t) {
            Vec3 middle = Vec3::Zero();
            for (const int v : t) middle += 0.25 * mesh.vertices[std::size_t(v)];
            return middle.x() > 0.1 && middle.y() > thick && middle.y() < 2 * thick;
        });
        auto strip = tissue(mesh, ElasticLaw::neo_hookean);
        strip->fixed_vertices =
            vertices_where(strip->tets.vertices, [=](const Vec3& p) { return p.y() < thick + 1e-9; });
        b.add(strip, material(1e5, 0.3), values);
        b.in.gravity = Vec3(0, -9.8, 0);
        b.in.mass_damping = 4;
        b.start();
        b.step(48);
        double lowest = 1; // of the upper arm's lower side
        for (std::size_t v = 0; v < strip->surface.size(); ++v)
            if (strip->surface[v].x() > 0.3 && std::abs(strip->surface[v].y() - 2 * thick) < 1e-9)
                lowest = std::min(lowest, b.places(0)[v].y());
        return std::pair(lowest, b.measured("contacts"));
    };
    const auto [lies, contacts] = fold(true);
    CHECK(contacts > 4);
    CHECK(lies < thick);
    CHECK(lies > thick - 0.002);
    const auto [passes, none] = fold(false);
    CHECK(passes < thick - 0.02);
    CHECK(none == 0);
}

TEST_CASE("contact: a sheet that a body crosses by its own length within a step catches it", "[contact]") {
    constexpr double thin = 0.01, size = 0.1;
    for (const double lengths : {1.0, 3.0}) {
        INFO(lengths << " lengths a step");
        Bodies b;
        auto sheet = box({0, -thin, 0}, {0.6, thin, 0.6}, 8, 1, 8);
        sheet->fixed_vertices = vertices_where(sheet->tets.vertices, [](const Vec3& p) {
            return p.x() < 1e-9 || p.x() > 0.6 - 1e-9 || p.z() < 1e-9 || p.z() > 0.6 - 1e-9;
        });
        b.add(sheet, material(1e6, 0.3), with(1e8));
        b.add(box({0.25, 0.06, 0.25}, Vec3::Constant(size), 2, 2, 2), material(1e6, 0.3), with(1e8));
        b.in.step_size = 1.0 / 96;
        b.start({{}, {{0, -lengths * size * 96, 0}, Vec3::Zero()}});
        for (int i = 0; i < 24; ++i) {
            b.step();
            double middle = 0, lowest = 1;
            const Points body = b.places(1), net = b.places(0);
            for (const Vec3& p : body) middle += p.y() / static_cast<double>(body.size());
            for (const Vec3& p : net) lowest = std::min(lowest, p.y());
            CHECK(middle > lowest);
        }
    }
}

TEST_CASE("contact: the force of a given press does not depend on how finely the surfaces are cut", "[contact]") {
    // A ball of bone is pushed into a block of the same tets.
    const auto press = [](int n) {
        Bodies b;
        auto block = box_with_skin({-0.1, -0.2, -0.1}, 0.2, 4, n);
        block->fixed_vertices = vertices_where(block->tets.vertices, [](const Vec3& p) { return p.y() < -0.2 + 1e-9; });
        b.add(block, material(1e5, 0.3), with(1e6));
        const SurfaceMesh ball = make_sphere(0.15, 4 * n, 4 * n);
        Points points;
        for (const Vec3& p : ball.points) points.push_back(p + Vec3(0.007, 0.15, 0.004));
        const int pusher = b.add(bone(points, ball.triangles), with(1e6));
        b.in.integrator = Integrator::quasi_static;
        b.start();
        for (int i = 0; i < 4; ++i) {
            for (Vec3& p : std::get<BoneInputs>(b.in.bodies[std::size_t(pusher)]).positions) p.y() -= 0.01;
            b.step();
        }
        return b.measured("force_N");
    };
    const double coarse = press(16), fine = press(32);
    CAPTURE(coarse, fine);
    CHECK(fine > 10);
    CHECK(coarse == Approx(fine).epsilon(0.02));
}

TEST_CASE("contact: what piles up gives the same bits with 1, 2 and 4 threads, and saved and loaded in between",
          "[contact]") {
    const auto make = [] {
        auto b = std::make_unique<Bodies>();
        ContactValues values = with(1e6);
        values.friction = 0.3, values.damping = 10;
        for (int i = 0; i < 6; ++i)
            b->add(box(Vec3(0.11 * (i % 2) + 0.02 * i, 0.01 + 0.12 * (i / 2), 0.01 * i), Vec3::Constant(0.1), 3, 3, 3),
                   material(5e4, 0.3), values);
        const TetMesh ground = box_mesh({2, 0.1, 2}, 2, 1, 2);
        Points points = ground.vertices;
        for (Vec3& p : points) p -= Vec3(1, 0.1, 1);
        b->add(bone(points, boundary_triangles(ground.tets)), values);
        b->in.gravity = Vec3(0.3, -9.8, 0.1);
        b->start();
        return b;
    };
    const auto run = [&](std::size_t threads, bool saves) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        auto b = make();
        std::vector<double> contacts;
        for (int i = 0; i < 16; ++i) {
            if (saves && i > 8) {
                b->state = load(save(b->state));
                b->workspace = std::make_unique<Workspace>(b->scene);
            }
            b->step();
            contacts.push_back(b->measured("contacts"));
        }
        CHECK(contacts[8] > 10); // it is saved in contact
        return std::pair(save(b->state), contacts);
    };
    const auto one = run(1, false);
    CHECK((run(2, false) == one));
    CHECK((run(4, false) == one));
    CHECK((run(2, true) == one));
}

TEST_CASE("contact: twenty tumbling cubes come to rest in a box within a hundred frames, and lose energy all the way",
          "[contact]") {
    constexpr double size = 0.1, room = 0.4, gravity = 9.8, rho = 1000, thick = 0.1;
    Bodies b;
    ContactValues values = with(1e6);
    values.friction = 0.3;
    std::vector<InitialMotion> motions;
    for (int i = 0; i < 20; ++i) {
        auto cube = box({0, 0, 0}, Vec3::Constant(size), 1, 1, 1);
        const Mat3 turn = Eigen::AngleAxisd(0.7 * i, Vec3(1, 0.3 * i, -0.5).normalized()).toRotationMatrix();
        const Vec3 middle(0.12 + 0.16 * (i % 2), 0.15 + 0.16 * (i / 4), 0.12 + 0.16 * (i / 2 % 2));
        for (Points* points : {&cube->tets.vertices, &cube->surface})
            for (Vec3& p : *points) p = middle + turn * (p - Vec3::Constant(0.5 * size));
        b.add(cube, material(2e5, 0.3, rho), values);
        motions.push_back({{0.2 * (i % 3 - 1), -1, 0.15 * (i % 5 - 2)}, {3.0 * (i % 4), 2, -1.0 * i}});
    }
    const auto wall = [&](const Vec3& low, const Vec3& high) {
        TetMesh mesh = box_mesh(high - low, 1, 1, 1);
        for (Vec3& p : mesh.vertices) p += low;
        b.add(bone(mesh.vertices, boundary_triangles(mesh.tets)), values);
        motions.emplace_back();
    };
    wall({-thick, -thick, -thick}, {room + thick, 0, room + thick});
    wall({-thick, 0, -thick}, {0, 2, room + thick}), wall({room, 0, -thick}, {room + thick, 2, room + thick});
    wall({0, 0, -thick}, {room, 2, 0}), wall({0, 0, room}, {room, 2, room + thick});
    b.in.gravity = Vec3(0, -gravity, 0);
    b.in.tolerance_factor = 1;
    b.start(motions);
    // Of linear tets with lumped masses: a quarter of each tet's at each corner.
    std::vector<double> mass;
    for (int body = 0; body < 20; ++body) {
        const TissueRest& t = *b.scene->tissue(body);
        std::vector<double> own(t.tets.vertices.size(), 0.0);
        for (const Tet& tet : t.tets.tets) {
            const auto p = [&](std::size_t i) { return t.tets.vertices[std::size_t(tet[i])]; };
            const double quarter = rho * std::abs((p(1) - p(0)).cross(p(2) - p(0)).dot(p(3) - p(0))) / 24;
            for (const int v : tet) own[std::size_t(v)] += quarter;
        }
        mass.insert(mass.end(), own.begin(), own.end());
    }
    const auto energies = [&] { // of motion, and in all but what contacts store
        double kinetic = 0, potential = 0;
        for (std::size_t v = 0; v < mass.size(); ++v) {
            kinetic += 0.5 * mass[v] * Eigen::Map<const Vec3>(b.state.v.data() + 3 * v).squaredNorm();
            potential += mass[v] * gravity * b.state.x[3 * v + 1];
        }
        return std::pair(kinetic, kinetic + potential);
    };
    const double begins = energies().second;
    double before = begins;
    for (int frame = 1; frame <= 100; ++frame) {
        b.step();
        const double now = energies().second;
        CHECK(now < before + 0.02 * begins); // what bodies stored when they met comes back
        before = now;
    }
    CHECK(energies().first < 1e-4 * begins);
    CHECK(before < 0.5 * begins);
    for (int body = 0; body < 20; ++body)
        for (const Vec3& p : b.places(body)) {
            CHECK(p.y() > -0.01);
            CHECK(std::min({p.x(), p.z(), room - p.x(), room - p.z()}) > -0.01);
        }
}
