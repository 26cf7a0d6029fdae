// tetWriter: the content of a tet mesh file; whoever pulls it puts it on disk.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "solver/mesh/mesh_files.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<TetMeshValue> tets{.name = "tets", .doc = "The tets to write."};
const Input<std::string> format{
    .name = "format",
    .def = "vtk",
    .doc =
        "The kind of file, all of them text: vtk (legacy, with the share of each tet that is solid, which tetMeshFile "
        "reads back; the others have no place for it, so their tets come back as all solid), mesh "
        "(Medit), "
        "msh (Gmsh 4.1), veg (VegaFEM), node and ele (TetGen; the two belong together, so take two writers).",
    .options = {"vtk", "mesh", "msh", "veg", "node", "ele"},
};
const Output<FileContent> out_file{.name = "outFile", .doc = "The file's bytes and ending, in scene units."};

std::string written(const solver::TetMesh& m, const std::string& ending) {
    if (ending == "mesh") return solver::write_medit(m);
    if (ending == "msh") return solver::write_gmsh(m);
    if (ending == "veg") return solver::write_veg(m);
    if (ending == "node") return solver::write_node(m);
    return ending == "ele" ? solver::write_ele(m) : solver::write_vtk(m);
}

void compute(const Reads& in, Writes& out) {
    out.set(out_file, FileContent{in[format], written(*in[tets].mesh, in[format])});
}

} // namespace

void add_tet_writer(Registry& registry) {
    NodeType type;
    type.name = "tetWriter";
    type.doc = "Makes the content of a tet mesh file.";
    type.inputs = {describe(tets), describe(format)};
    type.outputs = {describe(out_file)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
