// Rest shapes that change (terms/elastic/rest_change.h): free bodies come to rest exactly scaled or grown and without
// stress; what has grown acts as a body that was modelled so, for every law, element and scheme.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/elastic/rest_change.h"

#include "solver/error.h"
#include "solver/meshing/lattice.h"
#include "solver/terms/elastic/elastic.h"
#include "tests/support/rotated_box.h"
#include "tests/support/trial.h"

#include <Eigen/LU>
#include <tuple>

using namespace sinew::test;

namespace {

/// Tets around a block that stands askew: its surface cuts them.
TetMesh cut_tets(ElementKind kind) {
    const SurfaceMesh box = RotatedBox({0.2, 0.1, 0.1}, 30, 30).surface(1);
    LatticeOptions options;
    options.tet_size = 0.15;
    options.moments = kind == ElementKind::quadratic ? 4 : 1;
    return make_lattice(box.points, box.triangles, options);
}

TetMesh small_box() {
    TetMesh mesh = box_mesh({0.2, 0.1, 0.1}, 2, 1, 1);
    mesh.vertices[0] += Vec3(0.01, 0.02, -0.01);
    return mesh;
}

void add_fiber(TissueRest& rest, const Vec3& along) {
    const std::size_t n = rest.tets.tets.size();
    rest.fibers.push_back({Points(n, along.normalized()), std::vector<double>(n, 1.0)});
}

/// A body that nothing holds, with steps so long that inertia has no part in what it comes to.
Trial free_body(const TetMesh& mesh, ElasticLaw law, ElementKind kind, const TissueInputs& values) {
    Trial t(mesh, law, kind, nowhere, values);
    t.rest->stiff_directions.assign(mesh.tets.size(), Vec3(1, 2, 3).normalized());
    t.use_backward_euler(100);
    t.in.tolerance_factor = 1e-4;
    return t;
}

/// Greatest difference of a distance between two nodes from that after `to`, as a share of the latter.
double misshape(const Trial& t, const Mat3& to) {
    double worst = 0;
    for (std::size_t a = 0; a < t.nodes.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) {
            const double wanted = (to * (t.nodes[a] - t.nodes[b])).norm();
            const double is = (position(t.state, static_cast<int>(a)) - position(t.state, static_cast<int>(b))).norm();
            worst = std::max(worst, std::abs(is - wanted) / wanted);
        }
    return worst;
}

Mat3 growth(const Vec3& along, double scale) {
    const Vec3 a = along.normalized();
    return a * a.transpose() + scale * (Mat3::Identity() - a * a.transpose());
}

double volume_of(const Trial& t) {
    double out = 0;
    for (const Tet& tet : t.rest->tets.tets) {
        const auto at = [&](std::size_t c) { return position(t.state, tet[c]); };
        out += tet_volume(at(0), at(1), at(2), at(3));
    }
    return out;
}

double volume_at_rest(const Trial& t) {
    double out = 0;
    for (const Tet& tet : t.rest->tets.tets) {
        const auto at = [&](std::size_t c) { return t.nodes[static_cast<std::size_t>(tet[c])]; };
        out += tet_volume(at(0), at(1), at(2), at(3));
    }
    return out;
}

} // namespace

TEST_CASE("a free body of restScale s comes to rest without stress, exactly s^e as large", "[rest]") {
    for (const ElasticLaw law : all_laws)
        for (const ElementKind kind : kinds)
            for (const double e : {-1.0, 0.0, 1.0, 2.0}) {
                TissueInputs values = flesh(2e4, 0.45, 20000);
                values.layers[0].rest_scale = 0.8;
                values.layers[0].volume_conservation = 1e6;
                values.transverse_anisotropy = 0.5;
                values.rest_scale_envelope = e;
                values.fibers = {{1e4, 1, 1, 1}}; // pulls on whatever is longer than at rest
                Trial t = free_body(small_box(), law, kind, values);
                add_fiber(*t.rest, {1, 0.5, 0});
                t.start();
                bool converged = false;
                for (int step = 0; step < 3; ++step) converged = t.step();
                const double s = std::pow(0.8, e);
                INFO(t.name() << ", e " << e);
                CHECK(converged);
                CHECK(misshape(t, s * Mat3::Identity()) < 1e-7);
                CHECK(volume_of(t) == Approx(s * s * s * volume_at_rest(t)).epsilon(1e-7));
                CHECK(t.state.record.energy < 1e-12 * 2e4 * volume_at_rest(t));
                CHECK(t.state.record.min_j == Approx(1).epsilon(1e-6)); // seen from the rest shape
            }
}

TEST_CASE("a free muscle grows by the square of its scale across the fibres, keeps its length and has no stress",
          "[rest]") {
    const Vec3 along(1, 0.5, -0.3);
    for (const ElasticLaw law : all_laws)
        for (const ElementKind kind : kinds)
            for (const double g : {0.5, 1.6}) {
                TissueInputs values = flesh(2e4, 0.45, 20000);
                values.transverse_anisotropy = 0.5;
                values.fibers = {{1e4, 1, 1, 1, g}};
                Trial t = free_body(small_box(), law, kind, values);
                add_fiber(*t.rest, along);
                t.rest->stiff_directions = t.rest->fibers[0].directions;
                t.start();
                bool converged = false;
                for (int step = 0; step < 3; ++step) converged = t.step();
                INFO(t.name() << ", growth " << g);
                CHECK(converged);
                CHECK(misshape(t, growth(along, g)) < 1e-7);
                CHECK(volume_of(t) == Approx(g * g * volume_at_rest(t)).epsilon(1e-7));
                CHECK(t.state.record.energy < 1e-12 * 2e4 * volume_at_rest(t));
            }
}

TEST_CASE("growths of several fibres multiply, envelopes and weights are exponents, nothing grows without a fibre",
          "[rest]") {
    const Vec3 one(1, 0, 0), two(0.6, 0.8, 0);
    TissueInputs values = flesh(2e4, 0.3);
    values.layers[0].rest_scale = 1.1;
    values.fibers = {{0, 1, 0, 1, 1.5}, {0, 1, 0, 0.5, 0.7}};
    Trial t = free_body(small_box(), ElasticLaw::stvk, ElementKind::linear, values);
    add_fiber(*t.rest, one), add_fiber(*t.rest, two);
    t.rest->fibers[0].weights.assign(t.rest->fibers[0].weights.size(), 0.25);
    const Mat3 g = 1.1 * growth(two, std::pow(0.7, 0.5)) * growth(one, std::pow(1.5, 0.25));
    CHECK((rest_change(*t.rest, values, 0) - g).norm() < 1e-15);
    t.start();
    for (int step = 0; step < 3; ++step) t.step();
    CHECK(misshape(t, g) < 1e-7);
    CHECK(volume_of(t) ==
          Approx(std::pow(1.1, 3) * std::pow(0.7, 1) * std::pow(1.5, 0.5) * volume_at_rest(t)).epsilon(1e-7));
    t.rest->fibers[0].directions[3].setZero();
    CHECK((rest_change(*t.rest, values, 3) - 1.1 * growth(two, std::pow(0.7, 0.5))).norm() < 1e-15);
}

TEST_CASE("two fibres of one direction make the fourth power of their scale in volume", "[rest]") {
    TissueInputs values = flesh(2e4, 0.3);
    values.fibers = {{0, 1, 0, 1, 1.2}, {0, 1, 0, 1, 1.2}};
    Trial t = free_body(small_box(), ElasticLaw::neo_hookean, ElementKind::linear, values);
    add_fiber(*t.rest, {0, 1, 0}), add_fiber(*t.rest, {0, 1, 0});
    t.start();
    for (int step = 0; step < 3; ++step) t.step();
    CHECK(volume_of(t) == Approx(std::pow(1.2, 4) * volume_at_rest(t)).epsilon(1e-7));
    CHECK(misshape(t, growth({0, 1, 0}, 1.44)) < 1e-7);
}

TEST_CASE("layers composite their restScale, and the envelope is taken of what comes out", "[rest]") {
    auto t = tissue(regular_tet(0.1), ElasticLaw::stvk);
    t->layer_weights = {{1}, {0.4}};
    TissueInputs values = material(1e4, 0.3);
    values.layers.push_back(values.layers[0]);
    values.layers[0].rest_scale = 1.2, values.layers[1].rest_scale = 0.7, values.layers[1].envelope = 0.5;
    values.rest_scale_envelope = 2;
    const double s = 0.2 * 0.7 + 0.8 * 1.2;
    CHECK((rest_change(*t, values, 0) - s * s * Mat3::Identity()).norm() < 1e-14);
}

TEST_CASE("envelopes of layers, fibres and the rest scale may change at any step", "[rest]") {
    for (const ElementKind kind : kinds) {
        TissueInputs values = flesh(2e4, 0.3);
        values.layers[0].rest_scale = 1.1;
        values.layers.push_back(values.layers[0]);
        values.layers[1].rest_scale = 0.8, values.layers[1].envelope = 0.5;
        values.fibers = {{0, 1, 0, 0.5, 1.4}};
        Trial t = free_body(small_box(), ElasticLaw::stvk, kind, values);
        add_fiber(*t.rest, {0, 1, 0});
        t.rest->layer_weights.push_back(t.rest->layer_weights[0]);
        t.start();
        const auto comes_to = [&](double scale, double grown) {
            for (int step = 0; step < 3; ++step) t.step();
            INFO(t.name() << ", " << scale << ", " << grown);
            CHECK(misshape(t, scale * growth({0, 1, 0}, grown)) < 1e-7);
        };
        comes_to(0.95, std::sqrt(1.4));
        t.values().layers[1].envelope = 1;
        comes_to(0.8, std::sqrt(1.4));
        t.values().fibers[0].envelope = 1;
        comes_to(0.8, 1.4);
        t.values().rest_scale_envelope = -1;
        comes_to(1.25, 1.4);
        t.values().rest_scale_envelope = 0, t.values().fibers[0].growth = 1;
        comes_to(1, 1);
        t.values().rest_scale_envelope = 1;
        comes_to(0.8, 1);
    }
}

TEST_CASE("what has grown moves as what was modelled so, with the same mass", "[rest]") {
    const Vec3 along(1, 0.5, -0.3);
    const double s = 1.2, g = 0.7;
    const Mat3 to = s * growth(along, g);
    const auto map = [&](const Vec3& p) { return Vec3(to * p); };
    for (const ElasticLaw law : all_laws)
        for (const ElementKind kind : kinds)
            for (const bool cut : {false, true})
                for (const Integrator scheme : {Integrator::backward_euler, Integrator::tr_bdf2}) {
                    const TetMesh mesh = cut ? cut_tets(kind) : small_box();
                    TetMesh as_grown = mesh;
                    for (Vec3& p : as_grown.vertices) p = map(p);
                    TissueInputs values = flesh(2e4, 0.45, 100);
                    values.layers[0].volume_conservation = 1e5;
                    values.transverse_anisotropy = 0.5;
                    values.fibers = {{1e4, 0.6, 0.5, 1}};
                    Trial grown(mesh, law, kind, nowhere, values), modelled(as_grown, law, kind, nowhere, values);
                    grown.values().layers[0].rest_scale = s;
                    grown.values().fibers[0].growth = g;
                    modelled.values().layers[0].mass_density /= to.determinant();
                    for (Trial* t : {&grown, &modelled}) {
                        add_fiber(*t->rest, along);
                        t->rest->stiff_directions = t->rest->fibers[0].directions;
                        t->in.integrator = scheme;
                        t->in.step_size = 0.01;
                        t->in.stiffness_damping = 0.02;
                        t->in.gravity = Vec3(0, -9.8, 3);
                        t->in.tolerance_factor = 1e-5;
                        t->start();
                    }
                    // Both from the same place, at rest and bent.
                    grown.place(everywhere, [&](const Vec3& p) {
                        return Vec3(map(p) + Vec3(0, 3 * p.x() * p.x(), p.x() * p.y()));
                    });
                    modelled.state.x = grown.state.x;
                    for (int step = 0; step < 3; ++step) {
                        for (Trial* t : {&grown, &modelled}) {
                            t->values().forces.assign(t->nodes.size(), Vec3(0.1 * step, 0, 0.05));
                            t->state = advance(*t->workspace, t->state, std::span(&t->in, 1));
                        }
                    }
                    INFO(grown.name() << (cut ? ", cut" : ""));
                    CHECK(grown.distance_from(modelled) < 1e-9);
                    CHECK(grown.state.record.energy == Approx(modelled.state.record.energy).epsilon(1e-6));
                    CHECK(grown.state.record.min_j == Approx(modelled.state.record.min_j).epsilon(1e-6));
                }
}

namespace {

/// Stretch across a bar, and nominal stress along it over Young's modulus, at the stretch along it, with free sides.
struct Pulled {
    double across, stress;
};
Pulled pulled(ElasticLaw law, double stretch, double nu) {
    if (law == ElasticLaw::stvk) {
        const double strain = (stretch * stretch - 1) / 2;
        return {std::sqrt(1 - 2 * nu * strain), stretch * strain};
    }
    return {1 - nu * (stretch - 1), stretch - 1}; // co-rotational
}

/// Nodal forces of a uniform traction on the triangles of the border for which `where` holds at the corners.
Points traction(const Trial& t, const Where& where, const Vec3& pull) {
    Points out(t.nodes.size(), Vec3::Zero());
    const auto edges = edges_of(t.rest->tets.tets);
    for (const Triangle& triangle : t.rest->triangles) {
        Vec3 p[3];
        bool all = true;
        for (std::size_t c = 0; c < 3; ++c) {
            p[c] = t.rest->surface[static_cast<std::size_t>(triangle[c])];
            all = all && where(p[c]);
        }
        if (!all) continue;
        const Vec3 third = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm() / 3 * pull;
        for (std::size_t c = 0; c < 3; ++c) { // of quadratic tets the middles of edges carry it all
            const Vec3 at = t.rest->element == ElementKind::linear ? p[c] : Vec3(0.5 * (p[c] + p[(c + 1) % 3]));
            const auto node = vertices_where(t.nodes, [&](const Vec3& n) { return (n - at).norm() < 1e-12; });
            out[static_cast<std::size_t>(node.at(0))] += third;
        }
    }
    return out;
}

} // namespace

TEST_CASE("a bar of restScale 0.9 needs s^2 A times the law's stress at 1/s to be as long as it was modelled",
          "[rest]") {
    const double s = 0.9, e = 2e4, nu = 0.3;
    for (const ElasticLaw law : {ElasticLaw::stvk, ElasticLaw::corotational})
        for (const ElementKind kind : kinds) {
            TissueInputs values = flesh(e, nu);
            values.layers[0].rest_scale = s;
            Trial t = free_body(box_mesh({0.2, 0.1, 0.1}, 2, 1, 1), law, kind, values);
            const Pulled bar = pulled(law, 1 / s, nu);
            t.values().forces = traction(t, at_root, Vec3(-s * s * e * bar.stress, 0, 0));
            const Points far = traction(
                t, [](const Vec3& p) { return p.x() > 0.2 - 1e-9; }, Vec3(s * s * e * bar.stress, 0, 0));
            for (std::size_t v = 0; v < far.size(); ++v) t.values().forces[v] += far[v];
            t.start();
            bool converged = false;
            for (int step = 0; step < 4; ++step) converged = t.step();
            INFO(t.name());
            CHECK(converged);
            CHECK(misshape(t, Vec3(1, s * bar.across, s * bar.across).asDiagonal()) < 1e-7);
        }
}

TEST_CASE("between fixed walls a growing muscle presses by the law's stress in the grown volume", "[rest]") {
    // All of the border is held, so F = I: with g across the fibre x, Fe = diag(1, 1/g, 1/g) and P = g^2 P(Fe) Fe^-1 …
    const double g = 1.25, e = 2e4, nu = 0.3;
    const double mu = e / (2 * (1 + nu)), lambda = e * nu / ((1 + nu) * (1 - 2 * nu));
    const double strain = (1 / (g * g) - 1) / 2; // StVK: of both directions across
    // Work of the wall at y: dW/dF_yy = g^2 S_yy / g^2, with S = 2 mu E + lambda tr E.
    const double across = 2 * mu * strain + 2 * lambda * strain, along = g * g * 2 * lambda * strain;
    for (const ElementKind kind : kinds) {
        TissueInputs values = flesh(e, nu);
        values.fibers = {{0, 1, 0, 1, g}};
        Trial t(box_mesh({0.2, 0.1, 0.1}, 2, 2, 2), ElasticLaw::stvk, kind, nowhere, values);
        add_fiber(*t.rest, {1, 0, 0});
        t.start();
        Trial::Judge judge(t, t.state);
        std::vector<double> gradient;
        judge.potential.evaluate(t.state.x, &gradient, nullptr);
        Vec3 at_wall = Vec3::Zero(); // forces of the body's +x, +y, +z sides
        for (std::size_t v = 0; v < t.nodes.size(); ++v) {
            const std::size_t u = static_cast<std::size_t>(t.scene->numbering().unknown[v]);
            for (std::size_t c = 0; c < 3; ++c) {
                const double size = c == 0 ? 0.2 : 0.1;
                if (t.nodes[v][static_cast<int>(c)] > size - 1e-9) at_wall[static_cast<int>(c)] += gradient[3 * u + c];
                const bool inside =
                    t.nodes[v][static_cast<int>(c)] > 1e-9 && t.nodes[v][static_cast<int>(c)] < size - 1e-9;
                if (inside) CHECK(std::abs(gradient[3 * u + c]) < 1e-12 * e);
            }
        }
        CHECK(at_wall.x() == Approx(along * 0.01).epsilon(1e-10));
        CHECK(at_wall.y() == Approx(across * 0.02).epsilon(1e-10));
        CHECK(at_wall.z() == Approx(across * 0.02).epsilon(1e-10));
    }
}

TEST_CASE("a uniform restScale s makes a body s times as stiff about its rest", "[rest]") {
    const double s = 1.7;
    for (const ElasticLaw law : all_laws)
        for (const ElementKind kind : kinds) {
            TissueInputs values = flesh(2e4, 0.45, 100);
            values.layers[0].volume_conservation = 1e5;
            const auto stiffness = [&](double scale) {
                values.layers[0].rest_scale = scale;
                Trial t(small_box(), law, kind, nowhere, values);
                t.rest->stiff_directions.assign(t.rest->tets.tets.size(), Vec3(1, 2, 3).normalized());
                t.start();
                t.place(everywhere, [&](const Vec3& p) { return Vec3(scale * p); });
                Trial::Judge judge(t, t.state);
                BlockMatrix out(judge.potential.pattern());
                judge.potential.assemble(t.state.x, false, out);
                return out.values;
            };
            const std::vector<double> model = stiffness(1), scaled = stiffness(s);
            REQUIRE(model.size() == scaled.size());
            double worst = 0, most = 0;
            for (std::size_t i = 0; i < model.size(); ++i) {
                worst = std::max(worst, std::abs(scaled[i] - s * model[i]));
                most = std::max(most, std::abs(model[i]));
            }
            INFO(law_facts(law).name);
            CHECK(worst < 1e-12 * most);
        }
}

TEST_CASE("values that change no rest shape change no bit", "[rest]") {
    const auto run = [](const std::function<void(TissueInputs&, int)>& set, ElementKind kind) {
        TissueInputs values = flesh(2e4, 0.45, 100);
        values.layers[0].volume_conservation = 1e5;
        values.fibers = {{1e4, 0.6, 0.5, 1}};
        Trial t(small_box(), ElasticLaw::neo_hookean, kind, at_root, values);
        add_fiber(*t.rest, {1, 0.5, 0});
        t.in.integrator = Integrator::tr_bdf2;
        t.in.step_size = 0.01;
        t.in.stiffness_damping = 0.01;
        t.in.gravity = Vec3(0, -9.8, 0);
        t.start();
        for (int step = 0; step < 3; ++step) {
            set(t.values(), step);
            t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
        }
        return t.state.x;
    };
    for (const ElementKind kind : kinds) {
        const std::vector<double> plain = run([](TissueInputs&, int) {}, kind);
        CHECK(run([](TissueInputs& v, int step) { v.rest_scale_envelope = 0.3 * step; }, kind) == plain);
        CHECK(run([](TissueInputs& v, int) { v.layers[0].rest_scale = 3, v.rest_scale_envelope = 0; }, kind) == plain);
        CHECK(run([](TissueInputs& v, int) { v.layers[0].rest_scale = 1.01; }, kind) != plain);
        CHECK(run([](TissueInputs& v, int) { v.fibers[0].growth = 1.01; }, kind) != plain);
    }
}

TEST_CASE("a muscle that grows and shrinks by keys swings at each scheme's order, also damped", "[rest]") {
    const TetMesh mesh = box_mesh({0.3, 0.1, 0.1}, 3, 1, 1);
    for (const auto& [integrator, order] :
         {std::pair{Integrator::backward_euler, 1.0}, {Integrator::bdf2, 2.0}, {Integrator::tr_bdf2, 2.0}}) {
        std::vector<Vec3> tips;
        for (const int steps : {50, 100, 200}) {
            TissueInputs values = flesh(2e4, 0.3);
            values.layers[0].rest_scale = 1.2;
            values.fibers = {{2e4, 0.5, 0.2, 1, 1}};
            Trial t(mesh, ElasticLaw::neo_hookean, ElementKind::linear, at_root, values);
            add_fiber(*t.rest, {0.8, 0, 0.6});
            t.in.integrator = integrator;
            t.in.step_size = 0.2 / steps;
            t.in.tolerance_factor = 1e-3;
            t.in.stiffness_damping = 2e-3;
            t.values().rest_scale_envelope = 0;
            t.start();
            for (int i = 1; i <= steps; ++i) {
                const double time = i * t.in.step_size;
                t.values().rest_scale_envelope = std::sin(25 * time);
                t.values().fibers[0].growth = 1 + 0.3 * std::sin(20 * time);
                t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
                REQUIRE(t.state.record.converged);
                if (i == steps / 2) {
                    State copy = load(save(t.state));
                    CHECK(save(copy) == save(t.state));
                    t.state = std::move(copy);
                    t.workspace = std::make_unique<Workspace>(t.scene);
                }
            }
            tips.push_back(position(t.state, static_cast<int>(mesh.vertices.size()) - 1));
        }
        CHECK((tips[2] - mesh.vertices.back()).norm() > 0.01);
        INFO("scheme " << static_cast<int>(integrator) << ", " << (tips[0] - tips[1]).norm() << " "
                       << (tips[1] - tips[2]).norm());
        CHECK(std::log2((tips[0] - tips[1]).norm() / (tips[1] - tips[2]).norm()) == Approx(order).margin(0.25));
    }
}

TEST_CASE("rest shapes that no tet can have are refused, with the value that makes them", "[rest]") {
    const auto refused = [](const std::function<void(TissueInputs&)>& spoil) -> std::string {
        TissueInputs values = flesh(2e4, 0.3);
        values.fibers = {{1e4, 0.5, 0, 1, 1}, {1e4, 0.5, 0, 1, 1}};
        Trial t(regular_tet(0.1), ElasticLaw::stvk, ElementKind::linear, nowhere, values);
        add_fiber(*t.rest, {1, 0, 0}), add_fiber(*t.rest, {0, 1, 0});
        t.use_backward_euler(0.01);
        t.start();
        spoil(t.values());
        const State before = t.state;
        try {
            t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
        } catch (const Error& e) {
            CHECK(e.body == 0);
            CHECK(save(t.state) == save(before));
            return e.code + ": " + e.what();
        }
        return "";
    };
    CHECK(refused([](TissueInputs&) {}).empty());
    CHECK(refused([](TissueInputs& v) { v.layers[0].rest_scale = 0; }) ==
          "FE247: the restScale of a material is 0; it must be above 0");
    CHECK(refused([](TissueInputs& v) { v.layers[0].rest_scale = -1, v.rest_scale_envelope = 2; }) ==
          "FE247: the restScale of a material is -1; it must be above 0");
    CHECK(
        refused([](TissueInputs& v) { v.layers[0].rest_scale = 2, v.rest_scale_envelope = -10; }) ==
        "FE247: a restScale of 2 to the power of a restScaleEnvelope of -10 scales the tissue at rest by 0.000976562");
    CHECK(refused([](TissueInputs& v) { v.fibers[1].growth = 0; }) ==
          "FE247: the muscleGrowthScale of a fibre is 0; it must be above 0");
    CHECK(refused([](TissueInputs& v) { v.fibers[0].growth = 100, v.fibers[1].growth = 0.05; }) ==
          "FE247: the muscleGrowthScale of all fibres together is up to 2000 or its reciprocal across them");
    TissueInputs far = flesh(2e4, 0.3);
    far.layers[0].rest_scale = 2, far.rest_scale_envelope = 9;
    CHECK_NOTHROW(check_rest_scale(far));
    for (const double bad : {NAN, INFINITY}) {
        CHECK(refused([&](TissueInputs& v) { v.layers[0].rest_scale = bad; }) ==
              "FE304: the restScale of a tissue's material is not a finite number");
        CHECK(refused([&](TissueInputs& v) { v.rest_scale_envelope = bad; }) ==
              "FE304: the restScaleEnvelope of a tissue is not a finite number");
        CHECK(refused([&](TissueInputs& v) { v.fibers[0].growth = bad; }) ==
              "FE304: the muscleGrowthScale of a tissue's fibre is not a finite number");
    }
}
