// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/sliding/sliding_target.h"

#include "solver/mesh/surface_mesh.h"
#include "solver/parallel.h"
#include "solver/terms/attachment/find_targets.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::solver {

namespace {

int faces_at_edge(const CarriedSurface& surface, int a, int b) {
    const std::span<const int> fan = surface.fan(a);
    return static_cast<int>(
        std::count_if(fan.begin(), fan.end(), [&](int t) { return has_vertex(surface.triangles()[at(t)], b); }));
}

/// The share of b of what of p lies on the line from a to b, as of place_in_plane never exactly at an end.
double place_on_line(const Vec3& a, const Vec3& b, const Vec3& p) {
    const double length2 = (b - a).squaredNorm();
    if (!(length2 > 0)) return 0;
    const double share = (b - a).dot(p - a) / length2;
    return share == 0 || share == 1 ? share + 1e-15 : share;
}

void tidy(std::vector<int>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

} // namespace

SlidingTarget::SlidingTarget(const Scene& scene, int body)
    : surface_(scene, body, 0)
    , is_open_(!is_closed(surface_.triangles())) {
    if (surface_.deforms()) hessian_.emplace(surface_);
}

std::vector<char> SlidingTarget::allowed(const Scene& scene, const AttachmentRest& a) const {
    if (a.target_weights.empty()) return {};
    const std::vector<char> whole = allowed_triangles(a, scene.surface(a.target), scene.triangles(a.target));
    if (std::find(whole.begin(), whole.end(), 0) == whole.end()) return {};
    std::vector<char> out;
    for (const int t : surface_.parts_of()) out.push_back(whole[at(t)]);
    return out;
}

const std::vector<int>& SlidingTarget::carriers_about(int triangle) const {
    carriers_about_.resize(surface_.triangles().size());
    std::vector<int>& out = carriers_about_[at(triangle)];
    if (!out.empty()) return out;
    std::vector<int> points;
    for (const int corner : surface_.triangles()[at(triangle)])
        for (const int t : surface_.fan(corner))
            for (const int p : surface_.triangles()[at(t)]) points.push_back(p);
    tidy(points);
    for (const int p : points)
        for (const RideTerm& t : surface_.ride(p)) out.push_back(t.vertex);
    tidy(out);
    return out;
}

void SlidingTarget::place(const double* carriers) {
    places_.resize(surface_.point_count());
    parallel_for(places_.size(), 512,
                 [&](std::size_t p) { places_[p] = surface_.place(static_cast<int>(p), carriers); });
}

bool SlidingTarget::on_rim(int triangle, const Vec3& place) const {
    if (!is_open_) return false;
    const Triangle& t = surface_.triangles()[at(triangle)];
    int on[3], count = 0;
    for (int c = 0; c < 3; ++c)
        if (place[c] != 0) on[count++] = t[at(c)];
    if (count == 3) return false;
    if (count == 2) return faces_at_edge(surface_, on[0], on[1]) == 1;
    for (const int f : surface_.fan(on[0]))
        for (const int v : surface_.triangles()[at(f)])
            if (v != on[0] && faces_at_edge(surface_, on[0], v) == 1) return true;
    return false;
}

Feature SlidingTarget::feature_of(const ClosestFeature& nearest) const {
    Feature out;
    out.triangle = nearest.triangle;
    for (std::size_t c = 0; c < 3; ++c) out.on[c] = nearest.place[static_cast<Eigen::Index>(c)] != 0;
    out.inside = nearest.inside(), out.rim = on_rim(nearest.triangle, nearest.place);
    return out;
}

ClosestFeature SlidingTarget::place_on(const Feature& feature, const Vec3& p) const {
    const std::array<Vec3, 3> c = surface_.corners(feature.triangle, places_);
    ClosestFeature out;
    out.triangle = feature.triangle;
    std::array<std::size_t, 3> on{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k)
        if (feature.on[k]) on[count++] = k;
    if (count == 3) {
        out.place = place_in_plane(c, p);
    } else {
        const double share = count == 2 ? place_on_line(c[on[0]], c[on[1]], p) : 0;
        out.place[static_cast<Eigen::Index>(on[0])] = 1 - share;
        if (count == 2) out.place[static_cast<Eigen::Index>(on[1])] = share;
    }
    out.away = p - out.place[0] * c[0] - out.place[1] * c[1] - out.place[2] * c[2];
    return out;
}

Height SlidingTarget::height_over(const Feature& nearest, const Vec3& p, bool alone) const {
    Height out;
    const std::size_t corners = static_cast<std::size_t>(std::count(nearest.on.begin(), nearest.on.end(), true));
    if (corners == 3 || nearest.rim) {
        Feature face = nearest;
        face.on = {true, true, true};
        const ClosestFeature f = place_on(face, p);
        out.triangle = f.triangle, out.place = f.place, out.normal = face_normal(surface_, places_, f.triangle);
        out.value = out.normal.dot(f.away);
        return out;
    }
    ClosestFeature f;
    bool inside = nearest.inside;
    if (alone) {
        f = place_on(nearest, p);
    } else {
        const Triangle& t = surface_.triangles()[at(nearest.triangle)];
        int on[2] = {-1, -1}, count = 0;
        for (std::size_t k = 0; k < 3; ++k)
            if (nearest.on[k]) on[count++] = t[k];
        NearestPlace best;
        best.distance2 = std::numeric_limits<double>::infinity();
        for (const int face : surface_.fan(on[0]))
            if (count == 1 || has_vertex(surface_.triangles()[at(face)], on[1])) best.offer(surface_, places_, face, p);
        f = sinew::solver::feature_of(surface_, places_, best, p);
        inside = f.inside();
    }
    const double distance = f.away.norm();
    out.triangle = f.triangle, out.place = f.place;
    // On a face, and closer than this, where the way there has no direction, along the face's normal.
    if ((f.place.array() != 0).all() || !(distance > 1e-12 * surface_.mean_edge())) {
        out.normal = face_normal(surface_, places_, f.triangle);
        out.value = out.normal.dot(f.away);
    } else {
        out.value = inside ? -distance : distance;
        out.normal = f.away / out.value;
    }
    return out;
}

PointTriangleBlocks SlidingTarget::bend(const Height& h, bool project) const {
    PointTriangleBlocks out{};
    const bool is_face = (h.place.array() != 0).all();
    // A height over a face does not bend but with the face.
    if (!(std::abs(h.value) > 1e-9 * surface_.mean_edge()) || (project && is_face)) {
        for (Mat3& block : out) block.setZero();
        return out;
    }
    out = point_triangle_hessian(surface_.corners(h.triangle, places_), h.place, h.value * h.normal, project);
    add_square(h.place, -h.normal * h.normal.transpose(), out);
    return out;
}

} // namespace sinew::solver
