// zBone: a body that moves as its mesh does and never feels a force.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/appearance.h"
#include "nodes/contact_inputs.h"
#include "nodes/limits.h"
#include "nodes/matrices.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<bool> enable{
    .name = "enable",
    .def = true,
    .doc = "Off leaves the bone and its attachments out of the simulation. Keyed: while it is off its attachments let "
           "go and it touches nothing; what zHold moves with it still moves.",
    .looks_ahead = true,
};
const Wire<Mesh> mesh{
    .name = "mesh",
    .doc = "The bone's surface in scene units; it may move and deform from frame to frame, its vertices and "
           "faces "
           "stay the same.",
};
const Input<Matrix4> matrix{
    .name = "matrix",
    .def = identity_matrix,
    .limits = within_reach,
    .doc = "Moves the mesh; connect transform.outMatrix.",
};
const Input<std::string> appearance = appearance_input(Matter::bone);
const Input<Vec3> colour = colour_input({0.93, 0.885, 0.79});
const Output<Body> out_body{
    .name = "outBody",
    .doc = "The bone at this frame, for zSolver.bodies and zAttachment.",
};

std::shared_ptr<const BodyRest> make_rest(const Mesh& modelled) {
    solver::check_usable(modelled.surface());
    auto rest = std::make_shared<BodyRest>();
    auto bone = std::make_shared<solver::BoneRest>();
    bone->triangles = modelled.topology->triangles;
    bone->surface = *modelled.points;
    rest->data = std::shared_ptr<const solver::BoneRest>(std::move(bone));
    rest->mesh = modelled;
    rest->digest = Hasher()
                       .add("bone")
                       .add(modelled.topology->digest)
                       .add(static_cast<std::uint64_t>(modelled.points->size()))
                       .finish();
    return rest;
}

void compute(const Reads& in, Writes& out) {
    const Mesh& modelled = in[mesh];
    check_affine(in, matrix.name, in[matrix]);
    refuse_flat(in, matrix.name, in[matrix]);
    // All frames of a bone that only a matrix moves share one rest object.
    struct Kept {
        std::shared_ptr<const BodyRest> rest;
    };
    const Digest key = Hasher().add("zBone.rest").add(modelled.topology->digest).add(modelled.points_digest).finish();
    auto kept = in.lease<Kept>(
        key, [&] { return guarded(in, mesh.name, [&] { return std::make_shared<Kept>(Kept{make_rest(modelled)}); }); });
    Body body{kept->rest, in[enable], guarded(in, matrix.name, [&] { return moved(modelled, in[matrix]); })};
    body.contact = read_contact(in, Collider::bone, modelled, nullptr);
    body.takes_part = in.is_ever_on(enable);
    out.set(out_body, std::move(body));
}

} // namespace

void add_z_bone(Registry& registry) {
    NodeType type;
    type.name = "zBone";
    type.doc = "A rigid or deforming body that moves as given; tissues are attached to it.";
    type.inputs = {describe(enable), describe(mesh), describe(matrix), describe(appearance), describe(colour)};
    for (AttributeInfo& a : contact_attributes(Collider::bone)) type.inputs.push_back(std::move(a));
    type.outputs = {describe(out_body)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
