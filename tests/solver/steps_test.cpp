// Steps that fail, and what a frame of several sub-steps says of itself.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/implicit_form.h"
#include "solver/integrate/values_between.h"
#include "solver/residual_body.h"
#include "tests/support/trial.h"

#include <random>

using namespace sinew::test;

namespace {

constexpr Integrator schemes[] = {Integrator::backward_euler, Integrator::bdf2, Integrator::tr_bdf2};
constexpr double gravity = 8, step_size = 0.05;

/// A free tet, pulled to three times its length: its first step takes many iterations, and its middle just falls.
Trial stretched_tet(Integrator integrator) {
    Trial t(regular_tet(0.1), ElasticLaw::neo_hookean, ElementKind::linear, nowhere, material(1e6, 0.3));
    t.in.integrator = integrator;
    t.in.step_size = step_size;
    t.in.gravity = Vec3(0, 0, -gravity);
    t.in.tolerance_factor = 1e-4;
    t.start();
    t.place(everywhere, [](const Vec3& p) { return Vec3(3 * p.x(), 0.5 * p.y(), p.z()); });
    return t;
}

/// Of four equal masses.
double mean_z(const std::vector<double>& all) { return (all[2] + all[5] + all[8] + all[11]) / 4; }

} // namespace

TEST_CASE("a step that is taken in halves takes as long as it would have whole") {
    for (const Integrator integrator : schemes) {
        Trial t = stretched_tet(integrator);
        INFO("scheme " << static_cast<int>(integrator));
        const double start = mean_z(t.state.x);
        t.in.max_newton_iterations = 4;
        const State whole = advance(*t.workspace, t.state, std::span(&t.in, 1));
        CHECK_FALSE(whole.record.converged);
        CHECK(whole.record.halvings == 0);
        t.in.max_halvings = 12;
        const State halves = advance(*t.workspace, t.state, std::span(&t.in, 1));
        REQUIRE(halves.record.converged);
        CHECK(halves.record.halvings > 0);
        CHECK(halves.record.substeps == 1);
        // Nothing acts on the middle but gravity, which every scheme integrates to this speed in steps of any size.
        CHECK(mean_z(halves.v) == Approx(-gravity * step_size).epsilon(1e-6));
        if (integrator == Integrator::tr_bdf2)
            CHECK(mean_z(halves.x) - start == Approx(-0.5 * gravity * step_size * step_size).epsilon(1e-6));
        CHECK(halves.history.step_size == (integrator == Integrator::backward_euler ? 0 : halves.history.step_size));
        CHECK(halves.history.step_size < step_size);
    }
}

TEST_CASE("a sub-step that fails is not forgotten where the next one converges") {
    Trial t = stretched_tet(Integrator::backward_euler);
    std::vector<StepInputs> both(2, t.in);
    both[0].max_newton_iterations = 1;
    const State failed = advance(*t.workspace, t.state, std::span(both).first(1));
    REQUIRE_FALSE(failed.record.converged);
    const State good = advance(*t.workspace, failed, std::span(both).last(1));
    REQUIRE(good.record.converged);
    const State together = advance(*t.workspace, t.state, both);
    CHECK_FALSE(together.record.converged);
    CHECK(together.record.residual == failed.record.residual);
    CHECK(together.record.substeps == 2);
    CHECK(together.record.newton_iterations == 1 + good.record.newton_iterations);
    CHECK(together.steps == t.state.steps + 2);
    CHECK(together.x == good.x);
}

TEST_CASE("TR-BDF2 keeps the acceleration of a step that has converged, and of no other") {
    Trial t = stretched_tet(Integrator::tr_bdf2);
    const State good = advance(*t.workspace, t.state, std::span(&t.in, 1));
    REQUIRE(good.record.converged);
    REQUIRE(good.history.acceleration.size() == good.x.size());
    // The middle's, whatever the tet does.
    CHECK(mean_z(good.history.acceleration) == Approx(-gravity).epsilon(1e-6));
    t.in.max_newton_iterations = 1;
    const State failed = advance(*t.workspace, t.state, std::span(&t.in, 1));
    REQUIRE_FALSE(failed.record.converged);
    CHECK(failed.history.acceleration.empty());
    CHECK(failed.history.step_size == step_size);
}

TEST_CASE("progress counts sub-steps, and iterations as shares of one") {
    Trial t = stretched_tet(Integrator::backward_euler);
    t.in.max_newton_iterations = 50;
    const std::vector<StepInputs> four(4, t.in);
    std::vector<double> told;
    std::vector<int> iterations;
    StepControl control;
    control.progress = [&](double done, int iteration, double) {
        told.push_back(done), iterations.push_back(iteration);
    };
    REQUIRE(advance(*t.workspace, t.state, four, control).record.converged);
    int substep = -1;
    for (std::size_t i = 0; i < told.size(); ++i) {
        if (iterations[i] == 0) ++substep;
        CHECK(told[i] == Approx((substep + iterations[i] / 50.0) / 4).epsilon(1e-14));
    }
    CHECK(substep == 3);
    CHECK(iterations.size() > 8);
}

TEST_CASE("BDF2 goes on over steps that grow by less than it is stable for") {
    // Variable-step BDF2 is zero-stable for ratios below 1 + sqrt 2 (Hairer, Norsett and Wanner, Solving ODEs I,
    // III.5).
    State s;
    CHECK_FALSE(has_bdf2_history(s, 1));
    s.history.step_size = 1;
    CHECK((has_bdf2_history(s, 0.1) && has_bdf2_history(s, 1) && has_bdf2_history(s, 2.39)));
    CHECK_FALSE((has_bdf2_history(s, 2.41) || has_bdf2_history(s, 3) || has_bdf2_history(s, 20)));
}

TEST_CASE("layers share out masses in their order, each by its weight times its envelope") {
    const TetMesh mesh = regular_tet(0.1);
    TissueInputs values = material(1e5, 0.3, 1000);
    MaterialValues second = values.layers[0], third = values.layers[0];
    second.mass_density = 3000, second.envelope = 0.5;
    third.mass_density = 500, third.envelope = 1;
    values.layers.push_back(second), values.layers.push_back(third);
    Trial t(mesh, ElasticLaw::neo_hookean, ElementKind::linear, nowhere, values);
    t.rest->layer_weights = {{1.0}, {0.5}, {0.4}};
    t.use_backward_euler(0.01);
    t.start();
    t.values().forces.assign(4, Vec3(0, 0, 0.25)); // 1 N in all
    REQUIRE(t.step());
    // A quarter of 3000 over 1000 is 1500, and 0.4 of 500 over that 1100 kg/m^3.
    const double mass = 1100 * 0.001 / (6 * std::sqrt(2.0));
    CHECK(mean_z(t.state.v) == Approx(0.01 / mass).epsilon(1e-9));
}

TEST_CASE("halves of a step see what is keyed at their own times, whether gamma is told or guessed") {
    // Gravity grows from 0 to 8 m/s^2 over the step. TR-BDF2 integrates what is linear exactly, in halves too.
    for (const bool told : {false, true}) {
        Trial t(regular_tet(0.1), ElasticLaw::neo_hookean, ElementKind::linear, nowhere, material(1e6, 0.3));
        t.in.integrator = Integrator::tr_bdf2;
        t.in.step_size = step_size;
        t.in.tolerance_factor = 1e-4;
        t.start();
        REQUIRE(t.step()); // at rest, without gravity: what is keyed is known from here on
        t.place(everywhere, [](const Vec3& p) { return Vec3(3 * p.x(), 0.5 * p.y(), p.z()); });
        t.in.max_newton_iterations = 4;
        t.in.max_halvings = 12;
        t.in.gravity = Vec3(0, 0, -gravity);
        StepInputs now = t.in;
        if (told) {
            StepInputs within = t.in;
            within.gravity *= tr_bdf2_gamma;
            now.at_gamma = std::make_shared<const StepInputs>(within);
        }
        const State halves = advance(*t.workspace, t.state, std::span(&now, 1));
        INFO((told ? "told" : "guessed"));
        REQUIRE(halves.record.converged);
        CHECK(halves.record.halvings > 0);
        CHECK(mean_z(halves.v) == Approx(-0.5 * gravity * step_size).epsilon(1e-6));
    }
}

TEST_CASE("schemes refer strains to a mean of earlier shapes, whose weights are 1 together") {
    State s;
    s.x.assign(12, 0.0), s.v.assign(12, 0.0);
    s.history.x = s.x, s.history.v = s.v;
    s.history.step_size = 0.5;
    ImplicitForm form;
    for (const double ratio : {0.5, 1.0, 2.0}) {
        bdf2_form(s, 0.5 * ratio, form);
        CHECK(form.strain.start == Approx((1 + ratio) * (1 + ratio) / (1 + 2 * ratio)).epsilon(1e-14));
        CHECK(form.strain.between == Approx(-ratio * ratio / (1 + 2 * ratio)).epsilon(1e-14));
    }
    tr_bdf2_bdf2_form(s, s.x, s.v, 0.1, nullptr, form);
    const double root = std::sqrt(2.0); // gamma = 2 - sqrt 2
    CHECK(form.strain.between == Approx((root + 1) / 2).epsilon(1e-14));
    CHECK(form.strain.start == Approx(-(root - 1) / 2).epsilon(1e-14));
    CHECK(form.velocity_factor == Approx(2 / (0.1 * (2 - root))).epsilon(1e-14));
}

TEST_CASE("between two times each value is its share of both, and what comes or goes waits for the end") {
    const TetMesh mesh = regular_tet(0.1);
    SceneDescription d;
    auto body = tissue(mesh, ElasticLaw::stvk);
    body->fibers = {{{Vec3(1, 0, 0)}, {1.0}}};
    d.bodies = {body, bone(mesh.vertices, body->triangles)};
    AttachmentRest tie;
    tie.source = 0, tie.target = 1, tie.source_weights = {1};
    d.attachments = {tie, tie};
    const Scene scene(d);
    const auto inputs = [&](double x) {
        StepInputs in = still_inputs();
        TissueInputs values = material(100 * x, 0.1 * x, 1000 * x);
        values.layers[0].envelope = 0.25 * x;
        values.compression_resistance = 7 * x, values.transverse_anisotropy = 0.2 * x;
        values.fibers = {{10 * x, 0.1 * x, 0.2 * x, 0.3 * x}};
        values.forces.assign(4, Vec3(x, 2 * x, 3 * x));
        in.bodies = {values, BoneInputs{mesh.vertices}};
        in.gravity = Vec3(x, 2 * x, 3 * x);
        in.mass_damping = 4 * x, in.stiffness_damping = 5 * x;
        in.attachments = {{10 * x, 0.2 * x, 30 * x}, {10 * x, 0.2 * x, 30 * x}};
        return in;
    };
    StepInputs before = inputs(1), after = inputs(3), out;
    before.attachments[1].envelope = 0; // made within the step
    values_between(scene, before, after, 0.25, out);
    const double x = 1.5;
    CHECK((out.gravity - Vec3(x, 2 * x, 3 * x)).norm() < 1e-15);
    CHECK((out.mass_damping == Approx(4 * x) && out.stiffness_damping == Approx(5 * x)));
    const auto& t = std::get<TissueInputs>(out.bodies[0]);
    const MaterialValues& m = t.layers[0];
    CHECK((m.youngs_modulus == Approx(100 * x) && m.poissons_ratio == Approx(0.1 * x)));
    CHECK((m.mass_density == Approx(1000 * x) && m.envelope == Approx(0.25 * x)));
    CHECK((t.compression_resistance == Approx(7 * x) && t.transverse_anisotropy == Approx(0.2 * x)));
    const FiberValues& f = t.fibers[0];
    CHECK((f.strength == Approx(10 * x) && f.contraction_limit == Approx(0.1 * x)));
    CHECK((f.excitation == Approx(0.2 * x) && f.envelope == Approx(0.3 * x)));
    for (const Vec3& load : t.forces) CHECK((load - Vec3(x, 2 * x, 3 * x)).norm() < 1e-15);
    const AttachmentInputs& a = out.attachments[0];
    CHECK((a.stiffness == Approx(10 * x) && a.envelope == Approx(0.2 * x) && a.damping == Approx(30 * x)));
    const AttachmentInputs& made = out.attachments[1];
    CHECK((made.stiffness == Approx(30) && made.envelope == Approx(0.6) && made.damping == Approx(90)));
    // No loads are loads of zero.
    std::get<TissueInputs>(before.bodies[0]).forces.clear();
    values_between(scene, before, after, 0.25, out);
    for (const Vec3& load : std::get<TissueInputs>(out.bodies[0]).forces)
        CHECK((load - 0.75 * Vec3(1, 2, 3)).norm() < 1e-15);
    std::get<TissueInputs>(before.bodies[0]).forces.assign(4, Vec3(4, 0, 0));
    std::get<TissueInputs>(after.bodies[0]).forces.clear();
    values_between(scene, before, after, 0.25, out);
    REQUIRE(std::get<TissueInputs>(out.bodies[0]).forces.size() == 4);
    for (const Vec3& load : std::get<TissueInputs>(out.bodies[0]).forces) CHECK((load - Vec3(3, 0, 0)).norm() < 1e-15);
}

TEST_CASE("a body's forces are judged against the largest of those at work: loads, weight or inertia") {
    const TetMesh mesh = regular_tet(0.1);
    const double mass = 1000 * 0.001 / (6 * std::sqrt(2.0)) / 4; // of a vertex
    const auto at_work = [&](const Vec3& load, double g, double accelerated) {
        Trial t(mesh, ElasticLaw::stvk, ElementKind::linear, nowhere, material(1, 0.3, 1000)); // next to no stiffness
        if (accelerated != 0) t.use_backward_euler(0.1);
        t.in.gravity = Vec3(0, 0, -g);
        t.values().forces.assign(4, load);
        t.start();
        for (double& v : t.state.v) v = 0;
        for (std::size_t i = 2; i < 12; i += 3) t.state.v[i] = accelerated * 0.1;
        Trial::Judge judge(t, t.state);
        std::vector<double> gradient;
        std::vector<BodyForces> forces;
        judge.potential.begin_iteration(t.state.x);
        judge.potential.evaluate(t.state.x, &gradient, &forces);
        return forces.at(0).at_work;
    };
    CHECK(at_work({0.3, 0, -0.4}, 0, 0) == Approx(0.5 * 2).epsilon(1e-12)); // four loads of 0.5 N: sqrt(4 0.25)
    CHECK(at_work({0, 0, 0}, 10, 0) == Approx(10 * mass * 2).epsilon(1e-12));
    CHECK(at_work({0, 0, 0}, 0, 5) == Approx(5 * mass * 2).epsilon(1e-12));
    CHECK(at_work({0.3, 0, -0.4}, 10, 5) == Approx(1).epsilon(1e-12));
}

TEST_CASE("mass damping adds its rate of each mass to the Hessian") {
    const double mass = 1000 * 0.001 / (6 * std::sqrt(2.0)) / 4; // of a vertex
    const auto diagonal = [](double damping) {
        Trial t(regular_tet(0.1), ElasticLaw::stvk, ElementKind::linear, nowhere, material(1e4, 0.3, 1000));
        t.use_backward_euler(0.1);
        t.in.mass_damping = damping;
        t.start();
        Trial::Judge judge(t, t.state);
        std::vector<double> gradient;
        judge.potential.evaluate(t.state.x, &gradient, nullptr);
        BlockMatrix h(judge.potential.pattern());
        judge.potential.assemble(t.state.x, false, h);
        std::vector<double> out;
        for (int i = 0; i < 4; ++i) {
            const double* block = h.block(static_cast<std::size_t>(judge.potential.pattern().find(i, i)));
            for (int c = 0; c < 3; ++c) out.push_back(block[4 * c]);
        }
        return out;
    };
    const std::vector<double> without = diagonal(0), with = diagonal(3);
    for (std::size_t i = 0; i < 12; ++i) CHECK(with[i] - without[i] == Approx(3 * 10 * mass).epsilon(1e-9));
}

TEST_CASE("the body that is named with the residual is the one farthest from balance, wherever it stands") {
    struct Found {
        double residual;
        int body;
    };
    const auto look = [](const std::vector<double>& stretches) {
        SceneDescription d;
        StepInputs in = still_inputs();
        in.max_newton_iterations = 0; // each body is judged as it is
        for (std::size_t i = 0; i < stretches.size(); ++i) {
            TetMesh mesh = regular_tet(0.1);
            for (Vec3& p : mesh.vertices) p.x() += static_cast<double>(i);
            d.bodies.emplace_back(tissue(mesh, ElasticLaw::neo_hookean));
            in.bodies.emplace_back(material(1e5, 0.3));
        }
        const auto scene = std::make_shared<const Scene>(d);
        Workspace w(scene);
        State s = initial_state(*scene, in);
        for (std::size_t v = 0; v < s.x.size() / 3; ++v) {
            s.x[3 * v + 2] *= stretches[v / 4];
            s.v[3 * v] = v % 4 == 0 ? 1 : 0; // it deforms on its way, too
        }
        s = advance(w, s, std::span(&in, 1));
        REQUIRE_FALSE(s.record.converged);
        return Found{s.record.residual, residual_body(w)};
    };
    std::vector<double> order{1.001, 1.05, 1.5};
    do {
        std::size_t worst = 0;
        std::vector<double> alone;
        for (const double stretch : order) alone.push_back(look({stretch}).residual);
        for (std::size_t i = 0; i < 3; ++i)
            if (alone[i] > alone[worst]) worst = i;
        const Found found = look(order);
        INFO(alone[0] << " " << alone[1] << " " << alone[2]);
        CHECK(found.body == static_cast<int>(worst));
        CHECK(found.residual == Approx(alone[worst]).epsilon(1e-9));
        CHECK(*std::min_element(alone.begin(), alone.end()) < 0.995 * alone[worst]);
    } while (std::next_permutation(order.begin(), order.end()));
}

TEST_CASE("each of Newton's iterations ends lower than it began, from wherever it starts") {
    for (const ElasticLaw law : laws)
        for (const unsigned seed : {1u, 2u, 3u}) {
            Trial t(box_mesh({0.2, 0.2, 0.2}, 2, 2, 2), law, ElementKind::linear, at_root, material(1e4, 0.3));
            t.start();
            std::mt19937 random(seed);
            std::uniform_real_distribution<double> jitter(-0.06, 0.06); // of cells of 0.1: tets invert
            t.place([](const Vec3& p) { return !at_root(p); },
                    [&](const Vec3& p) { return Vec3(p + Vec3(jitter(random), jitter(random), jitter(random))); });
            const State start = t.state;
            Trial::Judge judge(t, start);
            const auto potential = [&](const State& s) { return judge.potential.evaluate(s.x, nullptr, nullptr); };
            double before = potential(start);
            for (int iterations = 1; iterations < 30; ++iterations) {
                t.in.max_newton_iterations = iterations;
                const State s = advance(*t.workspace, start, std::span(&t.in, 1));
                const double now = potential(s);
                INFO("law " << static_cast<int>(law) << ", seed " << seed << ", iteration " << iterations);
                CHECK(now <= before * (1 + 1e-12));
                before = now;
                if (s.record.converged) break;
            }
        }
}
