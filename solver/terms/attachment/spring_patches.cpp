// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/spring_patches.h"

#include "solver/index.h"
#include "solver/sort_into.h"
#include "solver/terms/elastic/layer_mix.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <unordered_map>
#include <unordered_set>
#include <variant>

namespace sinew::solver {

namespace {

/// Single springs are this many times as stiff as flesh across a tet. Fewer make bodies more exact, and let points that
/// are held stray farther: at 100 those of the arm's bones by 0.74 mm instead of less than 0.7.
constexpr double firmness = 125;

/// Of barycentric coordinates: what rounding and files leave.
constexpr double near = 1e-5;

/// In its tet, and not on one of its sides. Where a target keeps its distance that is the place at a distance, which
/// lies outside where the target's own point is on the tets' boundary.
bool inside(const AnchorEnd& end) {
    return std::all_of(end.coordinates.begin(), end.coordinates.end(), [](double c) { return c > near; });
}

/// Sums of areas, or products with them, that would be lost to underflow pull nothing.
bool weighs(const SpringBundles::Spring& s) { return s.area_weight > 1e-100; }

/// visit(attachment, vertices of its bundle, spring) for all springs, by rising attachments.
template <class Visit>
void for_each(const SpringBundles& bundles, const Visit& visit) {
    for (std::size_t b = 0; b < bundles.count(); ++b)
        bundles.for_each_spring(
            b, [&](const SpringBundles::Spring& s) { visit(bundles.attachment(b), bundles.vertices(b), s); });
}

/// Of springs that end inside of tets of their attachment's side.
struct NearestVertices {
    const Scene& scene;
    const SpringBundles& bundles;
    std::span<const std::span<const Anchor>> anchors;
    std::span<const int> sides;

    /// One a spring; -1 for others.
    std::vector<int> find() const {
        std::vector<int> out(bundles.spring_count(), -1);
        if (sides.empty()) return out;
        for_each(bundles, [&](int attachment, std::span<const int> vertices, const SpringBundles::Spring& s) {
            if (sides[at(attachment)] >= 0 && weighs(s)) out[s.number] = nearest(attachment, vertices, s);
        });
        return out;
    }

  private:
    int nearest(int attachment, std::span<const int> vertices, const SpringBundles::Spring& s) const {
        const AttachmentRest& rest = scene.description().attachments[at(attachment)];
        const int side = sides[at(attachment)];
        const bool at_source = side == scene.carrier_of(rest.source);
        const Anchor& anchor = anchors[at(attachment)][at(s.anchor)];
        if (!inside(at_source ? anchor.source : anchor.target)) return -1;
        const int first = scene.first_vertex(side), end = first + static_cast<int>(scene.vertex_count(side));
        // Where both ends move, the target's coefficients have the other sign.
        const double sign = at_source || !scene.deforms(rest.source) ? 1 : -1;
        // The first of those that are as near, up to rounding: in a lattice many samples lie between two.
        int out = -1;
        double most = -std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < vertices.size(); ++i)
            if (vertices[i] >= first && vertices[i] < end && sign * s.coefficients[i] > most + near)
                out = vertices[i], most = sign * s.coefficients[i];
        return out;
    }
};

/// Leaves springs to themselves (-1) whose patch would couple too many vertices.
void part_large_patches(const SpringBundles& bundles, std::vector<int>& nearest) {
    std::map<std::pair<int, int>, std::unordered_set<int>> coupled; // by attachment and vertex
    for_each(bundles, [&](int attachment, std::span<const int> vertices, const SpringBundles::Spring& s) {
        if (nearest[s.number] >= 0) coupled[{attachment, nearest[s.number]}].insert(vertices.begin(), vertices.end());
    });
    for_each(bundles, [&](int attachment, std::span<const int>, const SpringBundles::Spring& s) {
        int& vertex = nearest[s.number];
        if (vertex >= 0 && coupled[{attachment, vertex}].size() > SpringPatches::most_vertices) vertex = -1;
    });
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

std::array<HeldTets, 2> held_tets(const Scene& scene, const AttachmentRest& attachment,
                                  std::span<const Anchor> anchors) {
    std::array<HeldTets, 2> out;
    for (const std::size_t end : {0, 1}) {
        const int body = end == 0 ? attachment.source : attachment.target;
        if (!scene.tissue(body) || anchors.empty()) continue;
        std::map<int, double> areas;
        for (const Anchor& a : anchors) areas[(end == 0 ? a.source : a.target).tet] += a.area_weight;
        out[end] = {scene.carrier_of(body), {areas.begin(), areas.end()}};
    }
    return out;
}

double single_stiffness(const Scene& scene, const std::array<HeldTets, 2>& held, std::span<const double> edges,
                        const StepInputs& inputs) {
    double out = std::numeric_limits<double>::infinity();
    for (const HeldTets& end : held) {
        if (end.body < 0) continue;
        const TissueRest& rest = *scene.tissue(end.body);
        const auto& tissue = std::get<TissueInputs>(inputs.bodies[at(end.body)]);
        double sum = 0, all = 0;
        for (const auto& [tet, area] : end.areas)
            sum += area * mix_layers(rest, tissue, at(tet)).youngs_modulus, all += area;
        if (all > 0) out = std::min(out, firmness * sum / all / edges[at(end.body)]);
    }
    return out;
}

SpringPatches::SpringPatches(const Scene& scene, const SpringBundles& bundles,
                             std::span<const std::span<const Anchor>> anchors, std::span<const int> sides) {
    std::vector<int> nearest = NearestVertices{scene, bundles, anchors, sides}.find();
    patched_.assign(sides.size(), 0);
    for_each(bundles, [&](int attachment, std::span<const int>, const SpringBundles::Spring& s) {
        if (nearest[s.number] >= 0) patched_[at(attachment)] = 1;
    });
    if (std::none_of(patched_.begin(), patched_.end(), [](char p) { return p != 0; })) return;
    part_large_patches(bundles, nearest);

    of_spring_.assign(bundles.spring_count(), -1);
    std::map<std::pair<int, int>, int> patch_at; // by attachment and vertex
    std::vector<std::unordered_map<int, double>> sums;
    for_each(bundles, [&](int attachment, std::span<const int> vertices, const SpringBundles::Spring& s) {
        if (!patched_[at(attachment)] || !weighs(s)) return;
        const int next = static_cast<int>(patches_.size()), vertex = nearest[s.number];
        const int patch = vertex < 0 ? next : patch_at.try_emplace({attachment, vertex}, next).first->second;
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
