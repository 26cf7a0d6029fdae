// Sliding attachments: closed forms on a plate, around a ball and at the rim of what is painted, switched while it
// runs.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/marks_of.h"
#include "solver/mesh/primitives.h"
#include "solver/terms/sliding/lump_samples.h"
#include "solver/terms/sliding/sliding.h"
#include "tests/support/term_checks.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <tuple>

using namespace sinew::solver;
using namespace sinew::test;
using Catch::Detail::Approx;

namespace {

constexpr ElementKind both_elements[] = {ElementKind::linear, ElementKind::quadratic};
constexpr double side = 0.1, density = 1000, weight = 9.8 * density * side * side * side;

std::shared_ptr<TissueRest> block(const Vec3& size, const Vec3& corner, int n, ElementKind kind) {
    TetMesh mesh = box_mesh(size, n, n, n);
    for (Vec3& p : mesh.vertices) p += corner;
    auto t = tissue(mesh, ElasticLaw::stvk);
    t->element = kind;
    return t;
}

/// A flat net of n x n squares over [low, low + size] at y = 0, looking up.
std::shared_ptr<BoneRest> plate(double low, double size, int n) {
    Points points;
    std::vector<Triangle> triangles;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) points.emplace_back(low + size * i / n, 0, low + size * j / n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const int a = i * (n + 1) + j, b = a + n + 1;
            triangles.push_back({a, a + 1, b}), triangles.push_back({b, a + 1, b + 1});
        }
    return bone(points, triangles);
}

/// One attachment from body 0 to body 1.
struct Attached {
    SceneDescription description;
    StepInputs in = still_inputs();
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    State state;

    Attached(const std::shared_ptr<TissueRest>& source, const std::shared_ptr<BoneRest>& target,
             const std::function<bool(const Vec3&)>& painted, double stiffness, double young = 1e7) {
        description.bodies = {source, target};
        AttachmentRest a;
        a.source = 0, a.target = 1;
        for (const Vec3& p : source->surface) a.source_weights.push_back(painted(p) ? 1 : 0);
        description.attachments = {a};
        in.bodies = {material(young, 0, density), BoneInputs{target->surface}};
        in.attachments = {{stiffness, 1, 0}};
        in.attachments[0].set_mode(AttachmentMode::sliding);
    }
    void step(int count = 1) {
        if (!workspace) {
            scene = std::make_shared<const Scene>(description);
            workspace = std::make_unique<Workspace>(scene);
            state = initial_state(*scene, in);
        }
        for (int i = 0; i < count; ++i) {
            state = advance(*workspace, state, std::span(&in, 1));
            REQUIRE(state.record.converged);
        }
    }
    double measured(const char* name) const { return value_of(state.record.measured, "sliding", name); }
    /// Of its mass: the mean over its tets, which are alike.
    Vec3 centre() const {
        const TissueRest& t = *scene->tissue(0);
        Vec3 sum = Vec3::Zero();
        for (const Tet& tet : t.tets.tets)
            for (const int v : tet) sum += 0.25 * position(state, v);
        return sum / static_cast<double>(t.tets.tets.size());
    }
};

bool lowest(const Vec3& p, double y) { return p.y() < y + 1e-9; }

/// A block over a plate or another block, at a distance, under loads along it; `flags`: what of the target is painted.
ExampleScene over(ElementKind kind, bool to_bone, double damping, bool held, bool painted, int fineness) {
    const int n = kind == ElementKind::linear ? 2 * fineness : fineness;
    auto upper = block({0.2, 0.1, 0.1}, {0.03, 0.12, 0.01}, n, kind);
    auto lower = block({0.3, 0.1, 0.13}, {0, 0, 0}, n, kind);
    if (held)
        upper->fixed_vertices = vertices_where(upper->tets.vertices, [](const Vec3& p) { return p.x() > 0.2299; });
    const std::vector<int> floor = vertices_where(lower->tets.vertices, [](const Vec3& p) { return p.y() < 1e-9; });
    lower->fixed_vertices = floor;
    AttachmentRest a;
    a.source = 0, a.target = 1, a.max_distance = 1;
    for (const Vec3& p : upper->surface) a.source_weights.push_back(lowest(p, 0.12) ? 0.8 : 0);
    for (const Vec3& p : lower->surface)
        if (painted) a.target_weights.push_back(p.y() > 0.0999 && p.x() - p.z() < 0.2 ? 1 : 0);
    SceneDescription d;
    d.bodies = {upper};
    if (to_bone)
        d.bodies.emplace_back(bone(lower->surface, lower->triangles));
    else
        d.bodies.emplace_back(lower);
    d.attachments = {a};
    const Points plate = lower->surface;
    auto scene = std::make_shared<const Scene>(std::move(d));
    return {scene, [=](int step) {
                StepInputs in = still_inputs();
                in.gravity = Vec3(1, -9.8, 0.5);
                TissueInputs values = material(2e4, 0.3, 1000);
                values.forces.assign(scene->vertex_count(0), Vec3(0.001 * step, -0.002 * step, 0));
                in.bodies = {values};
                if (to_bone) {
                    Points moved = plate;
                    for (Vec3& p : moved) p += Vec3(0.002, 0.003, 0.001) * step;
                    in.bodies.emplace_back(BoneInputs{moved});
                } else {
                    in.bodies.emplace_back(material(3e4, 0.3, 1000));
                }
                in.attachments = {{3e5, 0.9, damping}};
                in.attachments[0].set_mode(AttachmentMode::sliding);
                return in;
            }};
}

} // namespace

std::vector<TermExample> sinew::test::sliding_examples() {
    std::vector<TermExample> out;
    for (const ElementKind kind : both_elements)
        for (const bool to_bone : {false, true})
            for (const auto& [damping, held, painted] :
                 {std::tuple{0.0, false, false}, {30.0, false, true}, {30.0, true, false}}) {
                TermExample e;
                e.name = std::string("sliding on a ") + (to_bone ? "bone, " : "tissue, ") +
                         (kind == ElementKind::linear ? "linear" : "quadratic") + (damping > 0 ? ", damped" : "") +
                         (held ? ", held" : "") + (painted ? ", painted" : "");
                e.type = &sliding_type;
                e.make = [kind, to_bone, damping = damping, held = held, painted = painted](int fineness) {
                    return over(kind, to_bone, damping, held, painted, fineness);
                };
                e.forces_cancel = !to_bone;
                e.torques_cancel = !to_bone && damping == 0;
                e.small = to_bone || kind == ElementKind::linear;
                e.couples_all = to_bone;
                e.projects_exactly = false; // the part that bends is left out
                out.push_back(std::move(e));
            }
    return out;
}

TEST_CASE("sliding: few points of a tet have the sums of all its samples", "[sliding]") {
    // Over a bent patch, a flat one, along a line, in one place: what they spread over bounds how many are left.
    struct Patch {
        int ways;
        std::size_t most_few, most[2]; ///< of degree 2 and 4
    };
    for (const Patch& patch : {Patch{3, 4, {10, 35}}, {2, 3, {6, 15}}, {1, 2, {3, 5}}, {0, 1, {1, 1}}}) {
        INFO(patch.ways);
        std::vector<std::array<double, 4>> samples;
        std::vector<double> weights;
        for (int i = 0; i < 60; ++i) {
            const double u = patch.ways > 0 ? std::fmod(0.618 * i, 1) : 0.4, v = patch.ways > 1 ? i / 60.0 : 0.3,
                         x = 0.1 + 0.5 * u - 0.1 * v, y = 0.2 + 0.1 * u + 0.4 * v,
                         z = 0.1 - 0.2 * u + 0.1 * v + (patch.ways > 2 ? 0.3 * u * v * v : 0);
            samples.push_back({1 - x - y - z, x, y, z}), weights.push_back(1 + i % 7);
        }
        const auto sum_of = [](const auto& list, int i, int j, int k) {
            double sum = 0;
            for (const LumpedSample& s : list)
                sum += s.weight * std::pow(s.coordinates[1], i) * std::pow(s.coordinates[2], j) *
                       std::pow(s.coordinates[3], k);
            return sum;
        };
        std::vector<LumpedSample> all;
        for (std::size_t i = 0; i < samples.size(); ++i) all.push_back({samples[i], weights[i]});
        const auto check = [&](const std::vector<LumpedSample>& some, int degree, std::size_t most) {
            INFO("degree " << degree << ", " << some.size() << " points");
            CHECK(some.size() <= most);
            for (const LumpedSample& s : some) CHECK(s.weight > 0);
            for (int i = 0; i <= degree; ++i)
                for (int j = 0; i + j <= degree; ++j)
                    for (int k = 0; i + j + k <= degree; ++k)
                        CHECK(sum_of(some, i, j, k) == Approx(sum_of(all, i, j, k)).epsilon(1e-9));
        };
        check(lump_into_few(samples, weights), 2, patch.most_few);
        check(lump_samples(samples, weights, 2), 2, patch.most[0]);
        check(lump_samples(samples, weights, 4), 4, patch.most[1]);
    }
}

TEST_CASE("sliding: held along the normal alone, a block goes down a slope like a point", "[sliding]") {
    // The slope is in gravity: the plate stays level. Backward Euler under a constant force: x = a h^2 n (n + 1) / 2.
    constexpr double angle = 20 * std::numbers::pi / 180, stiffness = 1e6;
    for (const ElementKind kind : both_elements)
        for (const double height : {0.0, 0.02}) {
            INFO((kind == ElementKind::linear ? "linear, " : "quadratic, ") << height);
            Attached s(
                block(Vec3::Constant(side), {0, height, 0}, 2, kind), plate(-1, 4, 7),
                [&](const Vec3& p) { return lowest(p, height); }, stiffness);
            s.in.gravity = 9.8 * Vec3(std::sin(angle), -std::cos(angle), 0);
            s.in.tolerance_factor = 1e-2;
            s.step(1);
            const double start = s.centre().x() - 9.8 * std::sin(angle) * s.in.step_size * s.in.step_size;
            s.step(23);
            const double h = s.in.step_size, expected = 9.8 * std::sin(angle) * h * h * 24 * 25 / 2;
            CHECK(expected > 1); // far over many faces
            CHECK(s.centre().x() - start == Approx(expected).epsilon(1e-6));
            // It hangs on the plate with what presses on it.
            CHECK(s.measured("force_N") == Approx(weight * std::cos(angle)).epsilon(1e-3));
            CHECK(s.measured("max_stretch_m") ==
                  Approx(weight * std::cos(angle) / (stiffness * side * side)).epsilon(0.03));
            // Shown as lines down to the plate, as long as the height that they are off or keep.
            const Marks marks = marks_of(*s.workspace, s.state, s.in);
            REQUIRE(marks.size() == 1);
            CHECK((marks[0].term == "sliding" && marks[0].what == "way" && marks[0].unit == "m"));
            double longest = 0;
            for (const Mark& m : marks[0].marks) {
                CHECK((m.part == 0 && m.bodies == std::array{0, 1}));
                CHECK(std::abs(m.to.y()) < 1e-12);
                CHECK(std::hypot(m.from.x() - m.to.x(), m.from.z() - m.to.z()) < 1e-12);
                CHECK(std::abs(m.value - std::abs(m.from.y() - height)) < 1e-12);
                longest = std::max(longest, m.value);
            }
            CHECK(longest == Approx(s.measured("max_stretch_m")).epsilon(1e-12));
        }
}

TEST_CASE("sliding: around a ball to its lowest place, over faces, edges and corners", "[sliding]") {
    constexpr double radius = 0.1, height = 0.01, small = 0.02;
    const SurfaceMesh ball = make_sphere(radius, 96, 64);
    for (const ElementKind kind : both_elements) {
        INFO((kind == ElementKind::linear ? "linear" : "quadratic"));
        const Vec3 corner = (radius + height) * Vec3(std::cos(0.5), std::sin(0.5), 0.1).normalized();
        Attached s(
            block(Vec3::Constant(small), corner, 2, kind), bone(ball.points, ball.triangles),
            [](const Vec3&) { return true; }, 3e5);
        s.in.gravity = Vec3(0, -9.8, 0);
        s.in.mass_damping = 3;
        s.in.max_newton_iterations = 60;
        s.step(1);
        const double distance = s.centre().norm();
        s.step(150);
        const Vec3 end = s.centre();
        CHECK(end.norm() == Approx(distance).epsilon(0.01));
        CHECK(end.y() < 0);
        CHECK(std::hypot(end.x(), end.z()) < 0.02 * radius);
    }
}

TEST_CASE("sliding: beyond the painted part of the target it is drawn back to its rim, at its height", "[sliding]") {
    constexpr double stiffness = 1e6, force = 800;
    for (const double height : {0.0, 0.03}) {
        Attached s(
            block(Vec3::Constant(side), {-side, height, 0}, 2, ElementKind::linear), plate(-1, 2, 10),
            [&](const Vec3& p) { return lowest(p, height); }, stiffness);
        for (const Vec3& p : std::get<1>(s.description.bodies[1])->surface)
            s.description.attachments[0].target_weights.push_back(p.x() < 1e-9 ? 1 : 0);
        // Pulled in the plane of the plate at what is held, so that it does not turn.
        auto& values = std::get<TissueInputs>(s.in.bodies[0]);
        const TissueRest& rest = *std::get<0>(s.description.bodies[0]);
        const std::vector<int> base =
            vertices_where(rest.tets.vertices, [&](const Vec3& p) { return lowest(p, height); });
        values.forces.assign(rest.tets.vertices.size(), Vec3::Zero());
        s.in.mass_damping = 20;
        s.in.max_newton_iterations = 60;
        for (const int v : base) values.forces[std::size_t(v)] = Vec3(force / static_cast<double>(base.size()), 0, 0);
        s.step(200);
        // All of it is beyond the rim at x = 0: force = stiffness x area x mean distance.
        Vec3 mean = Vec3::Zero();
        for (const int v : base) mean += position(s.state, v) / static_cast<double>(base.size());
        INFO(height);
        CHECK(mean.x() == Approx(force / (stiffness * side * side)).epsilon(0.01));
        CHECK(mean.y() == Approx(height).margin(1e-4));
    }
}

TEST_CASE("sliding: the mode of an attachment changes from step to step", "[sliding]") {
    Attached s(
        block(Vec3::Constant(side), {0, 0.01, 0}, 2, ElementKind::linear), plate(-1, 4, 7),
        [](const Vec3& p) { return lowest(p, 0.01); }, 1e7);
    s.in.attachments[0].set_mode(AttachmentMode::fixed);
    s.in.gravity = Vec3(2, -9.8, 0);
    s.step(10);
    CHECK(std::abs(s.centre().x() - 0.05) < 1e-3);
    CHECK(s.measured("force_N") == 0);
    s.in.attachments[0].set_mode(AttachmentMode::sliding);
    const double height = s.centre().y();
    s.step(24);
    CHECK(s.centre().x() > 0.5);
    CHECK(s.centre().y() == Approx(height).margin(1e-4));
    CHECK(value_of(s.state.record.measured, "attachment", "max_stretch_m") == 0);
    s.in.attachments[0].set_mode(AttachmentMode::none);
    std::vector<double> y;
    for (int i = 0; i < 3; ++i) s.step(), y.push_back(s.centre().y());
    const double h = s.in.step_size;
    CHECK((y[2] - 2 * y[1] + y[0]) / (h * h) == Approx(-9.8).epsilon(1e-3));
    // Fixed again: at the places of the start frame.
    s.in.attachments[0].set_mode(AttachmentMode::fixed);
    s.in.mass_damping = 20, s.in.max_newton_iterations = 100;
    s.step(60);
    CHECK(std::abs(s.centre().x() - 0.05) < 1e-3);
}

TEST_CASE("sliding: a factor knows what slides on what, wherever it has got to", "[sliding]") {
    // A block slides along a longer one, a third of it in these steps.
    auto upper = block({0.2, 0.1, 0.1}, {0.03, 0.11, 0.01}, 2, ElementKind::linear);
    auto lower = block({0.6, 0.1, 0.12}, {0, 0, 0}, 4, ElementKind::linear);
    lower->fixed_vertices = vertices_where(lower->tets.vertices, [](const Vec3& p) { return p.y() < 1e-9; });
    SceneDescription d;
    d.bodies = {upper, lower};
    AttachmentRest a;
    a.source = 0, a.target = 1;
    for (const Vec3& p : upper->surface) a.source_weights.push_back(lowest(p, 0.11) ? 1 : 0);
    d.attachments = {a};
    const auto scene = std::make_shared<const Scene>(std::move(d));
    StepInputs in = still_inputs();
    in.gravity = Vec3(4, -9.8, 0);
    in.bodies = {material(1e5, 0.3, density), material(1e5, 0.3, density)};
    in.attachments = {{1e6, 1, 0}};
    in.attachments[0].set_mode(AttachmentMode::sliding);
    in.linear_method = LinearMethod::direct;
    Workspace workspace(scene);
    State state = initial_state(*scene, in), halfway;
    const double from = position(state, 0).x();
    int with_iterations = 0;
    for (int step = 0; step < 16; ++step) {
        if (step == 8) halfway = state;
        state = advance(workspace, state, std::span(&in, 1));
        REQUIRE(state.record.converged);
        with_iterations += state.record.linear_iterations > 0;
    }
    CHECK(position(state, 0).x() - from > 0.2);
    // A factor that knows all leaves conjugate gradients nothing to do. At least one point in twenty has to have left
    // where the matrix has it until it is laid out anew, so some steps see a few that it does not have.
    CHECK(with_iterations <= 4);
    // What it was laid out by is part of the state.
    Workspace another(scene);
    for (int step = 8; step < 16; ++step) halfway = advance(another, halfway, std::span(&in, 1));
    CHECK(halfway.x == state.x);
}

TEST_CASE("sliding: an attachment that found no hold may be off, and says so when it is switched on", "[sliding]") {
    Attached s(
        block(Vec3::Constant(side), {0, 0.01, 0}, 1, ElementKind::linear), plate(-1, 2, 2),
        [](const Vec3&) { return false; }, 1e7);
    s.in.attachments[0].set_mode(AttachmentMode::none);
    s.step(2);
    for (const AttachmentMode mode : {AttachmentMode::sliding, AttachmentMode::fixed}) {
        s.in.attachments[0].set_mode(mode);
        try {
            advance(*s.workspace, s.state, std::span(&s.in, 1));
            FAIL("no error");
        } catch (const Error& e) {
            CHECK(e.code == "FE240");
            CHECK(e.attachment == 0);
        }
    }
}

TEST_CASE("sliding: what goes to and fro stays after four returns, unless the solve is stuck", "[sliding]") {
    auto source = block({0.1, 0.1, 0.1}, {0.01, 0.01, 0.01}, 2, ElementKind::linear);
    auto target = plate(-1, 2, 40);
    Attached a(
        source, target, [](const Vec3& p) { return lowest(p, 0.01); }, 1e6);
    const Scene scene(a.description);
    const State state = initial_state(scene, a.in);
    const std::unique_ptr<Term> slides = sliding_type.make(scene);
    REQUIRE(slides);
    slides->take(a.in, state);
    ImplicitForm form;
    quasi_static_form(state, form);
    const Positions here = state.x;
    Positions there = here;
    for (std::size_t v = 0; v < there.size(); v += 3) there[v] += 0.06; // over other faces
    const auto begin = [&] { slides->begin_stage({a.in, state, form, state.bones}); };

    begin();
    for (int turn = 0; turn < 2; ++turn) {
        CHECK(slides->settle(there, false));
        CHECK(slides->settle(here, false));
    }
    CHECK_FALSE(slides->settle(there, false)); // the fourth return
    CHECK_FALSE(slides->settle(there, false));
    CHECK(slides->settle(there, true));
    CHECK(slides->settle(here, true));
    CHECK_FALSE(slides->settle(here, true)); // nothing else is nearest
    // After a solution it is looked for twice more.
    begin();
    CHECK(slides->widen(there));
    CHECK(slides->widen(here));
    CHECK_FALSE(slides->widen(there));
}
