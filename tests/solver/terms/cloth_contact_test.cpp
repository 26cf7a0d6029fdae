// Contact of cloth that has a thickness: layers in closed form, points and edges that would pass, folds, momentum.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/implicit_form.h"
#include "solver/linear/truncated_newton.h"
#include "solver/mesh/crossings.h"
#include "solver/mesh/segment_math.h"
#include "solver/newton/potential.h"
#include "solver/terms/contact/contact.h"
#include "solver/terms/contact/crossed.h"
#include "solver/terms/hold/hold.h"
#include "tests/support/sheets.h"

#include <catch2/catch.hpp>
#include <random>
#include <span>

using namespace sinew::solver;
using namespace sinew::test;
using Catch::Detail::Approx;

namespace {

constexpr double density = 0.3, thickness = 0.004;

std::shared_ptr<BoneRest> box_bone(const Vec3& low, const Vec3& high) {
    TetMesh mesh = box_mesh(high - low, 1, 1, 1);
    for (Vec3& p : mesh.vertices) p += low;
    const auto t = tissue(mesh, ElasticLaw::stvk);
    return bone(t->surface, t->triangles);
}

struct Run {
    SceneDescription description = {};
    StepInputs in = still_inputs();
    std::shared_ptr<const Scene> scene = {};
    std::unique_ptr<Workspace> workspace = {};
    State state = {};

    int add(const BodyRest& body, const BodyInputs& values, double stiffness, double thick, bool itself = false) {
        description.bodies.push_back(body), in.bodies.push_back(values);
        const int number = static_cast<int>(description.bodies.size()) - 1;
        auto rest = std::make_shared<ContactRest>();
        rest->thickness = thick, rest->is_volume = thick == 0;
        description.parts.push_back({&contact_type, {number}, rest});
        ContactValues v;
        v.stiffness = stiffness, v.collides_with_itself = itself ? 1 : 0;
        put_fields(v, std::span(in.parts.emplace_back(contact_type.values.size())));
        return number;
    }
    int add_cloth(const Sheet& s, double stiffness, bool itself = false) {
        return add(cloth(s.points, s.triangles), cloth_material(500, 100, 1e-4, density), stiffness, thickness, itself);
    }
    int add_bone(const std::shared_ptr<BoneRest>& b, double stiffness) {
        return add(b, BoneInputs{b->surface}, stiffness, 0);
    }
    void hold(int body, const std::vector<int>& vertices) {
        const auto& sheet = *std::get<std::shared_ptr<const ClothRest>>(description.bodies[std::size_t(body)]);
        std::vector<double> weights(sheet.surface.size(), 0.0);
        for (const int v : vertices) weights[std::size_t(v)] = 1;
        auto rest = std::make_shared<HoldRest>();
        rest->part = painted_vertices(sheet.triangles, weights);
        description.parts.push_back({&hold_type, {body}, rest});
        put_fields(HoldValues{}, std::span(in.parts.emplace_back(hold_type.values.size())));
    }
    void step(int count, double step_size) {
        if (!workspace) {
            scene = std::make_shared<const Scene>(description);
            workspace = std::make_unique<Workspace>(scene);
            state = initial_state(*scene, in);
        }
        in.step_size = step_size;
        in.max_newton_iterations = 60, in.max_halvings = 4;
        for (int i = 0; i < count; ++i) {
            state = advance(*workspace, state, std::span(&in, 1));
            INFO("step " << i << " residual " << state.record.residual << " newton " << state.record.newton_iterations
                         << " contacts " << value_of(state.record.measured, "contact", "contacts"));
            REQUIRE(state.record.converged);
        }
    }
    Points places(int body) const { return surface_positions(*scene, state, body); }
    std::size_t crossings_of(int one, int other) const {
        const auto& a = scene->triangles(one);
        const auto& b = scene->triangles(other);
        if (one == other) return own_crossings(places(one), a).size();
        return crossings(places(one), a, places(other), b).size() + crossings(places(other), b, places(one), a).size();
    }
};

/// Of the energy on the way of a solve that moves a body from where it is by `from` to `to`, in steps: by how much more
/// or less it changes in a step than the slope at its middle says, and the most that it is [J].
struct Way {
    double off = 0, most = 0;
};
Way energy_on_way(Run& r, int body, const Vec3& from, const Vec3& to, int steps) {
    r.in.step_size = 1e3; // no inertia to speak of
    r.scene = std::make_shared<const Scene>(r.description);
    r.state = initial_state(*r.scene, r.in);
    std::size_t first = 0;
    for (int b = 0; b < body; ++b) first += r.scene->deforms(b) ? r.scene->vertex_count(b) : 0;
    const std::size_t count = r.scene->vertex_count(body);
    const auto at = [&](double share) {
        std::vector<double> x = r.state.x;
        const Vec3 way = from + share * (to - from);
        for (std::size_t v = first; v < first + count; ++v)
            for (std::size_t c = 0; c < 3; ++c) x[3 * v + c] += way[Eigen::Index(c)];
        return x;
    };
    // So that the whole way is looked over.
    for (std::size_t v = first; v < first + count; ++v)
        for (std::size_t c = 0; c < 3; ++c) r.state.v[3 * v + c] = to[Eigen::Index(c)] / r.in.step_size;
    Potential potential(*r.scene);
    potential.take(r.state, r.in);
    ImplicitForm form;
    backward_euler_form(r.state, r.in.step_size, form);
    potential.begin_step(r.state, r.in);
    potential.begin_stage(r.state, form, r.state.bones);
    Way out;
    std::vector<double> gradient;
    std::vector<BodyForces> forces;
    double last = potential.evaluate(at(0), nullptr, nullptr);
    for (int i = 1; i <= steps; ++i) {
        potential.begin_iteration(at((i - 1.0) / steps));
        potential.evaluate(at((i - 0.5) / steps), &gradient, &forces);
        const double here = potential.evaluate(at(double(i) / steps), nullptr, nullptr);
        double slope = 0;
        const Vec3 way = (to - from) / steps;
        for (std::size_t v = first; v < first + count; ++v)
            for (std::size_t c = 0; c < 3; ++c)
                slope += gradient[3 * std::size_t(r.scene->numbering().unknown[v]) + c] * way[Eigen::Index(c)];
        out.off = std::max(out.off, std::abs(here - last - slope));
        out.most = std::max(out.most, here);
        last = here;
    }
    return out;
}

Sheet raised(Sheet s, double z) {
    for (Vec3& p : s.points) p.z() += z;
    return s;
}

} // namespace

TEST_CASE("contact of cloth: it lies half its thickness above a solid and all of it above cloth, less what presses",
          "[contact]") {
    constexpr double weight = 9.8 * density; // per area
    const Sheet flat = make_sheet(evenly(0, 0.4, 8), 0.2, 4, Weave::crossed);
    {
        Run r;
        const int sheet = r.add_cloth(raised(flat, 0.0015), 2e4);
        r.add_bone(box_bone({-1, -1, -0.2}, {2, 2, 0}), 6e4);
        r.in.gravity = Vec3(0, 0, -9.8);
        r.step(100, 0.02);
        const double height = thickness / 2 - weight / 3e4; // the series stiffness
        for (const Vec3& p : r.places(sheet)) CHECK(p.z() == Approx(height).epsilon(1e-3));
        CHECK(value_of(r.state.record.measured, "contact", "force_N") == Approx(weight * 0.08).epsilon(1e-3));
    }
    Run r;
    Sheet small = make_sheet(evenly(0.063, 0.3, 5), 0.1, 3, Weave::bricks);
    for (Vec3& p : small.points) p += Vec3(0, 0.037, 0.0045);
    const int lower = r.add_cloth(flat, 2e4), upper = r.add_cloth(small, 2e4);
    std::vector<int> all(flat.points.size());
    for (std::size_t v = 0; v < all.size(); ++v) all[v] = static_cast<int>(v);
    r.hold(lower, all);
    r.in.gravity = Vec3(0, 0, -9.8);
    r.step(100, 0.02);
    double mean = 0;
    for (const Vec3& p : r.places(upper)) mean += p.z() / static_cast<double>(small.points.size());
    // Each sheet's points count for a part of the area, which on meshes that differ is shared out unevenly.
    CHECK(mean == Approx(thickness - weight / 2e4).epsilon(0.01));
    CHECK(value_of(r.state.record.measured, "contact", "force_N") == Approx(weight * 0.237 * 0.1).epsilon(1e-3));
}

TEST_CASE("contact of cloth: the edges of large faces press no harder than the cloth's own", "[contact]") {
    Run r;
    Sheet sheet = make_sheet(evenly(0, 0.4, 8), 0.2, 4, Weave::crossed);
    for (Vec3& p : sheet.points) p += Vec3(0.31, 0.41, 0.0015); // over both diagonals of the ground
    const int lying = r.add_cloth(sheet, 2e4);
    r.add_bone(box_bone({-1, -1, -0.2}, {2, 2, 0}), 6e4);
    constexpr double weight = 216; // per area, presses to less than a quarter of the thickness, where edges act
    r.in.gravity = Vec3(0, 0, -weight / density);
    r.step(100, 0.02);
    // 3e4 (d + 30 (d - 0.001)) is that weight at d = 0.0012.
    for (const Vec3& p : r.places(lying)) CHECK(p.z() == Approx(thickness / 2 - 0.0012).epsilon(0.03));
}

TEST_CASE("contact of cloth: a spike between its vertices lifts it", "[contact]") {
    // A solid's point meets the middle of a face, from either side of the sheet.
    for (const double side : {1.0, -1.0}) {
        Run r;
        const Sheet coarse = make_sheet(evenly(0, 0.4, 2), 0.4, 2, Weave::diagonal);
        const int sheet = r.add_cloth(coarse, 1e6);
        std::vector<int> rim;
        for (int v = 0; v < 9; ++v)
            if (v != 4) rim.push_back(v);
        r.hold(sheet, rim);
        const Points tip = {
            {0.05, 0.05, side * -0.1}, {0.15, 0.05, side * -0.1}, {0.1, 0.15, side * -0.1}, {0.27, 0.25, side * -0.01}};
        std::vector<Triangle> faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
        if (side < 0)
            for (Triangle& t : faces) std::swap(t[1], t[2]);
        const int spike = r.add_bone(bone(tip, faces), 1e6);
        for (int i = 1; i <= 40; ++i) {
            auto& moved = std::get<BoneInputs>(r.in.bodies[std::size_t(spike)]).positions;
            for (std::size_t v = 0; v < moved.size(); ++v) moved[v] = tip[v] + Vec3(0, 0, side * 0.001 * i);
            r.step(1, 0.02);
            CHECK(r.crossings_of(sheet, spike) == 0);
        }
        CHECK(side * r.places(sheet)[4].z() > 0.01);
    }
}

TEST_CASE("contact of cloth: strips that cross where neither has a vertex are held apart by their edges", "[contact]") {
    Run r;
    const Sheet one = make_sheet(evenly(0, 1, 1), 0.05, 1, Weave::diagonal);
    Sheet other = one; // square to it, above
    for (Vec3& p : other.points) p = Vec3(0.5 - p.y(), p.x() - 0.475, 0.01);
    const int lower = r.add_cloth(one, 1e6), upper = r.add_cloth(other, 1e6);
    r.hold(lower, {0, 1, 2, 3});
    r.in.gravity = Vec3(0, 0, -9.8);
    r.step(40, 0.02);
    CHECK(r.crossings_of(lower, upper) == 0);
    for (const Vec3& p : r.places(upper)) CHECK(p.z() > 0.25 * thickness);
    for (const Vec3& p : r.places(upper)) CHECK(p.z() < 0.6 * thickness);
}

TEST_CASE("contact of cloth: a strip that falls onto itself lies in layers, and without selfCollisions passes through",
          "[contact]") {
    const auto fold = [](bool itself, double gravity) {
        Run r;
        Sheet s = make_sheet(evenly(0, 0.6, 24), 0.1, 4, Weave::crossed);
        for (Vec3& p : s.points) p = Vec3(0.02 * std::sin(3 * p.x()), p.y(), p.x() + 0.01);
        const int sheet = r.add_cloth(s, 1e5, itself);
        r.add_bone(box_bone({-1, -1, -0.2}, {2, 2, 0}), 1e6);
        r.in.gravity = Vec3(0, 0, -gravity), r.in.stiffness_damping = 0.005;
        std::size_t most = 0;
        for (int i = 0; i < 40; ++i) {
            r.step(1, 0.0125);
            if (itself) CHECK(r.state.record.halvings == 0);
            most = std::max(most, r.crossings_of(sheet, sheet));
        }
        return most;
    };
    // Where folds come to lie hangs on rounding: from more starts than one.
    for (const double share : {0.0, 1e-5, 2e-5}) CHECK(fold(true, 9.8 * (1 + share)) == 0);
    CHECK(fold(false, 9.8) > 0);
}

TEST_CASE("contact of cloth: the energy has no jumps where a point goes from one face to another, of any sizes",
          "[contact]") {
    Run r;
    const Sheet uneven = make_sheet({0, 0.1, 0.13, 0.3, 0.32, 0.4}, 0.3, 2, Weave::diagonal);
    const Points upper = {{0.05, 0.14, 0.003}, {0.1, 0.15, 0.05}, {0, 0.16, 0.05}};
    r.add_cloth(uneven, 1e5);
    const int moved = r.add_cloth({upper, {{0, 1, 2}}, {}}, 1e5);
    const Way way = energy_on_way(r, moved, Vec3::Zero(), {0.3, 0.05, 0}, 3000);
    CHECK(way.most > 1e-5);
    CHECK(way.off < 1e-4 * way.most);
}

TEST_CASE("contact of cloth: a point is through one face of a sheet below it, and through none above, on any way",
          "[contact]") {
    Run r;
    Sheet sheet = make_sheet(evenly(-0.1, 0.2, 20), 0.2, 20, Weave::crossed);
    for (Vec3& p : sheet.points) p.y() -= 0.1;
    r.add_cloth(sheet, 1e5);
    r.add_cloth({{{0, 0, 0}, {0.5, 0, 5}, {0, 0.5, 5}}, {{0, 1, 2}}, {}}, 1e5);
    const Scene scene(r.description);
    const CollisionBodies bodies(scene);
    std::vector<ContactPair> pairs;
    bodies.find_thick_pairs(r.in.parts, pairs);
    const std::vector<std::array<std::vector<char>, 2>> held(pairs.size());
    ClothContact contact(scene, bodies);
    std::mt19937 generator(1);
    std::uniform_real_distribution<double> random(-1, 1);
    std::vector<ClothContact::Press> presses;
    std::size_t below = 0;
    for (int run = 0; run < 300; ++run) {
        std::vector<Points> places{scene.surface(0), scene.surface(1)};
        Vec3& p = places[1][0];
        p = Vec3(0.03 * random(generator), 0.03 * random(generator), 0.0015 + 0.001 * random(generator));
        std::vector<Points> later = places;
        // Sideways over several faces, and hardly below them.
        later[1][0] += Vec3(0.03 * random(generator), 0.03 * random(generator), -1e-5 - p.z());
        contact.begin(pairs, held, places, {});
        contact.search(later);
        contact.find_presses(places, presses), contact.accept();
        for (int iteration = 0; iteration < 12; ++iteration) {
            const double reach = std::array{3e-4, 1e-5, 3e-7}[std::size_t(iteration % 3)];
            if (iteration == 0)
                p = later[1][0];
            else
                for (double& c : p) c += reach * random(generator);
            contact.find_presses(places, presses), contact.accept();
            const auto is_through = [&](const ClothContact::Press& press) {
                return press.split == 1 && press.through && contact.body_of(press.corners[0]) == 1;
            };
            REQUIRE(std::ranges::count_if(presses, is_through) == (p.z() < 0 ? 1 : 0));
            below += p.z() < 0;
        }
    }
    CHECK(below > 1000);
}

TEST_CASE("contact of cloth: nor where the straight way from the start comes to pass by the end of an edge",
          "[contact]") {
    // An edge along y above the end of one along x, beside which the third corners are out of reach.
    Run r;
    const Points upper = {{0.01, -0.05, 0.002}, {0.01, 0.05, 0.002}, {0.1, 0, 0.0056}};
    const Points lower = {{0, 0, 0}, {-0.1, 0, 0}, {-0.1, 0, 0.1}};
    r.add_cloth({lower, {{0, 1, 2}}, {}}, 1e5);
    const int moved = r.add_cloth({upper, {{0, 1, 2}}, {}}, 1e5);
    // By straight ways it gets through where it has moved by more than .0175 along x.
    const Way way = energy_on_way(r, moved, {-0.011, 0, -0.0035}, {-0.03, 0, -0.0035}, 2000);
    CHECK(way.most > 1e-5);
    CHECK(way.off < 1e-4 * way.most);
}

TEST_CASE("contact of cloth: two sheets that meet keep their momentum", "[contact]") {
    Run r;
    const Sheet big = make_sheet(evenly(0, 0.4, 5), 0.4, 5, Weave::crossed);
    Sheet small = make_sheet(evenly(0.1, 0.25, 4), 0.15, 4, Weave::bricks);
    for (Vec3& p : small.points) p += Vec3(0, 0.12, 0.03);
    const int lower = r.add_cloth(big, 1e5), upper = r.add_cloth(small, 1e5);
    r.in.tolerance_factor = 1e-6;
    r.step(0, 0.01);
    for (std::size_t v = 0; v < r.scene->vertex_count(upper); ++v)
        r.state.v[3 * (r.scene->vertex_count(lower) + v) + 2] = -2;
    r.step(8, 0.01);
    const auto momentum = [&](int body) {
        Vec3 sum = Vec3::Zero();
        const Points& rest = r.scene->surface(body);
        const std::size_t first = body == lower ? 0 : r.scene->vertex_count(lower);
        for (const auto& [a, b, c] : r.scene->triangles(body)) {
            const auto p = [&](int v) -> const Vec3& { return rest[std::size_t(v)]; };
            const double third = density * (p(b) - p(a)).cross(p(c) - p(a)).norm() / 6;
            for (const int v : {a, b, c})
                sum += third * Eigen::Map<const Vec3>(r.state.v.data() + 3 * (first + std::size_t(v)));
        }
        return sum;
    };
    const double thrown = -2 * density * 0.15 * 0.15;
    CHECK(momentum(lower).z() < 0.1 * thrown);
    CHECK((momentum(lower) + momentum(upper) - Vec3(0, 0, thrown)).norm() < 1e-6 * std::abs(thrown));
}

TEST_CASE("crossings: an edge counts that goes through a face, not one that touches, nor of neighbours", "[contact]") {
    const Points face = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<Triangle> one = {{0, 1, 2}};
    const auto through = [&](const Vec3& from, const Vec3& to, const Vec3& aside) {
        return crossings({from, to, aside}, one, face, one);
    };
    const auto found = through({0.2, 0.2, -1}, {0.2, 0.2, 1}, {5, 5, 1});
    REQUIRE(found.size() == 1);
    CHECK((found[0] == Crossing{0, 1, 0}));
    CHECK(through({0.2, 0.2, 0}, {0.2, 0.2, 1}, {5, 5, 1}).empty());
    CHECK(through({0.6, 0.6, -1}, {0.6, 0.6, 1}, {5, 5, 1}).empty());
    CHECK(own_crossings({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}}, {{0, 1, 2}, {1, 3, 2}}).empty());
    // An edge of each goes through the other.
    CHECK(own_crossings({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, -1}, {0.2, 0.2, 1}, {9, 9, 1}},
                        {{0, 1, 2}, {3, 4, 5}})
              .size() == 2);
}

TEST_CASE("contact of cloth: what goes through on a straight way is known from its ends", "[contact]") {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
    CHECK(crosses_face({Vec3(0.2, 0.2, 1), a, b, c}, {Vec3(0.2, 0.2, -1), a, b, c}));
    CHECK_FALSE(crosses_face({Vec3(0.8, 0.8, 1), a, b, c}, {Vec3(0.8, 0.8, -1), a, b, c}));
    CHECK_FALSE(crosses_face({Vec3(0.2, 0.2, 1), a, b, c}, {Vec3(0.2, 0.2, 0.5), a, b, c}));
    // Around the rim: it is beyond it while it is in the plane, and below it only later.
    CHECK_FALSE(crosses_face({Vec3(-1, 0.2, 1), a, b, c}, {Vec3(0.5, 0.2, -2), a, b, c}));
    // Both move: the face falls onto a point that stays.
    const Vec3 down(0, 0, -3);
    CHECK(crosses_face({Vec3(0.2, 0.2, -1), a, b, c}, {Vec3(0.2, 0.2, -1), a + down, b + down, c + down}));
    CHECK(crosses_edge({Vec3(0.5, -1, 1), Vec3(0.5, 1, 1), a, b}, {Vec3(0.5, -1, -1), Vec3(0.5, 1, -1), a, b}));
    CHECK_FALSE(crosses_edge({Vec3(1.5, -1, 1), Vec3(1.5, 1, 1), a, b}, {Vec3(1.5, -1, -1), Vec3(1.5, 1, -1), a, b}));
    const SegmentPair near = closest_of_segments({0.25, -1, 2}, {0.25, 1, 2}, a, b);
    CHECK(near.s == 0.5);
    CHECK(near.t == 0.25);
    CHECK((near.away - Vec3(0, 0, 2)).norm() == 0);
    const SegmentPair beyond = closest_of_segments({3, 0, 1}, {3, 0, 2}, a, b);
    CHECK((beyond.s == 0 && beyond.t == 1));
    CHECK((beyond.away - Vec3(2, 0, 1)).norm() == 0);
}

TEST_CASE("truncated Newton: it solves what is positive definite, and ends along negative curvature", "[linear]") {
    const BlockPattern pattern = make_pattern(1, std::vector<std::pair<int, int>>{});
    BlockMatrix a(pattern), m(pattern);
    ComponentFactors factor(pattern);
    const auto set = [](BlockMatrix& to, double x, double y, double z) { to.values = {x, 0, 0, 0, y, 0, 0, 0, z}; };
    set(m, 2, 2, 2);
    REQUIRE(factor.factorize(m));
    TruncatedNewton solver;
    std::vector<double> x;
    const double any = std::numeric_limits<double>::infinity();
    set(a, 1, 2, 4);
    auto r = solver.solve(a, factor, {1, 1, 1}, x, 1e-12, 10, any);
    CHECK((r.converged && !r.negative));
    for (const auto& [i, want] : {std::pair{0, 1.0}, {1, 0.5}, {2, 0.25}}) CHECK(x[std::size_t(i)] == Approx(want));
    CHECK(r.length == Approx(std::sqrt(2 * (1 + 0.25 + 0.0625))));
    // No farther than it may: along the first direction, in the norm of m.
    r = solver.solve(a, factor, {1, 1, 1}, x, 1e-12, 10, 0.1);
    CHECK(r.length == Approx(0.1));
    CHECK(2 * (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) == Approx(0.01));
    // Curvature that is negative: twenty times what the factor alone would go.
    set(a, -1, 2, 2);
    r = solver.solve(a, factor, {1, 0, 0}, x, 1e-12, 10, any);
    CHECK(r.negative);
    CHECK(x[0] == Approx(10));
    CHECK((x[1] == 0 && x[2] == 0));
}
