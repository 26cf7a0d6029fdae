// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/spring_patches.h"

#include "solver/index.h"
#include "solver/sort_into.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <variant>

namespace sinew::solver {

namespace {

/// Single springs are this many times as stiff as flesh across a tet, so that they hardly stray from their patch. On
/// the arm at frame 33, linear tets, 1 takes 27 % of the distance from small quadratic tets away, 4 26, 16 22, 50 16;
/// what is attached to a bone then strays from it by up to 2, 1.6, 1.0, and less than 0.7 mm.
constexpr double firmness = 16;

/// Of barycentric coordinates: what rounding and files leave.
constexpr double near = 1e-5;

/// In its tet, and not on one of its sides. Where a target keeps its distance that is the place at a distance, which
/// lies outside where the target's own point is on the tets' boundary.
bool inside(const AnchorEnd& end) {
    return std::all_of(end.coordinates.begin(), end.coordinates.end(), [](double c) { return c > near; });
}

/// Sums of areas, or products with them, that would be lost to underflow pull nothing.
bool weighs(const SpringBundles::Spring& s) { return s.area_weight > 1e-100; }

double stiffest(const TissueInputs& tissue) {
    double modulus = 0;
    const auto take = [&](const std::vector<MaterialValues>& layers) {
        for (const MaterialValues& m : layers) modulus = std::max(modulus, m.youngs_modulus);
    };
    take(tissue.layers);
    for (const SubtissueInputs& part : tissue.subtissues) take(part.layers);
    return modulus;
}

} // namespace

std::vector<double> tet_edges(const Scene& scene) {
    std::vector<double> out(static_cast<std::size_t>(scene.body_count()), 0.0);
    for (int body = 0; body < scene.body_count(); ++body) {
        const TissueRest* tissue = scene.tissue(scene.carrier_of(body));
        if (!tissue) continue;
        const TetMesh& mesh = tissue->tets;
        double volume = 0;
        for (const Tet& t : mesh.tets)
            volume += std::abs(tet_volume(mesh.vertices[at(t[0])], mesh.vertices[at(t[1])], mesh.vertices[at(t[2])],
                                          mesh.vertices[at(t[3])]));
        out[at(body)] = std::cbrt(6 * std::numbers::sqrt2 * volume / static_cast<double>(mesh.tets.size()));
    }
    return out;
}

int patch_side(const Scene& scene, const AttachmentRest& attachment, std::span<const double> edges) {
    const double source = edges[at(attachment.source)], target = edges[at(attachment.target)];
    if (source == 0 && target == 0) return -1;
    // What rounding makes of tets of one size decides nothing.
    return scene.carrier_of(target > 1.02 * source ? attachment.target : attachment.source);
}

double single_stiffness(const Scene& scene, const AttachmentRest& attachment, std::span<const double> edges,
                        const StepInputs& inputs) {
    double out = std::numeric_limits<double>::infinity();
    for (const int body : {attachment.source, attachment.target})
        if (edges[at(body)] > 0) {
            const auto& tissue = std::get<TissueInputs>(inputs.bodies[at(scene.carrier_of(body))]);
            out = std::min(out, firmness * stiffest(tissue) / edges[at(body)]);
        }
    return out;
}

SpringPatches::SpringPatches(const Scene& scene, const SpringBundles& bundles,
                             std::span<const std::span<const Anchor>> anchors, std::span<const int> sides) {
    const auto& attachments = scene.description().attachments;
    const auto source_is_side = [&](int attachment) {
        return sides[at(attachment)] == scene.carrier_of(attachments[at(attachment)].source);
    };
    const auto is_inside = [&](int attachment, const SpringBundles::Spring& s) {
        const Anchor& anchor = anchors[at(attachment)][at(s.anchor)];
        return weighs(s) && inside(source_is_side(attachment) ? anchor.source : anchor.target);
    };
    patched_.assign(sides.size(), 0);
    for (std::size_t b = 0; b < bundles.count() && !sides.empty(); ++b) {
        const int attachment = bundles.attachment(b);
        if (sides[at(attachment)] < 0 || patched_[at(attachment)]) continue;
        bundles.for_each_spring(b, [&](const SpringBundles::Spring& s) {
            if (is_inside(attachment, s)) patched_[at(attachment)] = 1;
        });
    }
    if (std::none_of(patched_.begin(), patched_.end(), [](char p) { return p != 0; })) return;

    // Which vertex each spring is nearest to, and what that vertex's springs couple.
    std::vector<int> nearest_to(bundles.spring_count(), -1);
    const auto for_each_patched = [&](const auto& visit) {
        for (std::size_t b = 0; b < bundles.count(); ++b)
            if (const int attachment = bundles.attachment(b); patched_[at(attachment)])
                bundles.for_each_spring(b, [&](const SpringBundles::Spring& s) {
                    if (weighs(s)) visit(attachment, bundles.vertices(b), s);
                });
    };
    std::unordered_map<int, std::unordered_set<int>> coupled; // of the attachment at hand
    std::set<std::pair<int, int>> too_large;                  // by attachment and vertex
    int last = -1;
    const auto part_large_ones = [&](int next) {
        if (next == last) return;
        for (const auto& [vertex, others] : coupled)
            if (others.size() > most_vertices) too_large.insert({last, vertex});
        coupled.clear();
        last = next;
    };
    for_each_patched([&](int attachment, std::span<const int> vertices, const SpringBundles::Spring& s) {
        part_large_ones(attachment);
        if (!is_inside(attachment, s)) return;
        const int side = sides[at(attachment)];
        const int first = scene.first_vertex(side), end = first + static_cast<int>(scene.vertex_count(side));
        // Where both ends move, the target's coefficients have the other sign.
        const double sign = source_is_side(attachment) || !scene.deforms(attachments[at(attachment)].source) ? 1 : -1;
        // The first of those that are as near, up to rounding: in a lattice many samples lie between two.
        double most = -std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < vertices.size(); ++i)
            if (vertices[i] >= first && vertices[i] < end && sign * s.coefficients[i] > most + near)
                nearest_to[s.number] = vertices[i], most = sign * s.coefficients[i];
        coupled[nearest_to[s.number]].insert(vertices.begin(), vertices.end());
    });
    part_large_ones(-1);

    of_spring_.assign(bundles.spring_count(), -1);
    std::map<std::pair<int, int>, int> patch_at; // by attachment and vertex
    std::vector<std::unordered_map<int, double>> sums;
    for_each_patched([&](int attachment, std::span<const int> vertices, const SpringBundles::Spring& s) {
        const std::pair key{attachment, nearest_to[s.number]};
        const int next = static_cast<int>(patches_.size());
        const bool alone = key.second < 0 || too_large.contains(key);
        const int patch = alone ? next : patch_at.try_emplace(key, next).first->second;
        if (patch == next) patches_.push_back({attachment, 0}), sums.emplace_back();
        of_spring_[s.number] = patch;
        patches_[at(patch)].area += s.area_weight;
        for (std::size_t i = 0; i < vertices.size(); ++i)
            sums[at(patch)][vertices[i]] += s.area_weight * s.coefficients[i];
    });
    sort_into(patches_.size(), first_spring_, spring_, [&](const auto& visit) {
        for (std::size_t s = 0; s < of_spring_.size(); ++s)
            if (of_spring_[s] >= 0) visit(at(of_spring_[s]), static_cast<int>(s));
    });
    for (const auto& sum : sums) {
        first_pull_.push_back(static_cast<int>(pull_.size()));
        for (const auto& [vertex, area] : sum) pull_.push_back({vertex, area});
        std::sort(pull_.begin() + first_pull_.back(), pull_.end(),
                  [](const Pull& a, const Pull& b) { return a.vertex < b.vertex; });
    }
    first_pull_.push_back(static_cast<int>(pull_.size()));
}

} // namespace sinew::solver
