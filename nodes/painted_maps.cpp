// Computes painted maps from coordinates, distances and files.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/painted_maps.h"

#include "nodes/json_file.h"
#include "solver/error.h"
#include "solver/mesh/closest_point.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

namespace sinew::nodes {

using engine::NumberList;
using solver::Error;

namespace {

/// Hermite step on [0, 1] with flat ends.
double smoothstep(double t) { return t * t * (3 - 2 * t); }

/// 1 up to `inner`, 0 from `outer` on.
double fall(double distance, double inner, double outer) {
    if (distance <= inner) return 1;
    if (distance >= outer) return 0;
    return 1 - smoothstep((distance - inner) / (outer - inner));
}

/// Of each point to the mesh, 0 inside it.
NumberList distances(const solver::Points& points, const Mesh& other) {
    const solver::SurfaceTree tree(*other.points, other.topology->triangles);
    const bool has_inside = solver::is_closed(other.topology->triangles);
    NumberList out;
    out.reserve(points.size());
    for (const solver::Vec3& p : points) {
        const bool inside = has_inside && tree.inside(p);
        out.push_back(inside ? 0 : tree.closest(p).distance);
    }
    return out;
}

} // namespace

NumberList ramp_map(const solver::Points& points, int axis, double start, double end, bool smooth) {
    NumberList out;
    out.reserve(points.size());
    for (const solver::Vec3& p : points) {
        const double t = std::clamp((p[axis] - start) / (end - start), 0.0, 1.0);
        out.push_back(smooth ? smoothstep(t) : t);
    }
    return out;
}

NumberList near_map(const solver::Points& points, const Mesh& other, double inner, double outer) {
    NumberList out = distances(points, other);
    for (double& d : out) d = fall(d, inner, outer);
    return out;
}

double nearest_distance(const solver::Points& points, const Mesh& other) {
    const NumberList all = distances(points, other);
    return *std::min_element(all.begin(), all.end());
}

NumberList sphere_map(const solver::Points& points, const engine::Vec3& centre, double radius, double falloff) {
    const solver::Vec3 c(centre[0], centre[1], centre[2]);
    NumberList out;
    out.reserve(points.size());
    for (const solver::Vec3& p : points) out.push_back(fall((p - c).norm(), radius, radius + falloff));
    return out;
}

NumberList listed_map(std::size_t count, const NumberList& indices, const char* what) {
    NumberList out(count, 0.0);
    for (const double i : indices) {
        if (!(i >= 0 && i < static_cast<double>(count)) || i != std::floor(i)) {
            const std::string number = i == std::floor(i) && std::abs(i) < 1e15
                                           ? std::to_string(static_cast<long long>(i))
                                           : std::to_string(i);
            const bool vertices = std::string_view(what) == "vertex";
            throw Error("FE203",
                        std::string("there is no ") + what + " " + number + " in a mesh of " + std::to_string(count) +
                            (vertices ? " vertices" : " faces"),
                        vertices ? "Vertices count from 0." : "Faces count from 0.");
        }
        out[static_cast<std::size_t>(i)] = 1;
    }
    return out;
}

NumberList faces_within(const MeshTopology& topology, const NumberList& of_vertices) {
    NumberList out;
    out.reserve(topology.face_sizes.size());
    auto corner = topology.face_vertices.begin();
    for (const int size : topology.face_sizes) {
        out.push_back(
            std::all_of(corner, corner + size, [&](int v) { return of_vertices[static_cast<std::size_t>(v)] > 0; }));
        corner += size;
    }
    return out;
}

solver::Points face_centres(const Mesh& mesh) {
    solver::Points out;
    out.reserve(mesh.topology->face_sizes.size());
    auto corner = mesh.topology->face_vertices.begin();
    for (const int size : mesh.topology->face_sizes) {
        solver::Vec3 sum = solver::Vec3::Zero();
        for (int i = 0; i < size; ++i) sum += (*mesh.points)[static_cast<std::size_t>(*corner++)];
        out.emplace_back(sum / size);
    }
    return out;
}

FileMap file_map(const engine::FileAccess& files, const std::string& path, const std::string& pointer) {
    return parse_map(read_text(files, path, most_json_bytes), path, pointer);
}

FileMap parse_map(std::string_view text, const std::string& path, const std::string& pointer) {
    using Kind = FileMap::Kind;
    const nlohmann::json file = parse_json(text, path);
    const nlohmann::json& part = part_of(file, pointer, path);
    for (const auto& [key, kind] : {std::pair{"vertices", Kind::vertices}, std::pair{"faces", Kind::faces}}) {
        if (part.is_object() && part.contains(key))
            return {kind, numbers_of(part[key], "\"" + std::string(key) + "\"", path)};
        if (pointer.ends_with("/" + std::string(key))) return {kind, numbers_of(part, "\"" + pointer + "\"", path)};
    }
    return {Kind::numbers, numbers_of(part, pointer.empty() ? "the map" : "\"" + pointer + "\"", path)};
}

namespace {

/// Calls `take(face, a, b)` for each edge of each face.
template <class Take>
void for_edges(const MeshTopology& topology, const Take& take) {
    std::size_t first = 0;
    for (std::size_t f = 0; f < topology.face_sizes.size(); ++f) {
        const auto size = static_cast<std::size_t>(topology.face_sizes[f]);
        for (std::size_t k = 0; k < size; ++k)
            take(static_cast<int>(f), topology.face_vertices[first + k],
                 topology.face_vertices[first + (k + 1) % size]);
        first += size;
    }
}

void make_unique(std::vector<std::vector<int>>& lists) {
    for (std::vector<int>& l : lists) {
        std::sort(l.begin(), l.end());
        l.erase(std::unique(l.begin(), l.end()), l.end());
    }
}

} // namespace

std::vector<std::vector<int>> vertex_neighbours(const MeshTopology& topology, std::size_t count) {
    std::vector<std::vector<int>> out(count);
    for_edges(topology, [&](int, int a, int b) {
        out[static_cast<std::size_t>(a)].push_back(b);
        out[static_cast<std::size_t>(b)].push_back(a);
    });
    make_unique(out);
    return out;
}

std::vector<std::vector<int>> face_neighbours(const MeshTopology& topology) {
    std::map<std::pair<int, int>, std::vector<int>> faces;
    for_edges(topology, [&](int f, int a, int b) { faces[std::minmax(a, b)].push_back(f); });
    std::vector<std::vector<int>> out(topology.face_sizes.size());
    for (const auto& [edge, all] : faces)
        if (all.size() == 2 && all[0] != all[1]) { // else nobody could say which lies across
            out[static_cast<std::size_t>(all[0])].push_back(all[1]);
            out[static_cast<std::size_t>(all[1])].push_back(all[0]);
        }
    make_unique(out);
    return out;
}

engine::NumberList smooth_map(engine::NumberList map, const std::vector<std::vector<int>>& neighbours, int times) {
    engine::NumberList before;
    for (int n = 0; n < times; ++n) {
        before = map;
        for (std::size_t i = 0; i < map.size(); ++i) {
            if (neighbours[i].empty()) continue;
            double sum = 0;
            for (const int other : neighbours[i]) sum += before[static_cast<std::size_t>(other)];
            map[i] = 0.5 * (before[i] + sum / static_cast<double>(neighbours[i].size()));
        }
    }
    return map;
}

} // namespace sinew::nodes
