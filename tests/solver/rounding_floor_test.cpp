// Where rounding ends a solve: at a tolerance below what double precision holds Newton's method stops there, says that
// it has converged, and leaves nothing that further steps would take away.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/rounding_floor.h"
#include "tests/support/trial.h"

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace sinew::test;

namespace {

/// The residuals at `steps` more of Newton's steps with a factor from the end of the trial's step: in the middle of
/// them.
double usual_residual(const Trial& t, const State& before, int steps) {
    Trial::Judge judge(t, before);
    Potential& potential = judge.potential;
    std::vector<double> x = t.state.x, gradient, direction;
    std::vector<BodyForces> forces;
    BlockMatrix hessian(potential.pattern());
    ComponentFactors factors(potential.pattern());
    std::vector<double> residuals;
    for (int i = 0; i < steps; ++i) {
        potential.evaluate(x, &gradient, &forces);
        double worst = 0;
        for (const BodyForces& f : forces) worst = std::max(worst, f.sum / f.at_work);
        residuals.push_back(worst);
        potential.assemble(x, false, hessian);
        REQUIRE(factors.factorize(hessian));
        direction.resize(gradient.size());
        factors.solve(gradient.data(), direction.data());
        for (std::size_t u = 0; u < potential.unknown_count(); ++u)
            for (std::size_t c = 0; c < 3; ++c)
                x[3 * static_cast<std::size_t>(potential.numbering().vertex_of_unknown[u]) + c] -= direction[3 * u + c];
    }
    std::nth_element(residuals.begin(), residuals.begin() + steps / 2, residuals.end());
    return residuals[std::size_t(steps / 2)];
}

} // namespace

TEST_CASE("below what double precision holds a solve ends on rounding's floor and says that it has converged") {
    for (const ElementKind kind : kinds)
        for (const ElasticLaw law : laws)
            for (const LinearMethod method : {LinearMethod::direct, LinearMethod::automatic})
                for (const bool moving : {false, true}) {
                    int iterations[2];
                    for (const bool tight : {false, true}) {
                        Trial t(box_mesh({0.4, 0.1, 0.1}, 8, 2, 2), law, kind, at_root, flesh(1e5, 0.4, 20000));
                        if (moving) t.use_backward_euler(1.0 / 24);
                        t.in.linear_method = method;
                        t.in.gravity = Vec3(0, 0, -9.8);
                        t.in.tolerance_factor = tight ? 1e-10 : 1;
                        t.in.max_newton_iterations = 60;
                        t.start();
                        const State before = t.state;
                        t.state = advance(*t.workspace, before, std::span(&t.in, 1));
                        iterations[tight] = t.state.record.newton_iterations;
                        INFO(t.name() << ", moving " << moving << ", method " << int(method) << ", "
                                      << iterations[tight] << " iterations, residual " << t.state.record.residual);
                        CHECK(t.state.record.converged);
                        if (!tight) continue;
                        CHECK(t.state.record.residual < 1e-9);
                        CHECK(t.state.record.residual > 1e-16); // the tolerance itself is out of reach
                        CHECK(iterations[1] <= iterations[0] + 8);
                        // Nor does whoever goes on get a digit further down (what is left differs by some five times
                        // between BLAS kernels).
                        CHECK(t.state.record.residual < 8 * usual_residual(t, before, 30));
                    }
                }
}

TEST_CASE("bodies far apart in stiffness, on springs, each end on a floor of their own") {
    const std::vector<double> moduli = {1e3, 1e9};
    Trial t(box_mesh({0.2, 0.05, 0.05}, 5, 1, 1), ElasticLaw::stvk, ElementKind::linear, nowhere,
            flesh(moduli[0], 0.4));
    t.description.bodies.push_back(t.rest);
    t.in.bodies.push_back(flesh(moduli[1], 0.4));
    t.add_bone(root_plate());
    for (const int body : {0, 1}) t.attach_root(body, 2, 1e6);
    t.use_backward_euler(1.0 / 24);
    t.in.gravity = Vec3(0, -9.8, 0);
    t.in.tolerance_factor = 1e-7;
    t.in.max_newton_iterations = 60;
    t.start();
    for (int i = 0; i < 5; ++i) {
        t.state = advance(*t.workspace, t.state, std::span(&t.in, 1));
        INFO(t.name());
        CHECK(t.state.record.converged);
        CHECK(t.state.record.newton_iterations < 20);
    }
}

namespace {

/// A floor that is told forces, after steps whose linear system leaves `left` times the force.
struct Told {
    Trial t{box_mesh({0.4, 0.1, 0.1}, 2, 1, 1), ElasticLaw::stvk, ElementKind::linear, at_root, flesh(1e5, 0.4)};
    std::unique_ptr<Trial::Judge> judge;
    BlockMatrix zero;
    RoundingFloor floor;
    Told()
        : judge(start(t))
        , zero(judge->potential.pattern()) {}
    static std::unique_ptr<Trial::Judge> start(Trial& t) {
        t.start();
        return std::make_unique<Trial::Judge>(t, t.state);
    }
    bool after(double sum, double left) {
        std::vector<double> gradient(3 * judge->potential.unknown_count(), 0.0), direction(gradient.size(), 0.0);
        gradient[5] = left; // a zero matrix leaves all of it
        floor.take_direction(judge->potential, zero, gradient, direction);
        const std::vector<BodyForces> forces{{sum, 1}};
        floor.take_forces(forces);
        return floor.reached(forces, 1e-11);
    }
};

} // namespace

TEST_CASE("a floor is two whole steps in a row that do not halve the force, and nothing less") {
    SECTION("two idle steps") {
        Told told;
        CHECK_FALSE(told.after(1e-8, 0));
        CHECK_FALSE(told.after(0.6e-8, 0));
        CHECK(told.after(0.9e-8, 0));
    }
    SECTION("as long as it falls by half it is no floor") {
        Told told;
        for (double force = 1e-7; force > 1e-10; force *= 0.49) CHECK_FALSE(told.after(force, 0));
    }
    SECTION("a fall in between starts anew") {
        Told told;
        told.after(1e-8, 0);
        told.after(0.9e-8, 0);
        CHECK_FALSE(told.after(0.4e-8, 0));
        CHECK_FALSE(told.after(0.4e-8, 0));
        CHECK(told.after(0.3e-8, 0));
    }
    SECTION("a badly solved system says nothing") {
        Told told;
        told.after(1e-8, 0);
        for (int i = 0; i < 9; ++i) CHECK_FALSE(told.after(1e-8, 0.3e-8));
        CHECK_FALSE(told.after(1e-8, 0.2e-8));
        CHECK(told.after(1e-8, 0.2e-8));
    }
    SECTION("a residual of any size that matters is never excused") {
        Told told;
        for (int i = 0; i < 9; ++i) CHECK_FALSE(told.after(1.1e-4, 0));
    }
    SECTION("nor one that is no number") {
        Told told;
        for (int i = 0; i < 9; ++i) CHECK_FALSE(told.after(NAN, 0));
    }
    SECTION("what was forgotten does not count") {
        Told told;
        told.after(1e-8, 0);
        told.after(1e-8, 0);
        told.floor.forget();
        CHECK_FALSE(told.after(1e-8, 0));
        CHECK_FALSE(told.after(1e-8, 0));
        CHECK(told.after(1e-8, 0));
    }
}

TEST_CASE("a body that rounding stopped does not excuse another one") {
    Told told;
    RoundingFloor floor;
    const std::vector<double> nothing(3 * told.judge->potential.unknown_count(), 0.0);
    for (double falling = 1e-7; falling > 1e-9; falling *= 0.3) {
        floor.take_direction(told.judge->potential, told.zero, nothing, nothing);
        const std::vector<BodyForces> forces{{1e-8, 1}, {falling, 1}};
        floor.take_forces(forces);
        CHECK_FALSE(floor.reached(forces, 1e-11));
    }
    CHECK(is_lower({{1, 1}, {0.7, 1}}, {{1, 1}, {1, 1}}, 1e-11));
    CHECK_FALSE(is_lower({{1, 1}, {0.8, 1}}, {{1, 1}, {1, 1}}, 1e-11));
    CHECK_FALSE(is_lower({{0.1, 1}, {1, 1}}, {{0.5, 1}, {1, 1}}, 0.6)); // within the tolerance already
}
