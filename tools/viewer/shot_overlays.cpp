// The other side of page/src: lattice_view.js, fibre_view.js, attachment_view.js, marks_view.js and
// colour_maps.js.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/shot_overlays.h"

#include "tools/viewer/flesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <span>

namespace sinew::viewer {

using render::Segment;
using solver::Mat3;
using solver::Vec3;

namespace {

// sRGB, as in colour_maps.js; a test holds the two together.
constexpr std::array<unsigned, 6> heat{0x3b3f73, 0x32589f, 0x1f7fc4, 0x12a7d8, 0x3fd0e4, 0xa5f3ea};
constexpr std::array<unsigned, 5> distance{0x2e9d6a, 0xa3bf3c, 0xf5bb2e, 0xee7a2c, 0xa3157d};
constexpr unsigned lattice_grey = 0xaeb9c5;

Eigen::Vector3f channels(unsigned hex) {
    return Eigen::Vector3f(static_cast<float>(hex >> 16 & 255), static_cast<float>(hex >> 8 & 255),
                           static_cast<float>(hex & 255)) /
           255.0f;
}

/// Linear light at `t` in 0…1 of a scale.
Eigen::Vector3f colour_at(std::span<const unsigned> scale, double t) {
    const double x = std::clamp(t, 0.0, 1.0) * static_cast<double>(scale.size() - 1);
    const auto i = std::min(scale.size() - 2, static_cast<std::size_t>(x));
    const auto s = static_cast<float>(x - static_cast<double>(i));
    const Eigen::Vector3f srgb = channels(scale[i]) * (1 - s) + channels(scale[i + 1]) * s;
    return {render::to_linear(srgb[0]), render::to_linear(srgb[1]), render::to_linear(srgb[2])};
}

Vec3 at(const Coordinates& c, int v) {
    const auto i = 3 * static_cast<std::size_t>(v);
    return {static_cast<double>(c[i]), static_cast<double>(c[i + 1]), static_cast<double>(c[i + 2])};
}

Vec3 at(const ViewBody& body, std::size_t frame, int vertex) {
    const auto p = vertex_position(body, frame, static_cast<std::size_t>(vertex));
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

/// Edges of the faces that only one tet has.
void add_lattice(const ViewBody& body, std::size_t frame, std::vector<Segment>& out) {
    constexpr int faces[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
    std::map<std::array<int, 3>, int> seen;
    for (const solver::Tet& tet : body.lattice->tets)
        for (const auto& f : faces) {
            std::array<int, 3> key{};
            for (std::size_t k = 0; k < 3; ++k) key[k] = tet[static_cast<std::size_t>(f[k])];
            std::sort(key.begin(), key.end());
            ++seen[key];
        }
    std::set<std::array<int, 2>> edges;
    for (const auto& [face, count] : seen)
        if (count == 1) edges.insert({{face[0], face[1]}, {face[1], face[2]}, {face[0], face[2]}});
    const Eigen::Vector3f grey = colour_at(std::array{lattice_grey, lattice_grey}, 0);
    const Coordinates places = drawn_lattice(body, frame);
    for (const auto& [a, b] : edges) out.push_back({at(places, a), at(places, b), grey, 0.8f});
}

/// How a tet has turned and stretched.
Mat3 gradient_of(const ViewLattice& lattice, std::size_t frame, const solver::Tet& tet) {
    Mat3 now, rest;
    const Coordinates& p = lattice.frames[frame];
    for (int k = 0; k < 3; ++k) {
        now.col(k) = at(p, tet[static_cast<std::size_t>(k) + 1]) - at(p, tet[0]);
        rest.col(k) = at(lattice.rest, tet[static_cast<std::size_t>(k) + 1]) - at(lattice.rest, tet[0]);
    }
    return now * rest.inverse();
}

void add_fibres(const ViewBody& body, std::size_t frame, std::vector<Segment>& out) {
    for (const ViewFibres& fibres : body.fibres) {
        const Eigen::Vector3f colour = colour_at(heat, static_cast<double>(fibres.excitation.at(frame)));
        for (std::size_t i = 0; i < fibres.tets.size(); ++i) {
            const solver::Tet& tet = body.lattice->tets[static_cast<std::size_t>(fibres.tets[i])];
            Vec3 middle = Vec3::Zero();
            for (std::size_t k = 0; k < 4; ++k)
                middle += static_cast<double>(fibres.centre[4 * i + k]) * at(body.lattice->frames[frame], tet[k]);
            const Vec3 d = gradient_of(*body.lattice, frame, tet) * at(fibres.directions, static_cast<int>(i));
            const auto [back, forth] =
                std::pair(static_cast<double>(fibres.reach[2 * i]), static_cast<double>(fibres.reach[2 * i + 1]));
            out.push_back({middle - back * d, middle + forth * d, colour, 1.7f});
        }
    }
}

/// A vertex of what carries points of a body: its tets, or a bone's surface.
Vec3 host_place(const ViewBody& body, std::size_t frame, int vertex) {
    return body.lattice ? at(body.lattice->frames[frame], vertex) : at(body, frame, vertex);
}

Vec3 carried_place(const ViewCarried& point, const ViewBody& body, std::size_t frame) {
    Vec3 p = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k)
        if (point.host[k] >= 0) p += static_cast<double>(point.weights[k]) * host_place(body, frame, point.host[k]);
    return p;
}

/// Where an attached point holds on.
Vec3 anchor_place(const ViewAnchor& anchor, const ViewBody& target, std::size_t frame) {
    const Vec3 p = carried_place(anchor.target, target, frame);
    const Vec3 offset(static_cast<double>(anchor.offset[0]), static_cast<double>(anchor.offset[1]),
                      static_cast<double>(anchor.offset[2]));
    if (offset.isZero()) return p;
    const auto host = [&](std::size_t k) { return host_place(target, frame, anchor.target.host[k]); };
    // The triangle's own frame: first edge, across, normal (solver/terms/attachment/anchors.cpp).
    const Vec3 along = (host(1) - host(0)).normalized(),
               normal = (host(1) - host(0)).cross(host(2) - host(0)).normalized();
    return p + offset[0] * along + offset[1] * normal.cross(along) + offset[2] * normal;
}

/// The longest distance of the scene's frames in millimetres, which the last colour stands for.
double longest(const ViewScene& scene) {
    double most = 0;
    for (const ViewFrame& f : scene.frames)
        if (f.step && f.faults.empty())
            if (const double m = solver::value_of(f.step->measured, "attachment", "max_stretch_m"); std::isfinite(m))
                most = std::max(most, 1000 * m);
    return most > 0 ? most : 5;
}

void add_attachments(const ViewScene& scene, std::size_t frame, std::vector<Segment>& out) {
    const double most = longest(scene);
    for (const ViewAttachment& a : scene.attachments) {
        const ViewBody &source = scene.bodies[static_cast<std::size_t>(a.source)],
                       &target = scene.bodies[static_cast<std::size_t>(a.target)];
        if (!source.is_there(frame) || !target.is_there(frame)) continue;
        for (const ViewAnchor& anchor : a.anchors) {
            const Vec3 from = carried_place(anchor.source, source, frame), to = anchor_place(anchor, target, frame);
            const Eigen::Vector3f colour =
                colour_at(distance, 1000 * (to - from).norm() / scene.units_per_metre / most);
            out.push_back({from, to, colour, 1.0f});
            out.push_back({from, from, colour, 2.6f});
        }
    }
}

/// Least and most value of one unit over the frames without faults (all, if each has some), zero included.
std::array<double, 2> marks_range(const ViewScene& scene, const std::string& unit) {
    const bool none_is_good =
        std::none_of(scene.frames.begin(), scene.frames.end(), [](const ViewFrame& f) { return f.faults.empty(); });
    std::array<double, 2> out{0, 0};
    for (const ViewFrame& f : scene.frames) {
        if (!f.faults.empty() && !none_is_good) continue;
        for (const ViewMarks& group : f.marks)
            for (const ViewMark& m : group.marks)
                if (group.unit == unit)
                    out = {std::min(out[0], static_cast<double>(m.value)),
                           std::max(out[1], static_cast<double>(m.value))};
    }
    return out[0] < out[1] ? out : std::array<double, 2>{0, 1};
}

void add_marks(const ViewScene& scene, std::size_t frame, std::vector<Segment>& out) {
    const auto place = [](const std::array<float, 3>& p) {
        return Vec3(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
    };
    for (const ViewMarks& group : scene.frames[frame].marks) {
        const auto [least, most] = marks_range(scene, group.unit);
        for (const ViewMark& m : group.marks) {
            const Eigen::Vector3f colour = colour_at(distance, (static_cast<double>(m.value) - least) / (most - least));
            if (m.from != m.to) out.push_back({place(m.from), place(m.to), colour, 1.3f});
            out.push_back({place(m.from), place(m.from), colour, 2.6f});
        }
    }
}

} // namespace

const std::set<std::string>& overlay_names() {
    static const std::set<std::string> names{"lattice", "fibers", "attachments", "marks"};
    return names;
}

std::vector<Segment> overlay_segments(const ViewScene& scene, std::size_t frame, const std::set<std::string>& names) {
    std::vector<Segment> out;
    for (const ViewBody& body : scene.bodies) {
        if (!body.lattice || !body.is_there(frame)) continue;
        if (names.contains("lattice")) add_lattice(body, frame, out);
        if (names.contains("fibers")) add_fibres(body, frame, out);
    }
    if (names.contains("attachments")) add_attachments(scene, frame, out);
    if (names.contains("marks")) add_marks(scene, frame, out);
    return out;
}

} // namespace sinew::viewer
