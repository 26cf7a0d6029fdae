// Computes painted maps from coordinates, distances and files.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/painted_maps.h"

#include "nodes/json_file.h"
#include "solver/error.h"
#include "solver/mesh/closest_point.h"

#include <algorithm>
#include <cmath>

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
    const solver::SurfaceTree tree(*other.points, other.topology->triangles);
    const bool has_inside = solver::is_closed(other.topology->triangles);
    NumberList out;
    out.reserve(points.size());
    for (const solver::Vec3& p : points) {
        const bool inside = has_inside && tree.inside(p);
        out.push_back(fall(inside ? 0 : tree.closest(p).distance, inner, outer));
    }
    return out;
}

NumberList sphere_map(const solver::Points& points, const engine::Vec3& centre, double radius, double falloff) {
    const solver::Vec3 c(centre[0], centre[1], centre[2]);
    NumberList out;
    out.reserve(points.size());
    for (const solver::Vec3& p : points) out.push_back(fall((p - c).norm(), radius, radius + falloff));
    return out;
}

NumberList vertex_map(std::size_t vertex_count, const NumberList& vertices) {
    NumberList out(vertex_count, 0.0);
    for (const double v : vertices) {
        if (!(v >= 0 && v < static_cast<double>(vertex_count)) || v != std::floor(v)) {
            const std::string number = v == std::floor(v) && std::abs(v) < 1e15
                                           ? std::to_string(static_cast<long long>(v))
                                           : std::to_string(v);
            throw Error("FE203",
                        "there is no vertex " + number + " in a mesh of " + std::to_string(vertex_count) + " vertices",
                        "Vertices count from 0.");
        }
        out[static_cast<std::size_t>(v)] = 1;
    }
    return out;
}

NumberList file_map(std::size_t vertex_count, const std::string& path, const std::string& pointer) {
    const nlohmann::json file = read_json(path);
    const nlohmann::json& part = part_of(file, pointer, path);
    if (part.is_object() && part.contains("vertices"))
        return vertex_map(vertex_count, numbers_of(part["vertices"], "\"vertices\"", path));
    NumberList numbers = numbers_of(part, pointer.empty() ? "the map" : "\"" + pointer + "\"", path);
    return pointer.ends_with("/vertices") ? vertex_map(vertex_count, numbers) : numbers;
}

} // namespace sinew::nodes
