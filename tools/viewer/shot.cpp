// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/shot.h"

#include "solver/mesh/surface_mesh.h"
#include "tools/render/shading_mesh.h"
#include "tools/viewer/shot_overlays.h"

#include <utility>

namespace sinew::viewer {

namespace {

using solver::Points;

constexpr float flesh_under_overlays = 0.3f;

solver::Vec3 vec3(const std::array<float, 3>& p) {
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

/// The body's points as those of its shading vertices.
Points gather(const ViewBody& body, Points points) {
    return body.shading.empty() ? points : render::ShadingMesh{body.shading, {}}.gather(points);
}

render::Surface surface_of(const ViewBody& body, std::size_t frame) {
    Points points, rest;
    for (std::size_t v = 0; v < body.vertex_count(); ++v) {
        points.push_back(vec3(vertex_position(body, frame, v)));
        rest.push_back(vec3({body.rest[3 * v], body.rest[3 * v + 1], body.rest[3 * v + 2]}));
    }
    render::Surface surface;
    surface.points = gather(body, std::move(points));
    surface.triangles = body.triangles;
    surface.normals = solver::vertex_normals(surface.points, surface.triangles);
    if (body.look.stripes > 0) surface.grain = gather(body, render::grain_of(rest));
    surface.look = body.look;
    return surface;
}

} // namespace

render::Shot shot_of(const ViewScene& scene, std::size_t frame, const std::set<std::string>& overlays) {
    render::Shot shot{"frame " + std::to_string(scene.frames.at(frame).frame), {}};
    for (const ViewBody& body : scene.bodies) {
        if (!body.is_there(frame)) continue;
        shot.surfaces.push_back(surface_of(body, frame));
        shot.surfaces.back().is_framed = body.is_framed;
        if (!overlays.empty() && body.kind != render::BodyKind::bone)
            shot.surfaces.back().opacity = flesh_under_overlays;
    }
    shot.segments = overlay_segments(scene, frame, overlays);
    return shot;
}

void keep_bodies(ViewScene& scene, const std::set<std::size_t>& kept) {
    std::vector<int> place(scene.bodies.size(), -1);
    std::vector<ViewBody> bodies;
    for (const std::size_t b : kept) {
        place[b] = static_cast<int>(bodies.size());
        bodies.push_back(std::move(scene.bodies[b]));
    }
    scene.bodies = std::move(bodies);
    for (ViewAttachment& a : scene.attachments) {
        a.source = place[static_cast<std::size_t>(a.source)];
        a.target = place[static_cast<std::size_t>(a.target)];
    }
    std::erase_if(scene.attachments, [](const auto& a) { return a.source < 0 || a.target < 0; });
    // Marks that are about bodies, none of which is drawn, go with them.
    for (ViewFrame& frame : scene.frames)
        for (ViewMarks& group : frame.marks)
            std::erase_if(group.marks, [&](ViewMark& m) {
                const bool about_some = m.bodies[0] >= 0 || m.bodies[1] >= 0;
                for (int& b : m.bodies) b = b < 0 ? -1 : place[static_cast<std::size_t>(b)];
                return about_some && m.bodies[0] < 0 && m.bodies[1] < 0;
            });
}

} // namespace sinew::viewer
