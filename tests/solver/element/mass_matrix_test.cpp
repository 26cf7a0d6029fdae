// Masses: entries against integrals in closed form, momentum and kinetic energy of known motions, and the inverse.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/mass_matrix.h"
#include "tests/support/solver_scenes.h"

#include <array>
#include <catch2/catch.hpp>
#include <map>
#include <numeric>
#include <set>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

/// A polynomial in barycentric coordinates: powers -> factor.
using Polynomial = std::map<std::array<int, 4>, double>;

Polynomial product(const Polynomial& a, const Polynomial& b) {
    Polynomial out;
    for (const auto& [p, x] : a)
        for (const auto& [q, y] : b) out[{p[0] + q[0], p[1] + q[1], p[2] + q[2], p[3] + q[3]}] += x * y;
    return out;
}

/// Mean over a tet: of l0^a l1^b l2^c l3^d it is 6 a! b! c! d! / (a + b + c + d + 3)!.
double mean(const Polynomial& f) {
    const auto factorial = [](int n) {
        double out = 1;
        for (int i = 2; i <= n; ++i) out *= i;
        return out;
    };
    double out = 0;
    for (const auto& [p, x] : f)
        out += x * 6 * factorial(p[0]) * factorial(p[1]) * factorial(p[2]) * factorial(p[3]) /
               factorial(p[0] + p[1] + p[2] + p[3] + 3);
    return out;
}

/// Shape functions of the ten-node tet: l (2 l - 1) at corners, 4 l m at the middles of edges.
Polynomial shape(int node) {
    std::array<int, 4> one{}, two{};
    if (node < 4) {
        one[std::size_t(node)] = 1, two[std::size_t(node)] = 2;
        return {{two, 2.0}, {one, -1.0}};
    }
    const int* edge = tet_edge_corners[node - 4];
    ++one[std::size_t(edge[0])], ++one[std::size_t(edge[1])];
    return {{one, 4.0}};
}

/// The masses of one tissue with density 1: a scene, all couplings of its elements, and the masses on them.
struct Masses {
    std::shared_ptr<TissueRest> rest;
    std::unique_ptr<Scene> scene;
    BlockPattern pattern;
    MassMatrix m;
    std::vector<Vec3> nodes; ///< rest positions of all vertices

    Masses(const TetMesh& mesh, ElementKind kind, std::vector<int> held = {}) {
        rest = tissue(mesh, ElasticLaw::stvk);
        rest->element = kind;
        rest->fixed_vertices = std::move(held);
        scene = std::make_unique<Scene>(SceneDescription{{rest}, {}});
        const Scene::System& system = scene->system();
        std::vector<std::pair<int, int>> couplings;
        std::vector<double> of_tet;
        for (const TissueBatches& t : system.tissues)
            for (std::size_t slot = 0; slot < t.batch_count * lanes; ++slot) {
                of_tet.push_back(system.batches[slot / lanes].volume[slot % lanes]);
                for (int a = 0; a < t.nodes(); ++a)
                    for (int b = 0; b < t.nodes(); ++b) {
                        const int
                            i = system.numbering.unknown[std::size_t(system.node(t, slot / lanes, a)[slot % lanes])],
                            j = system.numbering.unknown[std::size_t(system.node(t, slot / lanes, b)[slot % lanes])];
                        if (i >= 0 && j >= 0) couplings.emplace_back(i, j);
                    }
            }
        pattern = make_pattern(static_cast<int>(system.numbering.vertex_of_unknown.size()), couplings);
        m.start(system.numbering, pattern);
        m.add_tets(system, of_tet);
        nodes = mesh.vertices;
        if (kind == ElementKind::quadratic)
            for (const auto& [a, b] : edges_of(mesh.tets))
                nodes.push_back(0.5 * (mesh.vertices[std::size_t(a)] + mesh.vertices[std::size_t(b)]));
    }
    /// A field at the unknowns, 3 numbers each.
    std::vector<double> field(const std::function<Vec3(const Vec3&)>& f) const {
        std::vector<double> out;
        for (const int v : scene->numbering().vertex_of_unknown) {
            const Vec3 u = f(nodes[std::size_t(v)]);
            out.insert(out.end(), {u.x(), u.y(), u.z()});
        }
        return out;
    }
    double product(const std::vector<double>& a, const std::vector<double>& b) const {
        std::vector<double> mb;
        m.multiply(b, mb);
        return std::inner_product(a.begin(), a.end(), mb.begin(), 0.0);
    }
};

/// One tet in which nothing is alike.
TetMesh skew_tet() {
    TetMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0.1, 0}, {0.2, 0.9, -0.1}, {0.1, 0.3, 0.8}};
    mesh.tets = {{0, 1, 2, 3}};
    return mesh;
}
double volume(const TetMesh& mesh) {
    Mat3 edges;
    for (int i = 0; i < 3; ++i) edges.col(i) = mesh.vertices[std::size_t(i) + 1] - mesh.vertices[0];
    return edges.determinant() / 6;
}

} // namespace

TEST_CASE("the consistent mass matrix of a ten-node tet is the integral of its shape functions' products", "[mass]") {
    const TetMesh mesh = skew_tet();
    const Masses masses(mesh, ElementKind::quadratic);
    const Scene::System& system = masses.scene->system();
    BlockMatrix a(masses.pattern);
    masses.m.add_to(a, 1);
    std::set<std::pair<int, int>> seen;
    for (int n = 0; n < 10; ++n)
        for (int k = 0; k < 10; ++k) {
            const int i = system.numbering.unknown[std::size_t(system.node(system.tissues[0], 0, n)[0])],
                      j = system.numbering.unknown[std::size_t(system.node(system.tissues[0], 0, k)[0])];
            if (i > j) continue;
            seen.insert({i, j});
            const double* block = a.block(std::size_t(masses.pattern.find(i, j)));
            const double expected = volume(mesh) * mean(product(shape(n), shape(k)));
            INFO(n << " " << k);
            for (int c = 0; c < 9; ++c) CHECK(block[c] == Approx(c % 4 ? 0 : expected).margin(1e-16));
        }
    CHECK(seen.size() == 55);
    // What weighs at a node is the integral of its shape function.
    for (int n = 0; n < 10; ++n)
        CHECK(masses.m.weight()[std::size_t(system.node(system.tissues[0], 0, n)[0])] ==
              Approx(volume(mesh) * mean(shape(n))));
}

TEST_CASE("a linear tet has a quarter of its mass at each vertex", "[mass]") {
    const TetMesh mesh = skew_tet();
    const Masses masses(mesh, ElementKind::linear);
    for (const double w : masses.m.weight()) CHECK(w == Approx(volume(mesh) / 4));
    BlockMatrix a(masses.pattern);
    masses.m.add_to(a, 3);
    for (int i = 0; i < 4; ++i)
        for (int j = i; j < 4; ++j)
            for (int c = 0; c < 9; ++c)
                CHECK(a.block(std::size_t(masses.pattern.find(i, j)))[c] ==
                      Approx(i == j && c % 4 == 0 ? 0.75 * volume(mesh) : 0).margin(1e-16));
}

TEST_CASE("a box weighs what it should, and moves with its momentum and kinetic energy", "[mass]") {
    const Vec3 size(0.4, 0.2, 0.3);
    const double mass = 0.4 * 0.2 * 0.3;
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        const Masses masses(box_mesh(size, 3, 2, 2), kind);
        CHECK(std::accumulate(masses.m.weight().begin(), masses.m.weight().end(), 0.0) == Approx(mass));
        const auto still = masses.field([](const Vec3&) { return Vec3(1, 0, 0); });
        CHECK(masses.product(still, still) == Approx(mass));
        const auto strain = masses.field([](const Vec3& p) { return Vec3(0, p.x(), 0); });
        const auto across = masses.field([](const Vec3&) { return Vec3(0, 1, 0); });
        CHECK(masses.product(across, strain) == Approx(mass * 0.2)); // the middle's speed
        if (kind == ElementKind::linear) continue;
        // Twice the energy of x -> (0, x, 0), of x -> (0, x^2, 0), and of a turn about z: moments of the box.
        CHECK(masses.product(strain, strain) == Approx(mass * 0.4 * 0.4 / 3));
        const auto bent = masses.field([](const Vec3& p) { return Vec3(0, p.x() * p.x(), 0); });
        CHECK(masses.product(bent, bent) == Approx(mass * std::pow(0.4, 4) / 5));
        const auto turn = masses.field([](const Vec3& p) { return Vec3(-p.y(), p.x(), 0); });
        CHECK(masses.product(turn, turn) == Approx(mass * (0.4 * 0.4 + 0.2 * 0.2) / 3));
    }
}

TEST_CASE("solving with masses undoes the product, also where vertices are held", "[mass]") {
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        const Masses masses(box_mesh({0.4, 0.2, 0.3}, 3, 2, 2), kind, {0, 3, 4});
        CHECK(masses.pattern.rows == static_cast<int>(masses.nodes.size()) - 3);
        std::vector<double> u(std::size_t(3 * masses.pattern.rows)), f, back;
        for (std::size_t i = 0; i < u.size(); ++i) u[i] = std::sin(1.7 * static_cast<double>(i));
        masses.m.multiply(u, f);
        masses.m.solve(f, back);
        double worst = 0;
        for (std::size_t i = 0; i < u.size(); ++i) worst = std::max(worst, std::abs(back[i] - u[i]));
        CHECK(worst < 1e-12);
        // Held vertices weigh too: their weight is part of the whole.
        CHECK(std::accumulate(masses.m.weight().begin(), masses.m.weight().end(), 0.0) == Approx(0.4 * 0.2 * 0.3));
    }
}
