// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/arcs.h"

#include "solver/parallel.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>

namespace sinew::solver {

namespace {

Vec3 at(const std::vector<double>& values, std::size_t first) {
    return {values[first], values[first + 1], values[first + 2]};
}

/// Of the squares of a direction's turn: what may be left beside it.
constexpr double mostly_rigid = 0.01;
/// Of the gain: what a straight move may cost.
constexpr double worth_turning = 0.1;

/// The rate w with J w = L, none about axes along which the body has no extent.
Vec3 turn_rate(const Mat3& inertia, const Vec3& momentum) {
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(inertia);
    Vec3 rate = Vec3::Zero();
    for (int i = 0; i < 3; ++i)
        if (axes.eigenvalues()[i] > 1e-9 * axes.eigenvalues()[2])
            rate += axes.eigenvectors().col(i).dot(momentum) / axes.eigenvalues()[i] * axes.eigenvectors().col(i);
    return rate;
}

} // namespace

void Arcs::fit(const Potential& potential, const std::vector<double>& x, const std::vector<double>& direction,
               const std::vector<double>& gain) {
    const std::vector<double>& weight = potential.vertex_stiffness();
    const std::vector<int>& unknown = potential.numbering().unknown;
    const std::vector<Deformable>& bodies = potential.numbering().deformables;
    turns_.resize(bodies.size());
    for (std::size_t t = 0; t < turns_.size(); ++t) {
        // Held vertices too: they are known to stay.
        const std::size_t first = bodies[t].first_vertex, count = bodies[t].vertex_count;
        const auto moves_by = [&](std::size_t v) {
            return unknown[v] < 0 ? Vec3(Vec3::Zero()) : at(direction, 3 * static_cast<std::size_t>(unknown[v]));
        };
        const auto linear = ordered_sums<7>(count, [&](std::size_t i, std::array<double, 7>& sums) {
            const std::size_t v = first + i;
            const Vec3 p = weight[v] * at(x, 3 * v), d = weight[v] * moves_by(v);
            sums[0] += weight[v];
            for (std::size_t c = 0; c < 3; ++c)
                sums[1 + c] += p[static_cast<Eigen::Index>(c)], sums[4 + c] += d[static_cast<Eigen::Index>(c)];
        });
        Turn& turn = turns_[t];
        turn = {Vec3::Zero(), Vec3::Zero()};
        if (!(linear[0] > 0)) continue;
        turn.centre = Vec3(linear[1], linear[2], linear[3]) / linear[0];
        const Vec3 shift = Vec3(linear[4], linear[5], linear[6]) / linear[0];
        const auto angular = ordered_sums<10>(count, [&](std::size_t i, std::array<double, 10>& sums) {
            const std::size_t v = first + i;
            const Vec3 r = at(x, 3 * v) - turn.centre, d = moves_by(v) - shift, l = r.cross(d);
            const double w = weight[v];
            sums[0] += w * r.x() * r.x(), sums[1] += w * r.y() * r.y(), sums[2] += w * r.z() * r.z();
            sums[3] += w * r.y() * r.z(), sums[4] += w * r.z() * r.x(), sums[5] += w * r.x() * r.y();
            for (std::size_t c = 0; c < 3; ++c) sums[6 + c] += w * l[static_cast<Eigen::Index>(c)];
            sums[9] += w * d.squaredNorm();
        });
        Mat3 inertia;
        inertia << angular[1] + angular[2], -angular[5], -angular[4], //
            -angular[5], angular[2] + angular[0], -angular[3],        //
            -angular[4], -angular[3], angular[0] + angular[1];
        if (!inertia.allFinite()) continue;
        const Vec3 momentum(angular[6], angular[7], angular[8]), rate = turn_rate(inertia, momentum);
        const double turning = rate.dot(momentum), bending = angular[9] - turning; // summed squares of both parts
        // A straight move by the angle theta strains what it should turn by theta^2/2. Where more than that is bent, an
        // arc would strain what does not turn with the rest, such as the tets about held vertices.
        const double theta = rate.norm(), strain = 0.5 * theta * theta;
        if (bending < std::min(mostly_rigid, 0.25 * theta * theta) * turning &&
            0.5 * linear[0] * strain * strain > worth_turning * gain[t])
            turn.rate = rate;
    }
}

void Arcs::move(const Potential& potential, const std::vector<double>& x, const std::vector<double>& direction,
                double share, std::vector<double>& out) const {
    const std::vector<int>& vertex_of = potential.numbering().vertex_of_unknown;
    out = x;
    for (std::size_t t = 0; t < turns_.size(); ++t) {
        const Turn& turn = turns_[t];
        const double angle = share * turn.rate.norm();
        // R - I - share [rate]x: what the arc adds to the straight move.
        Mat3 beyond = Mat3::Zero();
        if (angle > 0) {
            Mat3 k;
            const Vec3 axis = turn.rate.normalized();
            k << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
            const double half = std::sin(0.5 * angle);
            beyond = (std::sin(angle) - angle) * k + 2 * half * half * k * k;
        }
        const Deformable& body = potential.numbering().deformables[t];
        const std::size_t first = body.first_unknown, count = body.unknown_count;
        parallel_for(count, 4096, [&](std::size_t i) {
            const std::size_t v = 3 * static_cast<std::size_t>(vertex_of[first + i]);
            const Vec3 p = at(x, v), moved = p + share * at(direction, 3 * (first + i)) + beyond * (p - turn.centre);
            for (std::size_t c = 0; c < 3; ++c) out[v + c] = moved[static_cast<Eigen::Index>(c)];
        });
    }
}

} // namespace sinew::solver
