// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/tet_fitting.h"

#include "solver/meshing/edge_splits.h"
#include "solver/meshing/lattice.h"
#include "solver/meshing/layer_place.h"
#include "solver/parallel.h"

#include <cmath>
#include <set>

namespace sinew::solver {

namespace {

/// Of edges on a border: height of its arch by length, beyond which the tets are too large to know the border.
constexpr double most_bend = 0.12;
/// Tets that hold less of their volume are left out, as by lattices.
constexpr double negligible_share = 1e-9;

} // namespace

TetFitting::TetFitting(const TetMesh& tets, const Points& surface, const std::vector<Triangle>& triangles,
                       const MeshingControl& control)
    : vertices_(tets.vertices)
    , borders_(tets.vertices.size())
    , degree_(tets.cut.degree)
    , knows_coverage_(!tets.coverage.empty()) {
    if (!tets.cut.tets.empty())
        if (auto solid = tissue_solid(surface, triangles, control))
            tissue_ = std::make_shared<const Solid>(std::move(*solid));
    pieces_.resize(tets.tets.size());
    for (std::size_t t = 0; t < pieces_.size(); ++t)
        pieces_[t] = {tets.tets[t], static_cast<int>(t), knows_coverage_ ? tets.coverage[t] : 1.0, {}};
    const auto count = static_cast<std::ptrdiff_t>(moment_count(degree_));
    for (std::size_t k = 0; k < tets.cut.tets.size(); ++k)
        pieces_[at(tets.cut.tets[k])].moments.assign(tets.cut.of(k), tets.cut.of(k) + count);
    if (tissue_) skin_.emplace(*tissue_);
    is_sound_ = find_sound();
}

bool TetFitting::find_sound() const {
    if (std::all_of(pieces_.begin(), pieces_.end(), [](const Piece& p) { return p.moments.empty(); })) return true;
    if (!tissue_) return false;
    std::vector<char> alike(pieces_.size(), 1);
    parallel_for(pieces_.size(), 64, [&](std::size_t i) {
        if (pieces_[i].moments.empty()) return;
        TetMoments inside;
        inside.degree = degree_;
        std::copy(pieces_[i].moments.begin(), pieces_[i].moments.end(), inside.value.begin());
        alike[i] = std::abs(solid_share(corners(pieces_[i].tet)) - inside.volume()) < 1e-6;
    });
    return std::all_of(alike.begin(), alike.end(), [](char a) { return a != 0; });
}

void TetFitting::fit(const BorderPatch& patch) {
    const int number = static_cast<int>(patches_.size());
    patches_.push_back(&patch);
    find_crossed(patch);
    if (crossed_.empty()) return;
    std::vector<char> near(vertices_.size(), 0);
    for (const std::size_t i : crossed_)
        for (const int v : pieces_[i].tet) near[at(v)] = 1;
    find_stars(near);
    find_heights(patch);
    find_edges(patch);
    for (const auto& [v, height] : heights_)
        if (height == 0) touch(v, number);
    move_vertices(patch, number);
    split_edges(number);
    balance(patch, number);
    measure_changed();
}

void TetFitting::find_crossed(const BorderPatch& patch) {
    std::vector<char> is_crossed(pieces_.size(), 0);
    parallel_for(pieces_.size(), 64, [&](std::size_t i) {
        const std::array<Vec3, 4> c = corners(pieces_[i].tet);
        for (const int t : patch.touching(c))
            if (runs_inside(patch.part_in_tet(c, t), c, !pieces_[i].moments.empty())) {
                is_crossed[i] = 1;
                break;
            }
    });
    crossed_.clear();
    for (std::size_t i = 0; i < pieces_.size(); ++i)
        if (is_crossed[i]) crossed_.push_back(i);
}

bool TetFitting::runs_inside(const BarycentricPolygon& part, const std::array<Vec3, 4>& c, bool is_cut) const {
    const auto place = [&](const Barycentric& b) -> Vec3 {
        return b[0] * c[0] + b[1] * c[1] + b[2] * c[2] + b[3] * c[3];
    };
    const double length = (c[1] - c[0]).norm();
    for (std::size_t k = 2; k < part.size(); ++k) {
        const Vec3 p = place(part[0]), q = place(part[k - 1]), r = place(part[k]);
        if (!((q - p).cross(r - p).norm() > 1e-9 * length * length)) continue;
        if (!is_cut || is_inside({p, q, r}, length, 0)) return true;
    }
    return false;
}

bool TetFitting::is_inside(const std::array<Vec3, 3>& t, double length, int depth) const {
    const Vec3 center = (t[0] + t[1] + t[2]) / 3;
    const double radius = std::max({(t[0] - center).norm(), (t[1] - center).norm(), (t[2] - center).norm()});
    const double distance = tissue_->tree.closest(center, radius + 1e-6 * length).distance;
    // On the skin, which layer and tissue may share, is not inside.
    if (distance > 1e-6 * length && tissue_->tree.inside_either_way(center)) return true;
    constexpr int deepest = 4;
    if (distance > radius || depth == deepest) return false; // all of it lies as its centre does
    const std::array<Vec3, 3> m{0.5 * (t[1] + t[2]), 0.5 * (t[2] + t[0]), 0.5 * (t[0] + t[1])};
    return is_inside(m, length, depth + 1) || is_inside({t[0], m[2], m[1]}, length, depth + 1) ||
           is_inside({m[2], t[1], m[0]}, length, depth + 1) || is_inside({m[1], m[0], t[2]}, length, depth + 1);
}

void TetFitting::find_stars(const std::vector<char>& wanted) {
    stars_.assign(vertices_.size(), {});
    for (std::size_t i = 0; i < pieces_.size(); ++i)
        for (const int v : pieces_[i].tet)
            if (wanted[at(v)]) stars_[at(v)].push_back(static_cast<int>(i));
    sides_.assign(vertices_.size(), {});
    parallel_for(vertices_.size(), 256, [&](std::size_t v) {
        // Faces that one tet only has at the vertex, by their other two vertices.
        std::vector<std::array<int, 2>> faces;
        for (const int i : stars_[v]) {
            const Tet& tet = pieces_[at(i)].tet;
            for (std::size_t a = 0; a < 4; ++a)
                for (std::size_t b = a + 1; b < 4; ++b)
                    if (at(tet[a]) != v && at(tet[b]) != v)
                        faces.push_back({std::min(tet[a], tet[b]), std::max(tet[a], tet[b])});
        }
        std::sort(faces.begin(), faces.end());
        for (std::size_t k = 0; k < faces.size(); ++k) {
            if ((k > 0 && faces[k] == faces[k - 1]) || (k + 1 < faces.size() && faces[k] == faces[k + 1])) continue;
            const Vec3 p = vertices_[at(faces[k][0])] - vertices_[v], q = vertices_[at(faces[k][1])] - vertices_[v];
            sides_[v].push_back(p.cross(q).normalized());
        }
    });
}

void TetFitting::find_heights(const BorderPatch& patch) {
    heights_.clear();
    for (const std::size_t i : crossed_)
        for (const int v : pieces_[i].tet) heights_[v] = 0;
    for (auto& [v, height] : heights_) {
        height = patch.height(vertices_[at(v)]);
        const Tet& any = pieces_[at(stars_[at(v)].front())].tet;
        if (std::abs(height) < 1e-9 * (vertices_[at(any[0])] - vertices_[at(any[1])]).norm()) height = 0;
    }
}

void TetFitting::find_edges(const BorderPatch& patch) {
    edges_.clear();
    for (const std::size_t i : crossed_)
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = a + 1; b < 4; ++b) {
                const auto [low, high] = std::minmax(pieces_[i].tet[a], pieces_[i].tet[b]);
                if (heights_[low] * heights_[high] < 0) edges_[{low, high}] = 0;
            }
    for (auto& [edge, place] : edges_) place = patch.crossing(vertices_[at(edge[0])], vertices_[at(edge[1])]);
}

void TetFitting::split_edges(int number) {
    std::vector<EdgeSplit> splits;
    for (const auto& [edge, place] : edges_) {
        const Vec3 a = vertices_[at(edge[0])], b = vertices_[at(edge[1])];
        splits.push_back({edge, static_cast<int>(vertices_.size()), (b - a).norm()});
        // The new vertex lies on what both ends lie on.
        std::vector<int> on;
        std::set_intersection(borders_[at(edge[0])].begin(), borders_[at(edge[0])].end(), borders_[at(edge[1])].begin(),
                              borders_[at(edge[1])].end(), std::back_inserter(on));
        on.push_back(number);
        vertices_.push_back(a + place * (b - a));
        borders_.push_back(std::move(on));
    }
    const EdgeSplits all(std::move(splits));
    std::vector<Piece> pieces;
    std::vector<Tet> parts;
    for (Piece& p : pieces_) {
        parts.clear();
        all.parts_of(p.tet, parts);
        if (parts.size() == 1) {
            pieces.push_back(std::move(p));
            continue;
        }
        for (const Tet& part : parts) pieces.push_back({part, p.parent, p.coverage, p.moments, true});
    }
    pieces_ = std::move(pieces);
}

void TetFitting::measure_changed() {
    if (!tissue_) return;
    parallel_for(pieces_.size(), 16, [&](std::size_t i) {
        Piece& p = pieces_[i];
        if (!p.changed) return;
        p.changed = false;
        TetMoments inside;
        inside.degree = degree_;
        const std::array<Vec3, 4> c = corners(p.tet);
        const double share = closed_share(*tissue_, c, skin_->touching(c), &inside);
        p.moments.clear();
        p.coverage = share < negligible_share ? 0 : std::max(share, LatticeOptions{}.least_coverage);
        if (share < 1)
            p.moments.assign(inside.value.begin(),
                             inside.value.begin() + static_cast<std::ptrdiff_t>(moment_count(degree_)));
    });
    std::erase_if(pieces_, [](const Piece& p) { return p.coverage == 0; });
}

double TetFitting::slack(const Tet& tet, const BorderPatch& patch, int number) const {
    double highest = 0, longest = 0;
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4 && is_on(tet[a], number); ++b) {
            if (!is_on(tet[b], number)) continue;
            const Vec3 &p = vertices_[at(tet[a])], &q = vertices_[at(tet[b])];
            longest = std::max(longest, (q - p).norm());
            for (const Vec3& place : {p, q, Vec3(0.5 * (p + q))})
                highest = std::max(highest, std::abs(patch.height(place)));
        }
    if (!(highest > 0) || highest > most_bend * longest) return 0;
    const std::array<Vec3, 4> c = corners(tet);
    double area = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec3 &p = c[(k + 1) % 4], &q = c[(k + 2) % 4], &r = c[(k + 3) % 4];
        area = std::max(area, 0.5 * (q - p).cross(r - p).norm());
    }
    return 2 * highest * area / tet_volume(c[0], c[1], c[2], c[3]);
}

FittedTets TetFitting::result(const std::vector<std::vector<BorderPatch>>& patches) const {
    FittedTets out;
    out.tissue = tissue_;
    int first = 0; // number of the place's first patch
    for (const std::vector<BorderPatch>& of_place : patches) {
        std::vector<double>& slacks = out.slack.emplace_back(pieces_.size(), 0.0);
        parallel_for(pieces_.size(), 64, [&](std::size_t i) {
            std::set<int> touched;
            for (const int v : pieces_[i].tet) touched.insert(borders_[at(v)].begin(), borders_[at(v)].end());
            for (const int patch : touched)
                if (patch >= first && patch < first + static_cast<int>(of_place.size()))
                    slacks[i] = std::max(slacks[i], slack(pieces_[i].tet, of_place[at(patch - first)], patch));
            slacks[i] = std::min(slacks[i], 0.5);
        });
        first += static_cast<int>(of_place.size());
    }
    std::vector<int> number(vertices_.size(), -1);
    for (const Piece& p : pieces_)
        for (const int v : p.tet) number[at(v)] = 0;
    for (std::size_t v = 0; v < vertices_.size(); ++v)
        if (number[v] == 0) {
            number[v] = static_cast<int>(out.mesh.vertices.size());
            out.mesh.vertices.push_back(vertices_[v]);
        }
    out.mesh.cut.degree = degree_;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
        const Piece& p = pieces_[i];
        Tet tet;
        for (std::size_t k = 0; k < 4; ++k) tet[k] = number[at(p.tet[k])];
        out.mesh.tets.push_back(tet);
        out.parent.push_back(p.parent);
        if (knows_coverage_) out.mesh.coverage.push_back(p.coverage);
        if (p.moments.empty()) continue;
        out.mesh.cut.tets.push_back(static_cast<int>(i));
        out.mesh.cut.moments.insert(out.mesh.cut.moments.end(), p.moments.begin(), p.moments.end());
    }
    return out;
}

} // namespace sinew::solver
