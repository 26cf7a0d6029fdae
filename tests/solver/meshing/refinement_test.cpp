// Painted refinement: where, how fine, without gaps, and with angles that keep their bound.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice_checks.h"
#include "solver/error.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/primitives.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/meshing/bcc_grid.h"
#include "solver/meshing/red_green.h"
#include "solver/meshing/refined_cells.h"
#include "solver/meshing/refined_count.h"

#include <bit>
#include <random>
#include <tbb/global_control.h>

using namespace lattice_checks;

namespace {

std::array<Vec3, 4> places(const BccGrid& grid, std::int64_t tet) {
    std::array<Vec3, 4> result;
    const auto keys = grid.tet_vertices(tet);
    for (std::size_t k = 0; k < 4; ++k) result[k] = grid.position(keys[k]);
    return result;
}

double volume(const std::array<Vec3, 4>& c) { return tet_volume(c[0], c[1], c[2], c[3]); }

bool contains(const std::array<Vec3, 4>& tet, const Vec3& p) {
    Mat3 edges;
    edges << tet[1] - tet[0], tet[2] - tet[0], tet[3] - tet[0];
    const Vec3 l = edges.inverse() * (p - tet[0]);
    return l.minCoeff() > -1e-9 && l.sum() < 1 + 1e-9;
}

/// The unit sphere with the number of levels wanted at each vertex as a function of the place.
template <class Levels>
TetMesh refined_sphere(double size, double propagation, const Levels& levels, Fill fill = Fill::filled_cavities) {
    const SurfaceMesh sphere = make_sphere(1, 20, 20);
    LatticeOptions options;
    options.tet_size = size;
    options.propagation = propagation;
    options.least_coverage = 0;
    options.fill = fill;
    for (const Vec3& p : sphere.points) options.refinement.push_back(levels(p));
    return make_lattice(sphere.points, sphere.triangles, options);
}

using Places = std::set<std::vector<std::array<double, 3>>>;

/// The tets by the places of their corners, whatever their numbers.
Places tet_places(const TetMesh& mesh, const std::function<bool(const Vec3& middle)>& where) {
    Places result;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const auto c = corners_of(mesh, t);
        if (!where((c[0] + c[1] + c[2] + c[3]) / 4)) continue;
        std::vector<std::array<double, 3>> key;
        for (const Vec3& p : c) key.push_back({p.x(), p.y(), p.z()});
        std::sort(key.begin(), key.end());
        result.insert(key);
    }
    return result;
}

std::string code_of(const LatticeOptions& options, std::string* message = nullptr) {
    const SurfaceMesh cube = make_cube(3, 1, 1, 1, 1, 1);
    try {
        make_lattice(cube.points, cube.triangles, options);
    } catch (const Error& e) {
        if (message) *message = e.what();
        return e.code;
    }
    return "none";
}

SurfaceMesh cup() {
    const SurfaceMesh sphere = make_sphere(1, 24, 24);
    std::vector<Triangle> kept;
    for (const Triangle& t : sphere.triangles)
        if (sphere.points[at(t[0])].y() + sphere.points[at(t[1])].y() + sphere.points[at(t[2])].y() < 0.9)
            kept.push_back(t);
    return SurfaceMesh::from_triangles(sphere.points, kept);
}

} // namespace

TEST_CASE("lattice tets know their number, their parts and what they are part of", "[refinement]") {
    const BccGrid grid = make_bcc_grid(Vec3(1, 2, 3), Vec3(1, 1.4, 0.7), 0.5), fine = grid.finer();
    for (std::int64_t tet = 0; tet < grid.tet_count(); ++tet) {
        const auto keys = grid.tet_vertices(tet);
        REQUIRE(grid.tet_number({keys[2], keys[0], keys[3], keys[1]}) == (grid.holds(tet) ? tet : -1));
        if (!grid.holds(tet)) continue;
        double sum = 0;
        for (std::int64_t child : grid.children(tet)) {
            REQUIRE(fine.holds(child));
            REQUIRE(grid.parent_of(child) == tet);
            const auto c = places(fine, child);
            for (const Vec3& p : c) REQUIRE(contains(places(grid, tet), p));
            sum += volume(c);
        }
        REQUIRE(sum == Approx(volume(places(grid, tet))).epsilon(1e-12));
    }
    // Edges in the middle of the grid have all of their tets: four about long ones, six about short ones.
    const auto middle =
        grid.tet_vertices(12 * grid.cube_number({grid.cubes[0] / 2, grid.cubes[1] / 2, grid.cubes[2] / 2}));
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const BccGrid::TetRing ring = grid.tets_around(middle[i], middle[j]);
            REQUIRE(ring.count == (middle[i][0] % 2 == middle[j][0] % 2 ? 4 : 6));
            std::set<std::int64_t> distinct;
            for (std::size_t k = 0; k < at(ring.count); ++k) {
                distinct.insert(ring.tets[k]);
                const auto keys = grid.tet_vertices(ring.tets[k]);
                REQUIRE(std::find(keys.begin(), keys.end(), middle[i]) != keys.end());
                REQUIRE(std::find(keys.begin(), keys.end(), middle[j]) != keys.end());
            }
            REQUIRE(distinct.size() == at(ring.count));
        }
}

TEST_CASE("the closure of a set of split edges is the smallest that a cut resolves", "[refinement]") {
    std::vector<unsigned> closed;
    for (unsigned p = 0; p <= all_edges; ++p)
        if (closed_pattern(p) == p) closed.push_back(p);
    REQUIRE(closed.size() == 1 + 6 + 3 + 4 + 1);
    for (unsigned p = 0; p <= all_edges; ++p) {
        const unsigned c = closed_pattern(p);
        REQUIRE((p & ~c) == 0);
        for (unsigned other : closed)
            if ((p & ~other) == 0) REQUIRE((c & ~other) == 0); // contained in every other that would do
    }
}

TEST_CASE("all cuts of a lattice tet fill it and keep the dihedral angles in 30 to 116.57 degrees", "[refinement]") {
    const BccGrid grid = make_bcc_grid(Vec3::Zero(), Vec3(1, 1, 1), 1);
    Angles green, red;
    for (std::int64_t tet = 0; tet < grid.tet_count(); ++tet) {
        if (!grid.holds(tet)) continue;
        std::array<Vec3, 10> points;
        const auto corners = places(grid, tet);
        std::copy(corners.begin(), corners.end(), points.begin());
        constexpr std::size_t ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
        for (std::size_t e = 0; e < 6; ++e) points[4 + e] = 0.5 * (corners[ends[e][0]] + corners[ends[e][1]]);
        for (unsigned p = 0; p < all_edges; ++p) {
            if (closed_pattern(p) != p) continue;
            const auto& parts = green_parts(p);
            REQUIRE(parts.size() == (p == 0 ? 1 : std::popcount(p) == 1 ? 2 : 4));
            double sum = 0;
            std::set<int> used;
            for (const GreenPart& part : parts) {
                std::array<Vec3, 4> c;
                for (std::size_t k = 0; k < 4; ++k) c[k] = points[at(part[k])], used.insert(part[k]);
                REQUIRE(volume(c) > 0.2 * volume(corners));
                sum += volume(c);
                add_dihedral_angles(c, green);
            }
            REQUIRE(sum == Approx(volume(corners)).epsilon(1e-12));
            // All split edges have their midpoint used, and no other edge has.
            for (int e = 0; e < 6; ++e) REQUIRE((used.count(4 + e) == 1) == ((p >> e & 1u) == 1));
        }
        for (std::int64_t child : grid.children(tet)) add_dihedral_angles(places(grid.finer(), child), red);
    }
    REQUIRE(green.least == Approx(30).margin(1e-6));
    REQUIRE(green.most == Approx(116.5650512).margin(1e-6));
    REQUIRE(red.least == Approx(60).margin(1e-6));
    REQUIRE(red.most == Approx(90).margin(1e-6));
}

TEST_CASE("no paint leaves every bit of the lattice, full paint and propagation give the lattice of half the size",
          "[refinement]") {
    const auto everywhere = [](const Vec3&) { return true; };
    const TetMesh plain = refined_sphere(2 / 3.5, 0, [](const Vec3&) { return 0.0; });
    REQUIRE(plain.tets.size() == 600);
    REQUIRE(std::count(plain.coverage.begin(), plain.coverage.end(), 1.0) == 168);
    LatticeOptions options;
    options.least_coverage = 0;
    const SurfaceMesh sphere = make_sphere(1, 20, 20);
    for (int levels = 0; levels < 3; ++levels) {
        options.tet_size = 2 / 3.5 / (1 << levels);
        const TetMesh fine = make_lattice(sphere.points, sphere.triangles, options);
        const TetMesh refined = refined_sphere(2 / 3.5, 1, [&](const Vec3&) { return levels * 1.0; });
        REQUIRE(tet_places(refined, everywhere) == tet_places(fine, everywhere));
        REQUIRE(covered_volume(refined) == Approx(covered_volume(fine)).epsilon(1e-12));
        if (levels == 0) {
            REQUIRE(refined.tets == fine.tets);
            REQUIRE(refined.coverage == fine.coverage);
            REQUIRE(refined.vertices == fine.vertices);
        }
    }
}

TEST_CASE("levels round up, but not by rounding errors", "[refinement]") {
    const auto count = [](double level) {
        return refined_sphere(0.5, 1, [&](const Vec3&) { return level; }).tets.size();
    };
    const std::size_t one = count(1), two = count(2);
    REQUIRE(count(0.01) == one);
    REQUIRE(count(0.5) == one);
    REQUIRE(count(0.1 * 3 / 0.3) == one);
    REQUIRE(count(1 + 1e-12) == one);
    REQUIRE(count(1.01) == two);
}

TEST_CASE("refinement stays near the paint, and there it is as fine as asked", "[refinement]") {
    constexpr double size = 0.25;
    const auto cap = [](const Vec3& p) { return p.y() > 0.85 ? 2.0 : 0.0; };
    const TetMesh plain = refined_sphere(size, 0, [](const Vec3&) { return 0.0; });
    const TetMesh refined = refined_sphere(size, 0, cap), deep = refined_sphere(size, 1, cap);
    require_sound(refined);
    REQUIRE(refined.tets.size() > plain.tets.size() * 5 / 4);
    REQUIRE(refined.tets.size() < plain.tets.size() * 3);
    REQUIRE(deep.tets.size() > refined.tets.size());
    // The painted triangles end at y = 0.81; two coarse cubes below nothing has changed.
    const auto far = [](const Vec3& p) { return p.y() < 0.3; };
    REQUIRE(tet_places(refined, far) == tet_places(plain, far));
    int at_paint = 0;
    const SurfaceMesh sphere = make_sphere(1, 20, 20);
    for (const Vec3& p : sphere.points) {
        if (cap(p) == 0) continue;
        for (std::size_t t = 0; t < refined.tets.size(); ++t)
            if (contains(corners_of(refined, t), p)) {
                REQUIRE(longest_edge(corners_of(refined, t)) < size / 4 * 1.000001);
                ++at_paint;
            }
    }
    REQUIRE(at_paint > 60);
    // A gradient of paint gives all levels from 0 to 3 and nothing finer.
    const TetMesh graded = refined_sphere(size, 0, [](const Vec3& p) { return 1.5 * (p.y() + 1); });
    require_sound(graded);
    std::set<long> sizes;
    for (std::size_t t = 0; t < graded.tets.size(); ++t)
        sizes.insert(std::lround(100 * std::log2(size / longest_edge(corners_of(graded, t)))));
    REQUIRE(sizes.count(0) + sizes.count(100) + sizes.count(200) + sizes.count(300) == 4);
    REQUIRE(*sizes.rbegin() == 300);
    REQUIRE(*sizes.begin() == 0);
}

TEST_CASE("propagation sets the size of the inside", "[refinement]") {
    const auto size_at_centre = [](double levels, double propagation) {
        const TetMesh mesh = refined_sphere(0.25, propagation, [&](const Vec3&) { return levels; });
        double longest = 0;
        for (std::size_t t = 0; t < mesh.tets.size(); ++t)
            if (contains(corners_of(mesh, t), Vec3(0.01, 0.02, 0.03)))
                longest = std::max(longest, longest_edge(corners_of(mesh, t)));
        return longest;
    };
    REQUIRE(size_at_centre(2, 0) == Approx(0.25));
    REQUIRE(size_at_centre(2, 0.2) == Approx(0.25));
    REQUIRE(size_at_centre(2, 0.5) == Approx(0.125));
    REQUIRE(size_at_centre(1.5, 0.5) == Approx(0.125)); // 1.5 is rounded up before
    REQUIRE(size_at_centre(2, 1) == Approx(0.0625));
    REQUIRE(size_at_centre(1, 0.5) == Approx(0.125)); // halves round up
    REQUIRE(size_at_centre(1, 0.49) == Approx(0.25));
}

TEST_CASE("any paint gives a sound lattice that covers the solid's own volume", "[refinement]") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(0, 1);
    const SurfaceMesh meshes[] = {make_sphere(1, 12, 12), make_helix(1, 0.3, 1.5, 1.5, 10, 20),
                                  make_cube(1, 0.5, 2, 2, 3, 4),
                                  read_surface(SINEW_SOURCE_DIR "/graphs/scenes/arm_ziva/muscles/biceps.obj")};
    for (int trial = 0; trial < 24; ++trial) {
        const SurfaceMesh& mesh = meshes[trial % 4];
        LatticeOptions options;
        options.least_coverage = 0;
        options.tet_size = bounding_box(mesh.points).size().maxCoeff() / (2 + 3 * u(random));
        options.propagation = trial % 3 == 0 ? 0 : u(random);
        const double most = 1 + static_cast<double>(random() % 3), share = u(random);
        for (std::size_t v = 0; v < mesh.points.size(); ++v)
            options.refinement.push_back(u(random) < 0.3 * share ? most * u(random) : 0);
        const TetMesh lattice = make_lattice(mesh.points, mesh.triangles, options);
        CAPTURE(trial, lattice.tets.size());
        require_sound(lattice);
        if (lattice.tets.size() < 4000) require_no_hidden_border(lattice);
        REQUIRE(covered_volume(lattice) == Approx(enclosed_volume(mesh.points, mesh.triangles)).epsilon(1e-8));
    }
}

TEST_CASE("an open surface is refined too, and its covered volume settles", "[refinement]") {
    const SurfaceMesh open = cup();
    double volume[2];
    for (int k = 0; k < 2; ++k) {
        LatticeOptions options;
        options.tet_size = 0.6;
        options.least_coverage = 0;
        for (const Vec3& p : open.points) options.refinement.push_back(p.x() > 0.2 ? k : 0);
        const TetMesh lattice = make_lattice(open.points, open.triangles, options);
        require_sound(lattice);
        volume[k] = covered_volume(lattice);
    }
    REQUIRE(volume[1] == Approx(volume[0]).epsilon(0.01));
}

TEST_CASE("a refined lattice has the same bits on one thread and on many", "[refinement]") {
    const auto make = [] {
        return refined_sphere(0.4, 0.7, [](const Vec3& p) { return 3 * std::abs(std::sin(7 * p.x() + 3 * p.y())); });
    };
    TetMesh one;
    {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
        one = make();
    }
    const TetMesh many = make();
    REQUIRE(one.tets.size() > 5000);
    REQUIRE(one.vertices == many.vertices);
    REQUIRE(one.tets == many.tets);
    REQUIRE(one.coverage == many.coverage);
}

TEST_CASE("refinement that cannot be used is refused with its code", "[refinement]") {
    LatticeOptions options;
    std::string message;
    options.refinement = {1, 0, 1};
    REQUIRE(code_of(options, &message) == "FE204");
    REQUIRE(message == "3 refinement levels for a mesh of 8 vertices");
    for (double bad : {-1.0, std::nan(""), HUGE_VAL}) {
        options.refinement = {bad};
        REQUIRE(code_of(options) == "FE222");
    }
    options.refinement = {1};
    for (double bad : {-0.1, 1.1, std::nan("")}) {
        options.propagation = bad;
        REQUIRE(code_of(options) == "FE222");
    }
    options.propagation = 0;
    // The limit counts the finest cubes: 3 / 0.25 = 12, refined three times 96.
    options.tet_size = 0.25;
    options.max_resolution = 96;
    options.refinement = {3};
    REQUIRE(code_of(options) == "none");
    options.max_resolution = 95;
    REQUIRE(code_of(options, &message) == "FE210");
    REQUIRE(message.find("96 cubes along the longest side of 3, with a tet size of 0.25, refined 3 times; the limit is "
                         "95") != std::string::npos);
    options.max_resolution = 1 << 30;
    options.refinement = {60};
    REQUIRE(code_of(options) == "FE210");
}

TEST_CASE("refinement stops at the number of tets that it is allowed", "[refinement]") {
    const SurfaceMesh sphere = make_sphere(1, 20, 20);
    const Solid solid = make_solid(sphere.points, sphere.triangles);
    const BccGrid grid = make_bcc_grid(Vec3::Zero(), Vec3(2, 2, 2), 0.5);
    const CoarseCells coarse = find_coarse_cells(solid, grid, false, {});
    const auto made = [&](double levels, std::int64_t most) {
        const Paint paint(solid, {levels}, 0);
        return refine_cells(solid, grid, coarse, paint, {false, most}, {}).pieces.size();
    };
    REQUIRE(made(0, 100) > 500); // the limit is on refining
    REQUIRE(made(2, 100000) > 10000);
    try {
        made(2, 5000);
        FAIL("no error");
    } catch (const Error& e) {
        REQUIRE(e.code == "FE210");
        REQUIRE(std::string(e.what()) == "the refined lattice would have more than 5000 tets");
    }
}

TEST_CASE("paint that asks for too many tets by itself is refused before any is made", "[refinement]") {
    const SurfaceMesh sphere = make_sphere(1, 20, 20);
    const Solid solid = make_solid(sphere.points, sphere.triangles);
    const BccGrid grid = make_bcc_grid(Vec3::Zero(), Vec3(2, 2, 2), 0.5);
    const CoarseCells coarse = find_coarse_cells(solid, grid, false, {});
    std::vector<double> half(solid.points.size());
    for (std::size_t v = 0; v < half.size(); ++v) half[v] = solid.points[v].x() > 0 ? 4 : 0;
    for (const std::vector<double>& levels : {std::vector<double>{4}, half}) {
        const Paint paint(solid, levels, 0);
        const auto phases_of = [&](std::int64_t most) {
            std::set<std::string> phases;
            const MeshingControl control{{}, [&](double, std::string_view what) { phases.emplace(what); }};
            try {
                refine_cells(solid, grid, coarse, paint, {false, most}, control);
                phases.insert("done");
            } catch (const Error& e) {
                REQUIRE(std::string(e.what()) ==
                        "the refined lattice would have more than " + std::to_string(most) + " tets");
            }
            return phases;
        };
        REQUIRE(phases_of(50000) == std::set<std::string>{"counting the tets"});
        REQUIRE(phases_of(5'000'000).contains("done"));
    }
}

TEST_CASE("refinement is refused early by a count that never exceeds what would be made", "[refinement]") {
    const SurfaceMesh sphere = make_sphere(1, 10, 8), open = cup();
    for (const SurfaceMesh& surface : {sphere, open}) {
        const Solid solid = make_solid(surface.points, surface.triangles);
        const BccGrid grid = make_bcc_grid(Vec3::Zero(), Vec3(2, 2, 2), 0.5);
        std::vector<double> half, rising;
        for (const Vec3& p : solid.points) half.push_back(p.x() > 0 ? 3 : 0), rising.push_back(1.4 * (1 + p.y()));
        for (const bool is_surface_only : {false, true})
            for (const std::vector<double>& levels : {std::vector<double>{2}, half, rising})
                for (const double propagation : {0.0, 1.0}) {
                    // Shares of open surfaces take long.
                    if (!solid.is_closed && (is_surface_only || levels != rising || propagation == 0)) continue;
                    INFO(solid.is_closed << is_surface_only << levels.size() << " " << levels[0] << " " << propagation);
                    const CoarseCells coarse = find_coarse_cells(solid, grid, is_surface_only, {});
                    const Paint paint(solid, levels, propagation);
                    const auto cells = [&](std::int64_t most) {
                        return refine_cells(solid, grid, coarse, paint, {is_surface_only, most, 1, true}, {}).cells;
                    };
                    const auto corners = lattice_corners(solid, grid);
                    const RefinedCount count{solid, grid, coarse, paint, corners, is_surface_only};
                    const std::int64_t made = cells(1 << 30);
                    for (const int part : {2, 5, 8}) CHECK(count.at_least(made * part / 8, {}) <= made);
                    CHECK(cells(made) == made);
                    REQUIRE_THROWS_AS(cells(made - 1), Error);
                    CHECK(count.at_least(made / 5, {}) > made / 5);
                }
    }
}

TEST_CASE("paint that asks for too many tets inside is refused before any is made", "[refinement]") {
    const SurfaceMesh cylinder = make_cylinder(2, 12, 12, 8, 1);
    LatticeOptions options;
    options.tet_size = 2; // hardly a tet that the surface does not touch
    options.refinement = {6};
    options.propagation = 1;
    options.max_resolution = 100000;
    std::set<std::string> phases;
    MeshingControl control;
    control.progress = [&](double, std::string_view what) { phases.emplace(what); };
    try {
        make_lattice(cylinder.points, cylinder.triangles, options, control);
        FAIL("no error");
    } catch (const Error& e) {
        CHECK(e.code == "FE210");
        CHECK(std::string(e.what()) == "the refined lattice would have more than 20000000 tets");
    }
    CHECK(phases.contains("counting the tets"));
    CHECK_FALSE(phases.contains("refining"));
}

TEST_CASE("cutting cells pauses every few thousand of them, and stops where the pause says so", "[refinement]") {
    const BccGrid grid = make_bcc_grid(Vec3::Zero(), Vec3(2, 2, 2), 0.5);
    std::vector<std::int64_t> roots;
    for (std::int64_t tet = 0; tet < grid.tet_count(); ++tet)
        if (grid.holds(tet)) roots.push_back(tet);
    const auto cut_twice = [&](const std::function<void()>& pause) {
        RedGreen cells(grid, roots);
        cells.refine(
            [&](int level, std::size_t first) {
                const std::size_t count = cells.levels()[at(level)].cells.size() - first;
                return std::vector(count, level < 2 ? RedGreen::Verdict::split : RedGreen::Verdict::keep);
            },
            pause);
        return cells.levels()[2].cells.size();
    };
    std::size_t pauses = 0;
    const std::size_t finest = cut_twice([&] { ++pauses; });
    REQUIRE(finest == 64 * roots.size());
    CHECK(4096 * (pauses + 1) > finest); // each was judged, most settled too
    REQUIRE(pauses > 10);
    std::size_t left = 5;
    REQUIRE_THROWS_AS(cut_twice([&] {
                          if (--left == 0) throw Stopped();
                      }),
                      Stopped);
    CHECK(left == 0);
}

TEST_CASE("meshing reports how far it is and stops when asked", "[refinement]") {
    const SurfaceMesh sphere = make_sphere(1, 20, 20);
    LatticeOptions options;
    options.tet_size = 0.3;
    options.refinement = {1};
    std::vector<double> done;
    std::set<std::string> phases;
    MeshingControl control;
    control.progress = [&](double d, std::string_view what) { done.push_back(d), phases.emplace(what); };
    const TetMesh mesh = make_lattice(sphere.points, sphere.triangles, options, control);
    REQUIRE(done.size() > 20);
    REQUIRE(std::is_sorted(done.begin(), done.end()));
    REQUIRE(done.front() == 0);
    REQUIRE(done.back() == 1);
    REQUIRE(phases.size() == 5);
    const std::size_t reports = done.size();
    for (std::size_t calls = 0; calls < reports; calls += 3) {
        std::size_t count = 0;
        control.stop = [&] { return count++ == calls; };
        REQUIRE_THROWS_AS(make_lattice(sphere.points, sphere.triangles, options, control), Stopped);
    }
    // A stop that never comes changes nothing.
    control.stop = [] { return false; };
    REQUIRE(make_lattice(sphere.points, sphere.triangles, options, control).coverage == mesh.coverage);
}
