// Pressure and surface tension: what is measured and shown of several bodies, by hand.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/marks_of.h"
#include "solver/mesh/surface_pieces.h"
#include "solver/terms/pressure/pressure.h"
#include "solver/terms/surface_tension/surface_tension.h"
#include "tests/support/surface_forces.h"

#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

const Vec3 size(0.3, 0.1, 0.2);

/// A stiff box with its lower side held, a metre from the next one. `where`: faces that stay of its surface.
std::shared_ptr<TissueRest> box(ElementKind kind, int place, const std::function<bool(const Vec3&)>& where) {
    TetMesh mesh = box_mesh(size, 3, 1, 2);
    for (Vec3& p : mesh.vertices) p.x() += place;
    auto t = tissue(mesh, ElasticLaw::stvk);
    t->element = kind;
    Points nodes = mesh.vertices;
    if (kind == ElementKind::quadratic)
        for (const auto& [a, b] : edges_of(mesh.tets))
            nodes.push_back(0.5 *
                            (mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)]));
    t->fixed_vertices = vertices_where(nodes, [](const Vec3& p) { return p.z() < 1e-9; });
    std::erase_if(t->triangles, [&](const Triangle& tri) {
        return !std::all_of(tri.begin(), tri.end(),
                            [&](int v) { return where(t->surface[static_cast<std::size_t>(v)]); });
    });
    return t;
}
bool anywhere(const Vec3&) { return true; }
bool on_top(const Vec3& p) { return p.z() > 0.2 - 1e-9; }

struct Boxes {
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    StepInputs in = still_inputs();
    State state;
    Boxes(const SceneDescription& d, std::vector<PartValues> envelopes)
        : scene(std::make_shared<const Scene>(d))
        , workspace(std::make_unique<Workspace>(scene)) {
        in.integrator = Integrator::quasi_static;
        in.bodies.assign(d.bodies.size(), material(1e9, 0.3));
        in.parts = std::move(envelopes);
        state = initial_state(*scene, in);
        state = advance(*workspace, state, std::span(&in, 1));
        REQUIRE(state.record.converged);
    }
    double measured(const char* term, const char* name) const { return value_of(state.record.measured, term, name); }
    MarkGroup marks() {
        const Marks all = marks_of(*workspace, state, in);
        REQUIRE(all.size() == 1);
        return all[0];
    }
};

} // namespace

TEST_CASE("pieces of a surface are found, and those with a border are not closed") {
    // A tetrahedron, an open sheet of two triangles, one triangle the other way round, and a point of its own.
    const std::vector<Triangle> tet{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    std::vector<Triangle> all = tet;
    all.insert(all.end(), {{4, 5, 6}, {4, 6, 7}, {10, 9, 8}});
    const SurfacePieces p = find_pieces(12, all);
    REQUIRE(p.count() == 3);
    CHECK(p.of_point == std::vector<int>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, -1});
    CHECK(p.first_point == std::vector<int>{0, 4, 8});
    CHECK(p.is_closed == std::vector<char>{1, 0, 0});
    // Without any one of its faces, or with one turned round, it is open.
    for (std::size_t f = 0; f < 4; ++f) {
        std::vector<Triangle> open = tet, turned = tet;
        open.erase(open.begin() + static_cast<std::ptrdiff_t>(f));
        std::swap(turned[f][0], turned[f][1]);
        CHECK(find_pieces(4, open).is_closed == std::vector<char>{0});
        CHECK(find_pieces(4, turned).is_closed == std::vector<char>{0});
    }
}

TEST_CASE("pressure tells the volume of closed surfaces, and the largest net force on a body") {
    SceneDescription d;
    d.bodies = {box(ElementKind::linear, 0, anywhere), box(ElementKind::quadratic, 1, on_top),
                box(ElementKind::linear, 2, [](const Vec3& p) { return p.z() < 0.1 + 1e-9; })}; // a cup
    REQUIRE(std::get<0>(d.bodies[2])->triangles.size() == 6 + 16);
    d.parts = {on_surface(pressure_type, 0, {{300, {}}}), on_surface(pressure_type, 1, {{-200, {}}}),
               on_surface(pressure_type, 2, {{100, {}}})};
    const Boxes all(d, {{1}, {1}, {1}}), half(d, {{1}, {0.5}, {1.5}});
    CHECK(all.measured("pressure", "volume_m3") == Approx(size.prod()).epsilon(1e-5)); // of the closed one alone
    CHECK(all.measured("pressure", "net_force_N") == Approx(200 * 0.3 * 0.1).epsilon(1e-5));
    CHECK(half.measured("pressure", "net_force_N") == Approx(150 * 0.3 * 0.1).epsilon(1e-5));
}

TEST_CASE("arrows of pressure end on the surface where it presses, and begin there where it pulls") {
    for (const double pressure : {300.0, -300.0}) {
        SceneDescription d;
        d.bodies = {box(ElementKind::linear, 0, on_top)};
        d.parts = {on_surface(pressure_type, 0, {{pressure, {}}})};
        Boxes b(d, {{0.5}});
        const MarkGroup group = b.marks();
        CHECK((group.term == "pressure" && group.unit == "Pa"));
        REQUIRE(group.marks.size() == 6);
        for (const Mark& m : group.marks) {
            CHECK(m.value == Approx(0.5 * pressure).epsilon(1e-12));
            const Vec3 &on = pressure > 0 ? m.to : m.from, &off = pressure > 0 ? m.from : m.to;
            CHECK(on.z() == Approx(0.2).epsilon(1e-5));
            // As long as a triangle is wide: the root of its area.
            CHECK((off - on).norm() == Approx(std::sqrt(0.1 * 0.1 / 2)).epsilon(1e-4));
            CHECK(off.z() - on.z() == Approx(std::sqrt(0.1 * 0.1 / 2)).epsilon(1e-4));
        }
    }
}

TEST_CASE("surface tension tells the area of all bodies that have it, and shows what its envelopes leave") {
    SceneDescription d;
    d.bodies = {box(ElementKind::linear, 0, on_top), box(ElementKind::quadratic, 1, anywhere)};
    d.parts = {on_surface(surface_tension_type, 0, {{3, {}}}), on_surface(surface_tension_type, 1, {{2, {}}})};
    Boxes b(d, {{0.5}, {0.25}});
    const double box_area = 2 * (0.3 * 0.1 + 0.1 * 0.2 + 0.2 * 0.3);
    CHECK(b.measured("surfaceTension", "area_m2") == Approx(0.3 * 0.1 + box_area).epsilon(1e-5));
    const MarkGroup group = b.marks();
    REQUIRE(group.marks.size() == 6 + 44);
    for (const Mark& m : group.marks) CHECK(m.value == Approx(m.part == 0 ? 1.5 : 0.5).epsilon(1e-12));
}
