// Integrals over the part of a tet that is solid, against values known otherwise.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/closest_point.h"
#include "solver/mesh/primitives.h"
#include "solver/meshing/lattice.h"
#include "solver/meshing/tet_quadrature.h"
#include "tests/support/rotated_box.h"

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

using namespace sinew::solver;
using sinew::test::RotatedBox;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

TetMesh lattice_of(const SurfaceMesh& mesh, double size, int degree, std::vector<double> refinement = {}) {
    LatticeOptions options;
    options.tet_size = size;
    options.least_coverage = 0;
    options.moments = degree;
    options.refinement = std::move(refinement);
    return make_lattice(mesh.points, mesh.triangles, options);
}

double multinomial(const std::array<int, 4>& e) {
    constexpr double factorial[5] = {1, 1, 2, 6, 24};
    return 24 / (factorial[e[0]] * factorial[e[1]] * factorial[e[2]] * factorial[e[3]]);
}

/// Integral of (n . x + c)^4 over the solid part of all tets of a lattice of degree 4.
double quartic_integral(const TetMesh& mesh, const Vec3& n, double c) {
    double sum = 0;
    std::size_t next = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        std::array<Vec3, 4> p;
        double value[4];
        for (std::size_t k = 0; k < 4; ++k) p[k] = mesh.vertices[at(mesh.tets[t][k])], value[k] = n.dot(p[k]) + c;
        TetMoments moments = whole_moments(4);
        if (next < mesh.cut.tets.size() && mesh.cut.tets[next] == static_cast<int>(t))
            std::copy_n(mesh.cut.of(next++), most_moments, moments.value.begin());
        double integral = 0;
        for (std::size_t m = 0; m < most_moments; ++m) {
            double term = multinomial(quartic_exponents[m]) * moments.value[m];
            for (std::size_t k = 0; k < 4; ++k) term *= std::pow(value[k], quartic_exponents[m][k]);
            integral += term;
        }
        sum += tet_volume(p[0], p[1], p[2], p[3]) * integral;
    }
    REQUIRE(next == mesh.cut.tets.size());
    return sum;
}

/// The same over what a closed surface encloses: over each tet of a triangle and the origin, the mean of a power of a
/// linear function is the sum of all products of its corner values over their number.
double enclosed_integral(const SurfaceMesh& mesh, const Vec3& n, double c) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 &p = mesh.points[at(t[0])], &q = mesh.points[at(t[1])], &r = mesh.points[at(t[2])];
        const double a[4] = {c, n.dot(p) + c, n.dot(q) + c, n.dot(r) + c};
        double products = 0;
        for (int i = 0; i <= 4; ++i)
            for (int j = 0; i + j <= 4; ++j)
                for (int k = 0; i + j + k <= 4; ++k)
                    products +=
                        std::pow(a[0], i) * std::pow(a[1], j) * std::pow(a[2], k) * std::pow(a[3], 4 - i - j - k);
        sum += p.dot(q.cross(r)) / 6 * products / 35;
    }
    return sum;
}

/// (n . x + c)^4 over the box, by Gauss' rule of three points along each side, which is exact to degree 5.
double box_integral(const RotatedBox& box, const Vec3& n, double c) {
    constexpr double place[3] = {-0.7745966692414834, 0, 0.7745966692414834},
                     weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    double sum = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k) {
                const Vec3 local = 0.5 * (Vec3(place[i] + 1, place[j] + 1, place[k] + 1)).cwiseProduct(box.size);
                sum += weight[i] * weight[j] * weight[k] * std::pow(n.dot(box.at(local)) + c, 4);
            }
    return sum * box.size.prod();
}

Points directions() {
    return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.6, 0.8, 0}, {0.5, -0.7, 0.4}, {-0.3, 0.2, 0.9}, {0.8, 0.1, -0.5}};
}

} // namespace

TEST_CASE("moments of a tet within a tet are those of the formula", "[moments]") {
    const TetMoments whole = whole_moments(4);
    CHECK(whole.volume() == Approx(1).epsilon(1e-15));
    CHECK(whole.value[quartic_index(0, 0, 0, 0)] == Approx(24 * 6 / 5040.0).epsilon(1e-15));
    CHECK(whole.value[quartic_index(2, 0, 1, 3)] == Approx(6 / 5040.0).epsilon(1e-15));
    TetMoments added;
    added.add({{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}, 1);
    for (std::size_t m = 0; m < most_moments; ++m) CHECK(added.value[m] == Approx(whole.value[m]).epsilon(1e-14));

    // The corner of half the size at corner 2: l_i = l'_i / 2 for the others.
    TetMoments corner, first;
    first.degree = 1;
    const std::array<Barycentric, 4> piece{{{0.5, 0, 0.5, 0}, {0, 0.5, 0.5, 0}, {0, 0, 1, 0}, {0, 0, 0.5, 0.5}}};
    corner.add(piece, 0.125), first.add(piece, 0.125);
    CHECK(corner.value[quartic_index(0, 0, 1, 3)] == Approx(0.125 * 2 * 6 / 5040.0 / 16).epsilon(1e-13));
    const MomentTensors tensors(corner.value.data());
    CHECK(tensors.volume == Approx(0.125).epsilon(1e-14));
    CHECK(tensors.second[0][3] == Approx(0.125 * 6 / 120.0 / 4).epsilon(1e-13));
    CHECK(tensors.third[0][1][3] == Approx(0.125 * 6 / 720.0 / 8).epsilon(1e-13));
    for (std::size_t c = 0; c < 4; ++c) {
        CHECK(tensors.first[c] == Approx(0.125 * (c == 2 ? 0.625 : 0.125)).epsilon(1e-14));
        CHECK(first.value[c] == Approx(tensors.first[c]).epsilon(1e-14));
    }
    CHECK(first.volume() == Approx(0.125).epsilon(1e-15));
}

TEST_CASE("polynomials up to degree 4 over a turned box come out exactly", "[moments][lattice]") {
    for (const double size : {0.11, 0.05, 0.024}) {
        const RotatedBox box({0.1, 0.07, 0.23}, 30, 30);
        const TetMesh mesh = lattice_of(box.surface(1), size, 4);
        CHECK(mesh.cut.tets.size() > mesh.tets.size() / 8);
        for (const Vec3& n : directions())
            for (const double c : {0.0, 0.3}) {
                CAPTURE(size, n, c);
                CHECK(quartic_integral(mesh, n, c) == Approx(box_integral(box, n, c)).epsilon(1e-11));
            }
    }
}

TEST_CASE("and over a ball of triangles, refined or not, whatever the numbering", "[moments][lattice]") {
    const SurfaceMesh ball = make_sphere(1, 20, 20);
    std::vector<double> paint(ball.points.size());
    for (std::size_t v = 0; v < paint.size(); ++v) paint[v] = ball.points[v].x() > 0.3 ? 2 : 0;
    for (const bool refined : {false, true}) {
        const TetMesh mesh = lattice_of(ball, 0.5, 4, refined ? paint : std::vector<double>{});
        for (const Vec3& n : directions())
            CHECK(quartic_integral(mesh, n, 0.2) == Approx(enclosed_integral(ball, n, 0.2)).epsilon(1e-11));
    }
    // Triangles in another order and turned, vertices numbered backwards.
    SurfaceMesh other = ball;
    std::reverse(other.points.begin(), other.points.end());
    std::reverse(other.triangles.begin(), other.triangles.end());
    for (Triangle& t : other.triangles) {
        for (int& v : t) v = static_cast<int>(ball.points.size()) - 1 - v;
        std::rotate(t.begin(), t.begin() + 1, t.end());
    }
    const TetMesh a = lattice_of(ball, 0.5, 4), b = lattice_of(other, 0.5, 4);
    REQUIRE(a.cut.tets == b.cut.tets);
    for (std::size_t i = 0; i < a.cut.moments.size(); ++i)
        REQUIRE(a.cut.moments[i] == Approx(b.cut.moments[i]).margin(1e-14));
}

TEST_CASE("each tet's moments agree with random points", "[moments][lattice]") {
    const SurfaceMesh helix = make_helix(1, 0.35, 1.5, 1.5, 12, 30);
    const TetMesh mesh = lattice_of(helix, 0.6, 4);
    const SurfaceTree tree(helix.points, helix.triangles);
    std::mt19937 random(5);
    std::exponential_distribution<double> exponential;
    const int samples = 4000;
    for (std::size_t k = 0; k < mesh.cut.tets.size(); k += 17) {
        const Tet& tet = mesh.tets[at(mesh.cut.tets[k])];
        const MomentTensors exact(mesh.cut.of(k));
        double first[4] = {}, second[4][4] = {};
        for (int s = 0; s < samples; ++s) {
            double b[4], sum = 0;
            for (double& x : b) sum += x = exponential(random);
            Vec3 p = Vec3::Zero();
            for (std::size_t c = 0; c < 4; ++c) b[c] /= sum, p += b[c] * mesh.vertices[at(tet[c])];
            if (!tree.inside_either_way(p)) continue;
            for (int i = 0; i < 4; ++i) {
                first[i] += b[i] / samples;
                for (int j = 0; j < 4; ++j) second[i][j] += b[i] * b[j] / samples;
            }
        }
        for (int i = 0; i < 4; ++i) {
            REQUIRE(first[i] == Approx(exact.first[i]).margin(0.025));
            for (int j = 0; j < 4; ++j) REQUIRE(second[i][j] == Approx(exact.second[i][j]).margin(0.02));
        }
    }
}

TEST_CASE("moments of degree 1 and 4 agree and sum to the coverage, with holes and crossing parts too", "[moments]") {
    SurfaceMesh holed = make_sphere(1, 20, 20), crossing = make_sphere(1, 20, 20);
    std::erase_if(holed.triangles, [&](const Triangle& t) { return holed.points[at(t[0])].x() > 0.55; });
    holed = SurfaceMesh::from_triangles(holed.points, holed.triangles);
    const int n = static_cast<int>(crossing.points.size());
    for (int v = 0; v < n; ++v) crossing.points.push_back(crossing.points[at(v)] + Vec3(0.7, 0.31, 0.2));
    for (std::size_t t = 0, count = crossing.triangles.size(); t < count; ++t) {
        const Triangle old = crossing.triangles[t];
        crossing.triangles.push_back({old[0] + n, old[1] + n, old[2] + n});
    }
    crossing = SurfaceMesh::from_triangles(crossing.points, crossing.triangles);
    for (const SurfaceMesh& surface : {make_helix(1, 0.35, 1.5, 1.5, 12, 30), holed, crossing}) {
        const TetMesh linear = lattice_of(surface, 0.33, 1), quartic = lattice_of(surface, 0.33, 4);
        REQUIRE(linear.cut.tets == quartic.cut.tets);
        REQUIRE(linear.coverage == quartic.coverage);
        CHECK(linear.cut.degree == 1);
        CHECK(linear.cut.moments.size() == 4 * linear.cut.tets.size());
        std::size_t cut = 0;
        for (std::size_t t = 0; t < linear.tets.size(); ++t) cut += linear.coverage[t] < 1;
        REQUIRE(cut == linear.cut.tets.size());
        for (std::size_t k = 0; k < cut; ++k) {
            const double coverage = linear.coverage[at(linear.cut.tets[k])];
            const MomentTensors tensors(quartic.cut.of(k));
            REQUIRE(tensors.volume == Approx(coverage).margin(1e-13));
            double sum = 0;
            for (std::size_t c = 0; c < 4; ++c) {
                const double first = linear.cut.of(k)[c];
                sum += first;
                REQUIRE(first == Approx(tensors.first[c]).margin(1e-13));
                REQUIRE(first > -1e-14);
            }
            REQUIRE(sum == Approx(coverage).margin(1e-13));
        }
    }
}

TEST_CASE("the part of a tet where a linear function is positive has the moments of its pieces", "[moments]") {
    // l_0 > 1/4 cuts off a corner of 27/64; the other ways round are its complements.
    const std::array<Barycentric, 4> corners = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    TetMoments corner, rest, low, high;
    add_positive_part({0.75, -0.25, -0.25, -0.25}, corners, 1, corner);
    add_positive_part({-0.75, 0.25, 0.25, 0.25}, corners, 1, rest);
    CHECK(corner.volume() == Approx(27 / 64.0).epsilon(1e-14));
    add_positive_part({0.6, -0.2, 0.3, -0.4}, corners, 1, low);
    add_positive_part({-0.6, 0.2, -0.3, 0.4}, corners, 1, high);
    CHECK(low.volume() == Approx(positive_share({0.6, -0.2, 0.3, -0.4})).epsilon(1e-14));
    const TetMoments whole = whole_moments(4);
    for (std::size_t m = 0; m < most_moments; ++m) {
        CHECK(corner.value[m] + rest.value[m] == Approx(whole.value[m]).epsilon(1e-13));
        CHECK(low.value[m] + high.value[m] == Approx(whole.value[m]).epsilon(1e-13));
    }
    CHECK(MomentTensors(corner.value.data()).first[0] == Approx(27 / 64.0 * (0.25 + 0.75 / 4)).epsilon(1e-13));
}

TEST_CASE("moments have the same bits for one thread and many", "[moments][lattice]") {
    const SurfaceMesh helix = make_helix(1, 0.35, 1.5, 1.5, 12, 30);
    const TetMesh many = lattice_of(helix, 0.25, 4);
    tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    CHECK(lattice_of(helix, 0.25, 4).cut == many.cut);
}
