// Flaws of meshes: each kind is found, counted and placed, and nothing is found where nothing is wrong.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "soups.h"

#include "solver/error.h"
#include "solver/meshing/self_intersections.h"

#include <catch2/catch.hpp>

using namespace soups;

namespace {

using Edges = std::vector<std::array<int, 2>>;

MeshCheck inspect(const Shape& s) { return inspect_mesh(s.points, s.triangles); }

std::size_t flaws(const MeshCheck& c) {
    return c.open_edges.count + c.non_manifold_edges.count + c.badly_oriented_edges.count +
           c.non_manifold_vertices.count + c.degenerate_triangles.count + c.duplicate_triangles.count +
           c.coinciding_vertices.count + c.unused_vertices.count + c.crossing_triangles.count;
}

/// Two tets with the given second one.
Shape tet_and(const Points& more, std::vector<Triangle> triangles) {
    Shape s{"", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}, true};
    s.points.insert(s.points.end(), more.begin(), more.end());
    s.triangles.insert(s.triangles.end(), triangles.begin(), triangles.end());
    return s;
}

} // namespace

TEST_CASE("closed primitives have no flaws", "[meshcheck]") {
    for (const Shape& s :
         {shape("sphere", make_sphere(1, 20, 20)), shape("cube", make_cube(1, 2, 3, 2, 2, 2)),
          shape("cylinder", make_cylinder(1, 2, 20, 3, 2)), shape("helix", make_helix(1, 0.2, 2, 2, 8, 20))}) {
        INFO(s.name);
        const MeshCheck c = inspect(s);
        CHECK(flaws(c) == 0);
        CHECK(c.is_closed());
        CHECK(c.is_manifold());
        CHECK(c.components == 1);
        CHECK(c.volume == Approx(enclosed_volume(s.points, s.triangles)));
        CHECK(c.volume > 0);
    }
    CHECK(inspect({"inside out", make_sphere(1, 8, 8).points, reversed(make_sphere(1, 8, 8).triangles)}).volume < 0);
    CHECK(inspect(ten_shapes()[7]).components == 6);
}

TEST_CASE("each flaw is found alone and where it is", "[meshcheck]") {
    Shape plane = shape("plane", make_plane(1, 1, 1, 1), false);
    MeshCheck c = inspect(plane);
    CHECK(c.open_edges.count == 4);
    CHECK(c.open_edges.edges == Edges{{0, 1}, {0, 2}, {1, 3}, {2, 3}});
    CHECK(flaws(c) == 4);
    CHECK(c.is_manifold());
    CHECK_FALSE(c.is_closed());

    Shape turned = tet_and({}, {});
    std::swap(turned.triangles[2][0], turned.triangles[2][1]);
    c = inspect(turned);
    CHECK(c.badly_oriented_edges.edges == Edges{{1, 2}, {1, 3}, {2, 3}});
    CHECK(flaws(c) == 3);

    // A second tet below the edge 0-1 and one at the corner 3.
    c = inspect(tet_and({{0, -1, 0}, {0, -1, -1}}, {{0, 1, 4}, {0, 4, 5}, {4, 1, 5}, {0, 5, 1}}));
    CHECK(c.non_manifold_edges.edges == Edges{{0, 1}});
    CHECK(flaws(c) == 1);
    c = inspect(tet_and({{1, 0, 2}, {0, 1, 2}, {0, 0, 2}}, {{3, 4, 5}, {3, 5, 6}, {3, 6, 4}, {4, 6, 5}}));
    CHECK(c.non_manifold_vertices.first == std::vector<int>{3});
    CHECK(flaws(c) == 1);
    CHECK(c.is_closed());
    CHECK_FALSE(c.is_manifold());

    c = inspect(tet_and({{5, 5, 5}, {0, 0, 1}}, {}));
    CHECK(c.unused_vertices.first == std::vector<int>{4, 5});
    CHECK(c.coinciding_vertices.first == std::vector<int>{5});
    CHECK(flaws(c) == 3);

    c = inspect(tet_and({}, {{1, 0, 2}}));
    CHECK(c.duplicate_triangles.first == std::vector<int>{4});
    CHECK(c.non_manifold_edges.count == 3);

    c = inspect(tet_and({{0.5, 0, 0}}, {{0, 1, 4}}));
    CHECK(c.degenerate_triangles.first == std::vector<int>{4});

    CHECK_THROWS_AS(inspect({"", {{0, 0, 0}}, {{0, 1, 2}}}), Error);
    CHECK_THROWS_AS(inspect({"", {{0, 0, 0}, {1, 0, 0}, {0, NAN, 0}}, {{0, 1, 2}}}), Error);
}

TEST_CASE("crossings are found exactly: through, touching, overlapping, but not over what is shared", "[meshcheck]") {
    const auto count = [](const Points& points, const std::vector<Triangle>& triangles) {
        return self_intersections(points, triangles).count;
    };
    const Points base{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    const auto with = [&](const Points& more) {
        Points all = base;
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    const std::vector<Triangle> apart{{0, 1, 2}, {3, 4, 5}};
    CHECK(count(with({{1, 1, -1}, {1, 1.5, -1}, {1, 1, 1}}), apart) == 1);   // through
    CHECK(count(with({{1, 1, 0}, {1, 1.5, 1}, {1, 1, 1}}), apart) == 1);     // touches with a corner
    CHECK(count(with({{1, 1, 1e-12}, {1, 1.5, 1}, {1, 1, 1}}), apart) == 0); // does not quite
    CHECK(count(with({{1, 1, 0}, {5, 1, 0}, {1, 5, 0}}), apart) == 1);       // overlaps in the plane
    CHECK(count(with({{9, 9, 0}, {9, 8, 0}, {8, 9, 0}}), apart) == 0);
    CHECK(count(with({{2, 0, 0}, {1, -2, 0}, {3, -2, 0}}), apart) == 1); // touches a side from beside, in the plane
    CHECK(count(with({{2, -1e-15, 0}, {1, -2, 0}, {3, -2, 0}}), apart) == 0);
    CHECK(count(with({{1, 0, 0}, {3, 0, 0}, {2, -1, 0}}), apart) == 1);         // lies along a side
    CHECK(count(with({{-1, 4, 0}, {-1, 0, 0}}), {{0, 1, 2}, {2, 3, 4}}) == 0);  // beside it, but for a corner
    CHECK(count(with({{0, 1, 0}, {-1, 1, 0}}), {{0, 1, 2}, {2, 3, 4}}) == 1);   // the same with a second on a side
    CHECK(count(with({{0, 0, 0}, {0, 0, 4}, {0, 4, 4}}), apart) == 0);          // a corner at the same place
    CHECK(count(with({{-1, -1, 1}, {2, 2, -1}}), {{0, 1, 2}, {0, 3, 4}}) == 1); // shares a corner, and more
    CHECK(count(with({{-1, -1, 1}, {-2, 2, -1}}), {{0, 1, 2}, {0, 3, 4}}) == 0);
    CHECK(count(with({{2, 2, 1}}), {{0, 1, 2}, {1, 0, 3}}) == 0);  // shares an edge
    CHECK(count(with({{1, 1, 0}}), {{0, 1, 2}, {1, 0, 3}}) == 1);  // folded flat onto it
    CHECK(count(with({{1, -1, 0}}), {{0, 1, 2}, {1, 0, 3}}) == 0); // flat beside it
    const auto found = self_intersections(with({{1, 1, -1}, {1, 1.5, -1}, {1, 1, 1}}), apart);
    CHECK(found.edges == Edges{{0, 1}});
    // Two cubes that overlap: their sides cross in pairs, each found once.
    Shape two = shape("", make_cube(1, 1, 1, 1, 1, 1));
    append(two, make_cube(1, 1, 1, 1, 1, 1), {0.3, 0.4, 0.35});
    std::size_t by_hand = 0;
    for (int s = 0; s < 12; ++s)
        for (int t = 12; t < 24; ++t)
            by_hand += count(two.points,
                             {two.triangles[static_cast<std::size_t>(s)], two.triangles[static_cast<std::size_t>(t)]});
    CHECK(by_hand > 10);
    CHECK(count(two.points, two.triangles) == by_hand);
}

TEST_CASE("angles are measured", "[meshcheck]") {
    CHECK(least_angle({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}) == Approx(45));
    CHECK(least_angle({{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(3.0) / 2, 0}}, {{0, 1, 2}}) == Approx(60));
    CHECK(least_angle({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}) == Approx(0).margin(1e-12));
    CHECK(describe(Flaw{}, "hole", "holes").empty());
    Flaw f;
    for (int i = 0; i < 7; ++i) f.add(i, i + 1);
    CHECK(describe(f, "hole", "holes") == "7 holes (0-1, 1-2, 2-3, 3-4, 4-5, …)");
}

TEST_CASE("a fan of thousands of triangles is looked at in part, and a host can stop the search", "[meshcheck]") {
    Shape fan{"fan", {{0, 0, 0}}, {}, false};
    constexpr int count = 6000; // 18 million pairs around one corner
    for (int i = 0; i <= count; ++i) fan.points.emplace_back(1, 1e-3 * i, 1e-7 * i * i);
    for (int i = 0; i < count; ++i) fan.triangles.push_back({0, i + 1, i + 2});
    CHECK_FALSE(inspect(fan).crossing_triangles.is_whole);
    fan.triangles.resize(1000);
    const Flaw found = inspect(fan).crossing_triangles;
    CHECK(found.is_whole);
    CHECK(found.count == 0);
    int asked = 0;
    CHECK_THROWS_AS(self_intersections(fan.points, fan.triangles, [&] { return ++asked == 3; }), Stopped);
    CHECK(asked == 3);
}
