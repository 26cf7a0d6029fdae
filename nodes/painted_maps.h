// The shapes of painted maps that the weights node offers: one function a mode, one number a vertex.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/value.h"
#include "nodes/values.h"

#include <string>

namespace sinew::nodes {

/// 0 at `start`, 1 at `end` along axis 0, 1 or 2; beyond them constant.
engine::NumberList ramp_map(const solver::Points& points, int axis, double start, double end, bool smooth);
/// 1 up to `inner` from the other mesh, 0 from `outer` on, smooth between; inside a closed mesh the distance
/// is 0.
engine::NumberList near_map(const solver::Points& points, const Mesh& other, double inner, double outer);
/// 1 in the sphere, 0 from `falloff` outside of it on, smooth between.
engine::NumberList sphere_map(const solver::Points& points, const engine::Vec3& centre, double radius, double falloff);
/// 1 at the listed vertices, else 0. Throws solver::Error FE203 for an index that is none of the mesh's.
engine::NumberList vertex_map(std::size_t vertex_count, const engine::NumberList& vertices);
/// Numbers, or {"vertices": […]}, or a list of indices under a key that ends in /vertices.
/// Throws solver::Error IO401…IO403, FE203.
engine::NumberList file_map(std::size_t vertex_count, const std::string& path, const std::string& pointer);

} // namespace sinew::nodes
