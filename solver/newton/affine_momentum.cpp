// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/affine_momentum.h"

#include "solver/parallel.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace sinew::solver {

namespace {

/// What of the squared extent counts as none, so that flat bodies and those of a single point have no modes across.
constexpr double flat = 1e-12;

double share_of(const Deformable& d, const StepInputs& inputs) {
    const double damping = inertial_damping(inputs.bodies[static_cast<std::size_t>(d.body)]);
    return damping > 0 ? 1 - std::pow(1 - damping, inputs.step_size / affine_damping_time) : 0;
}

Vec3 at(const std::vector<double>& values, std::size_t index) {
    return {values[3 * index], values[3 * index + 1], values[3 * index + 2]};
}

Mat3 pseudo_inverse(const Mat3& spread) {
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(spread);
    Mat3 out = Mat3::Zero();
    for (int i = 0; i < 3; ++i) {
        const double extent = axes.eigenvalues()[i];
        if (!(extent > flat * axes.eigenvalues()[2])) continue;
        out += axes.eigenvectors().col(i) * axes.eigenvectors().col(i).transpose() / extent;
    }
    return out;
}

} // namespace

bool damps_affine_momentum(const StepInputs& inputs) {
    return std::any_of(inputs.bodies.begin(), inputs.bodies.end(),
                       [](const BodyInputs& body) { return inertial_damping(body) > 0; });
}

void AffineMomentum::remove(const Numbering& numbering, const MassMatrix& masses, const StepInputs& inputs,
                            const std::vector<double>& x, std::vector<double>& v) {
    const std::size_t n = numbering.unknown_count();
    ones_.assign(3 * n, 1.0), places_.resize(3 * n), speeds_.resize(3 * n);
    for (std::size_t u = 0; u < n; ++u) {
        const std::size_t vertex = 3 * static_cast<std::size_t>(numbering.vertex_of_unknown[u]);
        for (std::size_t c = 0; c < 3; ++c) places_[3 * u + c] = x[vertex + c], speeds_[3 * u + c] = v[vertex + c];
    }
    masses.multiply(ones_, mass_);
    masses.multiply(places_, of_place_);
    masses.multiply(speeds_, of_speed_);
    for (const Deformable& body : numbering.deformables) {
        const double share = share_of(body, inputs);
        if (share == 0) continue;
        const std::size_t first = body.first_unknown, count = body.unknown_count;
        const auto sums = ordered_sums<7>(count, [&](std::size_t i, std::array<double, 7>& sum) {
            const std::size_t u = first + i;
            sum[0] += mass_[3 * u];
            for (std::size_t c = 0; c < 3; ++c) sum[1 + c] += of_place_[3 * u + c], sum[4 + c] += of_speed_[3 * u + c];
        });
        if (!(sums[0] > 0)) continue;
        const Vec3 centre = Vec3(sums[1], sums[2], sums[3]) / sums[0];
        const Vec3 drift = Vec3(sums[4], sums[5], sums[6]) / sums[0];
        // With r = x - c: sum of r M r^T, and of M v r^T; those of the mean velocity vanish, as sum M r does.
        const auto moments = ordered_sums<18>(count, [&](std::size_t i, std::array<double, 18>& sum) {
            const std::size_t u = first + i;
            const Vec3 r = at(places_, u) - centre, m_r = at(of_place_, u) - mass_[3 * u] * centre,
                       m_v = at(of_speed_, u);
            for (Eigen::Index a = 0; a < 3; ++a)
                for (Eigen::Index b = 0; b < 3; ++b) {
                    sum[static_cast<std::size_t>(3 * a + b)] += r[a] * m_r[b];
                    sum[static_cast<std::size_t>(9 + 3 * a + b)] += m_v[a] * r[b];
                }
        });
        using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
        const Mat3 spread = Eigen::Map<const RowMajor>(moments.data());
        const Mat3 flow = Eigen::Map<const RowMajor>(moments.data() + 9);
        const Mat3 rate = flow * pseudo_inverse(0.5 * (spread + spread.transpose()));
        parallel_for(count, 4096, [&](std::size_t i) {
            const std::size_t u = first + i, vertex = 3 * static_cast<std::size_t>(numbering.vertex_of_unknown[u]);
            const Vec3 affine = drift + rate * (at(places_, u) - centre);
            for (std::size_t c = 0; c < 3; ++c) v[vertex + c] -= share * affine[static_cast<Eigen::Index>(c)];
        });
    }
}

} // namespace sinew::solver
