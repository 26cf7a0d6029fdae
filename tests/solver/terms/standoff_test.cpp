// What a search found and what does not press: left out until it may, and not longer.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/cloth_contact.h"
#include "solver/terms/contact/contact.h"
#include "solver/terms/contact/standoff.h"
#include "tests/support/grid_matrix.h"
#include "tests/support/sheets.h"

#include <catch2/catch.hpp>
#include <limits>

using namespace sinew::solver;
using namespace sinew::test;
using Catch::Detail::Approx;

TEST_CASE("a standoff lasts as long as what has moved since is less", "[contact]") {
    Standoff s;
    CHECK_FALSE(s.outlasts(0));
    s.set(1);
    CHECK(s.outlasts(0.25));
    CHECK(s.outlasts(0.5));
    CHECK_FALSE(s.outlasts(0.25));
    s.set(1), s.forget();
    CHECK_FALSE(s.outlasts(0));

    const auto none = [] { return 0.0; };
    const double on_its_side = std::numeric_limits<double>::infinity();
    // As far as the range is, where it cannot have gone through …
    CHECK(standoff(5, 2, on_its_side, [] { return 1e9; }) == Approx(3).epsilon(1e-5));
    // … else half of what its way lacks to have met the other side, or what keeps it on its side.
    CHECK(standoff(5, 2, 0, none) == Approx(2.5).epsilon(1e-5));
    CHECK(standoff(5, 2, 0, [] { return 3.0; }) == Approx(1).epsilon(1e-5));
    CHECK(standoff(5, 2, 1.5, [] { return 3.0; }) == Approx(1.5).epsilon(1e-5));
    CHECK_FALSE(standoff(5, 2, 0, [] { return 5.0; }) > 0);

    CHECK(PlaneStandoff{2, 0, 1, 1}.left() == Approx(0.5));
    CHECK(PlaneStandoff{0.2, 0, 1, 1}.left() == Approx(0.2));
    CHECK(PlaneStandoff{0.18, 0.5, 4, 2}.left() == Approx(0.02));
    CHECK(PlaneStandoff{-0.1, 0.5, 4, 2}.left() == 0);
}

TEST_CASE("contact of cloth: what presses does not hang on where else it was looked for", "[contact]") {
    SceneDescription description;
    StepInputs in = still_inputs();
    const auto add = [&](const BodyRest& body, double thickness) {
        description.bodies.push_back(body);
        auto rest = std::make_shared<ContactRest>();
        rest->thickness = thickness, rest->is_volume = thickness == 0;
        description.parts.push_back({&contact_type, {static_cast<int>(description.bodies.size()) - 1}, rest});
        ContactValues v;
        v.stiffness = 1e5, v.collides_with_itself = 1;
        put_fields(v, std::span(in.parts.emplace_back(contact_type.values.size())));
    };
    const Sheet large = make_sheet(evenly(0, 0.3, 12), 0.2, 8, Weave::crossed);
    Sheet small = make_sheet(evenly(0.05, 0.2, 7), 0.12, 5, Weave::bricks);
    for (Vec3& p : small.points) p += Vec3(0, 0.03, 0.006);
    add(cloth(large.points, large.triangles), 0.004);
    add(cloth(small.points, small.triangles), 0.004);
    TetMesh box = box_mesh(Vec3(0.1, 0.1, 0.1), 2, 2, 2);
    for (Vec3& p : box.vertices) p += Vec3(0.1, 0.05, -0.103);
    const auto solid = tissue(box, ElasticLaw::stvk);
    add(bone(solid->surface, solid->triangles), 0);
    const Scene scene(description);
    const CollisionBodies bodies(scene);
    std::vector<ContactPair> pairs;
    bodies.find_thick_pairs(in.parts, pairs);
    REQUIRE(pairs.size() == 5);
    const std::vector<std::array<std::vector<char>, 2>> held(pairs.size());
    std::vector<Points> start, later;
    for (int b = 0; b < 3; ++b) start.push_back(scene.surface(b));
    later = start;
    for (Vec3& p : later[1]) p.z() -= 0.02;

    ClothContact watched(scene, bodies);
    watched.begin(pairs, held, start, {});
    watched.search(later);
    std::vector<ClothContact::Press> presses, afresh;
    std::size_t most = 0, least = std::numeric_limits<std::size_t>::max(), through = 0;
    std::vector<Points> places = start, accepted;
    for (unsigned round = 0; round < 120; ++round) {
        // Rests, small moves and large ones by turns; through the other sheet and back.
        const double noise = std::array{0.0, 1e-6, 3e-5, 3e-4, 2e-3}[round % 5];
        const double fallen = 0.012 * (1 - std::cos(0.37 * round));
        const double changed = round % 5 == 4 ? 1.0 : 0.0;
        for (std::size_t b = 0; b < 2; ++b) {
            const std::vector<double> random = random_numbers(3 * places[b].size(), 7 * round + unsigned(b));
            for (std::size_t p = 0; p < places[b].size(); ++p) {
                if (changed > 0) places[b][p] = start[b][p] - Vec3(0, 0, b == 1 ? fallen : 0.3 * fallen);
                for (Eigen::Index d = 0; d < 3; ++d) places[b][p][d] += noise * random[3 * p + std::size_t(d)];
            }
        }
        watched.find_presses(places, presses);
        ClothContact other(scene, bodies);
        other.begin(pairs, held, start, {});
        other.search(later);
        if (round > 0) other.find_presses(accepted, afresh), other.accept();
        other.find_presses(places, afresh);
        REQUIRE(presses.size() == afresh.size());
        for (std::size_t i = 0; i < presses.size(); ++i) {
            REQUIRE(presses[i].corners == afresh[i].corners);
            REQUIRE(presses[i].weights == afresh[i].weights);
            REQUIRE(presses[i].gap == afresh[i].gap);
            REQUIRE(presses[i].stiffness == afresh[i].stiffness);
            through += presses[i].through;
        }
        // Not of every look a solve goes on.
        if (round % 3 == 0) accepted = places, watched.accept();
        most = std::max(most, presses.size()), least = std::min(least, presses.size());
    }
    CHECK(most > 100);
    CHECK(least < most / 4);
    CHECK(through > 100);
}
