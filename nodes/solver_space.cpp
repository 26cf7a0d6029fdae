// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/solver_space.h"

#include "nodes/matrices.h"
#include "nodes/z_solver_attributes.h"
#include "solver/mesh/rigid_motion.h"
#include "solver/terms/hold/hold.h"

#include <Eigen/LU>
#include <cmath>

namespace sinew::nodes {

using engine::Matrix4;
using engine::Reads;
using solver::Mat3;
using solver::Points;
using solver::Vec3;

namespace {

using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

/// How unlike one scale for all directions a matrix may be: recorded motion is rounded.
constexpr double even = 1e-5;

struct Similarity {
    double scale;
    Mat3 turn;
    Vec3 shift;
};

Similarity parts_of(const Matrix4& matrix) {
    const Eigen::Map<const RowMajor> m(matrix.data());
    const Mat3 linear = m.topLeftCorner<3, 3>();
    const double scale = std::cbrt(linear.determinant());
    return {scale, solver::best_rotation(linear / scale).toRotationMatrix(), m.topRightCorner<3, 1>()};
}

} // namespace

Matrix4 solver_frame(const Reads& in) {
    const Matrix4& above = in[z_solver::matrix];
    if (above != identity_matrix) {
        check_affine(in, z_solver::matrix.name, above);
        const Eigen::Map<const RowMajor> m(above.data());
        const Mat3 linear = m.topLeftCorner<3, 3>(), square = linear.transpose() * linear;
        const double size = square.trace() / 3;
        const double off = (square - size * Mat3::Identity()).cwiseAbs().maxCoeff();
        if (!(size > 0) || !(off <= even * size) || !(linear.determinant() > 0))
            in.fail(z_solver::matrix.name, "FE291",
                    !(size > 0)                 ? "the matrix makes everything flat"
                    : linear.determinant() <= 0 ? "the matrix mirrors"
                                                : "the matrix scales directions differently, or shears",
                    "Connect a transform that translates, rotates and scales evenly.");
    }
    const double s = in[z_solver::scale];
    return multiply(above, compose(in[z_solver::translate], in[z_solver::rotate], {s, s, s}, "xyz", {0, 0, 0}));
}

SolverSpace solver_space(double units, const Matrix4& at_start, const Matrix4& now) {
    SolverSpace out;
    out.units = units;
    if (at_start == now) return out;
    const Similarity from = parts_of(at_start), to = parts_of(now);
    out.moved = true;
    out.stretch = to.scale / from.scale;
    out.turn = to.turn * from.turn.transpose();
    out.shift = to.shift - out.stretch * (out.turn * from.shift);
    return out;
}

Points SolverSpace::to_metres(const Points& scene) const {
    Points out(scene);
    if (moved)
        for (Vec3& p : out) p = turn.transpose() * (p - shift) / stretch;
    if (units != 1)
        for (Vec3& p : out) p /= units;
    return out;
}

Points SolverSpace::to_scene(Points metres) const {
    if (units != 1)
        for (Vec3& p : metres) p *= units;
    if (moved)
        for (Vec3& p : metres) p = stretch * (turn * p) + shift;
    return metres;
}

Vec3 SolverSpace::place_in_scene(const Vec3& metres) const {
    const Vec3 p = metres * units;
    return moved ? Vec3(stretch * (turn * p) + shift) : p;
}

void take_into_space(const Reads& in, const SolverSpace& space, Force& hold) {
    if (!space.moved) return;
    auto values = solver::get_fields<solver::HoldValues>(hold.values);
    if (!static_cast<const solver::HoldRest*>(hold.rest.get())->follows_bone) {
        if (std::abs(space.stretch - 1) > 1e-9)
            in.fail(z_solver::scale.name, "FE292",
                    "the solver's scale changes, and a zHold keeps what it holds as large as it was",
                    "Hold it by a bone that is scaled along, attach it instead, or leave the scale alone.");
        solver::RigidMotion m = values.motion();
        m.rotation = Eigen::Quaterniond(solver::Mat3(space.turn.transpose())) * m.rotation;
        m.translation = space.turn.transpose() * (m.translation - space.shift / space.units);
        values.set_motion(m);
    }
    const Vec3 about = space.turn.transpose() *
                       (Vec3(values.about_x, values.about_y, values.about_z) - space.shift / space.units) /
                       space.stretch;
    values.about_x = about.x(), values.about_y = about.y(), values.about_z = about.z();
    put_fields(values, hold.values);
}

} // namespace sinew::nodes
