// The shapes of painted maps that the weights node offers: one function a mode, one number a vertex or face.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/file_access.h"
#include "engine/value.h"
#include "nodes/values.h"

#include <string>
#include <string_view>

namespace sinew::nodes {

/// 0 at `start`, 1 at `end` along axis 0, 1 or 2; beyond them constant.
engine::NumberList ramp_map(const solver::Points& points, int axis, double start, double end, bool smooth);
/// 1 up to `inner` from the other mesh, 0 from `outer` on, smooth between; inside a closed mesh the distance
/// is 0.
engine::NumberList near_map(const solver::Points& points, const Mesh& other, double inner, double outer);
/// Of the points the closest to the other mesh, in scene units; 0 inside it, if it is closed.
double nearest_distance(const solver::Points& points, const Mesh& other);
/// 1 in the sphere, 0 from `falloff` outside of it on, smooth between.
engine::NumberList sphere_map(const solver::Points& points, const engine::Vec3& centre, double radius, double falloff);
/// 1 at the listed indices, else 0. Throws solver::Error FE203 for one that is none of the mesh's. `what`: "vertex" or
/// "face".
engine::NumberList listed_map(std::size_t count, const engine::NumberList& indices, const char* what);
/// Of a map of the vertices: 1 at the faces whose vertices all have a weight above 0.
engine::NumberList faces_within(const MeshTopology& topology, const engine::NumberList& of_vertices);
/// For each vertex those along its faces' edges, for each face those across its edges; sorted, each once.
std::vector<std::vector<int>> vertex_neighbours(const MeshTopology& topology, std::size_t count);
std::vector<std::vector<int>> face_neighbours(const MeshTopology& topology);
/// Each weight goes half of the way to the mean of its neighbours, all at once, `times` times.
engine::NumberList smooth_map(engine::NumberList map, const std::vector<std::vector<int>>& neighbours, int times);
/// The mean of each face's vertices.
solver::Points face_centres(const Mesh& mesh);

/// What a file holds for a map: numbers, or indices of vertices or faces.
struct FileMap {
    enum class Kind { numbers, vertices, faces } kind;
    engine::NumberList numbers;
};
/// A list, or {"vertices": […]} or {"faces": […]}; a list under a key that ends in /vertices or /faces holds indices.
/// Throws solver::Error IO4xx.
FileMap file_map(const engine::FileAccess& files, const std::string& path, const std::string& pointer);
/// The same from the bytes of a file.
FileMap parse_map(std::string_view text, const std::string& path, const std::string& pointer);

} // namespace sinew::nodes
