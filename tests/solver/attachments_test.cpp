// Attachments against what they stand for: a held face, a spring bed, a painted part of a target.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/primitives.h"
#include "solver/meshing/lattice.h"
#include "solver/newton/potential.h"
#include "solver/terms/attachment/anchors.h"
#include "solver/terms/attachment/springs.h"
#include "tests/support/lattice_tissue.h"
#include "tests/support/solver_scenes.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <random>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

constexpr ElementKind kinds[] = {ElementKind::linear, ElementKind::quadratic};

std::size_t at(int i) { return static_cast<std::size_t>(i); }
bool at_root(const Vec3& p) { return p.x() < 1e-9; }

/// A large plate in the plane x = 0.
Points wall() { return {{0, -1, -1}, {0, 2, -1}, {0, 2, 2}, {0, -1, 2}}; }
std::shared_ptr<BoneRest> wall_bone() { return bone(wall(), {{0, 2, 1}, {0, 3, 2}}); }

std::vector<double> paint_vertices(const Points& points, const std::function<bool(const Vec3&)>& where) {
    std::vector<double> out(points.size(), 0.0);
    for (const int v : vertices_where(points, where)) out[at(v)] = 1;
    return out;
}

std::vector<double> paint_faces(const Points& points, const std::vector<Triangle>& triangles,
                                const std::function<bool(const Vec3&)>& where) {
    std::vector<double> out;
    for (const Triangle& t : triangles)
        out.push_back(std::all_of(t.begin(), t.end(), [&](int v) { return where(points[at(v)]); }));
    return out;
}

/// The same mesh, its vertices and tets in another order.
TetMesh shuffled(TetMesh mesh, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<int> order(mesh.vertices.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    Points vertices(mesh.vertices.size());
    for (std::size_t v = 0; v < order.size(); ++v) vertices[at(order[v])] = mesh.vertices[v];
    for (Tet& t : mesh.tets) {
        for (int& v : t) v = order[at(v)];
        std::rotate(t.begin(), t.begin() + 1, t.begin() + 3); // an even permutation
    }
    std::shuffle(mesh.tets.begin(), mesh.tets.end(), random);
    mesh.vertices = vertices;
    return mesh;
}

/// Sinking of the far lower edge's vertices of a bar under gravity, its tissue held as the description says.
double sag(const SceneDescription& d, const StepInputs& with_attachments) {
    StepInputs in = with_attachments;
    in.integrator = Integrator::quasi_static;
    in.gravity = Vec3(0, 0, -9.8);
    in.max_newton_iterations = 100;
    in.tolerance_factor = 1e-2;
    const auto scene = std::make_shared<const Scene>(d);
    Workspace w(scene);
    const State s = settle(w, initial_state(*scene, in), in);
    const TissueRest& t = *scene->tissue(0);
    const Points now = surface_positions(*scene, s, 0);
    const Vec3 size = bounding_box(t.surface).max;
    double sum = 0, count = 0;
    for (std::size_t v = 0; v < now.size(); ++v)
        if (t.surface[v].x() > size.x() - 1e-9) sum += t.surface[v].z() - now[v].z(), ++count;
    return sum / count;
}

StepInputs bar_inputs() {
    StepInputs in = still_inputs();
    in.bodies = {material(3e5, 0.3, 1060)};
    return in;
}

double clamped(const TetMesh& mesh, ElementKind kind) {
    auto t = tissue(mesh, ElasticLaw::stvk);
    t->element = kind;
    Points nodes = mesh.vertices;
    if (kind == ElementKind::quadratic)
        for (const auto& [a, b] : edges_of(mesh.tets))
            nodes.push_back(0.5 * (mesh.vertices[at(a)] + mesh.vertices[at(b)]));
    t->fixed_vertices = vertices_where(nodes, at_root);
    return sag({{t}, {}}, bar_inputs());
}

/// Held at the face x = 0 by springs of 1e12 N/m^3: to the wall, or to the same vertices of a bone of its own shape.
double glued(std::shared_ptr<TissueRest> t, PaintedOn painted, Correspondence correspondence) {
    AttachmentRest a;
    a.source = 0, a.target = 1;
    a.correspondence = correspondence;
    a.source_painted = painted;
    a.source_weights = painted == PaintedOn::faces ? paint_faces(t->surface, t->triangles, at_root)
                                                   : paint_vertices(t->surface, at_root);
    StepInputs in = bar_inputs();
    const bool by_id = correspondence == Correspondence::vertex_id;
    in.bodies.push_back(BoneInputs{by_id ? t->surface : wall()});
    in.attachments = {{1e12, 1, 0}};
    return sag({{t, by_id ? bone(t->surface, t->triangles) : wall_bone()}, {a}}, in);
}

std::shared_ptr<TissueRest> in_lattice(const SurfaceMesh& mesh, double tet_size, ElementKind kind) {
    return lattice_tissue(mesh, tet_size, TissueRest{}.law, kind);
}

SurfaceMesh bar_surface(int nx, int ny, int nz) {
    SurfaceMesh m = make_cube(0.4, 0.1, 0.1, nx, ny, nz);
    for (Vec3& p : m.points) p += Vec3(0.2, 0.05, 0.05);
    return m;
}

} // namespace

TEST_CASE("a face held by stiff springs is as good as clamped, for both elements, whatever the numbering") {
    for (const TetMesh& mesh : {box_mesh({0.4, 0.1, 0.1}, 5, 2, 2), box_mesh({0.4, 0.1, 0.1}, 2, 1, 1)})
        for (const ElementKind kind : kinds) {
            const double expected = clamped(mesh, kind);
            CHECK(expected > 0.01);
            for (const PaintedOn painted : {PaintedOn::vertices, PaintedOn::faces})
                for (const Correspondence c : {Correspondence::closest_point, Correspondence::vertex_id})
                    for (const unsigned seed : {0u, 1u, 2u}) {
                        auto t = tissue(seed ? shuffled(mesh, seed) : mesh, ElasticLaw::stvk);
                        t->element = kind;
                        INFO((kind == ElementKind::linear ? "linear, " : "quadratic, ")
                             << mesh.tets.size() << " tets, " << static_cast<int>(c) << ", numbering " << seed);
                        CHECK(glued(t, painted, c) == Approx(expected).epsilon(1e-3));
                    }
        }
}

TEST_CASE("a surface coarser than its tets is held like a fine one") {
    // Linear: the value of springs at every vertex of a surface of 290 vertices, before there were samples; the lattice
    // is too coarse for better. Quadratic: a finer mesh that fits, clamped.
    for (const auto& [kind, expected] :
         {std::pair{ElementKind::linear, 0.11086},
          {ElementKind::quadratic, clamped(box_mesh({0.4, 0.1, 0.1}, 12, 3, 3), ElementKind::quadratic)}})
        for (const auto& [nx, ny] : {std::pair{1, 1}, {3, 2}, {16, 4}, {32, 8}})
            for (const PaintedOn painted : {PaintedOn::vertices, PaintedOn::faces}) {
                INFO((kind == ElementKind::linear ? "linear, " : "quadratic, ") << nx << " x " << ny);
                CHECK(glued(in_lattice(bar_surface(nx, ny, ny), 0.05, kind), painted, Correspondence::closest_point) ==
                      Approx(expected).epsilon(0.01));
            }
}

TEST_CASE("an attachment's force does not depend on how finely the surface is cut") {
    // A ball in the same cubes, held below, is drawn at its painted top by a bone that has gone up.
    constexpr double radius = 0.1, way = 0.02, k = 1e6;
    const auto force = [&](int n, ElementKind kind) {
        auto ball = in_lattice(make_sphere(radius, 2 * n, n), 0.05, kind);
        Points nodes = ball->tets.vertices;
        if (kind == ElementKind::quadratic)
            for (const auto& [a, b] : edges_of(ball->tets.tets)) nodes.push_back(0.5 * (nodes[at(a)] + nodes[at(b)]));
        ball->fixed_vertices = vertices_where(nodes, [=](const Vec3& p) { return p.y() < -0.4 * radius; });
        AttachmentRest a;
        a.source = 0, a.target = 1;
        for (const Vec3& p : ball->surface) // fades out, so that its border is at no triangle's
            a.source_weights.push_back(std::clamp(p.y() / radius - 0.2, 0.0, 0.5) / 0.5);
        Points plate = {{-1, radius, -1}, {-1, radius, 1}, {1, radius, 1}, {1, radius, -1}};
        StepInputs in = still_inputs();
        in.integrator = Integrator::quasi_static;
        in.gravity = Vec3::Zero();
        in.bodies = {material(1e4, 0.3, 1000), BoneInputs{plate}};
        in.attachments = {{k, 1, 0}};
        const auto scene =
            std::make_shared<const Scene>(SceneDescription{{ball, bone(plate, {{0, 1, 2}, {0, 2, 3}})}, {a}});
        Workspace w(scene);
        const State start = initial_state(*scene, in);
        for (Vec3& p : std::get<BoneInputs>(in.bodies[1]).positions) p.y() += way;
        const State s = settle(w, start, in);
        double sum = 0;
        const AttachmentView kept = attachments_kept(start.memories);
        for (const Anchor& anchor : kept.anchors[0]) {
            const PointWeights p = scene->embedded(0, anchor.source.tet, anchor.source.coordinates);
            double moved = 0;
            for (int i = 0; i < p.count; ++i)
                moved += p.weight[i] * (position(s, p.vertex[i]).y() - position(start, p.vertex[i]).y());
            sum += k * anchor.area_weight * (way - moved);
        }
        return sum;
    };
    for (const ElementKind kind : kinds) {
        const double coarse = force(16, kind), fine = force(32, kind);
        INFO((kind == ElementKind::linear ? "linear: " : "quadratic: ") << coarse << " N, " << fine << " N");
        CHECK(coarse > 1);
        CHECK(coarse == Approx(fine).epsilon(0.02));
    }
}

TEST_CASE("a box that hangs by its painted top from a spring bed extends it by rho g V / (k A)") {
    const double k = 4e5, density = 1100, g = 9.8;
    const Points plate = {{-1, -1, 0.3}, {2, -1, 0.3}, {2, 2, 0.3}, {-1, 2, 0.3}};
    const auto on_top = [](const Vec3& p) { return p.z() > 0.3 - 1e-9; };
    for (const ElementKind kind : kinds)
        for (const PaintedOn painted : {PaintedOn::faces, PaintedOn::vertices}) {
            const TetMesh mesh = box_mesh({0.2, 0.1, 0.3}, 3, 2, 4);
            auto t = tissue(mesh, ElasticLaw::neo_hookean);
            t->element = kind;
            AttachmentRest a;
            a.source = 0, a.target = 1;
            a.source_painted = painted;
            a.source_weights = painted == PaintedOn::faces ? paint_faces(t->surface, t->triangles, on_top)
                                                           : paint_vertices(t->surface, on_top);
            const auto scene =
                std::make_shared<const Scene>(SceneDescription{{t, bone(plate, {{0, 1, 2}, {0, 2, 3}})}, {a}});
            StepInputs in = still_inputs();
            in.integrator = Integrator::quasi_static;
            in.gravity = Vec3(0, 0, -g);
            in.bodies = {material(2e5, 0.4, density), BoneInputs{plate}};
            in.attachments = {{k, 1, 0}};
            Workspace w(scene);
            const State start = initial_state(*scene, in), s = settle(w, start, in);
            double extension = 0, area = 0; // the mean over the samples
            const AttachmentView kept = attachments_kept(start.memories);
            for (const Anchor& anchor : kept.anchors[0]) {
                const PointWeights p = scene->embedded(0, anchor.source.tet, anchor.source.coordinates);
                double z = 0;
                for (int i = 0; i < p.count; ++i) z += p.weight[i] * position(s, p.vertex[i]).z();
                extension += anchor.area_weight * (0.3 - z);
                area += anchor.area_weight;
            }
            CHECK(area == Approx(0.02).epsilon(1e-12));
            CHECK(extension / area == Approx(density * g * 0.006 / (k * 0.02)).epsilon(1e-6));
        }
}

TEST_CASE(
    "the energy of a spring bed under an affine motion is the integral, whatever lies below or on the other side") {
    // Points of the face x = 0, 0 <= y, z <= 0.1, move by u = (p + q y + r z) e_x against a fixed bone.
    const double p = 0.003, q = 0.02, r = -0.05, b = 0.1, k = 7e6;
    const double integral =
        b * b * (p * p + p * q * b + p * r * b + q * q * b * b / 3 + r * r * b * b / 3 + q * r * b * b / 2);
    for (const ElementKind kind : kinds)
        for (const int cells : {1, 2, 5})
            for (const auto& [nx, ny] : {std::pair{1, 1}, {4, 3}, {16, 8}}) {
                auto t = in_lattice(bar_surface(nx, ny, ny), 0.1 / cells, kind);
                AttachmentRest a;
                a.source = 0, a.target = 1;
                a.source_painted = PaintedOn::faces;
                a.source_weights = paint_faces(t->surface, t->triangles, at_root);
                const Scene scene({{t, wall_bone()}, {a}});
                StepInputs in = bar_inputs();
                in.bodies.push_back(BoneInputs{wall()});
                in.attachments = {{2 * k, 0.5, 0}};
                State s = initial_state(scene, in);
                Springs springs(scene, attachments_kept(s.memories));
                ImplicitForm form;
                quasi_static_form(s, form);
                springs.begin_stage(in, s, s.bones, form);
                for (std::size_t v = 0; v < s.x.size(); v += 3) s.x[v] += p + q * s.x[v + 1] + r * s.x[v + 2];
                INFO(cells << " cells, surface of " << ny);
                CHECK(springs.energy(s.x, nullptr) == Approx(0.5 * k * integral).epsilon(2e-3));
            }
}

TEST_CASE("springs' energy by vertices is that of all samples, from rounding's distance to ten lengths away") {
    for (const double damping : {0.0, 3e4}) {
        auto t = in_lattice(bar_surface(8, 5, 5), 0.04, ElementKind::quadratic);
        AttachmentRest a;
        a.source = 0, a.target = 1;
        a.source_weights = paint_vertices(t->surface, at_root);
        const Scene scene({{t, wall_bone()}, {a}});
        StepInputs in = bar_inputs();
        in.bodies.push_back(BoneInputs{wall()});
        in.attachments = {{1e9, 0.5, damping}};
        const State s = initial_state(scene, in);
        const double step = 0.02, spring = 0.5e9, dashpot = 0.5 * damping / step;
        ImplicitForm form;
        backward_euler_form(s, step, form);
        Springs springs(scene, attachments_kept(s.memories));
        springs.begin_stage(in, s, s.bones, form);
        std::mt19937 random(2);
        std::normal_distribution<double> normal;
        std::vector<double> direction(s.x.size());
        for (double& d : direction) d = normal(random);
        // Far, near, far again, and very near: the places of expansion change in between.
        for (const double far : {1e-3, 4.0, 1e-5, 1e-2, 1e-11}) {
            std::vector<double> x(s.x), forward(s.x), back(s.x), gradient(s.x.size(), 0.0);
            for (std::size_t i = 0; i < x.size(); ++i) {
                x[i] += far * direction[i];
                forward[i] += 1.5 * far * direction[i], back[i] += 0.5 * far * direction[i];
            }
            INFO("damping " << damping << ", " << far << " m");
            // Both parts are quadratic in the same stretches, which begin at zero.
            const double expected = springs.stored_energy(x) * (1 + dashpot / spring);
            const double energy = springs.energy(x, gradient.data());
            CHECK(energy == Approx(expected).epsilon(far < 1e-10 ? 1e-4 : 1e-11));
            double slope = 0;
            for (std::size_t i = 0; i < x.size(); ++i) slope += gradient[i] * direction[i];
            const double difference = springs.stored_energy(forward) - springs.stored_energy(back);
            CHECK(slope * far == Approx(difference * (1 + dashpot / spring)).epsilon(far < 1e-10 ? 1e-4 : 1e-10));
            // The elastic forces alone: in a bed of one stiffness they are in proportion to all.
            std::vector<double> squares(2, 0.0);
            springs.add_squared_forces(x, squares);
            double all = 0;
            for (const double g : gradient) all += g * g;
            CHECK(std::sqrt(squares[0]) * (1 + dashpot / spring) == Approx(std::sqrt(all)).epsilon(1e-9));
        }
    }
}

TEST_CASE("forces between two tissues balance in sum and in moment, and are the energy's gradient") {
    for (const ElementKind kind : kinds) {
        auto below = in_lattice(bar_surface(1, 1, 1), 0.06, kind);
        auto above = tissue(box_mesh({0.3, 0.15, 0.1}, 3, 2, 2), ElasticLaw::stvk);
        for (Points* points : {&above->tets.vertices, &above->surface})
            for (Vec3& x : *points) x += Vec3(0.05, -0.02, 0.11);
        AttachmentRest a;
        a.source = 0, a.target = 1;
        a.source_weights = paint_vertices(below->surface, [](const Vec3& x) { return x.z() > 0.09; });
        const Scene scene({{below, above}, {a}});
        StepInputs in = bar_inputs();
        in.bodies.push_back(material(3e5, 0.3, 1000));
        in.attachments = {{1e6, 0.7, 0}};
        State s = initial_state(scene, in);
        Springs springs(scene, attachments_kept(s.memories));
        ImplicitForm form;
        quasi_static_form(s, form);
        springs.begin_stage(in, s, s.bones, form);
        CHECK(springs.energy(s.x, nullptr) == Approx(0).margin(1e-12)); // maintainOffset
        std::mt19937 random(5);
        std::normal_distribution<double> normal(0, 0.01);
        for (double& x : s.x) x += normal(random);
        std::vector<double> gradient(s.x.size(), 0.0);
        const double energy = springs.energy(s.x, gradient.data());
        CHECK(energy > 0);
        Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
        double size = 0;
        for (std::size_t v = 0; v < s.x.size(); v += 3) {
            const Vec3 g(gradient[v], gradient[v + 1], gradient[v + 2]), x(s.x[v], s.x[v + 1], s.x[v + 2]);
            sum += g, moment += x.cross(g), size += g.norm();
        }
        CHECK(sum.norm() < 1e-13 * size);
        CHECK(moment.norm() < 1e-13 * size);
        for (int probe = 0; probe < 20; ++probe) {
            const std::size_t i = std::uniform_int_distribution<std::size_t>(0, s.x.size() - 1)(random);
            const double h = 1e-5, at_i = s.x[i];
            s.x[i] = at_i + h;
            const double up = springs.energy(s.x, nullptr);
            s.x[i] = at_i - h;
            const double down = springs.energy(s.x, nullptr);
            s.x[i] = at_i;
            CHECK((up - down) / (2 * h) == Approx(gradient[i]).epsilon(1e-7).margin(1e-7 * energy));
        }
    }
}

TEST_CASE("targetWeights exclude: who faces what is not painted holds on to nothing, unless paint is near") {
    // A strip of 1 m along x, 1 cm above a table of the same length; the table's first 0.4 m are painted.
    SurfaceMesh strip = make_cube(1, 0.02, 0.05, 100, 1, 5), table = make_cube(1, 0.02, 0.2, 50, 1, 10);
    for (Vec3& p : table.points) p.y() -= 0.03;
    const auto attach = [&](Correspondence correspondence, PaintedOn on, double max_distance,
                            AttachmentStart& start) -> std::vector<Anchor> {
        auto t = in_lattice(correspondence == Correspondence::vertex_id ? table : strip, 0.05, ElementKind::linear);
        const auto below = [&](const Vec3& p) { return p.y() < bounding_box(t->surface).min.y() + 1e-6; };
        AttachmentRest a;
        a.source = 0, a.target = 1;
        a.correspondence = correspondence;
        a.source_painted = PaintedOn::faces;
        a.source_weights = paint_faces(t->surface, t->triangles, below);
        a.target_painted = on;
        a.max_distance = max_distance;
        const auto painted = [](const Vec3& p) { return p.x() < -0.1 + 1e-9; };
        a.target_weights = on == PaintedOn::faces ? paint_faces(table.points, table.triangles, painted)
                                                  : paint_vertices(table.points, painted);
        const Scene scene({{t, bone(table.points, table.triangles)}, {a}});
        StepInputs in = bar_inputs();
        in.bodies.push_back(BoneInputs{table.points});
        in.attachments = {{1e6, 1, 0}};
        const AttachmentView kept = attachments_kept(initial_state(scene, in).memories);
        start = kept.starts.at(0);
        return {kept.anchors.at(0).begin(), kept.anchors.at(0).end()};
    };
    for (const PaintedOn on : {PaintedOn::vertices, PaintedOn::faces}) {
        AttachmentStart start;
        // By default as far as two edges: 2 cm along the strip at most, and that is 1.7 cm at a height of 1 cm.
        std::vector<Anchor> anchors = attach(Correspondence::closest_point, on, 0, start);
        CHECK(start.painted == Approx(0.05));
        CHECK(start.max_distance > 0.01);
        CHECK(start.max_distance < 0.05);
        CHECK(start.longest <= start.max_distance);
        CHECK(1 - start.left_out / start.painted == Approx(0.4).margin(0.05));
        // What is left is told exactly: the part that faces paint, and 0.24 m beyond it that reach to its rim.
        anchors = attach(Correspondence::closest_point, on, 0.25, start);
        double held = 0;
        for (const Anchor& anchor : anchors) held += anchor.area_weight;
        CHECK(held + start.left_out == Approx(0.05));
        CHECK(held == Approx(0.05 * (0.4 + std::sqrt(0.25 * 0.25 - 1e-4))).epsilon(0.02));
        CHECK(start.longest == Approx(0.25).epsilon(0.02));
        // By vertices: the same faces, no reach.
        anchors = attach(Correspondence::vertex_id, on, 0, start);
        CHECK(start.left_out == Approx(0.6 * start.painted).epsilon(1e-9));
        for (const Anchor& anchor : anchors)
            for (const int v : anchor.target.vertices) CHECK(table.points[at(v)].x() < -0.1 + 1e-9);
    }
}

TEST_CASE("an attachment that finds no hold is refused, and the error says which") {
    auto t = tissue(box_mesh({0.1, 0.1, 0.1}, 2, 2, 2), ElasticLaw::stvk);
    const auto code = [&](AttachmentRest a) {
        a.source = 0, a.target = 1;
        StepInputs in = bar_inputs();
        in.bodies.push_back(BoneInputs{t->surface});
        in.attachments = {{1e6, 1, 0}, {1e6, 1, 0}};
        AttachmentRest good;
        good.source = 0, good.target = 1;
        try {
            initial_state(Scene({{t, bone(t->surface, t->triangles)}, {good, a}}), in);
        } catch (const Error& e) {
            CHECK(e.attachment == 1);
            return e.code;
        }
        return std::string();
    };
    const auto near = [](const Vec3& p) { return p.x() < 1e-9; };
    const auto far = [](const Vec3& p) { return p.x() > 0.1 - 1e-9; };
    AttachmentRest a;
    CHECK(code(a).empty());
    a.source_painted = a.target_painted = PaintedOn::faces;
    a.source_weights = paint_faces(t->surface, t->triangles, near);
    a.target_weights = paint_faces(t->surface, t->triangles, far);
    a.max_distance = 0.05;
    CHECK(code(a) == "FE240");
    a.max_distance = 0.15;
    CHECK(code(a).empty());
    a.correspondence = Correspondence::vertex_id;
    CHECK(code(a) == "FE240");
    a.source_weights = {0};
    CHECK(code(a) == "FE212");
    a.source_weights = {1, 1, 1};
    CHECK(code(a) == "FE204");
}

TEST_CASE("an attachment's damping is scaled by its envelope, like its stiffness") {
    const TetMesh mesh = regular_tet(0.1);
    auto t = tissue(mesh, ElasticLaw::neo_hookean);
    SceneDescription d;
    d.bodies = {t, bone(mesh.vertices, t->triangles)};
    AttachmentRest a;
    a.source = 0, a.target = 1, a.source_weights = {0.5};
    d.attachments = {a};
    auto scene = std::make_shared<const Scene>(d);
    Workspace w(scene);
    const double envelope = 0.25, k = 4e5, c = 800, area = std::sqrt(3.0) * 0.01,
                 mass = 1000 * 0.001 / (6 * std::sqrt(2.0)), h = 1.0 / 240;
    StepInputs in = still_inputs();
    in.bodies = {material(1e5, 0.3, 1000), BoneInputs{mesh.vertices}};
    in.attachments = {{k, envelope, c}};
    in.gravity = Vec3(0, 0, -9.81);
    in.step_size = h;
    State s = initial_state(*scene, in);
    double x = 0, v = 0;
    const double scale = 0.5 * envelope * area / mass;
    for (int i = 0; i < 60; ++i) {
        s = advance(w, s, std::span(&in, 1));
        v = (v - h * 9.81 - h * k * scale * x) / (1 + h * c * scale + h * h * k * scale);
        x += h * v;
        CHECK(position(s, 0).z() - mesh.vertices[0].z() == Approx(x).epsilon(1e-8));
    }
}

TEST_CASE("both ends of an attachment are judged against its elastic forces, not against its brakes") {
    // A tet and its copy 5 cm beside it, tied vertex by vertex: each spring is 5 cm long, each vertex gets a quarter.
    const TetMesh mesh = regular_tet(0.1);
    TetMesh beside = mesh;
    for (Vec3& p : beside.vertices) p.x() += 0.05;
    const double k = 1e6, force = k * std::sqrt(3.0) * 0.01 * 0.05;
    struct Case {
        bool is_source_first;
        double damping;
        bool trapezoid; ///< of TR-BDF2, where brakes begin with the speed that there was
    };
    for (const auto& [is_source_first, damping, trapezoid] :
         {Case{true, 0, false}, {false, 0, false}, {true, 1e7, false}, {false, 1e7, false}, {true, 1e7, true}}) {
        SceneDescription d;
        d.bodies = {tissue(mesh, ElasticLaw::neo_hookean), tissue(beside, ElasticLaw::neo_hookean)};
        AttachmentRest a;
        a.source = is_source_first ? 0 : 1, a.target = is_source_first ? 1 : 0;
        a.source_weights = {1};
        a.correspondence = Correspondence::vertex_id;
        a.maintain_offset = false;
        d.attachments = {a};
        const Scene scene(d);
        StepInputs in = still_inputs();
        in.bodies = {material(1, 0.3, 1e-6), material(1, 0.3, 1e-6)}; // nothing else counts
        in.attachments = {{k, 1, damping}};
        in.step_size = 0.1;
        State s = initial_state(scene, in);
        for (std::size_t v = 4; v < 8; ++v) s.v[3 * v + 1] = 1;
        Potential potential(scene);
        ImplicitForm form;
        s.history.acceleration.assign(s.x.size(), 0.0);
        if (trapezoid)
            tr_bdf2_trapezoid_form(s, in.step_size, nullptr, form);
        else
            backward_euler_form(s, in.step_size, form);
        potential.take(s, in);
        potential.begin_step(s, in);
        potential.begin_stage(s, form, s.bones);
        std::vector<double> x = s.x, gradient;
        for (std::size_t v = 4; v < 8; ++v) x[3 * v + 1] += 0.001; // so that brakes brake
        std::vector<BodyForces> forces;
        potential.begin_iteration(x);
        potential.evaluate(x, &gradient, &forces);
        const double pull = force * std::hypot(0.05, 0.001) / 0.05;
        for (const BodyForces& f : forces) CHECK(f.at_work == Approx(0.5 * pull).epsilon(1e-6));
        if (damping == 0)
            for (const BodyForces& f : forces) CHECK(f.sum == Approx(0.5 * pull).epsilon(1e-3));
        else
            CHECK(forces[0].sum > pull);
    }
}

TEST_CASE("a state holds an attachment's samples once, 128 bytes each, and those after it share them") {
    auto t = tissue(box_mesh({0.1, 0.1, 0.1}, 2, 2, 2), ElasticLaw::stvk);
    AttachmentRest a;
    a.source = 0, a.target = 1;
    a.source_weights = paint_vertices(t->surface, at_root);
    const auto scene = std::make_shared<const Scene>(SceneDescription{{t, wall_bone()}, {a}});
    StepInputs in = bar_inputs();
    in.bodies.push_back(BoneInputs{wall()});
    in.attachments = {{1e6, 1, 0}};
    const State start = initial_state(*scene, in);
    const AttachmentView kept = attachments_kept(start.memories);
    const std::size_t samples = kept.anchors.at(0).size();
    CHECK(samples >= 8); // triangles of the face
    // Each list with its length before it.
    constexpr std::size_t length = 8;
    const std::size_t memory = 8 + 5 * 8 + length + 128 * samples; // how many attachments; of each its start
    const TermMemory* own = find_memory(start.memories, "attachment");
    REQUIRE(own);
    CHECK(own->bytes.size() == memory);
    CHECK(reinterpret_cast<const std::byte*>(kept.anchors[0].data()) == own->bytes.data() + (memory - 128 * samples));
    std::size_t memories = length; // each with its name and version
    for (const TermMemory& m : start.memories) memories += length + m.term.size() + 4 + length + m.bytes.size();
    CHECK(memories < memory + 100);
    const std::size_t positions_and_velocities = 2 * (length + 27 * 3 * 8),
                      history = 8 + 3 * length + length + 1 + length, // step, x, v, acceleration, bones, values, frozen
        bones = length + length + (length + 4 * 3 * 8),               // none of the tissue
        record = 2 * 8 + 8 + 6 * 4 + 1 + length;
    const std::string_view mark = "sinew state 13\n";
    CHECK(save(start).size() ==
          mark.size() + positions_and_velocities + history + memories + length + bones + (8 + 3 * 4 + 1) + record);
    Workspace w(scene);
    const State next = advance(w, start, std::span(&in, 1));
    CHECK(find_memory(next.memories, "attachment")->bytes.data() == own->bytes.data());
}
