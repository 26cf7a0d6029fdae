// Quadratic tets and volume conservation: exactness, derivatives, and no locking where linear tets lock.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/material/principal.h"
#include "solver/newton/potential.h"
#include "solver/system.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

/// A body of one tissue with everything a static test needs.
struct Block {
    std::shared_ptr<TissueRest> rest;
    std::shared_ptr<const Scene> scene;
    StepInputs in = still_inputs();
    State state;
    Points nodes; ///< rest positions of all vertices of the state

    Block(const TetMesh& mesh, ElasticLaw law, ElementKind kind, const std::function<bool(const Vec3&)>& held,
          const TissueInputs& values) {
        rest = tissue(mesh, law);
        rest->element = kind;
        if (needs_direction(law)) rest->stiff_directions.assign(mesh.tets.size(), Vec3(1, 1, 0).normalized());
        nodes = mesh.vertices;
        if (kind == ElementKind::quadratic)
            for (const auto& [a, b] : edges_of(mesh.tets))
                nodes.push_back(
                    0.5 * (mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)]));
        rest->fixed_vertices = vertices_where(nodes, held);
        scene = std::make_shared<const Scene>(SceneDescription{{rest}, {}});
        in.integrator = Integrator::quasi_static;
        in.linear_method = LinearMethod::direct;
        in.max_newton_iterations = 60;
        in.bodies = {values};
        state = initial_state(*scene, in);
    }
    TissueInputs& values() { return std::get<TissueInputs>(in.bodies[0]); }
    void solve() {
        Workspace w(scene);
        state = advance(w, state, std::span(&in, 1));
        INFO("residual " << state.record.residual << " after " << state.record.newton_iterations << " iterations");
        CHECK(state.record.converged);
    }
    Vec3 displacement(const Vec3& at) const {
        for (std::size_t v = 0; v < nodes.size(); ++v)
            if ((nodes[v] - at).norm() < 1e-9) return position(state, static_cast<int>(v)) - nodes[v];
        FAIL("no vertex there");
        return {};
    }
};

/// Cook's panel of n x n x m cubes under a dead shear traction on its right end.
Block cook(int n, int m, double nu, ElementKind kind, ElasticLaw law = ElasticLaw::log_neo_hookean) {
    TetMesh mesh = box_mesh({1, 1, 1}, n, n, m);
    for (Vec3& p : mesh.vertices)
        p = Vec3(0.48 * p.x(), 0.44 * p.x() * (1 - p.y()) + p.y() * (0.44 + 0.16 * p.x()), 0.1 * p.z() - 0.05);
    Block b(
        mesh, law, kind, [](const Vec3& p) { return p.x() < 1e-12; }, material(1e5, nu));
    b.values().forces.assign(b.nodes.size(), Vec3::Zero());
    const std::vector<std::array<int, 2>> edges = edges_of(mesh.tets);
    for (const Triangle& t : boundary_triangles(mesh.tets)) {
        const Vec3 &p = mesh.vertices[static_cast<std::size_t>(t[0])],
                   &q = mesh.vertices[static_cast<std::size_t>(t[1])],
                   &r = mesh.vertices[static_cast<std::size_t>(t[2])];
        if (std::min({p.x(), q.x(), r.x()}) < 0.48 - 1e-9) continue;
        const Vec3 load = Vec3(0, 3125, 0) * 0.5 * (q - p).cross(r - p).norm() / 3;
        // A uniform traction loads a linear triangle's corners and a quadratic one's edge midpoints, a third each.
        for (std::size_t i = 0; i < 3; ++i) {
            const std::array<int, 2> edge{std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3])};
            const std::size_t midpoint =
                mesh.vertices.size() +
                static_cast<std::size_t>(std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin());
            b.values().forces[kind == ElementKind::linear ? static_cast<std::size_t>(t[i]) : midpoint] += load;
        }
    }
    b.solve();
    return b;
}

/// The beam of the catalogue's gravity cantilever.
Block cantilever(int nx, int ny, ElementKind kind, ElasticLaw law, double nu, double volume_conservation = 0,
                 double youngs_modulus = 1e6) {
    TissueInputs values = material(youngs_modulus, nu);
    values.layers[0].volume_conservation = volume_conservation;
    Block b(
        box_mesh({0.8, 0.1, 0.1}, nx, ny, ny), law, kind, [](const Vec3& p) { return p.x() < 1e-12; }, values);
    b.in.gravity = Vec3(0, 0, -9.81);
    b.solve();
    return b;
}
constexpr double tip[3] = {0.8, 0.05, 0.05};

} // namespace

TEST_CASE("patch test: quadratic tets and volume patches reproduce a linear displacement exactly") {
    TetMesh mesh = box_mesh({0.3, 0.2, 0.2}, 3, 2, 2);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> shift(-0.01, 0.01);
    const auto inside = [](const Vec3& p) {
        return p.x() > 1e-9 && p.x() < 0.3 - 1e-9 && p.y() > 1e-9 && p.y() < 0.2 - 1e-9 && p.z() > 1e-9 &&
               p.z() < 0.2 - 1e-9;
    };
    for (Vec3& p : mesh.vertices)
        if (inside(p)) p += Vec3(shift(random), shift(random), shift(random));
    Mat3 f;
    f << 1.1, 0.2, 0, -0.1, 0.9, 0.1, 0.05, 0, 1.05;
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic})
        for (const ElasticLaw law : all_laws)
            for (const double nu : {0.3, 0.49}) {
                TissueInputs values = material(1e4, nu);
                values.layers[0].volume_conservation = 3e5;
                Block b(
                    mesh, law, kind, [&](const Vec3& p) { return !inside(p); }, values);
                b.in.tolerance_factor = 1e-6;
                for (std::size_t v = 0; v < b.nodes.size(); ++v)
                    set_position(b.state, static_cast<int>(v), f * b.nodes[v]);
                std::normal_distribution<double> normal;
                for (std::size_t v = 0; v < b.nodes.size(); ++v)
                    if (inside(b.nodes[v]))
                        set_position(b.state, static_cast<int>(v),
                                     f * b.nodes[v] + 0.002 * Vec3(normal(random), normal(random), normal(random)));
                b.solve();
                double worst = 0;
                for (std::size_t v = 0; v < b.nodes.size(); ++v)
                    worst = std::max(worst, (position(b.state, static_cast<int>(v)) - f * b.nodes[v]).norm());
                INFO(static_cast<int>(kind) << " " << static_cast<int>(law) << " " << nu);
                CHECK(worst < 1e-10);
            }
}

TEST_CASE(
    "quadratic tets hold pure bending exactly: a parabolic displacement has its exact energy and is in equilibrium") {
    const double e = 1e5, nu = 0.3, k = 1e-4, half = 0.05;
    const auto bent = [&](const Vec3& p) {
        const double y = p.y() - half, z = p.z() - half;
        return Vec3(p.x() + k * p.x() * y, p.y() - 0.5 * k * (p.x() * p.x() + nu * (y * y - z * z)),
                    p.z() - nu * k * y * z);
    };
    const auto inside = [](const Vec3& p) {
        return p.x() > 1e-9 && p.x() < 0.2 - 1e-9 && p.y() > 1e-9 && p.y() < 0.1 - 1e-9 && p.z() > 1e-9 &&
               p.z() < 0.1 - 1e-9;
    };
    Block b(
        box_mesh({0.2, 0.1, 0.1}, 4, 2, 2), ElasticLaw::corotational, ElementKind::quadratic,
        [&](const Vec3& p) { return !inside(p); }, material(e, nu));
    for (std::size_t v = 0; v < b.nodes.size(); ++v)
        set_position(b.state, static_cast<int>(v), inside(b.nodes[v]) ? b.nodes[v] : bent(b.nodes[v]));
    b.in.tolerance_factor = 1e-6;
    b.solve();
    double worst = 0;
    for (std::size_t v = 0; v < b.nodes.size(); ++v)
        worst = std::max(worst, (position(b.state, static_cast<int>(v)) - bent(b.nodes[v])).norm());
    CHECK(worst < 1e-3 * k * 0.02);
    const double second_moment = std::pow(0.1, 4) / 12;
    CHECK(b.state.record.energy == Approx(0.5 * e * second_moment * k * k * 0.2).epsilon(1e-4));
}

TEST_CASE("with means, patches and fibres the gradient and Hessian converge to finite differences at second order") {
    const TetMesh mesh = box_mesh({0.2, 0.1, 0.1}, 3, 2, 2);
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic})
        for (const ElasticLaw law : all_laws) {
            auto rest = tissue(mesh, law);
            rest->element = kind;
            rest->stiff_directions.assign(mesh.tets.size(), Vec3(1, 1, 0).normalized());
            rest->fibers = {
                {Points(mesh.tets.size(), Vec3(0, 1, 1).normalized()), std::vector<double>(mesh.tets.size(), 1.0)}};
            const Scene scene(SceneDescription{{rest}, {}});
            StepInputs in = still_inputs();
            TissueInputs values = material(1e4, 0.47);
            values.layers[0].volume_conservation = 5e4;
            values.transverse_anisotropy = 0.4;
            values.fibers = {{2e4, 0.5, 0.7, 1}};
            in.bodies = {values};
            const State s = initial_state(scene, in);
            Potential potential(scene);
            ImplicitForm form;
            backward_euler_form(s, in.step_size, form);
            potential.take(s, in);
            potential.begin_step(s, in);
            potential.begin_stage(s, form, s.bones);
            std::mt19937 random(4);
            std::normal_distribution<double> normal;
            std::vector<double> x = s.x, direction(s.x.size()), g, plus, minus, hd(s.x.size());
            for (double& c : x) c += 0.002 * normal(random);
            for (double& d : direction) d = normal(random);
            const auto moved = [&](double t) {
                std::vector<double> out = x;
                for (std::size_t i = 0; i < x.size(); ++i) out[i] += t * direction[i];
                return out;
            };
            potential.evaluate(x, &g, nullptr);
            BlockMatrix h(potential.pattern());
            potential.assemble(x, false, h);
            multiply(h, direction.data(), hd.data());
            double slope = 0, gradient_error[2], hessian_error[2];
            for (std::size_t i = 0; i < g.size(); ++i) slope += g[i] * direction[i];
            for (int i = 0; i < 2; ++i) {
                const double t = i ? 5e-5 : 1e-4;
                const double up = potential.evaluate(moved(t), &plus, nullptr),
                             down = potential.evaluate(moved(-t), &minus, nullptr);
                gradient_error[i] = std::abs((up - down) / (2 * t) - slope);
                hessian_error[i] = 0;
                for (std::size_t k = 0; k < g.size(); ++k)
                    hessian_error[i] += std::pow((plus[k] - minus[k]) / (2 * t) - hd[k], 2);
            }
            INFO(static_cast<int>(kind) << " law " << static_cast<int>(law) << ": " << gradient_error[1] << " of "
                                        << slope);
            CHECK(std::log2(gradient_error[0] / gradient_error[1]) == Approx(2).margin(0.15));
            CHECK(std::log2(hessian_error[0] / hessian_error[1]) / 2 == Approx(2).margin(0.15));
        }
}

TEST_CASE("energies, det F and inverted tets of uniform deformations are those of closed forms") {
    const TetMesh mesh = box_mesh({0.2, 0.1, 0.1}, 2, 1, 1);
    const double volume = 0.2 * 0.1 * 0.1, e = 1e4, nu = 0.47;
    const double mu = e / (2 * (1 + nu)), lambda = e * nu / ((1 + nu) * (1 - 2 * nu));
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        INFO("element " << static_cast<int>(kind));
        auto rest = tissue(mesh, ElasticLaw::stvk);
        rest->element = kind;
        rest->fibers = {{Points(mesh.tets.size(), Vec3(1, 0, 0)), std::vector<double>(mesh.tets.size(), 0.5)}};
        const Scene scene(SceneDescription{{rest}, {}});
        StepInputs in = still_inputs();
        TissueInputs values = material(e, nu);
        values.fibers = {{2e4, 0.5, 0.6, 0.25}};
        in.bodies = {values};
        const State s = initial_state(scene, in);
        Potential potential(scene);
        ImplicitForm form;
        quasi_static_form(s, form);
        potential.take(s, in);
        potential.begin_step(s, in);
        potential.begin_stage(s, form, s.bones);
        const auto look = [&](const Vec3& stretch) {
            std::vector<double> x = s.x;
            for (std::size_t i = 0; i < x.size(); ++i) x[i] *= stretch[static_cast<Eigen::Index>(i % 3)];
            StepRecord r;
            std::vector<double> gradient;
            const double energy = potential.evaluate(x, &gradient, nullptr);
            potential.describe(x, r);
            CHECK(r.energy == Approx(energy).epsilon(1e-12));
            return r;
        };
        // Saint Venant and Kirchhoff's energy, and a fibre of 2e4 Pa, a quarter of 60 % of it, half painted, that pulls
        // to half of its length.
        const auto expected = [&](const Vec3& stretch) {
            const Vec3 strain = 0.5 * (stretch.cwiseProduct(stretch) - Vec3::Ones());
            const double pull = std::max(0.0, std::abs(stretch[0]) - 0.5);
            return volume * (mu * strain.squaredNorm() + 0.5 * lambda * strain.sum() * strain.sum() +
                             0.5 * (2e4 * 0.25 * 0.6 * 0.5) * pull * pull);
        };
        for (const Vec3& stretch : {Vec3(1, 1, 1), Vec3(1.1, 1.1, 1.1), Vec3(1.2, 0.9, 0.95), Vec3(0.4, 1, 1.1)}) {
            const StepRecord r = look(stretch);
            CHECK(r.energy == Approx(expected(stretch)).epsilon(1e-10));
            CHECK(r.min_j == Approx(stretch.prod()).epsilon(1e-10));
            CHECK(r.inverted == 0);
        }
        const StepRecord inside_out = look({-0.5, 1, 1});
        CHECK(inside_out.min_j == Approx(-0.5).epsilon(1e-10));
        CHECK(inside_out.inverted == static_cast<int>(mesh.tets.size()));
    }
}

TEST_CASE("fibres that are shorter than they pull to neither pull nor stiffen") {
    const TetMesh mesh = box_mesh({0.2, 0.1, 0.1}, 2, 1, 1);
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        auto rest = tissue(mesh, ElasticLaw::neo_hookean);
        rest->element = kind;
        rest->fibers = {
            {Points(mesh.tets.size(), Vec3(0, 1, 1).normalized()), std::vector<double>(mesh.tets.size(), 1.0)}};
        const Scene scene(SceneDescription{{rest}, {}});
        StepInputs in = still_inputs();
        std::vector<double> gradient[2];
        std::vector<double> hessian[2];
        double energy[2];
        for (const bool excited : {false, true}) {
            TissueInputs values = material(1e4, 0.3);
            values.fibers = {{2e4, 0.9, excited ? 0.7 : 0.0, 1}};
            in.bodies = {values};
            const State s = initial_state(scene, in);
            Potential potential(scene);
            ImplicitForm form;
            backward_euler_form(s, in.step_size, form);
            potential.take(s, in);
            potential.begin_step(s, in);
            potential.begin_stage(s, form, s.bones);
            std::vector<double> x = s.x;
            for (double& c : x) c *= 0.85;
            energy[excited] = potential.evaluate(x, &gradient[excited], nullptr);
            BlockMatrix h(potential.pattern());
            potential.assemble(x, false, h);
            hessian[excited] = {h.values.begin(), h.values.end()};
        }
        CHECK(energy[1] == Approx(energy[0]).epsilon(1e-14));
        REQUIRE(hessian[0].size() == hessian[1].size());
        double largest = 0, worst = 0, worst_force = 0;
        for (std::size_t i = 0; i < hessian[0].size(); ++i) {
            largest = std::max(largest, std::abs(hessian[0][i]));
            worst = std::max(worst, std::abs(hessian[1][i] - hessian[0][i]));
        }
        for (std::size_t i = 0; i < gradient[0].size(); ++i)
            worst_force = std::max(worst_force, std::abs(gradient[1][i] - gradient[0][i]));
        CHECK(worst <= 1e-12 * largest);
        CHECK(worst_force <= 1e-12);
    }
}

TEST_CASE(
    "quadratic tets: the gravity cantilever is within 4 % of the converged value on 192 tets and 1.2 % on 1,536") {
    const auto reference = accuracy()["cantilever_gravity"]["continuum"];
    for (const auto& [law, name] : {std::pair{ElasticLaw::stvk, "stvk"},
                                    {ElasticLaw::neo_hookean, "snh"},
                                    {ElasticLaw::log_neo_hookean, "nh"},
                                    {ElasticLaw::corotational, "corot"}}) {
        const double converged = reference[name]["tip_uz"]["value"];
        const Block b = cantilever(8, 2, ElementKind::quadratic, law, 0.4);
        INFO(name);
        CHECK(b.displacement(Vec3(tip[0], tip[1], tip[2])).z() == Approx(converged).epsilon(0.04));
    }
    const double converged = reference["stvk"]["tip_uz"]["value"];
    const Block finer = cantilever(16, 4, ElementKind::quadratic, ElasticLaw::stvk, 0.4);
    CHECK(finer.displacement(Vec3(tip[0], tip[1], tip[2])).z() == Approx(converged).epsilon(0.012));
}

TEST_CASE(
    "Cook's panel does not lock: quadratic tets stay within 3 % from nu = 0.3 to 0.499, where linear ones lose half") {
    const auto reference = accuracy()["cook_3d"]["continuum"];
    for (const char* nu : {"0.3", "0.45", "0.49", "0.499"}) {
        const double converged = reference[std::string("nu=") + nu]["uy_mid"]["value"];
        const Block b = cook(8, 2, std::stod(nu), ElementKind::quadratic); // 768 tets
        INFO("nu " << nu);
        CHECK(b.displacement(Vec3(0.48, 0.6, 0)).y() == Approx(converged).epsilon(0.03));
    }
    const Block locked = cook(8, 2, 0.499, ElementKind::linear);
    CHECK(locked.displacement(Vec3(0.48, 0.6, 0)).y() == Approx(0.027976402).epsilon(1e-4)); // its exact discrete value
}

TEST_CASE("a nearly incompressible step that is stopped midway leaves nothing behind in the workspace") {
    TissueInputs values = material(1e6, 0.3);
    values.layers[0].volume_conservation = 1e9;
    Block b(
        box_mesh({0.8, 0.1, 0.1}, 8, 1, 1), ElasticLaw::neo_hookean, ElementKind::linear,
        [](const Vec3& p) { return p.x() < 1e-12; }, values);
    b.in.gravity = Vec3(0, 0, -9.81);
    Workspace fresh(b.scene), used(b.scene);
    int asked = 0;
    StepControl count;
    count.stop = [&] { return ++asked, false; };
    const std::vector<std::byte> expected = save(advance(fresh, b.state, std::span(&b.in, 1), count));
    const int all = asked;
    for (int stop_at = 1; stop_at <= all; ++stop_at) {
        asked = 0;
        StepControl control;
        control.stop = [&] { return ++asked == stop_at; };
        CHECK_THROWS_AS(advance(used, b.state, std::span(&b.in, 1), control), Stopped);
        CHECK(save(advance(used, b.state, std::span(&b.in, 1))) == expected);
    }
}

namespace {

/// The volume inside the faces of all tets, each taken as n x n flat triangles between points that ride on it; those
/// that two tets share cancel.
double carried_volume(const Block& b, int n) {
    double volume = 0;
    constexpr int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    for (std::size_t t = 0; t < b.rest->tets.tets.size(); ++t)
        for (const auto& face : faces) {
            const auto point = [&](int i, int j) {
                std::array<double, 4> at{};
                at[static_cast<std::size_t>(face[0])] = 1 - static_cast<double>(i + j) / n;
                at[static_cast<std::size_t>(face[1])] = static_cast<double>(i) / n;
                at[static_cast<std::size_t>(face[2])] = static_cast<double>(j) / n;
                const PointWeights w = b.scene->embedded(0, static_cast<int>(t), at);
                Vec3 p = Vec3::Zero();
                for (int k = 0; k < w.count; ++k) p += w.weight[k] * position(b.state, w.vertex[k]);
                return p;
            };
            for (int i = 0; i < n; ++i)
                for (int j = 0; i + j < n; ++j) {
                    volume += point(i, j).dot(point(i + 1, j).cross(point(i, j + 1))) / 6;
                    if (i + j + 1 < n) volume += point(i + 1, j).dot(point(i + 1, j + 1).cross(point(i, j + 1))) / 6;
                }
        }
    return volume;
}

} // namespace

TEST_CASE("volume conservation keeps the volume of curved quadratic tets to the compliance asked for") {
    for (const double factor : {1e3, 1e7}) {
        const Block b = cantilever(8, 2, ElementKind::quadratic, ElasticLaw::neo_hookean, 0.3, factor * 1e6);
        // The chords of faces miss what bulges by the square of their length: extrapolated.
        const double coarse = carried_volume(b, 4), fine = carried_volume(b, 8), exact = fine + (fine - coarse) / 3;
        double rest = 0;
        for (const Tet& t : b.rest->tets.tets) {
            const auto& x = b.rest->tets.vertices;
            rest += tet_volume(x[static_cast<std::size_t>(t[0])], x[static_cast<std::size_t>(t[1])],
                               x[static_cast<std::size_t>(t[2])], x[static_cast<std::size_t>(t[3])]);
        }
        INFO("volumeConservation " << factor << " E");
        CHECK(std::abs(exact / rest - 1) < 1e-6);
    }
}

TEST_CASE("volume conservation keeps the volume and does not lock, on linear patches and on quadratic tets") {
    const Vec3 at(tip[0], tip[1], tip[2]);
    // The incompressible limit has the same shear modulus: Young's modulus 3 mu. On quadratic tets with nu = 0.4999.
    const double mu = lame(1e6, 0.3).mu;
    const double incompressible =
        cantilever(12, 3, ElementKind::quadratic, ElasticLaw::neo_hookean, 0.4999, 0, 2 * 1.4999 * mu)
            .displacement(at)
            .z();
    const auto check_volume = [](const Block& b) {
        double before = 0, after = 0;
        for (const Tet& t : b.rest->tets.tets) {
            Vec3 p[4];
            for (std::size_t i = 0; i < 4; ++i) p[i] = position(b.state, t[i]);
            const auto& x = b.rest->tets.vertices;
            before += tet_volume(x[static_cast<std::size_t>(t[0])], x[static_cast<std::size_t>(t[1])],
                                 x[static_cast<std::size_t>(t[2])], x[static_cast<std::size_t>(t[3])]);
            after += tet_volume(p[0], p[1], p[2], p[3]);
        }
        CHECK(std::abs(after / before - 1) < 2e-3);
    };
    for (const double factor : {1e3, 1e7}) {
        INFO("volumeConservation " << factor << " E");
        const Block quadratic = cantilever(8, 2, ElementKind::quadratic, ElasticLaw::neo_hookean, 0.3, factor * 1e6);
        CHECK(quadratic.displacement(at).z() == Approx(incompressible).epsilon(0.05));
        // Linear tets are too stiff in bending anyway. Volume conservation must not make that worse: on every tet of
        // its own it would lock them to less than a tenth.
        const double free =
            cantilever(32, 4, ElementKind::linear, ElasticLaw::neo_hookean, 0.3, 0, 3 * mu).displacement(at).z();
        const Block patches = cantilever(32, 4, ElementKind::linear, ElasticLaw::neo_hookean, 0.3, factor * 1e6);
        INFO("linear " << free << ", with volume conservation " << patches.displacement(at).z() << ", converged "
                       << incompressible);
        CHECK(std::abs(patches.displacement(at).z()) > 0.95 * std::abs(free));
        check_volume(patches);
    }
}
