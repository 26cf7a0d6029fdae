// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/view_data.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace sinew::viewer {

namespace {

std::array<float, 3> point(const Coordinates& c, std::size_t i) { return {c[3 * i], c[3 * i + 1], c[3 * i + 2]}; }

std::array<float, 3> embedded(const ViewLattice& lattice, std::size_t frame, std::size_t vertex) {
    std::array<double, 3> out{};
    const solver::Tet& tet = lattice.tets[static_cast<std::size_t>(lattice.surface.tet[vertex])];
    for (std::size_t k = 0; k < 4; ++k) {
        const auto p = point(lattice.frames[frame], static_cast<std::size_t>(tet[k]));
        for (std::size_t c = 0; c < 3; ++c)
            out[c] += static_cast<double>(lattice.surface.weights[4 * vertex + k]) * static_cast<double>(p[c]);
    }
    return {static_cast<float>(out[0]), static_cast<float>(out[1]), static_cast<float>(out[2])};
}

} // namespace

std::array<float, 3> vertex_position(const ViewBody& body, std::size_t frame, std::size_t vertex) {
    if (body.lattice && !body.lattice->surface.tet.empty()) return embedded(*body.lattice, frame, vertex);
    if (const auto* moving = std::get_if<DeformingMotion>(&body.motion)) return point(moving->points[frame], vertex);
    const auto& rigid = std::get<RigidMotion>(body.motion);
    const RigidPose& pose = rigid.poses[frame];
    const Eigen::Quaternionf q(pose.rotation[3], pose.rotation[0], pose.rotation[1], pose.rotation[2]);
    const auto r = point(body.rest, vertex);
    const Eigen::Vector3f moved =
        q * Eigen::Vector3f(r[0] - rigid.pivot[0], r[1] - rigid.pivot[1], r[2] - rigid.pivot[2]);
    return {moved[0] + pose.translation[0], moved[1] + pose.translation[1], moved[2] + pose.translation[2]};
}

std::array<std::array<float, 3>, 2> bounds(const ViewScene& scene) {
    constexpr float far = std::numeric_limits<float>::infinity();
    std::array<std::array<float, 3>, 2> box{{{far, far, far}, {-far, -far, -far}}};
    const bool none_is_good =
        std::none_of(scene.frames.begin(), scene.frames.end(), [](const ViewFrame& f) { return f.faults.empty(); });
    bool found = false;
    for (const ViewBody& body : scene.bodies) {
        bool is_first = true; // of the frames that have it: taken whole
        for (std::size_t f = 0; f < scene.frames.size(); ++f) {
            if (!body.is_there(f) || !(none_is_good || scene.frames[f].faults.empty())) continue;
            // About a thousand vertices are enough to place a camera over many frames.
            const std::size_t step = is_first ? 1 : std::max<std::size_t>(1, body.vertex_count() / 1000);
            is_first = false;
            for (std::size_t v = 0; v < body.vertex_count(); v += step) {
                const auto p = vertex_position(body, f, v);
                for (std::size_t c = 0; c < 3; ++c)
                    box[0][c] = std::min(box[0][c], p[c]), box[1][c] = std::max(box[1][c], p[c]);
                found = true;
            }
        }
    }
    return found ? box : std::array<std::array<float, 3>, 2>{};
}

} // namespace sinew::viewer
