// meshWriter: the content of a mesh file; whoever pulls it puts it on disk.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/options.h"
#include "solver/mesh/mesh_files.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<Mesh> mesh{.name = "mesh", .doc = "One mesh to write.", .required = false};
const Wire<MeshList> meshes{
    .name = "meshes",
    .doc = "Several meshes to write into one file, for example zSolver.outMeshes.",
    .required = false,
};
constexpr Option<std::string (*)(const solver::SurfaceMesh&)> formats[] = {
    {"obj", solver::write_obj}, {"ply", solver::write_ply}, {"stl", solver::write_stl}, {"off", solver::write_off}};
const Input<std::string> format{
    .name = "format",
    .def = "obj",
    .doc = "The kind of file: obj and off (text, polygons), ply (binary, polygons), stl (binary, triangles).",
    .keyable = false,
    .options = words(formats),
};
const Output<FileContent> out_file{.name = "outFile", .doc = "The file's bytes and ending, in scene units."};

void append(solver::SurfaceMesh& all, const Mesh& m) {
    const int first = static_cast<int>(all.points.size());
    const MeshTopology& t = *m.topology;
    all.points.insert(all.points.end(), m.points->begin(), m.points->end());
    all.face_sizes.insert(all.face_sizes.end(), t.face_sizes.begin(), t.face_sizes.end());
    for (const int v : t.face_vertices) all.face_vertices.push_back(first + v);
    for (const auto& [a, b, c] : t.triangles) all.triangles.push_back({first + a, first + b, first + c});
}

void compute(const Reads& in, Writes& out) {
    const Mesh* one = in.find(mesh);
    const MeshList* many = in.find(meshes);
    if (!one && !many)
        in.fail(mesh.name, "DG110", "neither mesh nor meshes is connected", "Connect what is to be written.");
    solver::SurfaceMesh all;
    if (one) append(all, *one);
    if (many)
        for (const Mesh& m : many->meshes) append(all, m);
    out.set(out_file, guarded(in, mesh.name, [&] {
                return FileContent{in[format], meaning(formats, in[format])(all)};
            }));
}

} // namespace

void add_mesh_writer(Registry& registry) {
    NodeType type;
    type.name = "meshWriter";
    type.doc = "Makes the content of a mesh file.";
    type.inputs = {describe(mesh), describe(meshes), describe(format)};
    type.outputs = {describe(out_file)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
