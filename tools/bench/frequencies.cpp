// Natural frequencies by inverse subspace iteration with Rayleigh-Ritz on the engine's own matrices.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/cholesky.h"
#include "tools/bench/studies.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

namespace sinew::bench {

using namespace solver;

namespace {

/// The Hessian at rest of `form`'s potential.
BlockMatrix assembled(Potential& potential, const State& state, const ImplicitForm& form) {
    potential.begin_stage(state, form, state.bones);
    BlockMatrix a(potential.pattern());
    potential.assemble(state.x, false, a);
    return a;
}

} // namespace

std::vector<double> natural_frequencies(const TissueRest& rest, const TissueInputs& values, int count) {
    const Scene scene({{std::make_shared<const TissueRest>(rest)}, {}});
    StepInputs in = tight_inputs();
    in.bodies = {values};
    State state = initial_state(scene, in);
    Potential potential(scene);
    potential.take(state, in);
    potential.begin_step(state, in);
    ImplicitForm still, moving;
    quasi_static_form(state, still);
    const BlockMatrix stiffness = assembled(potential, state, still);
    // A short step, so that the mass is not lost in the rounding of the stiffness that it is added to.
    const double h = 1e-4;
    backward_euler_form(state, h, moving);
    BlockMatrix inertia = assembled(potential, state, moving);
    for (std::size_t i = 0; i < inertia.values.size(); ++i)
        inertia.values[i] = h * h * (inertia.values[i] - stiffness.values[i]);
    const auto times_mass = [&](const Eigen::MatrixXd& x) {
        Eigen::MatrixXd y(x.rows(), x.cols());
        for (Eigen::Index j = 0; j < x.cols(); ++j) multiply(inertia, x.col(j).data(), y.col(j).data());
        return y;
    };
    const Eigen::Index n = 3 * stiffness.pattern->rows;
    Cholesky factor(*stiffness.pattern);
    if (!factor.factorize(stiffness)) throw std::logic_error("the stiffness of a held body at rest is not definite");

    const Eigen::Index width =
        std::min<Eigen::Index>(n, count + 8); // more than asked for, so that the last ones settle too
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    Eigen::MatrixXd basis(n, width), image(n, width);
    for (Eigen::Index j = 0; j < width; ++j)
        for (Eigen::Index i = 0; i < n; ++i) basis(i, j) = normal(random);
    Eigen::VectorXd last = Eigen::VectorXd::Zero(count), now(count);
    for (int iteration = 0; iteration < 500; ++iteration) {
        const Eigen::MatrixXd load = times_mass(basis);
        for (Eigen::Index j = 0; j < width; ++j) factor.solve(load.col(j).data(), image.col(j).data());
        // K image = M basis, so the reduced stiffness needs no product with K.
        const Eigen::MatrixXd k = image.transpose() * load, m = image.transpose() * times_mass(image);
        const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> small(0.5 * (k + k.transpose()),
                                                                              0.5 * (m + m.transpose()));
        basis = image * small.eigenvectors();
        now = small.eigenvalues().head(count);
        if ((now - last).cwiseAbs().maxCoeff() < 1e-11 * now[0]) break;
        last = now;
    }
    std::vector<double> out;
    for (int i = 0; i < count; ++i) out.push_back(std::sqrt(now[i]) / (2 * M_PI));
    return out;
}

} // namespace sinew::bench
