// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/finer_tets.h"

#include "solver/index.h"
#include "solver/mesh/tet_boundary.h"
#include "solver/meshing/layer_place.h"
#include "solver/meshing/tet_share.h"
#include "solver/meshing/triangle_finder.h"
#include "solver/ties.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

namespace sinew::solver {

namespace {

/// Where there are no more parts than this they are cut again; more than the other would take seconds.
constexpr std::size_t few_tets = 4000, most_tets = 100'000;
/// Parts with less inside would only make equations stiff.
constexpr double least_share = 1e-3;

/// The middle of each edge, by its ends.
class Middles {
  public:
    explicit Middles(TetMesh& mesh)
        : edges_(edges_of(mesh.tets))
        , first_(static_cast<int>(mesh.vertices.size())) {
        mesh.vertices.reserve(mesh.vertices.size() + edges_.size());
        for (const auto& [a, b] : edges_) mesh.vertices.push_back(0.5 * (mesh.vertices[at(a)] + mesh.vertices[at(b)]));
    }
    int operator()(int a, int b) const {
        const std::array<int, 2> edge{std::min(a, b), std::max(a, b)};
        return first_ + static_cast<int>(std::lower_bound(edges_.begin(), edges_.end(), edge) - edges_.begin());
    }

  private:
    std::vector<std::array<int, 2>> edges_;
    int first_;
};

/// Four corners cut off; what is left is cut in four along the shortest of its diagonals, which keeps the shape of a
/// lattice's tets. Which it is may not hang on rounding.
std::array<Tet, 8> eighths(const Tet& t, const Points& points, const Middles& middle) {
    const int m01 = middle(t[0], t[1]), m02 = middle(t[0], t[2]), m03 = middle(t[0], t[3]), m12 = middle(t[1], t[2]),
              m13 = middle(t[1], t[3]), m23 = middle(t[2], t[3]);
    // Ends of the diagonals, and the four other middles in turn around each.
    const std::array<std::array<int, 6>, 3> diagonals{
        {{m01, m23, m02, m12, m13, m03}, {m02, m13, m01, m03, m23, m12}, {m03, m12, m01, m13, m23, m02}}};
    const auto length = [&](const std::array<int, 6>& d) { return (points[at(d[0])] - points[at(d[1])]).norm(); };
    std::size_t best = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (clearly_less(length(diagonals[k]), length(diagonals[best]))) best = k;
    const std::array<int, 6>& d = diagonals[best];
    return {{{t[0], m01, m02, m03},
             {m01, t[1], m12, m13},
             {m02, m12, t[2], m23},
             {m03, m13, m23, t[3]},
             {d[0], d[1], d[2], d[3]},
             {d[0], d[1], d[3], d[4]},
             {d[0], d[1], d[4], d[5]},
             {d[0], d[1], d[5], d[2]}}};
}

/// The same tets, each as eight in turn.
TetMesh cut_in_eight(const TetMesh& tets) {
    TetMesh out;
    out.vertices = tets.vertices;
    out.tets = tets.tets;
    const Middles middle(out);
    out.tets.clear();
    out.tets.reserve(8 * tets.tets.size());
    for (const Tet& t : tets.tets)
        for (const Tet& part : eighths(t, out.vertices, middle)) out.tets.push_back(part);
    check_and_orient(out);
    return out;
}

/// Winding numbers at the vertices of the parts of tets that are cut, by corner_windings; 0 at others.
std::vector<double> windings_at_corners(const TetMesh& parts, const std::vector<std::size_t>& cut, const Solid& solid,
                                        const MeshingControl& control) {
    std::vector<double> edge(parts.vertices.size(), 0.0); // of a tet there
    for (const std::size_t t : cut)
        for (std::size_t k = 8 * t; k < 8 * t + 8; ++k) {
            const Tet& part = parts.tets[k];
            const double length = (parts.vertices[at(part[1])] - parts.vertices[at(part[0])]).norm();
            for (const int v : part) edge[at(v)] = length;
        }
    std::vector<std::size_t> corners;
    for (std::size_t v = 0; v < edge.size(); ++v)
        if (edge[v] > 0) corners.push_back(v);
    // Middles of the edges of one vertex follow each other: what is asked together lies together.
    constexpr std::size_t together = 8;
    std::vector<double> out(edge.size(), 0.0);
    MeshingPhase{control, 0, 0.5, "cutting tets"}.run(
        (corners.size() + together - 1) / together, 2, [&](std::size_t i) {
            const auto from = corners.begin() + static_cast<std::ptrdiff_t>(i * together),
                       to = corners.begin() + static_cast<std::ptrdiff_t>(std::min((i + 1) * together, corners.size()));
            Points points;
            std::vector<double> edges;
            std::for_each(from, to,
                          [&](std::size_t v) { points.push_back(parts.vertices[v]), edges.push_back(edge[v]); });
            const std::vector<double> found = corner_windings(solid, points, edges);
            for (auto v = from; v != to; ++v) out[*v] = found[static_cast<std::size_t>(v - from)];
        });
    return out;
}

/// What of each part is solid: of a tet that is cut the part's own share. Nothing where the eight do not agree with
/// what their tets know of themselves: parts of one coverage on both sides of a wall would be worse than the tet as it
/// is.
std::optional<std::vector<double>> parts_coverage(const TetMesh& parts, const std::vector<double>& coverage,
                                                  const std::vector<double>& known, const Solid* solid,
                                                  const MeshingControl& control) {
    std::vector<double> out(parts.tets.size());
    std::vector<std::size_t> cut;
    for (std::size_t t = 0; t < coverage.size(); ++t) {
        std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(8 * t), 8, coverage[t]);
        if (coverage[t] < 1) cut.push_back(t);
    }
    if (cut.empty()) return out;
    if (!solid) return {};
    constexpr double alike = 1e-6;
    const TriangleFinder finder(*solid);
    const std::vector<double> winding = windings_at_corners(parts, cut, *solid, control);
    std::vector<char> disagrees(cut.size(), 0);
    MeshingPhase{control, 0.5, 1, "cutting tets"}.run(cut.size(), 8, [&](std::size_t i) {
        std::array<double, 8> shares;
        for (std::size_t k = 0; k < 8; ++k) {
            const Tet& part = parts.tets[8 * cut[i] + k];
            const std::array<Vec3, 4> corners = corners_of(parts.vertices, part);
            const std::array<double, 4> at_corners{winding[at(part[0])], winding[at(part[1])], winding[at(part[2])],
                                                   winding[at(part[3])]};
            shares[k] = std::clamp(closed_share(*solid, corners, finder.touching(corners), at_corners), 0.0, 1.0);
        }
        const double mean = std::accumulate(shares.begin(), shares.end(), 0.0) / 8;
        disagrees[i] = std::abs(mean - known[cut[i]]) > alike;
        std::copy(shares.begin(), shares.end(), out.begin() + static_cast<std::ptrdiff_t>(8 * cut[i]));
    });
    // Where parts of a surface cross, shares are not exact: a few tets may keep what they know.
    constexpr double few = 0.01;
    const auto count = static_cast<double>(std::count(disagrees.begin(), disagrees.end(), 1));
    if (count > few * static_cast<double>(cut.size())) return {};
    for (std::size_t i = 0; i < cut.size(); ++i)
        if (disagrees[i]) std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(8 * cut[i]), 8, coverage[cut[i]]);
    return out;
}

/// Empty if it cannot be told what of the parts is solid. `known`: of the tets, without what their coverage is raised
/// by.
std::optional<FinerTets> halved(const FinerTets& from, const std::vector<double>& known, const Solid* solid,
                                const MeshingControl& control) {
    TetMesh parts = cut_in_eight(from.mesh);
    const auto coverage = parts_coverage(parts, from.mesh.coverage, known, solid, control);
    if (!coverage) return {};
    FinerTets out;
    for (std::size_t t = 0; t < from.parent.size(); ++t) {
        const auto first = coverage->begin() + static_cast<std::ptrdiff_t>(8 * t);
        const auto most = static_cast<std::size_t>(std::max_element(first, first + 8) - coverage->begin());
        for (std::size_t k = 8 * t; k < 8 * t + 8; ++k) {
            if ((*coverage)[k] < least_share && k != most) continue;
            out.mesh.tets.push_back(parts.tets[k]);
            out.mesh.coverage.push_back(std::max((*coverage)[k], 1e-9));
            out.parent.push_back(from.parent[t]);
        }
    }
    out.mesh.vertices = std::move(parts.vertices);
    drop_unused_vertices(out.mesh);
    return out;
}

} // namespace

FinerTets finer_tets(const TetMesh& tets, const Points& surface, const std::vector<Triangle>& triangles,
                     const MeshingControl& control) {
    FinerTets out;
    out.mesh.vertices = tets.vertices;
    out.mesh.tets = tets.tets;
    out.mesh.coverage = tets.coverage.empty() ? std::vector<double>(tets.tets.size(), 1.0) : tets.coverage;
    out.parent.resize(tets.tets.size());
    std::iota(out.parent.begin(), out.parent.end(), 0);
    if (8 * out.parent.size() > most_tets) return out;
    const MeshingControl quiet{control.stop, {}};
    const bool any_cut =
        std::any_of(out.mesh.coverage.begin(), out.mesh.coverage.end(), [](double c) { return c < 1; });
    const std::optional<Solid> solid = any_cut ? tissue_solid(surface, triangles, quiet) : std::optional<Solid>();
    std::vector<double> known = out.mesh.coverage;
    for (std::size_t k = 0; k < tets.cut.tets.size(); ++k) known[at(tets.cut.tets[k])] = known_share(tets.cut, k);
    for (int times = 0; times < 2; ++times) {
        const std::size_t count = out.parent.size();
        if (8 * count > most_tets || (times > 0 && count > few_tets)) break;
        auto next = halved(out, known, solid ? &*solid : nullptr, control);
        if (!next) break;
        out = std::move(*next);
        known = out.mesh.coverage;
    }
    return out;
}

Points means_over_parts(const FinerTets& finer, const Points& of_parts, std::size_t tet_count) {
    Points out(tet_count, Vec3::Zero());
    std::vector<double> volumes(tet_count, 0.0);
    for (std::size_t k = 0; k < of_parts.size(); ++k) {
        const std::array<Vec3, 4> c = corners_of(finer.mesh.vertices, finer.mesh.tets[k]);
        const double volume = finer.mesh.coverage[k] * tet_volume(c[0], c[1], c[2], c[3]);
        out[at(finer.parent[k])] += volume * of_parts[k];
        volumes[at(finer.parent[k])] += volume;
    }
    for (std::size_t t = 0; t < tet_count; ++t) out[t] /= volumes[t];
    return out;
}

} // namespace sinew::solver
