// Targets of rest shapes (terms/elastic/rest_shape.h): stretches and blends in closed form, free bodies that come to
// rest in the target without stress, and a tissue in a target's shape that acts as one that was modelled so.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/elastic/rest_shape.h"

#include "solver/error.h"
#include "solver/mesh/harmonic.h"
#include "solver/meshing/lattice.h"
#include "solver/terms/elastic/rest_change.h"
#include "tests/support/rotated_box.h"
#include "tests/support/trial.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

using namespace sinew::test;

namespace {

TetMesh small_box() {
    TetMesh mesh = box_mesh({0.2, 0.1, 0.1}, 2, 1, 1);
    mesh.vertices[0] += Vec3(0.01, 0.02, -0.01);
    return mesh;
}

TetMesh cut_tets(ElementKind kind) {
    const SurfaceMesh box = RotatedBox({0.2, 0.1, 0.1}, 30, 30).surface(1);
    LatticeOptions options;
    options.tet_size = 0.15;
    options.moments = kind == ElementKind::quadratic ? 4 : 1;
    return make_lattice(box.points, box.triangles, options);
}

Points moved(const Points& points, const Map& to) {
    Points out;
    for (const Vec3& p : points) out.push_back(to(p));
    return out;
}

std::vector<double> everywhere(const TetMesh& mesh) { return std::vector<double>(mesh.tets.size(), 1.0); }

/// Adds a target and returns its place among the parts.
std::size_t add_target(Trial& t, const TetMesh& mesh, const Points& target, double weight) {
    auto shape = std::make_shared<RestShape>(make_rest_shape(mesh, target, everywhere(mesh)));
    t.description.parts.push_back({&rest_shape_type, {0}, shape});
    t.in.parts.push_back({weight});
    return t.in.parts.size() - 1;
}

Trial free_body(const TetMesh& mesh, ElasticLaw law, ElementKind kind, const TissueInputs& values) {
    Trial t(mesh, law, kind, nowhere, values);
    t.rest->stiff_directions.assign(mesh.tets.size(), Vec3(1, 2, 3).normalized());
    t.use_backward_euler(100);
    t.in.tolerance_factor = 1e-4;
    return t;
}

/// Greatest difference of a distance between two nodes from that after `to`, as a share of the latter.
double misshape(const Trial& t, const Map& to) {
    double worst = 0;
    for (std::size_t a = 0; a < t.nodes.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) {
            const double wanted = (to(t.nodes[a]) - to(t.nodes[b])).norm();
            const double is = (position(t.state, static_cast<int>(a)) - position(t.state, static_cast<int>(b))).norm();
            worst = std::max(worst, std::abs(is - wanted) / wanted);
        }
    return worst;
}

Mat3 shear() {
    Mat3 m = Mat3::Identity();
    m(0, 1) = 0.4, m(1, 2) = -0.2;
    return m;
}

Mat3 of_three(double x, double y, double z) { return Vec3(x, y, z).asDiagonal(); }

RestShapes together(const std::vector<const RestShape*>& shapes, const std::vector<double>& weights) {
    return {shapes, weights};
}

std::string code_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error& e) {
        return e.code;
    }
    return "";
}

} // namespace

TEST_CASE("stretches of targets: turns mean nothing, weights are powers, targets multiply along the same axes",
          "[restshape]") {
    const TetMesh mesh = small_box();
    const auto shape = [&](const Mat3& f, const Vec3& shift = Vec3::Zero()) {
        return make_rest_shape(mesh, moved(mesh.vertices, [&](const Vec3& p) { return Vec3(f * p + shift); }),
                               everywhere(mesh));
    };
    const Mat3 turn = Eigen::AngleAxisd(1.2, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
    const RestShape big = shape(turn * 0.8, Vec3(5, 6, 7)), flat = shape(turn * of_three(2, 0.5, 1)),
                    long_one = shape(of_three(1, 1, 3));
    for (std::size_t tet = 0; tet < mesh.tets.size(); ++tet) {
        for (const double w : {1.0, 0.5, -1.0, 2.0})
            CHECK((together({&big}, {w}).stretch(tet) - std::pow(0.8, w) * Mat3::Identity()).norm() < 1e-13);
        CHECK((together({&flat}, {0.5}).stretch(tet) - of_three(std::sqrt(2), std::sqrt(0.5), 1)).norm() < 1e-13);
        CHECK((together({&flat, &long_one}, {1, 0.5}).stretch(tet) - of_three(2, 0.5, std::sqrt(3))).norm() < 1e-13);
        CHECK(together({&flat, &long_one}, {0, 0}).stretch(tet) == Mat3::Identity());
    }
    CHECK_FALSE(together({&flat, &long_one}, {0, 0}).act());
    // Axes that differ: the volume is still the product, and no blend of whatever weights is inside out.
    const RestShape oblique = shape(shear());
    for (const double w : {0.3, 1.0, -2.5, 4.0}) {
        const Mat3 u = together({&flat, &oblique, &long_one}, {w, 1 - w, -w}).stretch(0);
        CHECK(u.determinant() == Approx(std::pow(3, -w)).epsilon(1e-12));
        CHECK((u - u.transpose()).norm() < 1e-12);
        CHECK(Eigen::SelfAdjointEigenSolver<Mat3>(u).eigenvalues().minCoeff() > 0);
    }
    // A weight of 1 is the stretch of the polar decomposition.
    const Mat3 u = together({&oblique}, {1}).stretch(0);
    CHECK((u * u - shear().transpose() * shear()).norm() < 1e-13);
    CHECK(big.largest == Approx(-std::log(0.8)).epsilon(1e-12));
    CHECK(long_one.largest == Approx(std::log(3)).epsilon(1e-12));
}

TEST_CASE("targets come before restScale and growth, which run along what the target has stretched", "[restshape]") {
    const TetMesh mesh = small_box();
    Trial t = free_body(mesh, ElasticLaw::stvk, ElementKind::linear, {});
    t.values().layers = {{.rest_scale = 1.1}};
    const Vec3 along = Vec3(1, 1, 0).normalized();
    t.rest->fibers = {{Points(mesh.tets.size(), along), std::vector<double>(mesh.tets.size(), 1.0)}};
    t.values().fibers = {{.growth = 1.5}};
    const Mat3 f = of_three(3, 1, 1);
    const RestShape shape =
        make_rest_shape(mesh, moved(mesh.vertices, [&](const Vec3& p) { return Vec3(f * p); }), everywhere(mesh));
    const Vec3 a = (f * along).normalized(); // the fibres' line in the target
    const Mat3 grown = a * a.transpose() + 1.5 * (Mat3::Identity() - a * a.transpose());
    CHECK((rest_change(*t.rest, t.values(), 2, {{&shape}, {1}}) - 1.1 * grown * f).norm() < 1e-13);
}

TEST_CASE("a free body comes to rest in an affine target without stress, whatever its law and tets", "[restshape]") {
    for (const ElementKind kind : kinds)
        for (const ElasticLaw law :
             {ElasticLaw::stvk, ElasticLaw::neo_hookean, ElasticLaw::corotational, ElasticLaw::anisotropic})
            for (const bool cut : {false, true})
                for (const Mat3& f : {Mat3(1.3 * Mat3::Identity()), shear(), of_three(0.6, 1, 1.4)}) {
                    const TetMesh mesh = cut ? cut_tets(kind) : small_box();
                    const Map to = [&](const Vec3& p) { return Vec3(f * p); };
                    Trial t = free_body(mesh, law, kind, {});
                    t.values().layers = {{.volume_conservation = 2e4}};
                    add_target(t, mesh, moved(mesh.vertices, to), 1);
                    t.start();
                    REQUIRE(t.step());
                    INFO(static_cast<int>(law) << ", " << static_cast<int>(kind) << ", cut " << cut);
                    CHECK(t.state.record.converged);
                    CHECK(misshape(t, to) < 1e-6);
                    CHECK(t.state.record.energy < 1e-12);
                    CHECK(t.state.record.min_j == Approx(1).epsilon(1e-6));
                }
}

TEST_CASE("a body that is put into a bent target has no stress there", "[restshape]") {
    // Not affine: each tet is stretched otherwise. Quadratic tets with straight edges, as targets are.
    const Map to = [](const Vec3& p) { return Vec3(p.x() + 0.3 * p.y(), p.y() + 2 * p.x() * p.x(), 1.2 * p.z()); };
    for (const ElementKind kind : kinds) {
        const TetMesh mesh = small_box();
        Trial t = free_body(mesh, ElasticLaw::stvk, kind, {});
        t.values().layers = {{}};
        const Points target = moved(mesh.vertices, to);
        const std::size_t part = add_target(t, mesh, target, 1);
        t.start();
        for (std::size_t v = 0; v < target.size(); ++v) set_position(t.state, static_cast<int>(v), target[v]);
        if (kind == ElementKind::quadratic) {
            std::size_t v = target.size();
            for (const auto& [a, b] : edges_of(mesh.tets))
                set_position(t.state, static_cast<int>(v++),
                             0.5 * (target[static_cast<std::size_t>(a)] + target[static_cast<std::size_t>(b)]));
        }
        const std::vector<double> there = t.state.x;
        REQUIRE(t.step());
        double most = 0;
        for (std::size_t i = 0; i < there.size(); ++i) most = std::max(most, std::abs(t.state.x[i] - there[i]));
        CHECK(most < 1e-9);
        CHECK(t.state.record.energy < 1e-14);
        // And without the target it springs back to the model.
        t.in.parts[part] = {0};
        REQUIRE(t.step());
        CHECK(misshape(t, [](const Vec3& p) { return p; }) < 1e-6);
    }
}

TEST_CASE("a tissue in a target's shape acts as one that was modelled so", "[restshape]") {
    // Held at its root, pulled by its own fibres and by a load, with a stiff direction: every part of the law that a
    // direction or a volume enters. Its mass is the model's.
    const Map to = [](const Vec3& p) {
        return Vec3(1.2 * p.x(), p.y() + 1.5 * p.x() * p.x(), 0.8 * p.z() + 0.2 * p.x());
    };
    for (const ElementKind kind : kinds)
        for (const ElasticLaw law : {ElasticLaw::stvk, ElasticLaw::anisotropic}) {
            const TetMesh model = small_box();
            TetMesh sculpted = model;
            sculpted.vertices = moved(model.vertices, to);
            const Vec3 along = Vec3(2, 1, 0.3).normalized();
            TissueInputs values;
            values.layers = {{.volume_conservation = 1e4}};
            values.fibers = {{.strength = 8e3, .contraction_limit = 0.4, .excitation = 0.7}};
            values.transverse_anisotropy = 0.3;
            const auto make = [&](const TetMesh& mesh, bool in_target) {
                Trial t(mesh, law, kind, at_root, values);
                Points directions;
                for (const Tet& tet : mesh.tets) {
                    Mat3 was, is;
                    for (int k = 0; k < 3; ++k) {
                        const auto v = [&](int c) {
                            return static_cast<std::size_t>(tet[static_cast<std::size_t>(c)]);
                        };
                        was.col(k) = model.vertices[v(k + 1)] - model.vertices[v(0)];
                        is.col(k) = mesh.vertices[v(k + 1)] - mesh.vertices[v(0)];
                    }
                    directions.push_back((is * was.inverse() * along).normalized());
                }
                t.rest->fibers = {{directions, std::vector<double>(mesh.tets.size(), 1.0)}};
                t.rest->stiff_directions = directions;
                t.in.tolerance_factor = 1e-5;
                t.values().forces.assign(t.nodes.size(), Vec3(0.001, -0.02, 0.01));
                if (in_target) add_target(t, mesh, sculpted.vertices, 1);
                t.start();
                return t;
            };
            Trial changed = make(model, true), modelled = make(sculpted, false);
            // What holds the root stands where the model has it: the map leaves x = 0 as far along z alone, so hold
            // both there.
            for (std::size_t v = 0; v < changed.nodes.size(); ++v)
                if (at_root(changed.nodes[v])) REQUIRE(std::abs(to(changed.nodes[v]).x()) < 1e-12);
            INFO(static_cast<int>(law) << ", " << static_cast<int>(kind));
            // The same positions, other ways to them: energies and forces agree.
            State at = modelled.state;
            for (std::size_t i = 0; i < at.x.size(); ++i) at.x[i] += 0.004 * std::sin(3.0 * static_cast<double>(i));
            const auto evaluate = [&](Trial& t, std::vector<double>& gradient) {
                State before = t.state;
                before.x = at.x;
                t.state = before;
                Trial::Judge judge(t, before);
                std::vector<BodyForces> forces;
                return judge.potential.evaluate(at.x, &gradient, &forces);
            };
            std::vector<double> one, other;
            const double first = evaluate(changed, one), second = evaluate(modelled, other);
            CHECK(first == Approx(second).epsilon(1e-10));
            REQUIRE(one.size() == other.size());
            double most = 0, size = 0;
            for (std::size_t i = 0; i < one.size(); ++i)
                most = std::max(most, std::abs(one[i] - other[i])), size = std::max(size, std::abs(other[i]));
            CHECK(size > 0);
            CHECK(most < 1e-9 * size);
        }
}

TEST_CASE("weights of targets may change from step to step, and zero is no target, bit for bit", "[restshape]") {
    const TetMesh mesh = small_box();
    for (const Integrator scheme : {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2}) {
        const auto run = [&](bool with_target, const std::function<double(int)>& weight, bool resumed = false) {
            Trial t(mesh, ElasticLaw::stvk, ElementKind::quadratic, at_root, {});
            t.values().layers = {{}};
            t.in.integrator = scheme;
            t.in.step_size = 0.02;
            t.in.stiffness_damping = 0.002;
            t.in.gravity = {0, -9.8, 0};
            if (with_target)
                add_target(t, mesh, moved(mesh.vertices, [](const Vec3& p) { return Vec3(shear() * p); }), 0);
            t.start();
            for (int step = 0; step < 6; ++step) {
                if (with_target) t.in.parts[0] = {weight(step)};
                t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
                CHECK(t.state.record.converged);
                if (resumed && step == 2) {
                    t.state = load(save(t.state));
                    t.workspace = std::make_unique<Workspace>(t.scene);
                }
            }
            return t.state.x;
        };
        const auto ramp = [](int step) { return 0.2 * step; };
        CHECK(run(true, [](int) { return 0; }) == run(false, {}));
        CHECK(run(true, ramp) != run(false, {}));
        CHECK(run(true, ramp) == run(true, ramp, true));
        CHECK(run(true, [&](int step) { return step < 3 ? ramp(step) : 0; }) != run(false, {}));
    }
}

TEST_CASE("a surface's shape is carried to the tets: affine ones exactly, bent ones to the points of the surface",
          "[restshape]") {
    const SurfaceMesh box = RotatedBox({0.2, 0.1, 0.1}, 30, 30).surface(6);
    LatticeOptions options;
    options.tet_size = 0.04;
    const TetMesh mesh = make_lattice(box.points, box.triangles, options);
    const Embedding embedding = embed(mesh, box.points);
    const PaintedSurface surface{box.points, box.triangles, embedding};
    const auto carried = [&](const Map& to) { return carried_to_target(mesh, surface, moved(box.points, to)); };
    for (const Mat3& f : {Mat3(0.8 * Mat3::Identity()), shear()}) {
        const Map to = [&](const Vec3& p) { return Vec3(f * p + Vec3(1, 2, 3)); };
        const Points is = carried(to), wanted = moved(mesh.vertices, to);
        double most = 0;
        for (std::size_t v = 0; v < is.size(); ++v) most = std::max(most, (is[v] - wanted[v]).norm());
        CHECK(most < 1e-13);
    }
    const Map bent = [](const Vec3& p) { return Vec3(p.x(), p.y() + 1.5 * p.x() * p.x(), p.z()); };
    const Points tets = carried(bent);
    std::vector<double> x;
    for (const Vec3& p : tets) x.insert(x.end(), p.data(), p.data() + 3);
    Points on_surface;
    apply(embedding, mesh.tets, x.data(), on_surface);
    double most = 0;
    for (std::size_t v = 0; v < on_surface.size(); ++v)
        most = std::max(most, (on_surface[v] - bent(box.points[v])).norm());
    CHECK(most < 2e-3); // of 0.2, by tets of 0.04
    // And the tets that are solid for the most part are stretched as the map stretches them at their middles.
    const RestShape shape = make_rest_shape(mesh, tets, everywhere(mesh));
    double off = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        if (mesh.coverage[t] < 0.5) continue;
        double x = 0;
        for (const int v : mesh.tets[t]) x += 0.25 * mesh.vertices[static_cast<std::size_t>(v)].x();
        Mat3 f = Mat3::Identity();
        f(1, 0) = 3 * x;
        const Mat3 u = together({&shape}, {1}).stretch(t);
        off = std::max(off, (u * u - f.transpose() * f).norm());
    }
    CHECK(off < 0.2); // of a strain of up to 0.6
}

TEST_CASE("targets that cannot be shapes of rest are refused", "[restshape]") {
    const TetMesh mesh = small_box();
    // Turned as a whole, wherever it is painted on, or in places alone.
    const auto said_of = [&](const Map& to, std::vector<double> paint) -> std::string {
        try {
            make_rest_shape(mesh, moved(mesh.vertices, to), paint);
        } catch (const Error& e) {
            return e.code + " " + e.what() + " | " + e.hint;
        }
        return "";
    };
    const auto mirror = [](const Vec3& p) { return Vec3(-p.x(), p.y(), p.z()); };
    const std::string all = std::to_string(mesh.tets.size()), mirrored = "It is a mirror image of the tissue, or flat";
    std::vector<double> first(mesh.tets.size(), 0.0);
    first[0] = 1;
    const std::string whole = said_of(mirror, everywhere(mesh)), part = said_of(mirror, first);
    CHECK(whole.starts_with("FE286 the target turns " + all + " of " + all + " tets inside out; the first is tet 0"));
    CHECK(part.starts_with("FE286 the target turns 1 of " + all + " tets inside out; the first is tet 0"));
    CHECK(whole.find(mirrored) != std::string::npos);
    CHECK(part.find(mirrored) != std::string::npos);
    const auto fold = [](const Vec3& p) { return Vec3(std::abs(p.x() - 0.08), p.y(), p.z()); };
    CHECK(said_of(fold, everywhere(mesh)).find("Choose smaller tets") != std::string::npos);
    // What is not painted may do as it likes.
    CHECK_NOTHROW(
        make_rest_shape(mesh, Points(mesh.vertices.size(), Vec3::Zero()), std::vector<double>(mesh.tets.size(), 0.0)));
    CHECK(code_of([&] { make_rest_shape(mesh, Points(mesh.vertices.size(), Vec3::Zero()), everywhere(mesh)); }) ==
          "FE286");
    const RestShape large =
        make_rest_shape(mesh, moved(mesh.vertices, [](const Vec3& p) { return Vec3(100 * p); }), everywhere(mesh));
    CHECK(code_of([&] { check_rest_shapes({{&large}, {1.4}}); }).empty());
    CHECK(code_of([&] { check_rest_shapes({{&large}, {-1.6}}); }) == "FE247");
    CHECK(code_of([&] { check_rest_shapes({{&large, &large}, {0.8, 0.8}}); }) == "FE247");
    const auto apart = [&](double share) { check_rest_shapes({{&large}, {share}}); };
    CHECK_THROWS_WITH(apart(2), "the rest shapes together stretch the tissue at rest by up to 10000 or its reciprocal");
    CHECK_THROWS_WITH(
        apart(200),
        "the rest shapes together stretch the tissue at rest by more than 1e9 or its reciprocal, as flat ones do");
}
