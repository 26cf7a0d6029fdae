// zHold: holds a painted part of a tissue exactly where it is, or moves it with a transform or a bone.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/body_maps.h"
#include "nodes/limits.h"
#include "nodes/matrices.h"
#include "nodes/options.h"
#include "nodes/subtissues.h"
#include "solver/terms/hold/hold.h"

#include <algorithm>
#include <cmath>

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<bool> enable{
    .name = "enable",
    .def = true,
    .doc = "Off holds nothing.",
    .keyable = false,
};
const Wire<Body> tissue{.name = "tissue", .doc = "The tissue or cloth that is held."};
const Input<NumberList> weights{
    .name = "weights",
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc =
        "One number per vertex or face of the tissue's mesh (see weightsOn), one for all, or none for 1 everywhere, "
        "which holds the whole tissue: nothing of it moves or deforms by itself then, and a check doubts it. What is "
        "above 0 is held, wholly. A face whose vertices are all painted is held with them. Exact for the "
        "painted part of the mesh: every corner (and edge, of quadratic tets) that carries some of it is held. Where "
        "the tets' surface is the mesh that is just the painted part; a lattice is held in all tets that the "
        "painted part passes, so up to one tet deep.",
};
const Input<std::string> weights_on{
    .name = "weightsOn",
    .def = std::string(word_of(solver::PaintedOn::vertices)),
    .doc = "What weights counts.",
    .keyable = false,
    .options = words(options_of<solver::PaintedOn>),
};
const Input<Matrix4> matrix{
    .name = "matrix",
    .def = identity_matrix,
    .limits = within_reach,
    .doc = "Moves what is held, from where it is modelled, as this matrix moves from its value at the start frame; "
           "connect transform.outMatrix. Turns and translations only.",
};
const Wire<Body> bone{
    .name = "bone",
    .doc = "Moves what is held with this bone, instead of by matrix. The bone keeps its shape and is among "
           "zSolver.bodies; one that is switched off holds nothing.",
    .required = false,
};
const Input<Vec3> moment_point{
    .name = "momentPoint",
    .limits = within_reach,
    .doc = "The point, in scene units, that the reported moment is about. It does not move with the hold.",
};
const Output<Force> out_force{
    .name = "outForce",
    .doc = "The hold, for zSolver.forces. The report gives the force and the moment with which it holds on to the "
           "tissue.",
};

/// What of a polygon mesh is painted.
solver::PaintedPart painted_part(const Reads& in, const Body& body) {
    const Mesh& mesh = body.rest->mesh;
    const std::string name = in.source_name(tissue.name);
    const NumberList each = painted_map(in, weights, weights_on, body, name);
    if (std::none_of(each.begin(), each.end(), [](double w) { return w > 0; }))
        in.fail(weights.name, "FE212", "nothing of " + name + " has a weight above 0", "Paint what is to be held.");
    const std::vector<solver::Triangle>& triangles = mesh.topology->triangles;
    if (meaning(options_of<solver::PaintedOn>, in[weights_on]) == solver::PaintedOn::vertices)
        return solver::painted_vertices(triangles, each);
    return solver::painted_triangles(triangles, mesh.points->size(), each);
}

solver::RigidMotion rigid_motion(const Reads& in) {
    if (in[matrix] == identity_matrix) return {};
    check_affine(in, matrix.name, in[matrix]);
    const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> m(in[matrix].data());
    const solver::Mat3 turn = m.topLeftCorner<3, 3>();
    const double off = (turn.transpose() * turn - solver::Mat3::Identity()).cwiseAbs().maxCoeff();
    if (!(off <= 1e-5) || turn.determinant() < 0)
        in.fail(matrix.name, "FE250",
                off <= 1e-5 ? std::string("the matrix mirrors")
                            : "the matrix scales or shears (by " + std::to_string(0.5 * off) + ")",
                "Use a transform that only translates and rotates; scale the meshes before they are connected.");
    return {solver::best_rotation(turn), m.topRightCorner<3, 1>()};
}

void compute(const Reads& in, Writes& out) {
    const Body& body = in[tissue];
    if (body.is_bone())
        in.fail(tissue.name, "FE218", in.source_name(tissue.name) + " is a bone, and moves as it is given",
                "Connect a tissue.");
    refuse_subtissue(in, tissue.name, body, in.source_name(tissue.name));
    const Body* moving = in.find(bone);
    if (moving && !moving->is_bone())
        in.fail(bone.name, "FE218", in.source_name(bone.name) + " is no bone: what deforms cannot hold another body",
                "Connect a zBone, or tie the two with a zAttachment.");
    if (moving && in[matrix] != identity_matrix)
        in.fail(matrix.name, "DG110", "both a matrix and a bone shall move what is held", "Connect one of the two.");
    Force f;
    f.type = &solver::hold_type;
    if (in[enable] && (!moving || moving->takes_part)) {
        f.bodies.push_back(id_of(body));
        if (moving) f.bodies.push_back(id_of(*moving));
    }
    auto rest = std::make_shared<solver::HoldRest>();
    rest->part = painted_part(in, body);
    rest->follows_bone = moving != nullptr;
    f.rest = std::move(rest);
    f.digest = Hasher().add("zHold").add_doubles(in[weights]).add(in[weights_on]).add(moving != nullptr).finish();
    solver::HoldValues values;
    values.set_motion(rigid_motion(in));
    values.about_x = in[moment_point][0], values.about_y = in[moment_point][1], values.about_z = in[moment_point][2];
    f.values.resize(f.type->values.size());
    put_fields(values, f.values);
    out.set(out_force, std::move(f));
}

} // namespace

void add_z_hold(Registry& registry) {
    NodeType type;
    type.name = "zHold";
    type.doc = "Holds a painted part of a tissue or cloth exactly where it is, or moves it rigidly with a transform or "
               "a bone.";
    type.inputs = {describe(enable), describe(tissue), describe(weights),     describe(weights_on),
                   describe(matrix), describe(bone),   describe(moment_point)};
    type.outputs = {describe(out_force)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
