// Map transfer: unchanged meshes, linear maps, bounds, fibre ends on coarser meshes.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/map_transfer.h"
#include "solver/mesh/primitives.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

using namespace sinew::solver;

namespace {

MapTransfer between(const SurfaceMesh& a, const SurfaceMesh& b) {
    return find_places(a.points, a.triangles, b.points, b.triangles);
}

std::vector<double> on(const SurfaceMesh& m, double (*f)(const Vec3&)) {
    std::vector<double> out;
    for (const Vec3& p : m.points) out.push_back(f(p));
    return out;
}

} // namespace

TEST_CASE("an unchanged mesh keeps its map to the bit, also with other numbers for its vertices", "[mesh][transfer]") {
    const SurfaceMesh ball = make_sphere(1.3, 20, 14);
    std::mt19937 random(3);
    std::vector<double> map;
    for (std::size_t i = 0; i < ball.points.size(); ++i) map.push_back(random() / 4294967296.0);
    CHECK(transfer_map(between(ball, ball), map) == map);
    SurfaceMesh turned = ball;
    std::reverse(turned.points.begin(), turned.points.end());
    for (Triangle& t : turned.triangles)
        for (int& v : t) v = static_cast<int>(ball.points.size()) - 1 - v;
    std::vector<double> back = transfer_map(between(ball, turned), map);
    std::reverse(back.begin(), back.end());
    CHECK(back == map);
}

TEST_CASE("linear maps come out linear on other triangles of the same surface", "[mesh][transfer]") {
    const auto linear = [](const Vec3& p) { return 0.3 + 0.2 * p.x() - 0.4 * p.z(); };
    const SurfaceMesh coarse = make_plane(2, 1, 3, 2), fine = make_plane(2, 1, 17, 11);
    const std::vector<double> map = transfer_map(between(coarse, fine), on(coarse, linear));
    REQUIRE(map.size() == fine.points.size());
    for (std::size_t v = 0; v < map.size(); ++v) CHECK(map[v] == Approx(linear(fine.points[v])).margin(1e-12));
    // Beyond the border the closest point is on it.
    const SurfaceMesh wide = make_plane(4, 1, 8, 2);
    const std::vector<double> beyond = transfer_map(between(coarse, wide), on(coarse, linear));
    for (std::size_t v = 0; v < beyond.size(); ++v) {
        Vec3 p = wide.points[v];
        p.x() = std::clamp(p.x(), -1.0, 1.0);
        CHECK(beyond[v] == Approx(linear(p)).margin(1e-12));
    }
}

TEST_CASE("a smooth map on a ball survives a change of its triangles, within its bounds", "[mesh][transfer]") {
    const auto smooth = [](const Vec3& p) { return 0.5 + 0.5 * std::sin(3 * p.x()) * p.y(); };
    double before = 1;
    for (const int n : {16, 32, 64}) {
        const SurfaceMesh from = make_sphere(1, n, n), to = make_sphere(1, 45, 37);
        const std::vector<double> map = on(from, smooth), moved = transfer_map(between(from, to), map);
        double worst = 0;
        for (std::size_t v = 0; v < moved.size(); ++v)
            worst = std::max(worst, std::abs(moved[v] - smooth(to.points[v])));
        CHECK(worst < 0.35 * before); // second order
        before = worst;
        CHECK(*std::max_element(moved.begin(), moved.end()) <= *std::max_element(map.begin(), map.end()));
        CHECK(*std::min_element(moved.begin(), moved.end()) >= *std::min_element(map.begin(), map.end()));
    }
    CHECK(before < 0.01);
}

TEST_CASE("fibre ends stay ends, on finer and on coarser meshes", "[mesh][transfer]") {
    const auto painted = [](const Vec3& p) { return p.x() < -0.9 ? 0.05 : p.x() > 0.9 ? 0.95 : 0.3; };
    for (const auto& [n, m] : {std::pair{24, 60}, std::pair{60, 7}, std::pair{24, 24}}) {
        INFO(n << " to " << m);
        const SurfaceMesh from = make_sphere(1, n, n), to = make_sphere(1, m, m);
        const std::vector<double> ends = transfer_ends(between(from, to), on(from, painted));
        for (const double e : ends) CHECK((e == 0 || e == 0.5 || e == 1));
        CHECK(std::count(ends.begin(), ends.end(), 0.0) > 0);
        CHECK(std::count(ends.begin(), ends.end(), 1.0) > 0);
        CHECK(std::count(ends.begin(), ends.end(), 0.5) > static_cast<long>(ends.size()) / 2);
        for (std::size_t v = 0; v < ends.size(); ++v) {
            const double x = to.points[v].x(), reach = 0.9 - 4.0 / std::min(n, m);
            if (ends[v] == 0) CHECK(x < -reach);
            if (ends[v] == 1) CHECK(x > reach);
        }
    }
    // One painted vertex, far from all vertices of a coarse mesh.
    const SurfaceMesh fine = make_plane(1, 1, 30, 30), coarse = make_plane(1, 1, 1, 1);
    std::vector<double> one(fine.points.size(), 0.5);
    one[40] = 1;
    const std::vector<double> ends = transfer_ends(between(fine, coarse), one);
    CHECK(std::count(ends.begin(), ends.end(), 1.0) == 1);
}

TEST_CASE("fibre ends begin at 0.9 and 0.1, and one that has been taken marks no second vertex", "[mesh][transfer]") {
    const auto at = [](int corner) {
        MapTransfer::Place p;
        p.corners = {corner, corner, corner}, p.barycentric = Vec3(1, 0, 0);
        return p;
    };
    MapTransfer same;
    for (int v = 0; v < 4; ++v) same.on_old.push_back(at(v)), same.on_new.push_back(at(v));
    CHECK(transfer_ends(same, {0.9, 0.1, std::nextafter(0.9, 0), std::nextafter(0.1, 1)}) ==
          std::vector<double>{1, 0, 0.5, 0.5});
    // Old vertex 0 is nearest to new vertex 0, and has new vertex 1 nearest to itself; 1 is taken by none.
    const MapTransfer crossed{{at(0), at(2)}, {at(1), at(1), at(1)}};
    CHECK(transfer_ends(crossed, {1, 0.5, 0.5}) == std::vector<double>{1, 0.5});
    CHECK(transfer_ends(crossed, {0.5, 1, 0.5}) == std::vector<double>{0.5, 1});
}

TEST_CASE("maps and meshes that do not fit are refused", "[mesh][transfer]") {
    const SurfaceMesh a = make_plane(1, 1, 2, 2), b = make_plane(1, 1, 3, 3);
    CHECK_THROWS_AS(transfer_map(between(a, b), std::vector<double>(b.points.size(), 1.0)), Error);
    CHECK_THROWS_AS(transfer_ends(between(a, b), {}), Error);
    CHECK_THROWS_AS(find_places(a.points, {}, b.points, b.triangles), Error);
    Points bad = b.points;
    bad[2].x() = NAN;
    CHECK_THROWS_AS(find_places(a.points, a.triangles, bad, b.triangles), Error);
}
