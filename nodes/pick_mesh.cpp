// pickMesh: one mesh of a list, so that what one solver gives is a bone of the next.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"

#include <cmath>

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<MeshList> meshes{
    .name = "meshes",
    .doc = "The list: zSolver.outMeshes, zEmbedder.outMeshes. Between whole frames, where a simulation has no meshes, "
           "vertices are taken on straight lines between the two nearest.",
    .whole_frames = true,
};
const Input<std::string> body{
    .name = "body",
    .doc = "The name of the node whose mesh it is, as it is connected to that solver's bodies or that embedder's "
           "meshes. It follows when the node is renamed.",
    .keyable = false,
    .names_entry_of = "meshes",
};
const Input<std::int64_t> index{
    .name = "index",
    .def = -1,
    .limits = {.min = -1, .max = 1e9},
    .doc = "The mesh by its place in the list, from 0 on, instead of by name; -1 leaves it to body.",
    .keyable = false,
};
const Output<Mesh> out_mesh{.name = "outMesh", .doc = "The mesh at this frame, in scene units."};

std::string listed(const std::vector<std::string>& names) {
    std::string out;
    for (std::size_t i = 0; i < names.size(); ++i) out += (i ? ", " : "") + std::to_string(i) + " " + names[i];
    return out;
}

std::size_t wanted(const Reads& in, std::size_t count) {
    const int named = in.entry(body);
    const std::int64_t given = in[index];
    if (named >= 0 && given >= 0)
        in.fail(index.name, "DG110", "both body and index say which mesh it is", "Give one of the two.");
    if (named < 0 && given < 0)
        in.fail(body.name, "DG110", "neither body nor index says which mesh it is",
                "Name one of: " + listed(in.entry_names(body)) + ".");
    const std::int64_t at = named >= 0 ? named : given;
    if (at < static_cast<std::int64_t>(count)) return static_cast<std::size_t>(at);
    const std::vector<std::string> names = in.entry_names(body);
    in.fail(named >= 0 ? body.name : index.name, "FE290",
            "there is no mesh " + std::to_string(at) + ": " + in.source_name(meshes.name) + " gives " +
                std::to_string(count) + (names.size() == count && count > 0 ? " (" + listed(names) + ")" : ""),
            count > 0 ? "Give a number from 0 to " + std::to_string(count - 1) + "."
                      : "Connect a list that has meshes.");
}

void compute(const Reads& in, Writes& out) {
    const auto [before, after] = in.around(meshes);
    const Mesh& from = before->meshes[wanted(in, before->meshes.size())];
    const double share = in.frame() - std::floor(in.frame());
    if (share == 0) return out.set(out_mesh, from);
    const Mesh& to = after->meshes[wanted(in, after->meshes.size())];
    solver::Points points(*from.points);
    if (to.points->size() != points.size())
        in.fail(meshes.name, "FE294", "the mesh has other vertices at the next frame", "A body keeps its vertices.");
    for (std::size_t v = 0; v < points.size(); ++v) points[v] += share * ((*to.points)[v] - points[v]);
    out.set(out_mesh, from.with_points(std::move(points)));
}

} // namespace

void add_pick_mesh(Registry& registry) {
    NodeType type;
    type.name = "pickMesh";
    type.doc = "Takes one mesh out of a solver's or embedder's list: connected to zBone.mesh it lets one simulation "
               "drive the next in the same graph.";
    type.inputs = {describe(meshes), describe(body), describe(index)};
    type.outputs = {describe(out_mesh)};
    type.uses_time = true; // between frames
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
