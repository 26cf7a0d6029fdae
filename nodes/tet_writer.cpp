// tetWriter: the content of a tet mesh file; whoever pulls it puts it on disk.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/options.h"
#include "solver/mesh/mesh_files.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<TetMeshValue> tets{.name = "tets", .doc = "The tets to write."};
constexpr Option<std::string (*)(const solver::TetMesh&)> formats[] = {
    {"vtk", solver::write_vtk}, {"mesh", solver::write_medit}, {"msh", solver::write_gmsh},
    {"veg", solver::write_veg}, {"node", solver::write_node},  {"ele", solver::write_ele}};
const Input<std::string> format{
    .name = "format",
    .def = "vtk",
    .doc =
        "The kind of file, all of them text: vtk (legacy, with the share of each tet that is solid, which tetMeshFile "
        "reads back; the others have no place for it, so their tets come back as all solid), mesh "
        "(Medit), "
        "msh (Gmsh 4.1), veg (VegaFEM), node and ele (TetGen; the two belong together, so take two writers).",
    .options = words(formats),
};
const Output<FileContent> out_file{.name = "outFile", .doc = "The file's bytes and ending, in scene units."};

void compute(const Reads& in, Writes& out) {
    out.set(out_file, FileContent{in[format], meaning(formats, in[format])(*in[tets].mesh)});
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
