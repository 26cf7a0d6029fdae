// zTet: the tets of a tissue, as a lattice around its mesh or as the user's own.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "solver/meshing/lattice.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<Mesh> mesh{.name = "mesh", .doc = "The tissue's surface.", .required = false};
const Input<double> tet_size{
    .name = "tetSize",
    .def = 0,
    .limits = {.min = 0},
    .doc = "Side of the lattice's cubes, in scene units; no tet is wider. 0 takes the longest side of the "
           "mesh's "
           "bounding box / 3.5.",
    .keyable = false,
};
const Input<std::int64_t> max_resolution{
    .name = "maxResolution",
    .def = 150,
    .limits = {.min = 1, .max = 100000},
    .doc = "A safety stop: a lattice with more cubes than this along the longest side is refused.",
    .keyable = false,
};
const Wire<TetMeshValue> tets{
    .name = "tets",
    .doc = "A tet mesh of your own, used instead of the lattice.",
    .required = false,
};
const Output<TetMeshValue> out_tets{
    .name = "outTets",
    .doc = "The tets, in scene units; connect to zTissue.tets.",
};

void compute(const Reads& in, Writes& out) {
    if (const TetMeshValue* own = in.find(tets)) return out.set(out_tets, *own);
    const Mesh* m = in.find(mesh);
    if (!m) in.fail(mesh.name, "DG110", "neither mesh nor tets is connected", "Connect the tissue's mesh.");
    const solver::LatticeOptions options{in[tet_size], static_cast<int>(in[max_resolution])};
    out.set(out_tets, guarded(in, mesh.name, [&] {
                return TetMeshValue::from(solver::make_lattice(*m->points, m->topology->triangles, options));
            }));
}

} // namespace

void add_z_tet(Registry& registry) {
    NodeType type;
    type.name = "zTet";
    type.doc =
        "Fills a mesh with tets: a body-centred cubic lattice, 12 tets a cube, that the mesh is embedded in.";
    type.inputs = {describe(mesh), describe(tet_size), describe(max_resolution), describe(tets)};
    type.outputs = {describe(out_tets)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
