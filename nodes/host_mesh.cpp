// hostMesh: a mesh that stands in the graph itself, or that a host program sends frame by frame.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/limits.h"
#include "solver/mesh/coordinates.h"

#include <cmath>

namespace sinew::nodes {

using namespace engine;

namespace {

const Limits reach{.min = -solver::largest_coordinate, .max = solver::largest_coordinate};

const Input<NumberList> points{
    .name = "points",
    .limits = reach,
    .doc = "x, y and z of each vertex, one after the other, in scene units. Keyed, every key has as many; between keys "
           "vertices move on straight lines.",
    .list_keys = true,
};
const Input<NumberList> face_sizes{
    .name = "faceSizes",
    .limits = within_reach,
    .doc = "How many corners each face has; none: all are triangles.",
};
const Input<NumberList> face_vertices{
    .name = "faceVertices",
    .limits = within_reach,
    .doc = "The corners of the faces, one face after the other: vertices, counted from 0.",
};
const Input<NumberList> rest_points{
    .name = "restPoints",
    .limits = reach,
    .doc = "Vertices as in points, by which faces with more than three corners are cut into triangles. They keep the "
           "cut the same while the mesh deforms; none: points.",
};
const Output<Mesh> out_mesh{.name = "outMesh", .doc = "The mesh at this frame, in scene units."};

solver::Points points_of(const Reads& in, const Input<NumberList>& input) {
    const NumberList& all = in[input];
    if (all.size() % 3 != 0)
        in.fail(input.name, "DG125", std::to_string(all.size()) + " numbers are no list of points",
                "Give x, y and z of each vertex.");
    solver::Points out(all.size() / 3);
    for (std::size_t v = 0; v < out.size(); ++v) out[v] = solver::Vec3(all[3 * v], all[3 * v + 1], all[3 * v + 2]);
    return out;
}

/// Whole numbers from `least` on.
std::vector<int> whole(const Reads& in, const Input<NumberList>& input, int least) {
    std::vector<int> out;
    for (const double v : in[input]) {
        if (v != std::floor(v) || v < least || v > 2e9)
            in.fail(input.name, "DG125",
                    "entry " + std::to_string(out.size()) + " is " + std::to_string(v) + "; whole numbers from " +
                        std::to_string(least) + " on fit");
        out.push_back(static_cast<int>(v));
    }
    return out;
}

Mesh made_reference(const Reads& in, solver::Points shape) {
    std::vector<int> corners = whole(in, face_vertices, 0), sizes = whole(in, face_sizes, 3);
    if (sizes.empty()) {
        if (corners.size() % 3 != 0)
            in.fail(face_vertices.name, "DG125", std::to_string(corners.size()) + " corners are no list of triangles",
                    "Give three a triangle, or faceSizes.");
        sizes.assign(corners.size() / 3, 3);
    }
    return guarded(in, face_vertices.name, [&] {
        try {
            solver::check_faces(shape.size(), sizes, corners);
        } catch (const solver::Error& why) {
            if (why.code == "FE208") in.fail(face_vertices.name, "DG125", why.what(), why.hint);
            throw;
        }
        solver::SurfaceMesh mesh =
            solver::SurfaceMesh::from_polygons(std::move(shape), std::move(sizes), std::move(corners));
        solver::check_usable(mesh);
        return Mesh::from(std::move(mesh));
    });
}

void compute(const Reads& in, Writes& out) {
    solver::Points now = points_of(in, points);
    if (now.empty())
        in.fail(points.name, "DG124", "there is no mesh yet",
                "Let the host send it before this frame is evaluated, or write points and faces.");
    const bool has_rest = !in[rest_points].empty();
    if (has_rest && in[rest_points].size() != in[points].size())
        in.fail(rest_points.name, "DG125",
                std::to_string(in[rest_points].size()) + " numbers; points has " + std::to_string(in[points].size()),
                "Give the same vertices.");
    Hasher h;
    h.add("hostMesh").add(in.digest_of(face_sizes.name)).add(in.digest_of(face_vertices.name));
    h.add(std::uint64_t{now.size()}).add(in.digest_of(rest_points.name));
    // Only a cut of larger faces depends on where the vertices are.
    const bool cuts = !has_rest && !in[face_sizes].empty();
    if (cuts) h.add(in.digest_of(points.name));
    auto reference = in.lease<Mesh>(h.finish(), [&] {
        return std::make_shared<Mesh>(made_reference(in, has_rest ? points_of(in, rest_points) : now));
    });
    out.set(out_mesh, guarded(in, points.name, [&] {
                solver::check_coordinates(now);
                return reference->with_points(std::move(now));
            }));
}

} // namespace

void add_host_mesh(Registry& registry) {
    NodeType type;
    type.name = "hostMesh";
    type.doc = "A mesh whose points and faces stand in the graph, or that a program around Sinew sends, frame by frame "
               "if it deforms.";
    type.inputs = {describe(points), describe(face_sizes), describe(face_vertices), describe(rest_points)};
    type.outputs = {describe(out_mesh)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
