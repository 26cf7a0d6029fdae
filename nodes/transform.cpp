// transform: moves a mesh by keyed translate, rotate and scale, by a recorded matrix track, or by both.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/limits.h"
#include "nodes/matrices.h"
#include "nodes/motion_track.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<Mesh> mesh{
    .name = "mesh",
    .doc = "The mesh to move; without it only outMatrix is made.",
    .required = false,
};
const Input<Vec3> translate{.name = "translate", .limits = within_reach, .doc = "Translation, in scene units."};
const Input<Vec3> rotate{
    .name = "rotate",
    .unit = "deg",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Rotation about x, y and z.",
};
const Input<Vec3> scale{
    .name = "scale",
    .def = {1, 1, 1},
    .unit = "1",
    .limits = within_reach,
    .doc = "Scale along x, y and z; applied first. Never 0, which leaves nothing of a body.",
};
const Input<std::string> rotate_order{
    .name = "rotateOrder",
    .def = "xyz",
    .doc = "The order of the three rotations; xyz turns about x first.",
    .options = {"xyz", "yzx", "zxy", "xzy", "yxz", "zyx"},
};
const Input<Vec3> rotate_pivot{
    .name = "rotatePivot",
    .limits = within_reach,
    .doc = "The point that the rotation leaves in place, in scene units.",
};
const Input<Matrix4> parent{
    .name = "offsetParentMatrix",
    .def = identity_matrix,
    .limits = within_reach,
    .doc = "A matrix applied last, for example outMatrix of the transform above this one.",
};
const Input<File> track{
    .name = "track",
    .doc = "A motion file (JSON) with one matrix per bone and frame; it moves the mesh before "
           "translate, rotate and scale do. Its matrices are row-major and in scene units.",
};
const Input<std::string> track_name{
    .name = "trackName",
    .doc = "The bone of the motion file that is followed.",
};
const Input<double> track_offset{
    .name = "trackOffset",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Shift along the track, in track frames: graph frame 1 shows track frame "
           "1 + trackOffset.",
};
const Input<double> track_rate{
    .name = "trackRate",
    .def = 1,
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Track frames per graph frame: 5 for a motion of 120 frames a second at 24. "
           "Between track frames the motion is interpolated, beyond the ends it stands still.",
    .keyable = false,
};
const Output<Matrix4> out_matrix{.name = "outMatrix", .doc = "The whole transformation at this frame."};
const Output<Mesh> out_mesh{.name = "outMesh", .doc = "The moved mesh; the empty mesh if none is connected."};

Matrix4 tracked(const Reads& in) {
    if (in[track].path.empty()) return identity_matrix;
    if (in[track_name].empty())
        in.fail(track_name.name, "DG110", "a track is given but no trackName",
                "Name one of the bones of the motion file.");
    // The parsed track only saves work, so it may lie in a lease; each bone has its own and none waits for
    // another.
    const Digest key = Hasher().add("transform.track").add(in[track].content).add(in[track_name]).finish();
    auto motion = in.lease<MatrixTrack>(key, [&] {
        return guarded(in, track.name, [&] {
            return std::make_shared<MatrixTrack>(read_matrix_track(in.files(), in[track].path, in[track_name]));
        });
    });
    return motion->at(track_frame(in.frame(), in[track_offset], in[track_rate]));
}

void compute(const Reads& in, Writes& out) {
    check_affine(in, parent.name, in[parent]);
    refuse_flat(in, parent.name, in[parent]);
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (in[scale][axis] == 0)
            in.fail(scale.name, "FE332",
                    std::string("the scale along ") + "xyz"[axis] +
                        " is 0, which makes everything flat: what it moves has no volume left",
                    "Scale along each axis by a number other than 0; 1 leaves the size alone.");
    const Matrix4 keyed = compose(in[translate], in[rotate], in[scale], in[rotate_order], in[rotate_pivot]);
    const Matrix4 recorded = tracked(in);
    refuse_flat(in, track.name, recorded);
    const Matrix4 all = multiply(in[parent], multiply(keyed, recorded));
    out.set(out_matrix, all);
    const Mesh* m = in.find(mesh);
    out.set(out_mesh, m ? guarded(in, mesh.name, [&] { return moved(*m, all); }) : Mesh::from({}));
}

} // namespace

void add_transform(Registry& registry) {
    NodeType type;
    type.name = "transform";
    type.doc = "Moves a mesh: keyed, by a recorded motion, or both.";
    type.inputs = {describe(mesh),         describe(translate),    describe(rotate),    describe(scale),
                   describe(rotate_order), describe(rotate_pivot), describe(parent),    describe(track),
                   describe(track_name),   describe(track_offset), describe(track_rate)};
    type.outputs = {describe(out_matrix), describe(out_mesh)};
    type.uses_time = true; // the track is read at the frame
    type.time_input = track.name;
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
