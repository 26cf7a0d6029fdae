// Contact: which bodies are tested against which, with which values, and the bytes that contacts are kept in.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/terms/contact/contact.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>
#include <string>

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
    std::vector<TermMemory> memories(1);
    memories[0].term = contact_type.name;
    keep_contacts(kept, memories[0]);
    ContactMemory back;
    contacts_kept(memories, back);
    CHECK((back.contacts == kept.contacts && back.couplings == kept.couplings));
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
