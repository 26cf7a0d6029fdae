// tetMeshFile: a tetrahedral mesh from a file, for tissues that bring their own tets.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "solver/mesh/mesh_files.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<File> file{
    .name = "file",
    .doc = "The tet mesh file: Medit .mesh or legacy VTK .vtk, both as text. Tets that are turned "
           "inside out are flipped. Coordinates are scene units.",
    .required = true,
};
const Output<TetMeshValue> out_tets{
    .name = "outTets",
    .doc = "The tets; connect to zTissue.tets or zTet.tets.",
};
const Output<Mesh> out_mesh{
    .name = "outMesh",
    .doc = "The boundary triangles of the tets, facing outwards; its "
           "vertices are those of the tet mesh, numbered alike.",
};

void compute(const Reads& in, Writes& out) {
    solver::TetMesh tets = guarded(in, file.name, [&] {
        solver::TetMesh t = solver::read_tets(in[file].path);
        solver::check_and_orient(t);
        return t;
    });
    solver::SurfaceMesh surface =
        solver::SurfaceMesh::from_triangles(tets.vertices, solver::boundary_triangles(tets.tets));
    out.set(out_mesh, Mesh::from(std::move(surface)));
    out.set(out_tets, TetMeshValue::from(std::move(tets)));
}

} // namespace

void add_tet_mesh_file(Registry& registry) {
    NodeType type;
    type.name = "tetMeshFile";
    type.doc = "Reads a tetrahedral mesh from a file.";
    type.inputs = {describe(file)};
    type.outputs = {describe(out_tets), describe(out_mesh)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
