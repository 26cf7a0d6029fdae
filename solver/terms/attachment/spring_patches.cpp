// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/spring_patches.h"

#include "solver/index.h"
#include "solver/sort_into.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <variant>

namespace sinew::solver {

namespace {

/// Single springs are this many times as stiff as flesh across a tet, so that they hardly stray from their patch. On
/// the arm at frame 33, linear tets, 1 takes 27 % of the distance from small quadratic tets away, 4 26, 16 22, 50 16;
/// what is attached to a bone then strays from it by up to 2, 1.6, 1.0, and less than 0.7 mm.
constexpr double firmness = 16;

/// Of a regular tet of the mean volume.
double mean_edge(const TetMesh& mesh) {
    double volume = 0;
    for (const Tet& t : mesh.tets)
        volume += std::abs(tet_volume(mesh.vertices[at(t[0])], mesh.vertices[at(t[1])], mesh.vertices[at(t[2])],
                                      mesh.vertices[at(t[3])]));
    return std::cbrt(6 * std::numbers::sqrt2 * volume / static_cast<double>(mesh.tets.size()));
}

/// Of barycentric coordinates: what rounding and files leave.
constexpr double near = 1e-5;

/// Not on one of its tet's sides.
bool inside(const AnchorEnd& end) {
    return std::all_of(end.coordinates.begin(), end.coordinates.end(), [](double c) { return std::abs(c) > near; });
}

} // namespace

PatchSide patch_side(const Scene& scene, const AttachmentRest& attachment) {
    PatchSide out;
    for (const int body : {attachment.source, attachment.target})
        if (const TissueRest* tissue = scene.tissue(body))
            if (const double edge = mean_edge(tissue->tets); edge > out.edge) out = {body, edge};
    return out;
}

double resistance(const PatchSide& side, const StepInputs& inputs) {
    if (side.body < 0) return std::numeric_limits<double>::infinity();
    const auto& tissue = std::get<TissueInputs>(inputs.bodies[at(side.body)]);
    double modulus = 0;
    const auto take = [&](const std::vector<MaterialValues>& layers) {
        for (const MaterialValues& m : layers) modulus = std::max(modulus, m.youngs_modulus);
    };
    take(tissue.layers);
    for (const SubtissueInputs& part : tissue.subtissues) take(part.layers);
    return firmness * modulus / side.edge;
}

SpringPatches::SpringPatches(const Scene& scene, const SpringBundles& bundles,
                             std::span<const std::span<const Anchor>> anchors, std::span<const char> stiff) {
    patched_.assign(stiff.size(), 0);
    std::vector<PatchSide> sides;
    const auto is_inside = [&](int attachment, const SpringBundles::Spring& s) {
        const Anchor& anchor = anchors[at(attachment)][at(s.anchor)];
        const AttachmentRest& rest = scene.description().attachments[at(attachment)];
        return inside(sides[at(attachment)].body == rest.source ? anchor.source : anchor.target);
    };
    for (std::size_t a = 0; a < stiff.size(); ++a)
        sides.push_back(stiff[a] ? patch_side(scene, scene.description().attachments[a]) : PatchSide{});
    for (std::size_t b = 0; b < bundles.count(); ++b) {
        const int attachment = bundles.attachment(b);
        if (!stiff.empty() && sides[at(attachment)].body >= 0 && !patched_[at(attachment)])
            bundles.for_each_spring(b, [&](const SpringBundles::Spring& s) {
                if (is_inside(attachment, s)) patched_[at(attachment)] = 1;
            });
    }
    if (std::none_of(patched_.begin(), patched_.end(), [](char p) { return p != 0; })) return;

    of_spring_.assign(bundles.spring_count(), -1);
    std::unordered_map<int, int> patch_at; // of the attachment at hand, by vertices
    std::vector<std::unordered_map<int, double>> sums;
    for (std::size_t b = 0; b < bundles.count(); ++b) {
        const int attachment = bundles.attachment(b);
        if (b > 0 && bundles.attachment(b - 1) != attachment) patch_at.clear();
        if (!patched_[at(attachment)]) continue;
        const AttachmentRest& rest = scene.description().attachments[at(attachment)];
        const int side = sides[at(attachment)].body;
        const int first = scene.first_vertex(side), end = first + static_cast<int>(scene.vertex_count(side));
        // Where both ends move, the target's coefficients have the other sign.
        const double sign = side == rest.source || !scene.deforms(rest.source) ? 1 : -1;
        const std::span<const int> vertices = bundles.vertices(b);
        bundles.for_each_spring(b, [&](const SpringBundles::Spring& s) {
            const int next = static_cast<int>(patches_.size());
            int patch = next;
            if (is_inside(attachment, s)) {
                // The first of those that are as near, up to rounding: in a lattice many samples lie between two.
                int nearest = -1;
                double most = -std::numeric_limits<double>::infinity();
                for (std::size_t i = 0; i < vertices.size(); ++i)
                    if (vertices[i] >= first && vertices[i] < end && sign * s.coefficients[i] > most + near)
                        nearest = vertices[i], most = sign * s.coefficients[i];
                patch = patch_at.try_emplace(nearest, next).first->second;
            }
            if (patch == next) patches_.push_back({attachment, 0}), sums.emplace_back();
            of_spring_[s.number] = patch;
            patches_[at(patch)].area += s.area_weight;
            for (std::size_t i = 0; i < vertices.size(); ++i)
                sums[at(patch)][vertices[i]] += s.area_weight * s.coefficients[i];
        });
    }
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
