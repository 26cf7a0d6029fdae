// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/recorder.h"

#include "tools/cli/rigid_motion.h"
#include "tools/render/shading_mesh.h"
#include "tools/viewer/faults.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace sinew::viewer {

using solver::Points;

namespace {

/// Of the body's diagonal; a fifth of what the page's 16 bits lose.
constexpr double rigid_tolerance = 2e-6;

std::vector<std::array<int, 2>> polygon_edges(const solver::SurfaceMesh& mesh) {
    std::vector<std::array<int, 2>> edges;
    std::size_t first = 0;
    for (const int size : mesh.face_sizes) {
        const auto count = static_cast<std::size_t>(size);
        for (std::size_t k = 0; k < count; ++k) {
            const int a = mesh.face_vertices[first + k], b = mesh.face_vertices[first + (k + 1) % count];
            edges.push_back({std::min(a, b), std::max(a, b)});
        }
        first += count;
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

bool is_finite(const Points& points) {
    return std::all_of(points.begin(), points.end(),
                       [](const solver::Vec3& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < most_drawable; });
}

} // namespace

BodyRecorder::BodyRecorder(std::string name, std::string node, render::BodyKind kind, int index,
                           const render::Appearance& appearance) {
    body_.name = std::move(name), body_.node = std::move(node), body_.kind = kind;
    body_.look = render::look_of(kind, appearance, index);
    body_.matter = render::matter_of(kind, appearance);
    body_.motion = RigidMotion{};
}

void BodyRecorder::set_rest(const solver::SurfaceMesh& rest) {
    rest_ = rest.points;
    triangles_ = rest.triangles;
    has_rest_ = true;
    body_.rest = coordinates(rest.points);
    body_.edges = polygon_edges(rest);
    const render::ShadingMesh shading = render::split_creases(rest.points, rest.triangles);
    body_.triangles = shading.triangles;
    bool same = shading.source.size() == rest.points.size();
    for (std::size_t i = 0; same && i < shading.source.size(); ++i) same = shading.source[i] == static_cast<int>(i);
    if (!same) body_.shading = shading.source;
    if (solver::is_closed(rest.triangles))
        if (const double v = solver::enclosed_volume(rest.points, rest.triangles); v > 0) rest_volume_ = v;
    auto& rigid = std::get<RigidMotion>(body_.motion);
    solver::Vec3 centre = solver::Vec3::Zero();
    for (const solver::Vec3& p : rest_) centre += p / static_cast<double>(rest_.size());
    for (int c = 0; c < 3; ++c) rigid.pivot[static_cast<std::size_t>(c)] = static_cast<float>(centre[c]);
}

void BodyRecorder::set_lattice(const solver::TetMesh& tets, const solver::Embedding& surface) {
    ViewLattice lattice;
    lattice.tets = tets.tets;
    lattice.rest = coordinates(tets.vertices);
    lattice.surface.tet = surface.tet;
    for (const auto& b : surface.barycentric)
        for (const double w : b) lattice.surface.weights.push_back(static_cast<float>(w));
    lattice_fits_ = surface.size() == rest_.size();
    if (!lattice_fits_) lattice.surface = {};
    body_.lattice = std::move(lattice);
    if (is_rigid_) body_.motion = DeformingMotion{};
    is_rigid_ = false;
}

bool BodyRecorder::try_rigid(const Points& points) {
    if (rest_.empty() || !is_finite(points)) return false;
    cli::RigidFit fit(rest_, rigid_tolerance);
    const auto found = fit.add(points);
    if (!found) return false;
    auto& rigid = std::get<RigidMotion>(body_.motion);
    RigidPose pose;
    const Eigen::Quaterniond& q = found->rotation;
    pose.rotation = {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
                     static_cast<float>(q.w())};
    // The fit turns about its own centre; ours is rounded to single precision.
    const solver::Vec3 pivot(static_cast<double>(rigid.pivot[0]), static_cast<double>(rigid.pivot[1]),
                             static_cast<double>(rigid.pivot[2]));
    const solver::Vec3 t = found->translation + q * (pivot - fit.pivot());
    pose.translation = {static_cast<float>(t[0]), static_cast<float>(t[1]), static_cast<float>(t[2])};
    rigid.poses.push_back(pose);
    return true;
}

void BodyRecorder::store(const Points& points) {
    if (is_rigid_) {
        if (try_rigid(points)) return;
        // Not rigid after all: the frames so far are written out.
        DeformingMotion moving;
        const std::size_t count = std::get<RigidMotion>(body_.motion).poses.size();
        for (std::size_t f = 0; f < count; ++f) {
            Coordinates& out = moving.points.emplace_back();
            for (std::size_t v = 0; v < rest_.size(); ++v)
                for (const float c : vertex_position(body_, f, v)) out.push_back(c);
        }
        body_.motion = std::move(moving);
        is_rigid_ = false;
    }
    std::get<DeformingMotion>(body_.motion).points.push_back(lattice_fits_ ? Coordinates{} : coordinates(points));
}

void BodyRecorder::repeat_last() {
    if (is_rigid_) {
        auto& rigid = std::get<RigidMotion>(body_.motion);
        rigid.poses.push_back(rigid.poses.empty() ? RigidPose{{0, 0, 0, 1}, rigid.pivot} : rigid.poses.back());
    } else {
        std::get<DeformingMotion>(body_.motion).points.emplace_back();
    }
    if (body_.lattice) body_.lattice->frames.emplace_back();
    body_.volume.push_back(std::numeric_limits<float>::quiet_NaN());
}

void BodyRecorder::measure_volume(const Points& points) {
    body_.volume.push_back(rest_volume_
                               ? static_cast<float>(solver::enclosed_volume(points, triangles_) / *rest_volume_)
                               : std::numeric_limits<float>::quiet_NaN());
}

void BodyRecorder::add(int frame, const solver::SurfaceMesh& mesh) {
    if (!has_rest_) set_rest(mesh);
    add_points(frame, mesh.points);
}

void BodyRecorder::add_points(int frame, const Points& points) {
    if (!has_rest_) throw std::logic_error("a body's points came before its connectivity");
    const bool fits = points.size() == rest_.size();
    body_.present.push_back(fits);
    if (!fits) {
        other_count_.push_back(frame);
        repeat_last();
        return;
    }
    store(points);
    measure_volume(points);
}

void BodyRecorder::add_tets(const Points& tet_vertices) { body_.lattice->frames.push_back(coordinates(tet_vertices)); }

void BodyRecorder::add_missing(int frame) {
    body_.present.push_back(0);
    missing_.push_back(frame);
    repeat_last();
}

ViewBody BodyRecorder::finish(std::vector<ViewNote>& notes) {
    if (!missing_.empty())
        notes.push_back({true, body_.name + ": nothing for frame" + (missing_.size() == 1 ? " " : "s ") +
                                   frame_list(missing_) + "; it is hidden there."});
    if (!other_count_.empty())
        notes.push_back({true, body_.name + " has " + std::to_string(rest_.size()) +
                                   " vertices, but another number in frame" + (other_count_.size() == 1 ? " " : "s ") +
                                   frame_list(other_count_) + "; it is hidden there."});
    if (std::all_of(body_.present.begin(), body_.present.end(), [](char there) { return there != 0; }))
        body_.present.clear();
    if (std::none_of(body_.volume.begin(), body_.volume.end(), [](float v) { return std::isfinite(v); }))
        body_.volume.clear();
    return std::move(body_);
}

Coordinates coordinates(const Points& points) {
    Coordinates out;
    out.reserve(3 * points.size());
    for (const solver::Vec3& p : points)
        for (int c = 0; c < 3; ++c)
            out.push_back(std::abs(p[c]) < most_drawable ? static_cast<float>(p[c])
                                                         : std::numeric_limits<float>::quiet_NaN());
    return out;
}

std::string frame_list(const std::vector<int>& frames) {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < frames.size();) {
        std::size_t end = i;
        while (end + 1 < frames.size() && frames[end + 1] == frames[end] + 1) ++end;
        parts.push_back(std::to_string(frames[i]) + (end > i ? "-" + std::to_string(frames[end]) : ""));
        i = end + 1;
    }
    constexpr std::size_t most = 8;
    std::string out;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (i == most && parts.size() > most + 1)
            return out + " and " + std::to_string(parts.size() - most) + " more ranges";
        out += (i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
    }
    return out;
}

} // namespace sinew::viewer
