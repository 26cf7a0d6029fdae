// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/spring_bundles.h"

#include "solver/sort_into.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>

namespace sinew::solver {

namespace {

/// What one spring's ends ride on.
struct Ends {
    std::array<int, SpringBundles::most_vertices> vertex{};
    std::array<double, SpringBundles::most_vertices> coefficient{};
    std::size_t count = 0;
    std::span<const int> vertices() const { return {vertex.data(), count}; }
};

/// A list of vertices by its place in a longer one.
struct Place {
    std::size_t first, count;
};
struct Hash {
    const std::vector<int>& vertices;
    std::size_t operator()(const Place& p) const {
        std::uint64_t h = p.count;
        for (std::size_t i = p.first; i < p.first + p.count; ++i) {
            h = (h ^ static_cast<std::uint64_t>(vertices[i])) * 0x9e3779b97f4a7c15U;
            h ^= h >> 32;
        }
        return h;
    }
};
struct Alike {
    const std::vector<int>& vertices;
    bool operator()(const Place& a, const Place& b) const {
        const auto begin = [&](const Place& p) { return vertices.begin() + static_cast<std::ptrdiff_t>(p.first); };
        return std::equal(begin(a), begin(a) + static_cast<std::ptrdiff_t>(a.count), begin(b),
                          begin(b) + static_cast<std::ptrdiff_t>(b.count));
    }
};

} // namespace

SpringBundles::SpringBundles(const Scene& scene, std::span<const std::span<const Anchor>> anchors) {
    const auto& attachments = scene.description().attachments;
    std::size_t springs = 0;
    const auto pulls = [&](std::size_t a) {
        return scene.deforms(attachments[a].source) || scene.deforms(attachments[a].target);
    };
    for (std::size_t a = 0; a < anchors.size(); ++a)
        if (pulls(a)) springs += anchors[a].size();
    anchor_.reserve(springs), area_.reserve(springs);
    for (std::size_t a = 0; a < anchors.size(); ++a)
        if (pulls(a)) add(static_cast<int>(a), anchors[a], scene);
    bundles_.shrink_to_fit(), vertex_.shrink_to_fit(), coefficient_.shrink_to_fit();
}

void SpringBundles::add(int attachment, std::span<const Anchor> anchors, const Scene& scene) {
    const AttachmentRest& rest = scene.description().attachments[at(attachment)];
    const bool pulls_source = scene.deforms(rest.source), pulls_target = scene.deforms(rest.target);
    const auto ends_of = [&](const Anchor& anchor) {
        Ends out;
        const auto add_end = [&](const AnchorEnd& end, int body, double sign) {
            const PointWeights point = carried_end(scene, body, end);
            for (int k = 0; k < point.count; ++k, ++out.count)
                out.vertex[out.count] = point.vertex[k], out.coefficient[out.count] = sign * point.weight[k];
        };
        if (pulls_source) add_end(anchor.source, rest.source, 1);
        if (pulls_target) add_end(anchor.target, rest.target, pulls_source ? -1 : 1);
        return out;
    };

    const std::size_t first_bundle = bundles_.size();
    std::unordered_map<Place, int, Hash, Alike> known(0, Hash{vertex_}, Alike{vertex_});
    std::vector<int> bundle_of(anchors.size());
    for (std::size_t i = 0; i < anchors.size(); ++i) {
        const Ends ends = ends_of(anchors[i]);
        const Place place{vertex_.size(), ends.count};
        vertex_.insert(vertex_.end(), ends.vertices().begin(), ends.vertices().end());
        const auto [found, is_new] = known.try_emplace(place, static_cast<int>(bundles_.size() - first_bundle));
        bundle_of[i] = found->second;
        if (is_new)
            bundles_.push_back({attachment, 0, place.first, 0});
        else
            vertex_.resize(place.first);
    }

    std::vector<int> start, anchor;
    sort_into(bundles_.size() - first_bundle, start, anchor, [&](const auto& visit) {
        for (std::size_t i = 0; i < anchors.size(); ++i) visit(at(bundle_of[i]), static_cast<int>(i));
    });
    for (std::size_t b = first_bundle; b < bundles_.size(); ++b) {
        bundles_[b].first_spring = anchor_.size(), bundles_[b].first_coefficient = coefficient_.size();
        for (int k = start[b - first_bundle]; k < start[b - first_bundle + 1]; ++k) {
            const Anchor& a = anchors[at(anchor[at(k)])];
            const Ends ends = ends_of(a);
            anchor_.push_back(anchor[at(k)]), area_.push_back(a.area_weight);
            coefficient_.insert(coefficient_.end(), ends.coefficient.begin(),
                                ends.coefficient.begin() + static_cast<std::ptrdiff_t>(ends.count));
        }
    }
}

} // namespace sinew::solver
