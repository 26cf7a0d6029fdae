// zDelaunayTetMesh: tets inside a closed surface, whose triangles stay as they are.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/meshing_time.h"
#include "solver/meshing/delaunay_tets.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<Mesh> mesh{
    .name = "mesh",
    .doc = "A closed manifold surface that does not cross itself, such as zIsoMesh.outMesh; the better its "
           "triangles, the better the tets. Anything else is refused with the edges or triangles to blame.",
};
const Input<double> refinement_quality{
    .name = "refinementQuality",
    .def = 0.8,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "1 fills the inside with tets as small as the surface's triangles; below, tets grow with depth, "
           "edges by "
           "1.2 (1 - refinementQuality) of the distance from the surface; 0 puts no vertices inside but "
           "those that "
           "flat tets need. Keep it at 0.8 or above for simulation.",
    .keyable = false,
};
const Output<TetMeshValue> out_tets{
    .name = "outTets",
    .doc = "The tets, in scene units; connect to zTissue.tets or zTet.tets. Their boundary is the input's "
           "triangles, and the input's vertices come first, in their order. No dihedral angle is below 0.05 degrees; "
           "a surface that makes flatter tets is refused.",
};

void compute(const Reads& in, Writes& out) {
    // Kept under the digest of the mesh, so that one whose node reads the time is filled once.
    const Digest key =
        Hasher().add("zDelaunayTetMesh").add(in.digest_of(mesh.name)).add(in[refinement_quality]).finish();
    auto made = in.lease<TetMeshValue>(key, [&] {
        const Mesh& m = in[mesh];
        const solver::DelaunayTetOptions options{in[refinement_quality], in[max_time]};
        return std::make_shared<TetMeshValue>(
            guarded(in, mesh.name,
                    [&] {
                        return TetMeshValue::from(
                            solver::make_delaunay_tets(*m.points, m.topology->triangles, options, meshing_control(in)));
                    },
                    {{"FE232", refinement_quality.name}, {"FE233", max_time.name}}));
    });
    out.set(out_tets, *made);
}

} // namespace

void add_z_delaunay_tet_mesh(Registry& registry) {
    NodeType type;
    type.name = "zDelaunayTetMesh";
    // 3: made about the surface's middle, in its size
    type.numerics = 4; // sides of triangles in sharp folds are known
    type.doc = "Fills a closed surface with tets whose boundary is exactly that surface.";
    type.inputs = {describe(mesh), describe(refinement_quality), describe(max_time)};
    type.outputs = {describe(out_tets)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
