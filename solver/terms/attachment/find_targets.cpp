// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/find_targets.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/parallel.h"

#include <algorithm>
#include <map>
#include <string>

namespace sinew::solver {

namespace {

Triangle sorted(Triangle t) {
    std::sort(t.begin(), t.end());
    return t;
}

double mean_edge(const TargetSearch& in, const std::vector<char>& allowed) {
    double sum = 0, count = 0;
    for (std::size_t t = 0; t < allowed.size(); ++t)
        for (std::size_t i = 0; i < 3 && allowed[t]; ++i, ++count)
            sum += (in.target[at(in.triangles[t][i])] - in.target[at(in.triangles[t][(i + 1) % 3])]).norm();
    return sum / count;
}

void find_closest(const TargetSearch& in, const std::vector<SurfaceSample>& samples, FoundTargets& out) {
    const std::vector<char> allowed = allowed_triangles(in.attachment, in.target, in.triangles);
    const bool everywhere = std::find(allowed.begin(), allowed.end(), 0) == allowed.end();
    out.max_distance = in.attachment.max_distance > 0 ? in.attachment.max_distance
                                                      : 2 * std::min(mean_edge(in, allowed), in.source_edge);
    parallel_for(samples.size(), 16, [&](std::size_t i) {
        const ClosestPoint any = in.tree->closest(samples[i].point);
        const bool at_once = everywhere || (any.triangle >= 0 && allowed[at(any.triangle)]);
        const ClosestPoint c = at_once ? any : in.tree->closest(samples[i].point, allowed);
        if (c.triangle < 0) return;
        // A point on the rim of what is allowed is allowed, whichever triangle was found first.
        if (c.distance > std::max(out.max_distance, any.distance * (1 + 1e-9))) return;
        out.points[i] = {true, in.triangles[at(c.triangle)], c.barycentric, c.point};
    });
}

void find_same_vertices(const TargetSearch& in, const std::vector<SurfaceSample>& samples, FoundTargets& out) {
    const AttachmentRest& a = in.attachment;
    const bool by_faces = a.target_painted == PaintedOn::faces && a.target_weights.size() > 1;
    std::map<Triangle, std::size_t> faces; // of the target, by their vertices
    for (std::size_t t = 0; t < in.triangles.size() && by_faces; ++t) faces.emplace(sorted(in.triangles[t]), t);
    const std::size_t count = by_faces ? in.triangles.size() : in.target.size();
    if (a.target_weights.size() > 1 && a.target_weights.size() != count)
        throw Error("FE204",
                    "target weights: " + std::to_string(a.target_weights.size()) + " for a mesh of " +
                        std::to_string(count) + (by_faces ? " triangles" : " vertices"),
                    "give one number for each, or one for all");
    const auto allowed = [&](const Triangle& t) {
        if (a.target_weights.empty()) return true;
        if (a.target_weights.size() == 1) return a.target_weights.front() > 0;
        if (!by_faces) return std::all_of(t.begin(), t.end(), [&](int v) { return a.target_weights[at(v)] > 0; });
        const auto face = faces.find(sorted(t));
        if (face == faces.end())
            throw Error("FE217",
                        "the target has no face of the vertices " + std::to_string(t[0]) + ", " + std::to_string(t[1]) +
                            " and " + std::to_string(t[2]) + ", which the source has",
                        "paint the target's vertices, or use a target with the same faces");
        return a.target_weights[face->second] > 0;
    };
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Triangle& t = in.source_triangles[at(samples[i].triangle)];
        if (!allowed(t)) continue;
        const Vec3& b = samples[i].place;
        out.points[i] = {true, t, b,
                         b[0] * in.target[at(t[0])] + b[1] * in.target[at(t[1])] + b[2] * in.target[at(t[2])]};
    }
}

} // namespace

std::vector<char> allowed_triangles(const AttachmentRest& attachment, const Points& target,
                                    const std::vector<Triangle>& triangles) {
    const CornerWeights paint = corner_weights(target, triangles, attachment.target_weights, attachment.target_painted);
    std::vector<char> allowed(triangles.size());
    for (std::size_t t = 0; t < allowed.size(); ++t)
        allowed[t] = std::all_of(paint[t].begin(), paint[t].end(), [](double w) { return w > 0; });
    if (std::find(allowed.begin(), allowed.end(), 1) == allowed.end())
        throw Error("FE240", "no face of the target has a target weight above 0 at all its vertices",
                    "paint the target where the source may attach");
    return allowed;
}

FoundTargets find_targets(const TargetSearch& in, const std::vector<SurfaceSample>& samples) {
    FoundTargets out;
    out.points.resize(samples.size());
    const bool by_vertices = in.attachment.correspondence == Correspondence::vertex_id;
    if (by_vertices)
        find_same_vertices(in, samples, out);
    else
        find_closest(in, samples, out);
    if (std::none_of(out.points.begin(), out.points.end(), [](const TargetPoint& p) { return p.allowed; }))
        throw Error("FE240",
                    by_vertices ? "all that is painted of the source has its vertices where the target is forbidden"
                                : "no painted point of the source is near to where the target is allowed",
                    "paint the target where the source is to hold on, or raise maxDistance");
    return out;
}

} // namespace sinew::solver
