// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/term_checks.h"

#include "solver/error.h"
#include "tests/support/count_allocations.h"
#include "tests/support/grid_matrix.h"

#include <Eigen/Dense>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <tbb/global_control.h>

namespace sinew::test {

using namespace solver;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A random direction over all vertices, as long as their spacing.
VectorXd direction(const TermProbe& probe, unsigned seed) {
    VectorXd out = as_vector(random_numbers(3 * probe.numbering().vertex_count(), seed));
    for (const Deformable& d : probe.numbering().deformables)
        out.segment(Eigen::Index(3 * d.first_vertex), Eigen::Index(3 * d.vertex_count)) *= d.spacing;
    return out;
}

/// Errors of central differences at halving distances. They must come down to `tolerance`, with the second order as
/// long as they stand out of the rounding noise (noise_at_1 / distance), or far below it: where a kink lies nearby, no
/// order is seen before the noise.
void check_order(const std::function<double(double)>& error, double noise_at_1, double tolerance) {
    constexpr int count = 16;
    double errors[count], least = std::numeric_limits<double>::infinity();
    double order = std::numeric_limits<double>::quiet_NaN();
    for (int k = 0; k < count; ++k) {
        const double h = 0.02 * std::pow(0.5, k);
        errors[k] = error(h);
        least = std::min(least, errors[k]);
        if (k > 0 && errors[k] > 100 * noise_at_1 / h) order = std::log2(errors[k - 1] / errors[k]);
    }
    INFO("least error " << least << " of " << tolerance << " allowed, order " << order);
    CHECK(least <= tolerance);
    if (!std::isnan(order)) CHECK((order >= 1.8 || least <= 1e-4 * tolerance));
}

bool can_be_asked(const TermExample& example, const Pose& pose) { return example.knows_inverted || !pose.inverted; }

} // namespace

void check_gradient(const TermExample& example) {
    TermProbe probe(example);
    const VectorXd d = direction(probe, 1);
    for (const Pose& pose : poses(probe)) {
        if (!can_be_asked(example, pose)) continue;
        INFO(pose.name);
        const std::vector<double> x(pose.x.data(), pose.x.data() + pose.x.size());
        const double value = probe.energy(pose.x), change = probe.term().begin_iteration(x);
        const double scale = probe.scale(pose.x);
        CHECK(probe.energy(pose.x) == Approx(value + change).margin(1e-12 * std::max(scale, std::abs(value))));
        const VectorXd g = probe.gradient(pose.x);
        REQUIRE(g.allFinite());
        if (!example.acts) {
            CHECK(g.isZero(0));
            CHECK(value == 0);
            continue;
        }
        if (!pose.smooth) continue;
        const double slope = g.dot(d);
        REQUIRE(slope != 0);
        check_order(
            [&](double h) {
                return std::abs((probe.energy(pose.x + h * d) - probe.energy(pose.x - h * d)) / (2 * h) - slope);
            },
            1e-15 * (scale + g.norm() * pose.x.norm()), 1e-6 * g.norm() * d.norm());
    }
}

void check_hessian(const TermExample& example) {
    TermProbe probe(example);
    const VectorXd d = probe.gather(direction(probe, 2));
    for (const Pose& pose : poses(probe)) {
        if (!can_be_asked(example, pose)) continue;
        INFO(pose.name);
        // Twice: what a term follows from iteration to iteration has come to rest then.
        const std::vector<double> x(pose.x.data(), pose.x.data() + pose.x.size());
        probe.term().begin_iteration(x), probe.term().begin_iteration(x);
        const MatrixXd h = probe.hessian(pose.x, false);
        REQUIRE(h.allFinite());
        if (!example.acts) CHECK(h.isZero(0));
        if (!pose.smooth || !example.acts || (!example.couples_all && pose.name != "near")) continue;
        const auto change = [&](const VectorXd& along, double step) -> VectorXd {
            const VectorXd move = step * probe.spread(along);
            return probe.gather(probe.gradient(pose.x + move) - probe.gradient(pose.x - move)) / (2 * step);
        };
        const double noise = 1e-15 * (probe.gradient(pose.x).norm() + h.norm() * pose.x.norm());
        if (example.has_energy) {
            const VectorXd exact = h * d;
            check_order([&](double step) { return (change(d, step) - exact).norm(); }, noise,
                        1e-6 * h.norm() * d.norm());
        } else { // the symmetric part of the forces' derivative
            // Several directions: the error along one may change its sign.
            const VectorXd hd = h * d;
            const VectorXd others[] = {probe.gather(direction(probe, 3)), probe.gather(direction(probe, 4)),
                                       probe.gather(direction(probe, 5))};
            check_order(
                [&](double step) {
                    const VectorXd along_d = change(d, step);
                    double squares = 0;
                    for (const VectorXd& e : others) {
                        const double off = 0.5 * (e.dot(along_d) + d.dot(change(e, step))) - e.dot(hd);
                        squares += off * off;
                    }
                    return std::sqrt(squares);
                },
                noise * (d.norm() + others[0].norm()) / std::sqrt(double(d.size())),
                1e-6 * h.norm() * d.norm() * others[0].norm());
        }
    }
}

void check_projection(const TermExample& example) {
    TermProbe probe(example);
    for (const Pose& pose : poses(probe)) {
        if (!can_be_asked(example, pose)) continue;
        INFO(pose.name);
        const MatrixXd exact = probe.hessian(pose.x, false), projected = probe.hessian(pose.x, true);
        REQUIRE(projected.allFinite());
        const VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(projected).eigenvalues();
        const double size = std::max(exact.norm(), projected.norm());
        CHECK(values.minCoeff() >= -1e-12 * size);
        if (!example.projects_exactly) continue;
        CHECK(Eigen::SelfAdjointEigenSolver<MatrixXd>(projected - exact).eigenvalues().minCoeff() >= -1e-9 * size);
    }
}

void check_sums(const TermExample& example) {
    if (!example.forces_cancel && !example.torques_cancel) return;
    TermProbe probe(example);
    for (const Pose& pose : poses(probe)) {
        if (!can_be_asked(example, pose)) continue;
        INFO(pose.name);
        const VectorXd g = probe.gradient(pose.x);
        Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
        double forces = 0, torques = 0;
        for (Eigen::Index i = 0; i < g.size(); i += 3) {
            const Vec3 f = g.segment<3>(i), x = pose.x.segment<3>(i);
            force += f, torque += x.cross(f);
            forces += f.norm(), torques += x.norm() * f.norm();
        }
        CHECK(force.norm() <= 1e-13 * forces);
        if (example.torques_cancel) CHECK(torque.norm() <= 1e-13 * torques);
    }
}

void check_turns(const TermExample& example) {
    if (!example.turns) return;
    const Mat3 turn = Eigen::AngleAxisd(2.3, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
    const Vec3 shift(0.4, -1.1, 0.7);
    TermProbe probe(example), turned(example, 1, turn, shift);
    for (const Pose& pose : poses(probe)) {
        if (!can_be_asked(example, pose) || !pose.smooth) continue;
        INFO(pose.name);
        VectorXd x = pose.x;
        for (Eigen::Index i = 0; i < x.size(); i += 3) x.segment<3>(i) = Vec3(turn * pose.x.segment<3>(i) + shift);
        probe.widen(pose.x), turned.widen(x);
        VectorXd g = probe.gradient(pose.x);
        for (Eigen::Index i = 0; i < g.size(); i += 3) g.segment<3>(i) = Vec3(turn * g.segment<3>(i));
        const double rounding = 1e-14 * probe.hessian(pose.x, false).norm() * x.norm();
        CHECK((turned.gradient(x) - g).norm() <= rounding + 1e-11 * g.norm());
        if (example.has_energy)
            CHECK(turned.energy(x) ==
                  Approx(probe.energy(pose.x)).margin(rounding * x.norm() + 1e-12 * probe.scale(pose.x)));
    }
}

void check_threads(const TermExample& example) {
    const auto run = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        TermProbe probe(example, 4);
        std::vector<double> out = probe.before().x;
        // Nearer than the pose that others check: laws that know no inverted tets must know it at this fineness too.
        const VectorXd start = Eigen::Map<const VectorXd>(out.data(), Eigen::Index(out.size())),
                       x = start + 0.05 * (poses(probe).front().x - start), g = probe.gradient(x);
        out.push_back(probe.energy(x));
        REQUIRE(std::isfinite(out.back()));
        out.insert(out.end(), g.data(), g.data() + g.size());
        for (const bool project : {false, true}) {
            const BlockMatrix h = probe.hessian_blocks(x, project);
            out.insert(out.end(), h.values.begin(), h.values.end());
            std::vector<double> product(std::size_t(g.size()), 0.0);
            if (!h.overlay.empty()) h.overlay.add_product(out.data(), product.data());
            out.insert(out.end(), product.begin(), product.end());
        }
        return out;
    };
    const std::vector<double> one = run(1), two = run(2);
    REQUIRE(one.size() == two.size());
    const auto differs = std::mismatch(one.begin(), one.end(), two.begin()).first;
    CHECK(differs - one.begin() == std::ssize(one)); // the first number that differs
}

void check_saving(const TermExample& example) {
    const ExampleScene made = example.make(1);
    Workspace one(made.scene), other(made.scene);
    State s = initial_state(*made.scene, made.inputs(0));
    for (int k = 1; k <= 4; ++k) {
        const StepInputs in = made.inputs(k);
        const State loaded = load(save(s));
        const State again = advance(other, loaded, std::span(&in, 1));
        s = advance(one, s, std::span(&in, 1));
        CHECK(again.x == s.x);
        CHECK(again.v == s.v);
        CHECK(again.memories == s.memories);
        CHECK(again.parts == s.parts);
    }
}

void check_allocations(const TermExample& example) {
    if (!counts_allocations() || !example.small) return;
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    const ExampleScene made = example.make(1);
    constexpr int first = 4, shorter = 3, longer = 8;
    std::vector<StepInputs> inputs;
    for (int k = 0; k <= first + longer; ++k) {
        inputs.push_back(made.inputs(k));
        inputs.back().linear_method = LinearMethod::iterative;
        inputs.back().max_halvings = 0;
    }
    Workspace w(made.scene);
    const std::span<const StepInputs> all(inputs);
    const State start = advance(w, initial_state(*made.scene, inputs.front()), all.subspan(1, first));
    advance(w, start, all.subspan(1 + first, longer)); // buffers grow to what these steps take
    std::size_t taken[2];
    for (const int steps : {shorter, longer}) {
        const std::size_t before = allocations().all;
        const State end = advance(w, start, all.subspan(1 + first, std::size_t(steps)));
        taken[steps == longer] = allocations().all - before;
        CHECK(end.record.converged);
        INFO("an example must move at every step: change a load or a value of it");
        CHECK(end.record.newton_iterations >= steps);
        CHECK(taken[steps == longer] > 0); // the returned state: else nothing is counted
    }
    CHECK(taken[1] == taken[0]);
}

void check_values(const TermExample& example) {
    const ExampleScene made = example.make(1);
    const std::vector<Part>& parts = made.scene->description().parts;
    Workspace w(made.scene);
    const State start = initial_state(*made.scene, made.inputs(0));
    for (std::size_t p = 0; p < parts.size(); ++p)
        for (std::size_t i = 0; i < parts[p].type->values.size(); ++i) {
            StepInputs in = made.inputs(1);
            in.parts[p][i] = std::numeric_limits<double>::quiet_NaN();
            INFO(parts[p].type->values[i].name);
            try {
                advance(w, start, std::span(&in, 1));
                FAIL("a value that is no number was taken");
            } catch (const Error& e) {
                CHECK(e.code == "FE304");
                CHECK(std::string(e.what()).find(parts[p].type->values[i].name) != std::string::npos);
                CHECK(e.body == parts[p].bodies.front());
            }
        }
}

} // namespace sinew::test
