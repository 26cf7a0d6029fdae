// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/hard_judge.h"

#include "solver/linear/component_factors.h"
#include "solver/newton/potential.h"
#include "tools/bench/beams.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace sinew::bench {

using namespace solver;

namespace {

/// The stage that ends with the step. TR-BDF2's point at gamma h follows from its second stage's own formula,
/// x' = X + (gamma h / 2) v' with X = c1 x_gamma - c2 x, and the velocity there from the trapezoid rule.
void last_stage(const State& before, const StepInputs& in, const State& after, ImplicitForm& form,
                std::vector<double>& x_gamma) {
    const double h = in.step_size, g = tr_bdf2_gamma;
    switch (in.integrator) {
    case Integrator::quasi_static:
        return quasi_static_form(before, form);
    case Integrator::backward_euler:
        return backward_euler_form(before, h, form);
    case Integrator::bdf2:
        return bdf2_form(before, h, form);
    case Integrator::tr_bdf2: {
        const double middle = 1 / (g * (2 - g)), start = (1 - g) * (1 - g) * middle, half = 0.5 * g * h;
        std::vector<double> v_gamma(before.x.size());
        x_gamma.resize(before.x.size());
        for (std::size_t i = 0; i < before.x.size(); ++i) {
            x_gamma[i] = (after.x[i] - half * after.v[i] + start * before.x[i]) / middle;
            v_gamma[i] = (x_gamma[i] - before.x[i]) / half - before.v[i];
        }
        return tr_bdf2_bdf2_form(before, x_gamma, v_gamma, h, nullptr, form);
    }
    }
}

/// Adds this share of the largest entry there.
void add_to_diagonal(BlockMatrix& a, double share) {
    double largest = 0;
    const auto each = [&](const auto& act) {
        for (int row = 0; row < a.pattern->rows; ++row)
            for (std::size_t c = 0; c < 9; c += 4)
                act(a.block(static_cast<std::size_t>(a.pattern->row_start[static_cast<std::size_t>(row)]))[c]);
    };
    each([&](double& entry) { largest = std::max(largest, std::abs(entry)); });
    each([&](double& entry) { entry += share * largest; });
}

} // namespace

StepCheck check_step(const Scene& scene, const State& before, const StepInputs& in, const State& after) {
    StepCheck out;
    Potential potential(scene);
    potential.take(before, in);
    const std::size_t n = potential.unknown_count();
    if (n == 0) return out;
    ImplicitForm form;
    std::vector<double> x_gamma;
    last_stage(before, in, after, form, x_gamma);
    potential.begin_step(before, in);
    potential.begin_stage(before, form, after.bones);
    std::vector<double> gradient(3 * n), direction(3 * n);
    std::vector<BodyForces> forces;
    potential.renew(after.x);
    while (potential.widen(after.x)) {
    } // contacts that the start of the step does not tell of
    potential.evaluate(after.x, &gradient, &forces);
    for (const BodyForces& f : forces) out.residual = std::max(out.residual, f.sum / f.at_work);
    BlockMatrix hessian(potential.pattern());
    ComponentFactors factors(potential.pattern());
    potential.assemble(after.x, false, hessian);
    // Without inertia what nothing holds may go anywhere: of that only rounding says whether it is a minimum.
    if (in.integrator == Integrator::quasi_static) add_to_diagonal(hessian, 1e-10);
    out.definite = factors.factorize(hessian);
    if (!out.definite) {
        potential.assemble(after.x, true, hessian);
        if (!factors.factorize(hessian)) {
            out.move = INFINITY;
            return out;
        }
    }
    factors.solve(gradient.data(), direction.data());
    for (std::size_t u = 0; u < n; ++u) {
        const double move = position(direction, static_cast<int>(u)).norm();
        if (!(move <= out.move)) out.move = move; // kept if it is no number
    }
    return out;
}

double least_det(const Scene& scene, const std::vector<double>& x) {
    double least = INFINITY;
    for (int body = 0; body < scene.body_count(); ++body) {
        const TissueRest* tissue = scene.tissue(body);
        if (!tissue) continue;
        const bool quadratic = tissue->element == ElementKind::quadratic;
        const auto edges = quadratic ? edges_of(tissue->tets.tets) : std::vector<std::array<int, 2>>{};
        const int first = scene.first_vertex(body), corners = static_cast<int>(tissue->tets.vertices.size());
        const auto at = [&](int v) { return position(x, first + v); };
        for (const Tet& tet : tissue->tets.tets) {
            Mat3 rest, now;
            for (int c = 0; c < 3; ++c) {
                const auto corner = static_cast<std::size_t>(tet[static_cast<std::size_t>(c) + 1]);
                rest.col(c) = tissue->tets.vertices[corner] - tissue->tets.vertices[static_cast<std::size_t>(tet[0])];
            }
            const double volume = rest.determinant();
            // dx/d(lambda) at corner k: of linear tets everywhere x_i; of quadratic ones, where lambda_k = 1,
            // 4 x_ik - x_i for i not k, and 3 x_k.
            for (std::size_t k = 0; k < (quadratic ? 4u : 1u); ++k) {
                Vec3 slope[4];
                for (std::size_t i = 0; i < 4; ++i) {
                    slope[i] = at(tet[i]);
                    if (!quadratic) continue;
                    if (i == k) {
                        slope[i] *= 3;
                        continue;
                    }
                    const std::array<int, 2> edge{std::min(tet[i], tet[k]), std::max(tet[i], tet[k])};
                    const auto found = std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin();
                    slope[i] = 4 * at(corners + static_cast<int>(found)) - slope[i];
                }
                for (int c = 0; c < 3; ++c) now.col(c) = slope[c + 1] - slope[0];
                least = std::min(least, now.determinant() / volume);
            }
        }
    }
    return least;
}

std::string not_a_number(const State& s) {
    const std::pair<const char*, const std::vector<double>*> lists[] = {{"position", &s.x}, {"velocity", &s.v}};
    for (const auto& [what, numbers] : lists)
        for (const double c : *numbers)
            if (!std::isfinite(c)) return std::string("a ") + what + " is no number";
    const StepRecord& r = s.record;
    bool finite = std::isfinite(r.residual) && std::isfinite(r.energy) && std::isfinite(r.min_j);
    for (const Measured& m : r.measured) finite = finite && std::isfinite(m.value);
    if (!finite) return "a number of the report is none";
    return {};
}

} // namespace sinew::bench
