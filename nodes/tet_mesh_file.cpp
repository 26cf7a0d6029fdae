// tetMeshFile: a tetrahedral mesh from a file, for tissues that bring their own tets.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/mesh_formats.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<File> file{
    .name = "file",
    .doc = "The tet mesh file: Medit .mesh and legacy VTK .vtk as text, Gmsh .msh (2.x and 4.1, text or "
           "binary), "
           "VegaFEM .veg, or TetGen's .node. Tets that are turned inside out are flipped. Cell data \"coverage\" of a "
           ".vtk file is the share of each tet that is solid, as tetWriter puts it; without it tets are solid. "
           "Coordinates are scene units.",
    .required = true,
};
const Input<File> elements{
    .name = "elementFile",
    .doc = "TetGen's .ele file, which belongs to the .node file; none for other formats.",
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

bool ends_with_node(const std::string& path) {
    return path.size() > 5 && (path.ends_with(".node") || path.ends_with(".NODE"));
}

void compute(const Reads& in, Writes& out) {
    const std::string &path = in[file].path, &more = in[elements].path;
    if (ends_with_node(path) != !more.empty())
        in.fail(elements.name, "DG110",
                more.empty() ? "a .node file has no tets of its own" : "elementFile goes with a .node file only",
                "Name TetGen's .node file at file and its .ele file at elementFile.");
    solver::TetMesh tets = guarded(in, more.empty() ? file.name : elements.name, [&] {
        solver::TetMesh t = read_tets(in.files(), path, more);
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
    type.numerics = 2; // reads the coverage
    type.doc = "Reads a tetrahedral mesh from a file.";
    type.inputs = {describe(file), describe(elements)};
    type.outputs = {describe(out_tets), describe(out_mesh)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
