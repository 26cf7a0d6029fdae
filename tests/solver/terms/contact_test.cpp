// Contact: closed forms of rest and sliding, balance of what two bodies do to each other, fast and deep points, state.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/terms/contact/contact.h"
#include "tests/support/sheets.h"
#include "tests/support/term_checks.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

using namespace sinew::solver;
using namespace sinew::test;
using Catch::Detail::Approx;

namespace {

constexpr ElementKind both_elements[] = {ElementKind::linear, ElementKind::quadratic};

std::shared_ptr<TissueRest> block(const Vec3& size, const Vec3& corner, int n, ElementKind kind) {
    TetMesh mesh = box_mesh(size, n, n, n);
    for (Vec3& p : mesh.vertices) p += corner;
    auto t = tissue(mesh, ElasticLaw::stvk);
    t->element = kind;
    return t;
}

std::shared_ptr<BoneRest> box_bone(const Vec3& low, const Vec3& high, int n = 1) {
    TetMesh mesh = box_mesh(high - low, n, n, n);
    for (Vec3& p : mesh.vertices) p += low;
    const auto t = tissue(mesh, ElasticLaw::stvk);
    return bone(t->surface, t->triangles);
}

/// Bodies that collide, and their values.
struct Collision {
    SceneDescription description;
    StepInputs in = still_inputs();
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    State state;

    int add(const std::shared_ptr<TissueRest>& t, const TissueInputs& values, const ContactValues& contact = {},
            double spacing = 0) {
        description.bodies.emplace_back(t);
        in.bodies.emplace_back(values);
        return collide(contact, spacing, true);
    }
    int add(const std::shared_ptr<BoneRest>& b, const ContactValues& contact = {}, bool is_volume = true) {
        description.bodies.emplace_back(b);
        in.bodies.emplace_back(BoneInputs{b->surface});
        return collide(contact, 0, is_volume);
    }
    int collide(const ContactValues& contact, double spacing, bool is_volume) {
        auto rest = std::make_shared<ContactRest>();
        rest->spacing = spacing, rest->is_volume = is_volume;
        const int body = static_cast<int>(description.bodies.size()) - 1;
        description.parts.push_back({&contact_type, {body}, std::move(rest)});
        in.parts.emplace_back(contact_type.values.size());
        set(body, contact);
        return body;
    }
    void set(int body, const ContactValues& contact) { put_fields(contact, std::span(in.parts[std::size_t(body)])); }
    Points& bone_points(int body) { return std::get<BoneInputs>(in.bodies[std::size_t(body)]).positions; }
    void start() {
        scene = std::make_shared<const Scene>(description);
        workspace = std::make_unique<Workspace>(scene);
        state = initial_state(*scene, in);
    }
    void step(int count = 1) {
        if (!workspace) start();
        for (int i = 0; i < count; ++i) {
            state = advance(*workspace, state, std::span(&in, 1));
            REQUIRE(state.record.converged);
        }
    }
    double measured(const char* name) const { return value_of(state.record.measured, "contact", name); }
    Vec3 centre(int body) const {
        Vec3 sum = Vec3::Zero();
        const Points points = surface_positions(*scene, state, body);
        for (const Vec3& p : points) sum += p;
        return sum / static_cast<double>(points.size());
    }
    double lowest(int body) const {
        double y = 1e9;
        for (const Vec3& p : surface_positions(*scene, state, body)) y = std::min(y, p.y());
        return y;
    }
};

constexpr double side = 0.2, density = 1000, weight = density * 9.8 * side * side * side;

/// A block that stands on a bone's flat top at y = 0, or hangs above it.
Collision standing(ElementKind kind, const ContactValues& own, const ContactValues& grounds, double height = 0,
                   double spacing = 0) {
    Collision c;
    c.in.gravity = Vec3(0, -9.8, 0);
    c.add(block(Vec3::Constant(side), {0.4, height, 0.4}, 4, kind), material(1e6, 0, density), own, spacing);
    c.add(box_bone({-1, -0.2, -1}, {2, 0, 2}), grounds);
    return c;
}

ContactValues with(double stiffness, double friction = 0, double damping = 0, bool slides = true) {
    ContactValues v;
    v.stiffness = stiffness, v.friction = friction, v.damping = damping, v.slides = slides ? 1 : 0;
    return v;
}

/// A block pressed into a plate or into another block, moved by loads.
ExampleScene pressed(ElementKind kind, bool on_bone, const ContactValues& values, bool held, int fineness) {
    auto c = std::make_shared<Collision>();
    const int n = kind == ElementKind::linear ? 2 * fineness : fineness;
    auto upper = block({0.2, 0.1, 0.1}, {0.03, 0.095, 0.01}, n, kind);
    auto lower = block({0.3, 0.1, 0.13}, {0, 0, 0}, n, kind);
    if (held && on_bone)
        upper->fixed_vertices = vertices_where(upper->tets.vertices, [](const Vec3& p) { return p.x() > 0.2299; });
    lower->fixed_vertices =
        vertices_where(lower->tets.vertices, [&](const Vec3& p) { return p.y() < 1e-9 || (held && p.x() > 0.2999); });
    c->add(upper, material(2e4, 0.3, 1000), values);
    if (on_bone)
        c->add(box_bone({-0.2, -0.1, -0.3}, {0.6, 0.1, 0.4}), values);
    else
        c->add(lower, material(3e4, 0.3, 1000), values);
    c->in.gravity = Vec3(0.002, -9.8, 0.001);
    c->start();
    return {c->scene, [c](int step) {
                StepInputs in = c->in;
                std::get<TissueInputs>(in.bodies[0])
                    .forces.assign(c->scene->vertex_count(0), Vec3(0.00001 * step, -0.0005 * step, 0));
                return in;
            }};
}

/// A sheet of cloth pressed onto another one, or onto a bone, over less than their thickness.
ExampleScene pressed_cloth(bool on_bone, const ContactValues& values, int fineness) {
    constexpr double thickness = 0.02;
    auto d = SceneDescription{};
    StepInputs in = still_inputs();
    const auto collide = [&](double thick) {
        auto rest = std::make_shared<ContactRest>();
        rest->thickness = thick, rest->is_volume = thick == 0;
        d.parts.push_back({&contact_type, {static_cast<int>(d.bodies.size()) - 1}, std::move(rest)});
        put_fields(values, in.parts.emplace_back(contact_type.values.size()));
    };
    const auto add = [&](double x, double z, int cells) {
        Sheet sheet = make_sheet(evenly(x, x + 0.3, cells), 0.2, cells, Weave::crossed);
        // Not level, so that edges pass each other at different heights.
        for (Vec3& p : sheet.points) p.z() = z + 0.004 * std::sin(20 * p.x() + 31 * p.y());
        d.bodies.emplace_back(cloth(sheet.points, sheet.triangles));
        in.bodies.emplace_back(cloth_material(500, 100, 1e-3, 0.3));
        collide(thickness);
    };
    add(0, 0.012 * (on_bone ? 0.7 : 1), 3 * fineness);
    if (on_bone) {
        const auto ground = box_bone({-0.2, -0.2, -0.1}, {0.6, 0.5, 0}, 3);
        d.bodies.emplace_back(ground), in.bodies.emplace_back(BoneInputs{ground->surface});
        collide(0);
    } else {
        add(0.037, 0, 4 * fineness);
    }
    in.gravity = Vec3(0, 0, -9.8);
    in.step_size = 0.002; // they would be far from each other after longer ones
    auto scene = std::make_shared<const Scene>(d);
    return {scene, [in, scene](int step) {
                StepInputs now = in;
                std::get<ClothInputs>(now.bodies[0])
                    .forces.assign(scene->vertex_count(0), Vec3(1e-6 * step, 0, -1e-5 * step));
                return now;
            }};
}

} // namespace

std::vector<TermExample> sinew::test::contact_examples() {
    std::vector<TermExample> out;
    for (const bool on_bone : {false, true})
        for (const auto& [what, values] :
             {std::pair{", sliding", with(1e4)}, {", friction and damping", with(1e4, 0.4, 50)}}) {
            TermExample e;
            e.name = std::string("contact of cloth with ") + (on_bone ? "a bone" : "cloth") + what;
            e.type = &contact_type;
            e.make = [on_bone = on_bone, values = values](int fineness) {
                return pressed_cloth(on_bone, values, fineness);
            };
            e.forces_cancel = !on_bone;
            e.torques_cancel = !on_bone && values.friction == 0;
            e.couples_all = false;
            e.projects_exactly = false; // the part that bends is left out
            out.push_back(std::move(e));
        }
    for (const ElementKind kind : both_elements)
        for (const bool on_bone : {false, true})
            for (const auto& [what, values, held] :
                 {std::tuple{", sliding", with(1e5), false}, std::tuple{", sliding, held", with(3e5), true},
                  std::tuple{", friction and damping", with(1e5, 0.4, 50), false},
                  std::tuple{", fixed, damped", with(1e5, 0, 50, false), false}}) {
                TermExample e;
                e.name = std::string("contact with a ") + (on_bone ? "bone, " : "tissue, ") +
                         (kind == ElementKind::linear ? "linear" : "quadratic") + what;
                e.type = &contact_type;
                e.make = [kind = kind, on_bone = on_bone, values = values, held = held](int fineness) {
                    return pressed(kind, on_bone, values, held, fineness);
                };
                e.forces_cancel = !on_bone;
                e.torques_cancel = !on_bone && values.friction == 0 && values.damping == 0;
                e.small = on_bone || kind == ElementKind::linear;
                e.couples_all = on_bone;
                e.projects_exactly = false; // the part that bends is left out
                out.push_back(std::move(e));
            }
    return out;
}

TEST_CASE("contact: a block rests as deep as its weight presses", "[contact]") {
    // k A d = weight, with the series stiffness of the two.
    for (const ElementKind kind : both_elements)
        for (const auto& [own, grounds] : {std::pair{1e6, 1e6}, {1e6, 1e7}}) {
            INFO((kind == ElementKind::linear ? "linear " : "quadratic ") << own << " " << grounds);
            Collision c = standing(kind, with(own), with(grounds), 0, 0.01);
            c.in.integrator = Integrator::backward_euler;
            c.step(40);
            const double k = 2 * own * grounds / (own + grounds);
            CHECK(c.measured("force_N") == Approx(weight).epsilon(1e-5));
            CHECK(c.measured("max_depth_m") == Approx(weight / (k * side * side)).epsilon(0.01));
        }
}

TEST_CASE("contact: without friction a block slides down like a point, with more than the slope it sticks",
          "[contact]") {
    // The slope is in gravity: the ground stays level. The block lies at its depth of rest already.
    constexpr double angle = 20 * std::numbers::pi / 180;
    const auto slide = [&](double friction, Integrator integrator = Integrator::bdf2) {
        Collision c = standing(ElementKind::linear, with(1e6, friction), with(1e6, friction));
        // It comes to rest on the level before the ground is tilted, as it were.
        c.in.gravity = 9.8 * Vec3(0, -std::cos(angle), 0);
        c.step(60);
        for (int i = 1; i <= 40; ++i) { // at once would be a push
            c.in.gravity.x() = 9.8 * std::sin(angle) * i / 40;
            c.step();
        }
        c.in.integrator = integrator;
        if (integrator == Integrator::bdf2) c.in.step_size = 1.0 / 96;
        c.step(40);
        const double before = c.centre(0).x();
        c.step(20);
        const double middle = c.centre(0).x();
        c.step(20);
        const double h = 20 * c.in.step_size;
        return std::pair((c.centre(0).x() - 2 * middle + before) / (h * h), c.centre(0).x() - middle);
    };
    CHECK(slide(0).first == Approx(9.8 * std::sin(angle)).epsilon(0.01));
    CHECK(slide(0.2).first == Approx(9.8 * (std::sin(angle) - 0.2 * std::cos(angle))).epsilon(0.02));
    // The front of the block presses harder than its back and takes over what slips there, until nothing does.
    CHECK(std::abs(slide(1.02 * std::tan(angle), Integrator::backward_euler).second) < 1e-7);
    CHECK(slide(0.98 * std::tan(angle), Integrator::backward_euler).second > 1e-3);
}

TEST_CASE("contact: fixed contacts do not creep", "[contact]") {
    Collision c = standing(ElementKind::linear, with(1e6, 0, 0, false), with(1e6), -0.0005);
    c.in.gravity = 9.8 * Vec3(0.3, -0.95, 0);
    c.step(60);
    const double before = c.centre(0).x();
    c.step(100);
    CHECK(std::abs(c.centre(0).x() - before) < 1e-9);
}

TEST_CASE("contact: two free blocks keep their momentum", "[contact]") {
    for (const ElementKind kind : both_elements) {
        Collision c;
        c.add(block({0.2, 0.2, 0.2}, {0, 0, 0}, 3, kind), material(1e5, 0.3, 1000), with(1e6));
        c.add(block({0.1, 0.1, 0.1}, {0.05, 0.201, 0.06}, 3, kind), material(5e4, 0.3, 2000), with(1e6));
        c.in.tolerance_factor = 1e-8;
        c.start();
        const std::vector<InitialMotion> motions = {{}, {{0.1, -1, 0.2}, {0, 0, 0}}};
        c.state = initial_state(*c.scene, c.in, motions);
        double deepest = 0;
        for (int i = 0; i < 24; ++i) {
            c.step();
            deepest = std::max(deepest, c.measured("max_depth_m"));
        }
        CHECK(deepest > 1e-3);
        // Masses of 8 and 2 kg; centres of mass from the tets, which carry it exactly in proportion to volume.
        const Numbering& numbering = c.scene->numbering();
        Vec3 momentum = Vec3::Zero();
        for (std::size_t d = 0; d < 2; ++d) {
            const TissueRest& t = *c.scene->tissue(static_cast<int>(d));
            const double rho = d == 0 ? 1000 : 2000;
            const int first = static_cast<int>(numbering.deformables[d].first_vertex);
            const auto velocity = [&](int v) { return Eigen::Map<const Vec3>(c.state.v.data() + 3 * (first + v)); };
            std::map<std::pair<int, int>, int> middles;
            int next = static_cast<int>(t.tets.vertices.size());
            for (const auto& [a, b] : edges_of(t.tets.tets)) middles[{a, b}] = next++;
            for (const Tet& tet : t.tets.tets) {
                const auto p = [&](std::size_t i) { return t.tets.vertices[std::size_t(tet[i])]; };
                const double mass = rho * std::abs((p(1) - p(0)).cross(p(2) - p(0)).dot(p(3) - p(0))) / 6;
                if (kind == ElementKind::linear) {
                    for (const int v : tet) momentum += mass / 4 * velocity(v);
                } else { // integrals of the shape functions: -1/20 at corners, 1/5 at the middles of edges
                    for (const int v : tet) momentum -= mass / 20 * velocity(v);
                    for (std::size_t i = 0; i < 4; ++i)
                        for (std::size_t j = i + 1; j < 4; ++j)
                            momentum += mass / 5 * velocity(middles.at(std::minmax(tet[i], tet[j])));
                }
            }
        }
        const Vec3 given = 2 * Vec3(0.1, -1, 0.2);
        CHECK((momentum - given).norm() < 1e-10 * given.norm());
    }
}

TEST_CASE("contact: a block that crosses a thin plate within one step is caught", "[contact]") {
    Collision c;
    c.add(block(Vec3::Constant(0.1), {0, 0.05, 0}, 2, ElementKind::linear), material(1e6, 0.3, 1000), with(1e8));
    c.add(box_bone({-0.5, -0.002, -0.5}, {0.6, 0, 0.6}), with(1e8)); // 2 mm thick
    c.start();
    const std::vector<InitialMotion> motions = {{{0, -12, 0}, {0, 0, 0}}, {}}; // five of its lengths a frame
    c.state = initial_state(*c.scene, c.in, motions);
    c.in.max_newton_iterations = 200;
    double lowest = 1;
    for (int i = 0; i < 6; ++i) {
        c.step();
        lowest = std::min(lowest, c.centre(0).y());
    }
    CHECK(lowest > 0);
    CHECK(c.centre(0).y() > 0.04);
}

TEST_CASE("contact: what is switched off, without volume or in other sets goes through", "[contact]") {
    const auto falls = [](const std::function<void(Collision&)>& change) {
        Collision c = standing(ElementKind::linear, with(1e6), with(1e6), 0.01);
        change(c);
        c.step(12);
        return c.lowest(0);
    };
    const double free_fall = [] {
        double v = 0, y = 0.01;
        for (int i = 0; i < 12; ++i) v += 9.8 / 24, y -= v / 24;
        return y;
    }();
    ContactValues off = with(1e6);
    off.collides = 0;
    CHECK(falls([&](Collision& c) { c.set(0, off); }) == Approx(free_fall).epsilon(1e-6));
    CHECK(falls([&](Collision& c) { c.set(1, with(0)); }) == Approx(free_fall).epsilon(1e-6));
    const auto change_rest = [](int part, const std::function<void(ContactRest&)>& change) {
        return [=](Collision& c) {
            auto rest = std::make_shared<ContactRest>(
                static_cast<const ContactRest&>(*c.description.parts[std::size_t(part)].rest));
            change(*rest);
            c.description.parts[std::size_t(part)].rest = rest;
        };
    };
    CHECK(falls(change_rest(1, [](ContactRest& r) { r.sets = {3}; })) > -0.01); // the block is in none: with all
    CHECK(falls([&](Collision& c) {
              change_rest(0, [](ContactRest& r) { r.sets = {1, 2}; })(c);
              change_rest(1, [](ContactRest& r) { r.sets = {3}; })(c);
          }) == Approx(free_fall).epsilon(1e-6));
    // Without the ground's volume its few corners are all that could press into the block.
    CHECK(falls(change_rest(1, [](ContactRest& r) { r.is_volume = false; })) == Approx(free_fall).epsilon(1e-6));
    ContactValues negative = with(1e6);
    negative.friction = -0.1;
    Collision c = standing(ElementKind::linear, negative, with(1e6));
    try {
        c.step();
        FAIL("a negative friction was taken");
    } catch (const Error& e) {
        CHECK(e.code == "FE304");
        CHECK(e.body == 0);
        CHECK(std::string(e.what()).find("contactFriction") != std::string::npos);
    }
}

TEST_CASE("contact: masses that a refused step has taken count at the next", "[contact]") {
    const auto ends = [](bool refused) {
        Collision c = standing(ElementKind::linear, with(1e6), with(1e6));
        c.step();
        std::get<TissueInputs>(c.in.bodies[0]).layers[0].mass_density = 3 * density;
        if (refused) {
            ContactValues negative = with(1e6);
            negative.friction = -0.1;
            c.set(0, negative);
            CHECK_THROWS_AS(c.step(), Error);
            c.set(0, with(1e6));
        }
        c.step();
        return c.state.x;
    };
    CHECK((ends(true) == ends(false)));
}

TEST_CASE("contact: edges of two blocks pass each other, and with points between do not", "[contact]") {
    // Crossed bars of two triangles a side: their vertices never come near each other.
    const auto crossed = [](double spacing) {
        Collision c;
        c.in.gravity = Vec3(0, -9.8, 0);
        auto upper = tissue(box_mesh({0.05, 0.05, 0.6}, 1, 1, 5), ElasticLaw::stvk);
        for (Points* p : {&upper->tets.vertices, &upper->surface})
            for (Vec3& q : *p) q += Vec3(0.3, 0.06, -0.3);
        c.add(upper, material(1e7, 0.3, 1000), with(1e7), spacing);
        auto lower = box_bone({0, 0, -0.025}, {0.6, 0.05, 0.025});
        c.add(lower, with(1e7));
        c.step(8);
        return c.centre(0).y();
    };
    double v = 0, fallen = 0.085;
    for (int i = 0; i < 8; ++i) v += 9.8 / 24, fallen -= v / 24;
    CHECK(crossed(0) == Approx(fallen).epsilon(1e-6));
    CHECK(crossed(0.02) == Approx(0.075).margin(0.003));
}

TEST_CASE("contact: what is inside at the start comes out through the nearest place", "[contact]") {
    Collision c = standing(ElementKind::linear, with(1e7), with(1e7), -0.03, 0.01);
    c.in.mass_damping = 20;
    c.step(1);
    CHECK(c.measured("contacts") > 0);
    c.step(60);
    CHECK(c.lowest(0) == Approx(-weight / (1e7 * side * side)).epsilon(0.02));
    CHECK((c.centre(0) - Vec3(0.5, 0.1, 0.5)).norm() < 0.003);
    // A contact that is deeper than asked for is dropped, and the block falls on.
    ContactValues shallow = with(1e7);
    shallow.longest = 0.01;
    Collision d = standing(ElementKind::linear, shallow, with(1e7), -0.03);
    d.step();
    CHECK(d.measured("contacts") == 0);
    CHECK(d.measured("dropped") == 25); // all points of its bottom
    d.step(2);
    CHECK(d.measured("dropped") == 0);
    CHECK(d.lowest(0) < -0.05);
}

TEST_CASE("contact: what is dropped as too deep is counted once", "[contact]") {
    ContactValues shallow = with(1e4);
    shallow.longest = 0.005;
    // It falls by 17 mm within the step.
    Collision falling = standing(ElementKind::linear, shallow, with(1e4), -0.001);
    falling.step();
    CHECK(falling.measured("contacts") == 25);
    CHECK(falling.measured("dropped") == 25);
    falling.step();
    CHECK(falling.measured("contacts") == 0);
    CHECK(falling.measured("dropped") == 0);
    // So over a frame of two sub-steps.
    Collision halved = standing(ElementKind::linear, shallow, with(1e4), -0.001);
    halved.start();
    const std::vector<StepInputs> twice{halved.in, halved.in};
    halved.state = advance(*halved.workspace, halved.state, twice);
    CHECK(halved.measured("contacts") == 0);
    CHECK(halved.measured("dropped") == 25);
    // At rest it is .2 mm deep, which then is too much.
    Collision resting = standing(ElementKind::linear, with(1e7), with(1e7), -weight / (1e7 * side * side));
    resting.step(2);
    CHECK(resting.measured("contacts") == 25);
    CHECK(resting.measured("dropped") == 0);
    shallow.stiffness = 1e7, shallow.longest = 1e-4;
    resting.set(0, shallow);
    resting.step();
    CHECK(resting.measured("contacts") == 0);
    CHECK(resting.measured("dropped") == 25);
    resting.step();
    CHECK(resting.measured("dropped") == 0);
}

TEST_CASE("contact: what is inside where two bodies begin to collide comes out, whatever let them pass until then",
          "[contact]") {
    const double rest = -weight / (1e7 * side * side);
    ContactValues off = with(1e7);
    off.collides = 0;
    for (const auto& [body, values] : {std::pair{0, off}, {1, off}, {0, with(0)}, {1, with(0)}}) {
        INFO("body " << body << (values.collides > 0 ? ", without stiffness" : ", off"));
        // At rest they press into each other a little, and sink a centimetre while nothing holds them.
        Collision c = standing(ElementKind::linear, with(1e7), with(1e7), rest, 0.01);
        c.in.mass_damping = 20;
        c.step(4);
        CHECK(c.lowest(0) == Approx(rest).epsilon(0.02));
        c.set(body, values);
        c.step(2);
        CHECK(c.measured("contacts") == 0);
        CHECK(c.lowest(0) < -0.01);
        c.set(body, with(1e7));
        c.step(1);
        CHECK(c.measured("contacts") > 0);
        c.step(60);
        CHECK(c.lowest(0) == Approx(rest).epsilon(0.02));
        CHECK(c.measured("force_N") == Approx(weight).epsilon(0.01));
        CHECK((c.centre(0) - Vec3(0.5, 0.1, 0.5)).norm() < 0.003);
    }
    // What has been let in deeper than contacts may be goes on as it did.
    ContactValues shallow = with(1e7);
    shallow.longest = 0.01;
    Collision d = standing(ElementKind::linear, off, with(1e7), -0.012);
    d.in.mass_damping = 20;
    d.step();
    d.set(0, shallow);
    d.step();
    CHECK(d.measured("contacts") == 0);
    CHECK(d.measured("dropped") == 25);
    CHECK(d.lowest(0) < -0.03);
}
