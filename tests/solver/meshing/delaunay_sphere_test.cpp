// Delaunay tets where Delaunay has no choice: all vertices on one sphere. Flat tets; parts that face wrongly.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "soups.h"

#include "solver/error.h"
#include "solver/mesh/tet_quality.h"
#include "solver/meshing/delaunay_tets.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace soups;

namespace {

std::vector<Triangle> canonical(std::vector<Triangle> triangles) {
    for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

TetMesh fill(const Shape& s, double quality) { return make_delaunay_tets(s.points, s.triangles, {quality}); }

void require_exact(const Shape& s, const TetMesh& m) {
    CHECK(std::equal(s.points.begin(), s.points.end(), m.vertices.begin()));
    CHECK(canonical(boundary_triangles(m.tets)) == canonical(s.triangles));
    double sum = 0;
    for (const Tet& t : m.tets) {
        const auto x = [&](std::size_t k) { return m.vertices[static_cast<std::size_t>(t[k])]; };
        const double v = tet_volume(x(0), x(1), x(2), x(3));
        REQUIRE(v > 0);
        sum += v;
    }
    CHECK(sum == Approx(enclosed_volume(s.points, s.triangles)).epsilon(1e-12));
}

Error refusal(const Shape& s, double quality = 0.8) {
    try {
        fill(s, quality);
    } catch (const Error& e) {
        return e;
    }
    return {"none", ""};
}

} // namespace

TEST_CASE("a sphere with all vertices at one distance gets good tets, and more for more quality",
          "[delaunay][sphere]") {
    for (const int n : {20, 40}) {
        const Shape s = shape("sphere", make_sphere(1, n, n));
        std::size_t before = 0;
        for (const double q : {0.0, 0.5, 0.8, 1.0}) {
            INFO(n << " " << q);
            const TetMesh m = fill(s, q);
            require_exact(s, m);
            // Without vertices inside, tets reach from the surface to whatever flat ones have made necessary.
            CHECK(dihedral_range(m)[0] > (q > 0 ? 8 : 0.3));
            CHECK(dihedral_range(m)[1] < (q > 0 ? 162 : 179.3));
            CHECK(m.tets.size() > before);
            before = m.tets.size();
        }
    }
    const Shape s = shape("sphere", make_sphere(1, 20, 20));
    const TetMesh a = fill(s, 0.8), b = fill(s, 0.8);
    CHECK(a.vertices == b.vertices);
    CHECK(a.tets == b.tets);
}

TEST_CASE("a sphere can be stopped at any of the questions whether to stop", "[delaunay][sphere]") {
    const Shape s = shape("sphere", make_sphere(1, 16, 16));
    int asked = 0;
    std::vector<double> seen;
    const MeshingControl watch{[&] { return ++asked, false; },
                               [&](double done, std::string_view) { seen.push_back(done); }};
    make_delaunay_tets(s.points, s.triangles, {1}, watch);
    CHECK(std::is_sorted(seen.begin(), seen.end()));
    for (int when = 1; when <= asked; when += 1 + asked / 10) {
        int count = 0;
        const MeshingControl stop{[&] { return ++count >= when; }, {}};
        CHECK_THROWS_AS(make_delaunay_tets(s.points, s.triangles, {1}, stop), Stopped);
        CHECK(count == when);
    }
}

TEST_CASE("a surface that leaves only flat tets is refused", "[delaunay][sphere]") {
    const Error e = refusal(shape("sheet", make_cube(1, 1e-6, 1, 1, 1, 1)));
    CHECK(e.code == "FE237");
    CHECK(std::string(e.what()).find("0.05 degrees") != std::string::npos);
}

TEST_CASE("parts that face the wrong way are named, not called a fault of the program", "[delaunay][sphere]") {
    const SurfaceMesh inner = make_sphere(0.5, 12, 8);
    Shape nested = shape("nested", make_sphere(1, 24, 16));
    const int first = static_cast<int>(nested.triangles.size());
    append(nested, inner);
    const Error e = refusal(nested);
    CHECK(e.code == "FE236");
    const std::string message = e.what();
    CHECK(message.find(std::to_string(inner.triangles.size()) + " triangles face into the solid (" +
                       std::to_string(first) + ",") != std::string::npos);

    Shape pair = shape("pair", make_sphere(1, 24, 16));
    append(pair, inner.points, reversed(inner.triangles), {3, 0, 0});
    CHECK(refusal(pair).code == "FE236");

    Shape cavity = shape("cavity", make_sphere(1, 24, 16));
    append(cavity, inner.points, reversed(inner.triangles));
    require_exact(cavity, fill(cavity, 0.8));
}
