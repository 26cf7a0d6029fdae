// Parts of a surface that face the wrong way, wholly or in places, and tets too large to know a volume.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice_checks.h"
#include "soups.h"

#include "solver/error.h"
#include "solver/meshing/iso_mesh.h"
#include "solver/meshing/self_intersections.h"
#include "solver/meshing/solid.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <regex>

using namespace soups;

namespace {

Shape cube(const Vec3& size = Vec3::Ones()) { return shape("cube", make_cube(size.x(), size.y(), size.z(), 1, 1, 1)); }

TetMesh lattice_of(const Shape& s, double size = 0, Fill fill = Fill::filled_cavities) {
    LatticeOptions options;
    options.tet_size = size;
    options.fill = fill;
    return make_lattice(s.points, s.triangles, options);
}

double volume_of(const Shape& s, double size = 0.2, Fill fill = Fill::filled_cavities) {
    return lattice_checks::covered_volume(lattice_of(s, size, fill));
}

Error refusal(const Shape& s, double size = 0.2, Fill fill = Fill::filled_cavities) {
    try {
        lattice_of(s, size, fill);
    } catch (const Error& e) {
        return e;
    }
    return {"none", ""};
}

/// A band of n quads about the y axis that comes back to itself upside down.
Shape moebius(int n) {
    Shape s{"one-sided band", {}, {}};
    for (int i = 0; i < n; ++i) {
        const double a = 2 * M_PI * i / n;
        const Vec3 out(std::cos(a), 0, std::sin(a)), across = std::cos(a / 2) * out + std::sin(a / 2) * Vec3::UnitY();
        s.points.push_back(out - 0.3 * across);
        s.points.push_back(out + 0.3 * across);
    }
    for (int i = 0; i < n; ++i) {
        const int a = 2 * i, b = a + 1;
        const int c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? a + 3 : 0;
        s.triangles.push_back({a, b, d});
        s.triangles.push_back({a, d, c});
    }
    return s;
}

} // namespace

TEST_CASE("a part that is inside out is as solid as any", "[parts]") {
    Shape mirrored = cube();
    append(mirrored, cube().points, reversed(cube().triangles), {3, 0, 0});
    CHECK(volume_of(mirrored) == Approx(2).epsilon(1e-9));
    for (const Fill fill : {Fill::filled_cavities, Fill::empty_cavities}) {
        // They cross: one solid, without a hollow where they do.
        Shape crossing = cube();
        append(crossing, cube().points, reversed(cube().triangles), {0.5, 0.5, 0.5});
        CHECK(volume_of(crossing, 0.2, fill) == Approx(1.875).epsilon(1e-3));
    }
    // Inside out as a whole: what lies inside another part stays a cavity.
    Shape hollow = cube();
    append(hollow, make_cube(0.5, 0.5, 0.5, 1, 1, 1));
    Shape turned = hollow;
    turned.triangles = reversed(hollow.triangles);
    for (const Shape& s : {hollow, turned}) {
        CHECK(volume_of(s, 0.2, Fill::filled_cavities) == Approx(1).epsilon(1e-9));
        CHECK(volume_of(s, 0.2, Fill::empty_cavities) == Approx(0.875).epsilon(1e-9));
    }
}

TEST_CASE("triangles that face the wrong way are turned to agree with their part", "[parts]") {
    const TetMesh right = lattice_of(cube(), 0.2);
    for (const std::size_t every : {2, 3, 12}) {
        INFO(every);
        Shape mixed = cube();
        for (std::size_t t = 0; t < mixed.triangles.size(); t += every)
            std::swap(mixed.triangles[t][1], mixed.triangles[t][2]);
        const TetMesh m = lattice_of(mixed, 0.2);
        CHECK(m.tets == right.tets);
        CHECK(m.vertices == right.vertices);
        CHECK(lattice_checks::covered_volume(m) == Approx(1).epsilon(1e-9));
        // There is no hole to be closed.
        CHECK(refusal(mixed, 0.2, Fill::empty_cavities).code == "none");
    }
    // Also with a small hole, and beside an edge of three triangles.
    Shape ball = shape("ball", make_sphere(1, 24, 16));
    ball.triangles.pop_back();
    const double whole = volume_of(ball);
    for (std::size_t t = 0; t < ball.triangles.size(); t += 2) std::swap(ball.triangles[t][1], ball.triangles[t][2]);
    CHECK(volume_of(ball) == Approx(whole).epsilon(1e-9));
}

TEST_CASE("a solid whose volume numbers cannot hold is refused", "[parts]") {
    for (const double size : {1e-310, 1e-100, 1e-61, 1e61}) {
        INFO(size);
        CHECK(refusal(cube(Vec3::Constant(size)), 0).code == "FE224");
    }
    CHECK(volume_of(cube(Vec3::Constant(1e-59)), 0) == Approx(1e-177).epsilon(1e-9));
}

TEST_CASE("a vertex that went astray, beside which everything is flat, is named", "[parts]") {
    Shape astray = cube();
    astray.points[5].z() = 1e39;
    CHECK(std::string(refusal(astray, 0).what())
              .ends_with("since vertex 5 (counted from 0) lies far away from the others"));
    Shape flat = cube();
    for (Vec3& p : flat.points) p.z() *= 1e-12;
    CHECK(std::string(refusal(flat, 0).what()) == "the mesh is flat: its bounding box is 1 x 1 x 1e-12");
    flat.points[5].x() = 1e39; // in its plane: it would be flat without
    CHECK(std::string(refusal(flat, 0).what()) == "the mesh is flat: its bounding box is 1e+39 x 1 x 1e-12");
}

TEST_CASE("a band with one side only has no inside, and the message says where", "[parts]") {
    const Error e = refusal(moebius(24));
    CHECK(e.code == "FE223");
    CHECK(std::string(e.what()).find("1 part of the mesh cannot be turned to face one way, the first at the edge "
                                     "between vertices ") == 0);
}

TEST_CASE("an iso mesh of crossing parts, one inside out, is the surface of their union", "[parts][iso]") {
    Shape crossing = cube();
    append(crossing, cube().points, reversed(cube().triangles), {0.5, 0.5, 0.5});
    IsoMeshOptions o;
    o.triangle_size = 0.1;
    o.resolution = 64;
    const IsoMesh mesh = make_iso_mesh(crossing.points, crossing.triangles, o);
    CHECK(mesh.components == 1);
    CHECK(enclosed_volume(mesh.points, mesh.triangles) == Approx(1.875).epsilon(0.01));
    // A cavity of a surface that is inside out as a whole stays one.
    Shape hollow = cube();
    append(hollow, make_cube(0.5, 0.5, 0.5, 1, 1, 1).points, reversed(make_cube(0.5, 0.5, 0.5, 1, 1, 1).triangles));
    append(hollow, cube().points, cube().triangles, {2, 0, 0});
    hollow.triangles = reversed(hollow.triangles);
    const IsoMesh kept = make_iso_mesh(hollow.points, hollow.triangles, o);
    CHECK(kept.components == 3);
    CHECK(enclosed_volume(kept.points, kept.triangles) == Approx(1.875).epsilon(0.01));
}

TEST_CASE("check and the iso mesh agree on what is closed", "[parts][iso]") {
    const Points points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}};
    const std::vector<Triangle> low{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}},
        high{{4, 6, 5}, {4, 5, 7}, {5, 6, 7}, {4, 7, 6}};
    const auto joined = [](std::vector<Triangle> a, const std::vector<Triangle>& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
    };
    struct Case {
        std::string name;
        std::vector<Triangle> triangles;
        bool by_numbers, encloses;
    };
    const std::vector<Triangle> walls(low.begin() + 1, low.end());
    for (const Case& c : {Case{"a tet", low, true, true},
                          {"without its floor", walls, false, false},
                          {"with the floor of another on vertices of its own", joined(walls, {high[0]}), false, true},
                          {"with a wall that looks inwards", joined(walls, {{0, 1, 2}}), false, true},
                          {"with a wall twice", joined(low, {low[2]}), false, true},
                          // Welding leaves one of the two floors.
                          {"in a higher one with the same floor", joined(low, high), true, false}}) {
        INFO(c.name);
        const MeshCheck found = inspect_mesh(points, c.triangles);
        CHECK(found.is_closed() == c.by_numbers);
        CHECK(found.encloses == c.encloses);
        IsoMeshOptions options;
        options.resolution = 16;
        std::string code = "none";
        try {
            make_iso_mesh(points, c.triangles, options);
        } catch (const Error& e) {
            code = e.code;
        }
        CHECK((code == "FE230") == !c.encloses);
    }
}

TEST_CASE("tets so large that their least share is more than a tenth of the solid are refused, and the size "
          "that the message names does",
          "[parts]") {
    Shape dust{"dust", {}, {}};
    std::mt19937 random(3);
    for (int i = 0; i < 100; ++i)
        append(dust, make_cube(0.03, 0.03, 0.03, 1, 1, 1), 5 / 4294967296.0 * Vec3(random(), random(), random()));
    for (const auto& [s, size, volume] :
         {std::tuple{shape("sphere", make_sphere(1, 20, 20)), 20.0, 4.0948632},
          std::tuple{cube({1000, 1, 1}), 0.0, 1000.0},
          std::tuple{shape("sphere", make_sphere(1, 20, 20)), 1e6, 4.0948632}, std::tuple{dust, 0.0, 100 * 2.7e-5}}) {
        INFO(s.name << " " << size);
        const Error e = refusal(s, size);
        REQUIRE(e.code == "FE210");
        CHECK(std::string(e.what()).find("too large for this mesh") != std::string::npos);
        std::smatch named;
        REQUIRE(std::regex_search(e.hint, named, std::regex("tet size of ([0-9.e+-]+) or less")));
        const TetMesh m = lattice_of(s, std::stod(named[1]));
        const double counted = lattice_checks::covered_volume(m);
        CHECK(counted > 0.999 * volume);
        CHECK(counted < 1.1001 * volume);
    }
    // What is thirty times as long as thick is no needle yet.
    CHECK(volume_of(cube({30, 1, 1}), 0) == Approx(30).epsilon(0.1));
    // Without a least share there is nothing to refuse, down to tets that hold next to nothing.
    LatticeOptions bare;
    bare.tet_size = 100;
    bare.least_coverage = 0;
    const Shape ball = shape("sphere", make_sphere(1, 20, 20));
    CHECK(lattice_checks::covered_volume(make_lattice(ball.points, ball.triangles, bare)) ==
          Approx(4.0948632).epsilon(1e-6));
}

TEST_CASE("no size is tried for a sheet so thin that none would do", "[parts]") {
    const auto questions = [](double thickness, std::string* hint) {
        const SurfaceMesh sheet = make_cube(4, 0.8, thickness, 20, 4, 4);
        LatticeOptions options;
        options.tet_size = 0.2;
        std::size_t asked = 0;
        MeshingControl control;
        control.stop = [&] { return ++asked, false; };
        try {
            make_lattice(sheet.points, sheet.triangles, options, control);
        } catch (const Error& e) {
            *hint = e.hint;
        }
        return asked;
    };
    std::string none, thin;
    const std::size_t once = questions(0.02, &none), refused = questions(8e-7, &thin);
    CHECK(none.empty());
    CHECK(thin.starts_with("choose a smaller tet size, and a higher maximum resolution"));
    CHECK(refused < 2 * once); // each try asks as often as the whole lattice, or more
}

TEST_CASE("a sheet too thin for its tets is refused before they are measured", "[parts]") {
    // As many times as measuring them tells.
    for (const auto& [thickness, times] : {std::pair{1e-6, "32.5"}, std::pair{1e-8, "1667"}}) {
        INFO(thickness);
        const SurfaceMesh sheet = make_cube(1, thickness, 1, 1, 1, 1);
        LatticeOptions options;
        options.tet_size = 0.05;
        bool is_measured = false;
        MeshingControl control;
        control.progress = [&](double, std::string_view what) { is_measured |= what == "measuring the tets"; };
        std::string said;
        try {
            make_lattice(sheet.points, sheet.triangles, options, control);
        } catch (const Error& e) {
            CHECK(e.code == "FE210");
            said = e.what();
        }
        CHECK(said.ends_with(std::string("its volume would come out ") + times + " times as large"));
        CHECK(!is_measured);
    }
}

TEST_CASE("long triangles have solid on one side", "[parts]") {
    // Each of the 400 sides is twenty times as long as the prism is thick, and its places are asked together.
    const SurfaceMesh prism = make_cylinder(0.5, 20, 400, 1, 1);
    const Solid solid = make_solid(prism.points, prism.triangles);
    REQUIRE(solid.triangles.size() == 1600);
    for (const Solid::Sides& s : solid.sides) REQUIRE((s.below == 1 && s.above == 0));
}
