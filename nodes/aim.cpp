// aim: a matrix that brings what was modelled between two joints to where those joints are now.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/limits.h"
#include "nodes/matrices.h"

#include <Eigen/Geometry>

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<Vec3> start{
    .name = "start",
    .limits = within_reach,
    .doc = "The first joint at this frame, in scene units; what was at restStart comes to lie there.",
};
const Input<Vec3> end{
    .name = "end",
    .def = {1, 0, 0},
    .limits = within_reach,
    .doc = "The second joint, in scene units; gives the direction alone, nothing is stretched.",
};
const Input<Vec3> up{
    .name = "up",
    .def = {0, 1, 0},
    .unit = "1",
    .limits = within_reach,
    .doc = "A direction beside the line of the joints; what pointed to restUp points to its side. Of any length.",
};
const Input<Vec3> rest_start{
    .name = "restStart",
    .limits = within_reach,
    .doc = "The first joint where the bone was modelled, in scene units.",
    .keyable = false,
};
const Input<Vec3> rest_end{
    .name = "restEnd",
    .def = {1, 0, 0},
    .limits = within_reach,
    .doc = "The second joint there, in scene units; the default is a bone along x.",
    .keyable = false,
};
const Input<Vec3> rest_up{
    .name = "restUp",
    .def = {0, 1, 0},
    .unit = "1",
    .limits = within_reach,
    .doc = "The direction up there, as up.",
    .keyable = false,
};
const Output<Matrix4> out_matrix{
    .name = "outMatrix",
    .doc = "The motion from the rest joints to those at this frame: a rotation and a translation; for zBone.matrix.",
};

solver::Vec3 vector(const Vec3& v) { return {v[0], v[1], v[2]}; }

/// Columns: along the joints, up at a right angle to them, and the third.
solver::Mat3 axes(const Reads& in, const Input<Vec3>& from, const Input<Vec3>& to, const Input<Vec3>& upwards) {
    const solver::Vec3 along = (vector(in[to]) - vector(in[from])).stableNormalized();
    const solver::Vec3 wanted = vector(in[upwards]).stableNormalized();
    if (!(along.norm() > 0.5))
        in.fail(to.name, "DG110", std::string(from.name) + " and " + std::string(to.name) + " are the same point",
                "Give two joints.");
    const solver::Vec3 side = along.cross(wanted);
    if (!(side.norm() > 1e-6))
        in.fail(upwards.name, "DG110",
                std::string(upwards.name) +
                    (wanted.norm() > 0.5 ? " points along the line of the joints" : " has no length"),
                "Give a direction beside that line.");
    solver::Mat3 out;
    out.col(0) = along;
    out.col(2) = side.normalized();
    out.col(1) = out.col(2).cross(along);
    return out;
}

void compute(const Reads& in, Writes& out) {
    const solver::Mat3 turn = axes(in, start, end, up) * axes(in, rest_start, rest_end, rest_up).transpose();
    const solver::Vec3 shift = vector(in[start]) - turn * vector(in[rest_start]);
    Matrix4 m = identity_matrix;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        for (std::size_t j = 0; j < 3; ++j) m[4 * i + j] = turn(row, static_cast<Eigen::Index>(j));
        m[4 * i + 3] = shift[row];
    }
    out.set(out_matrix, m);
}

} // namespace

void add_aim(Registry& registry) {
    NodeType type;
    type.name = "aim";
    type.doc = "Places a bone between two joints, with a direction for up, instead of angles.";
    type.inputs = {describe(start),      describe(end),      describe(up),
                   describe(rest_start), describe(rest_end), describe(rest_up)};
    type.outputs = {describe(out_matrix)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
