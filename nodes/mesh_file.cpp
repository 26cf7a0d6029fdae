// meshFile: a polygon mesh from a file.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/mesh_formats.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<File> file{
    .name = "file",
    .doc = "The mesh file: OBJ, OFF, PLY, STL or GLB, told by its ending. Polygons are kept for output "
           "and cut into triangles for the simulation. Coordinates are scene units (those of GLB are usually metres).",
    .required = true,
};
const Output<Mesh> out_mesh{.name = "outMesh", .doc = "The mesh as it stands in the file, in scene units."};

void compute(const Reads& in, Writes& out) {
    solver::SurfaceMesh mesh = guarded(in, file.name, [&] {
        solver::SurfaceMesh m = read_mesh(in.files(), in[file].path);
        solver::check_usable(m);
        return m;
    });
    out.set(out_mesh, Mesh::from(std::move(mesh)));
}

} // namespace

void add_mesh_file(Registry& registry) {
    NodeType type;
    type.name = "meshFile";
    type.doc = "Reads a polygon mesh from a file.";
    type.inputs = {describe(file)};
    type.outputs = {describe(out_mesh)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
