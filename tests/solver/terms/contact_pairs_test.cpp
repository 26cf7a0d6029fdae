// Contact: which bodies are tested against which, with which values, and the bytes that contacts are kept in.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/initial_state.h"
#include "solver/marks_of.h"
#include "solver/terms/contact/contact.h"
#include "tests/support/solver_scenes.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <tuple>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

struct Body {
    ContactValues values;
    ContactRest rest;
};

/// Pairs of two tissues and, after them, bones, all far from each other.
std::vector<ContactPair> pairs_of(const std::vector<Body>& bodies, std::size_t tissues) {
    SceneDescription d;
    std::vector<PartValues> values;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        TetMesh mesh = box_mesh({1, 1, 1}, 1, 1, 1);
        for (Vec3& p : mesh.vertices) p.x() += 5.0 * static_cast<double>(i);
        const auto t = tissue(mesh, ElasticLaw::stvk);
        if (i < tissues)
            d.bodies.emplace_back(t);
        else
            d.bodies.emplace_back(bone(t->surface, t->triangles));
        d.parts.push_back({&contact_type, {static_cast<int>(i)}, std::make_shared<ContactRest>(bodies[i].rest)});
        put_fields(bodies[i].values, values.emplace_back(contact_type.values.size()));
    }
    const Scene scene(d);
    const CollisionBodies all(scene);
    std::vector<ContactPair> out;
    all.find_pairs(values, out);
    return out;
}

/// "0>1 1>0": who is tested against whom.
std::string names(const std::vector<ContactPair>& pairs) {
    std::string out;
    for (const ContactPair& p : pairs)
        out += (out.empty() ? "" : " ") + std::to_string(p.source) + ">" + std::to_string(p.target);
    return out;
}

Body body(std::vector<int> sets = {}, bool is_volume = true) {
    Body b;
    b.rest.sets = std::move(sets), b.rest.is_volume = is_volume;
    return b;
}

std::string code_of(const std::vector<TermMemory>& memories) {
    ContactMemory out;
    try {
        contacts_kept(memories, out);
    } catch (const Error& e) {
        return e.code;
    }
    return "";
}

} // namespace

TEST_CASE("contact: two bodies meet with their series stiffness, mean friction, and the larger of the rest") {
    Body a = body(), b = body();
    a.values.stiffness = 1e5, a.values.friction = 0.4, a.values.damping = 10, a.values.longest = 0.05;
    b.values.stiffness = 3e5, b.values.friction = 0.9, b.values.damping = 40, b.values.longest = 0.01;
    const auto pairs = pairs_of({a, b}, 2);
    REQUIRE(names(pairs) == "0>1 1>0");
    for (const ContactPair& p : pairs) {
        CHECK(p.stiffness == Approx(1.5e5).epsilon(1e-14)); // 2 / (1 / a + 1 / b)
        CHECK(p.friction == Approx(0.6).epsilon(1e-14));    // the geometric mean
        CHECK(p.damping == 40);
        CHECK(p.longest == 0.05);
        CHECK((p.slides && p.both_ways));
    }
    for (Body* fixed : {&a, &b}) {
        fixed->values.slides = 0;
        for (const ContactPair& p : pairs_of({a, b}, 2)) CHECK_FALSE(p.slides);
        fixed->values.slides = 1;
    }
    b.values.friction = 0;
    for (const ContactPair& p : pairs_of({a, b}, 2)) CHECK(p.friction == 0);
    b.values.stiffness = 0;
    CHECK(pairs_of({a, b}, 2).empty());
}

TEST_CASE("contact: bodies collide that share a number of their sets, and those without numbers with all") {
    CHECK(names(pairs_of({body({1, 2}), body({2})}, 2)) == "0>1 1>0");
    CHECK(names(pairs_of({body({1}), body({2, 3})}, 2)) == "");
    CHECK(names(pairs_of({body({1}), body()}, 2)) == "0>1 1>0");
    CHECK(names(pairs_of({body(), body({7})}, 2)) == "0>1 1>0");
    CHECK(names(pairs_of({body({1}), body({2}), body()}, 2)) == "0>2 1>2 2>0 2>1");
}

TEST_CASE("contact: switches are on from halfway, sheets and bones are met by others alone") {
    Body on = body(), off = body();
    on.values.collides = 0.5, off.values.collides = 0.49;
    CHECK(names(pairs_of({on, body()}, 2)) == "0>1 1>0");
    CHECK(names(pairs_of({off, body()}, 2)) == "");
    Body itself = body({1});
    itself.values.collides_with_itself = 1;
    CHECK(names(pairs_of({itself, body({2})}, 2)) == "0>0");
    itself.values.collides_with_itself = 0.49;
    CHECK(names(pairs_of({itself, body({2})}, 2)) == "");
    // A sheet's points press on solids, and nothing presses on it; bones leave each other alone.
    const auto pairs = pairs_of({body(), body({}, false), body(), body()}, 2);
    CHECK(names(pairs) == "0>2 0>3 1>0 1>2 1>3 2>0 3>0");
    for (const ContactPair& p : pairs) CHECK(p.both_ways == (p.source != 1));
}

TEST_CASE("contact: kept contacts come back as they were, and other bytes are refused") {
    ContactMemory kept;
    kept.contacts = {{0, 7, 1, 3, {0.25, 0.25, 0.5}, 2, 0, {1, 0, 0}, 12.5},
                     {1, 2, 0, 9, {0, 0, 1}, 9, 0, {0, 0, 1}, 2}};
    kept.couplings = {{0, 1, 1, 4}, {0, 1, 1, 5}};
    kept.pairs = {{0, 1}, {1, 0}};
    std::vector<TermMemory> memories(1);
    memories[0].term = contact_type.name;
    keep_contacts(kept, memories[0]);
    ContactMemory back;
    contacts_kept(memories, back);
    CHECK((back.contacts == kept.contacts && back.couplings == kept.couplings && back.pairs == kept.pairs));
    CHECK(code_of(memories) == "");
    const std::span<const std::byte> good = memories[0].bytes;
    const std::vector<std::byte> all(good.begin(), good.end());
    const auto with_bytes = [&](std::size_t count) {
        std::vector<TermMemory> other = memories;
        std::vector<std::byte> bytes = all;
        bytes.resize(count);
        std::copy(bytes.begin(), bytes.end(), other[0].bytes.rewrite(count).begin());
        return code_of(other);
    };
    for (const std::size_t count : {all.size() + 1, all.size() - 1, all.size() / 2, std::size_t{9}, std::size_t{3}})
        CHECK(with_bytes(count) == "IO403");
    CHECK(with_bytes(all.size()) == "");
}

namespace {

/// Where bodies stand as modelled, and what is near what there.
struct Standing {
    std::unique_ptr<Scene> scene;
    std::unique_ptr<CollisionBodies> bodies;
    std::unique_ptr<TouchSearch> search;
    explicit Standing(const std::vector<std::shared_ptr<TissueRest>>& tissues) {
        SceneDescription d;
        for (std::size_t i = 0; i < tissues.size(); ++i) {
            d.bodies.emplace_back(tissues[i]);
            d.parts.push_back({&contact_type, {static_cast<int>(i)}, std::make_shared<ContactRest>()});
        }
        scene = std::make_unique<Scene>(d);
        bodies = std::make_unique<CollisionBodies>(*scene);
        search = std::make_unique<TouchSearch>(*bodies);
        const std::vector<const double*> carriers(tissues.size(), scene->numbering().rest.data());
        search->begin(carriers), search->sweep(carriers);
    }
};

std::shared_ptr<TissueRest> block(const Vec3& size, const Vec3& corner, int n) {
    TetMesh mesh = box_mesh(size, n, n, n);
    for (Vec3& p : mesh.vertices) p += corner;
    return tissue(mesh, ElasticLaw::stvk);
}

/// A mesh less the tets whose middles are there, and less what they alone had of vertices.
TetMesh without(TetMesh mesh, const std::function<bool(const Vec3&)>& there) {
    std::erase_if(mesh.tets, [&](const Tet& t) {
        Vec3 middle = Vec3::Zero();
        for (const int v : t) middle += 0.25 * mesh.vertices[static_cast<std::size_t>(v)];
        return there(middle);
    });
    std::vector<int> number(mesh.vertices.size(), -1);
    Points kept;
    for (Tet& t : mesh.tets)
        for (int& v : t) {
            int& n = number[static_cast<std::size_t>(v)];
            if (n < 0) n = static_cast<int>(kept.size()), kept.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
            v = n;
        }
    mesh.vertices = kept;
    return mesh;
}

/// A third of the triangles about each vertex.
std::vector<double> vertex_areas(const TissueRest& t, const std::function<bool(const Vec3&)>& of_face) {
    std::vector<double> out(t.surface.size(), 0.0);
    for (const Triangle& tri : t.triangles) {
        const Vec3 &a = t.surface[static_cast<std::size_t>(tri[0])], &b = t.surface[static_cast<std::size_t>(tri[1])],
                   &c = t.surface[static_cast<std::size_t>(tri[2])];
        const Vec3 n = 0.5 * (b - a).cross(c - a);
        if (of_face(n / n.norm()))
            for (const int v : tri) out[static_cast<std::size_t>(v)] += n.norm() / 3;
    }
    return out;
}

} // namespace

TEST_CASE("contact: points of two bodies that meet share the area, the more finely sampled body takes more") {
    // The lower side of a small block is 5 cm inside of a large one.
    const auto large = block({1, 1, 1}, {0, 0, 0}, 2), small = block({0.5, 0.5, 0.5}, {0.2, 0.95, 0.3}, 2);
    Standing s({large, small});
    ContactPair alone;
    alone.source = 1, alone.target = 0;
    ContactPair both = alone;
    both.both_ways = true;
    std::vector<Touch> touches;
    s.search->find_inside(alone, touches);
    REQUIRE(touches.size() == 9);
    const auto anywhere = [](const Vec3&) { return true; };
    const std::vector<double> facing = vertex_areas(*small, [](const Vec3&n) { return n.y() < -0.9; }),
                              own = vertex_areas(*small, anywhere), others = vertex_areas(*large, anywhere);
    double sum = 0;
    for (const Touch& t : touches) {
        CHECK(t.feature.away.norm() == Approx(0.05).epsilon(1e-9));
        const auto p = static_cast<std::size_t>(t.point);
        CHECK(small->surface[p].y() == Approx(0.95));
        CHECK(s.search->area(alone, t) == Approx(facing[p]).epsilon(1e-9));
        sum += s.search->area(alone, t);
        double other = 0;
        for (const int v : (*s.bodies)[0].triangles()[static_cast<std::size_t>(t.feature.triangle)])
            other += others[static_cast<std::size_t>(v)] / 3;
        const double share = other * other / (own[p] * own[p] + other * other);
        CHECK(share > 0.5); // the small block's points are the closer ones
        CHECK(s.search->area(both, t) == Approx(share * facing[p]).epsilon(1e-9));
    }
    CHECK(sum == Approx(0.25).epsilon(1e-9)); // of the whole side
}

TEST_CASE("contact: a body does not touch itself where it is near itself as modelled") {
    // An angle of two arms, each four cells wide; its inner sides see each other next to the edge between them.
    const TetMesh mesh =
        without(box_mesh({1, 1, 0.125}, 8, 8, 1), [](const Vec3& p) { return p.x() > 0.5 && p.y() > 0.5; });
    Standing s({tissue(mesh, ElasticLaw::stvk)});
    ContactPair itself;
    itself.source = itself.target = 0;
    const double edge = (*s.bodies)[0].mean_edge();
    CHECK(edge > 0.125);
    CHECK(edge < 0.18);
    std::vector<Touch> touches;
    s.search->find_near(itself, 0.13, {}, 0, touches);
    CHECK(touches.empty());
    // Farther along than three edges the other arm counts.
    s.search->find_near(itself, 0.51, {}, 0, touches);
    CHECK_FALSE(touches.empty());
    for (const Touch& t : touches)
        for (const int v : (*s.bodies)[0].triangles()[static_cast<std::size_t>(t.feature.triangle)])
            CHECK(((*s.bodies)[0].modelled(v) - (*s.bodies)[0].modelled(t.point)).norm() >= 3 * edge);
}

TEST_CASE("contact: parts of a body that lie beside each other at rest, but are far along its surface, touch") {
    // A fork of two prongs, eight cells long and one wide, a cell apart: nearer to each other than three edges.
    const TetMesh mesh = without(box_mesh({1, 0.3, 0.1}, 10, 3, 1),
                                 [](const Vec3& p) { return p.x() > 0.2 && p.y() > 0.1 && p.y() < 0.2; });
    Standing s({tissue(mesh, ElasticLaw::stvk)});
    ContactPair itself;
    itself.source = itself.target = 0;
    std::vector<Touch> touches;
    s.search->find_near(itself, 0.101, {}, 0, touches);
    CHECK(touches.size() >= 16); // of the far halves of both prongs
    for (const Touch& t : touches) {
        const Vec3& p = (*s.bodies)[0].modelled(t.point);
        CHECK(p.x() > 0.2 + 2 * 0.1); // near the root the surface between them is as near
        CHECK(std::abs(p.y() - 0.15) == Approx(0.05).epsilon(1e-9)); // of sides that face each other alone
        CHECK(std::abs(t.feature.away.y()) == Approx(0.1).epsilon(1e-9));
        CHECK(t.feature.away.norm() == Approx(0.1).epsilon(1e-9));
    }
}

namespace {

/// A block that stands on a bone, tilted where asked for, after a step.
struct Pressed {
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    StepInputs in = still_inputs();
    State state;
    explicit Pressed(const Vec3& velocity, double depth, double damping, double tilt = 0) {
        auto upper = block({0.2, 0.2, 0.2}, {0, -depth, 0}, 2);
        for (Vec3& p : upper->tets.vertices) p.y() += tilt * p.x();
        upper->surface = upper->tets.vertices;
        upper->embedding = embed(upper->tets, upper->surface);
        TetMesh ground = box_mesh({4, 1, 4}, 1, 1, 1);
        for (Vec3& p : ground.vertices) p += Vec3(-2, -1, -2);
        const auto g = tissue(ground, ElasticLaw::stvk);
        SceneDescription d;
        d.bodies = {upper, bone(g->surface, g->triangles)};
        ContactValues values;
        values.stiffness = 1e6, values.damping = damping;
        for (const int b : {0, 1}) {
            d.parts.push_back({&contact_type, {b}, std::make_shared<ContactRest>()});
            put_fields(values, in.parts.emplace_back(contact_type.values.size()));
        }
        in.bodies = {material(1e6, 0.3, 1000), BoneInputs{g->surface}};
        in.gravity = Vec3(0, -9.8, 0);
        in.step_size = 0.01;
        scene = std::make_shared<const Scene>(d);
        workspace = std::make_unique<Workspace>(scene);
        state = initial_state(*scene, in, std::vector<InitialMotion>{{velocity, Vec3::Zero()}, {}});
    }
    void step(int count) {
        for (int i = 0; i < count; ++i) {
            state = advance(*workspace, state, std::span(&in, 1));
            REQUIRE(state.record.converged);
        }
    }
    double measured(const char* name) const { return value_of(state.record.measured, "contact", name); }
};

} // namespace

TEST_CASE("contact: what is measured is the sum and the most of what is shown, and contacts are kept in order") {
    Pressed p({0, 0, 0}, 0.001, 0, 0.005);
    p.step(1);
    const Marks marks = marks_of(*p.workspace, p.state, p.in);
    REQUIRE(marks.size() == 1);
    REQUIRE(marks[0].marks.size() >= 3);
    double deepest = 0, least = 1, force = 0;
    for (const Mark& m : marks[0].marks) {
        deepest = std::max(deepest, (m.from - m.to).norm());
        least = std::min(least, (m.from - m.to).norm());
        force += m.value;
    }
    CHECK(deepest > 1.2 * least);
    CHECK(p.measured("max_depth_m") == Approx(deepest).epsilon(1e-9));
    CHECK(p.measured("force_N") == Approx(force).epsilon(1e-3)); // areas are those of the step's start
    CHECK(p.measured("contacts") == static_cast<double>(marks[0].marks.size()));
    ContactMemory kept;
    contacts_kept(p.state.memories, kept);
    REQUIRE(kept.contacts.size() >= 3);
    for (std::size_t i = 1; i < kept.contacts.size(); ++i) {
        const KeptContact &a = kept.contacts[i - 1], &b = kept.contacts[i];
        CHECK(std::tie(a.source, a.target, a.point) < std::tie(b.source, b.target, b.point));
    }
    CHECK(std::is_sorted(kept.couplings.begin(), kept.couplings.end()));
}

TEST_CASE("contact: damping brakes what opens and closes, and lets slide what slides") {
    Pressed p({1, 0, 0}, 0.0005, 1e6);
    p.step(20);
    CHECK(p.measured("contacts") > 0);
    double along = 0;
    for (std::size_t i = 0; i < p.state.v.size(); i += 3) along += p.state.v[i] / (p.state.v.size() / 3.0);
    CHECK(along == Approx(1).epsilon(1e-3));
}

TEST_CASE("contact: what other forces pull through a wall within one step is caught as well") {
    // A block half a metre above the ground hangs on springs whose other end jumps to 0.6 m below it.
    const auto upper = block({0.2, 0.2, 0.2}, {0, 0.5, 0}, 2);
    // Nothing but the springs moves it, and the ground is fine: who looks no farther than by speeds finds nothing near.
    TetMesh ground = box_mesh({1, 0.5, 1}, 10, 5, 10);
    for (Vec3& p : ground.vertices) p += Vec3(-0.4, -0.5, -0.4);
    const auto g = tissue(ground, ElasticLaw::stvk);
    SceneDescription d;
    d.bodies = {upper, bone(g->surface, g->triangles), bone(upper->surface, upper->triangles)};
    AttachmentRest tie;
    tie.source = 0, tie.target = 2, tie.source_weights = {1}, tie.correspondence = Correspondence::vertex_id;
    d.attachments = {tie};
    StepInputs in = still_inputs();
    ContactValues values;
    values.stiffness = 1e7;
    for (const int b : {0, 1}) {
        d.parts.push_back({&contact_type, {b}, std::make_shared<ContactRest>()});
        put_fields(values, in.parts.emplace_back(contact_type.values.size()));
    }
    in.bodies = {material(1e6, 0.3, 1000), BoneInputs{g->surface}, BoneInputs{upper->surface}};
    in.attachments = {{1e3, 1, 0}};
    in.step_size = 1;
    in.max_newton_iterations = 200;
    const auto scene = std::make_shared<const Scene>(d);
    Workspace w(scene);
    State s = initial_state(*scene, in);
    for (Vec3& p : std::get<BoneInputs>(in.bodies[2]).positions) p.y() -= 1.1;
    s = advance(w, s, std::span(&in, 1));
    REQUIRE(s.record.converged);
    double lowest = 1e9;
    for (std::size_t i = 1; i < s.x.size(); i += 3) lowest = std::min(lowest, s.x[i]);
    CHECK(lowest > -0.001);
    CHECK(lowest < 0);
    CHECK(value_of(s.record.measured, "contact", "contacts") >= 4);
    // Springs on 0.24 m^2 pull by 0.6 m, and 8 kg come to move by half a metre a second; edges press aside, too.
    CHECK(value_of(s.record.measured, "contact", "force_N") == Approx(1e3 * 0.24 * 0.6 - 8 * 0.5).epsilon(0.05));
}
