// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/layer_border.h"

#include "solver/mesh/tet_quality.h"
#include "solver/meshing/border_patches.h"
#include "solver/meshing/edge_splits.h"
#include "solver/meshing/lattice.h"
#include "solver/meshing/layer_place.h"
#include "solver/parallel.h"

#include <cmath>
#include <map>
#include <set>

namespace sinew::solver {

namespace {

/// A vertex moves onto the border if it lies nearer to it than this share of an edge.
constexpr double near_share = 0.3;
/// One that may not move counts as on the border if it lies nearer than this: tets must not become flat.
constexpr double least_share = 0.02;
/// Moved vertices leave tets at least this good (tet_quality), or half as good as they were.
constexpr double least_quality = 0.35;
/// Of edges on a border: height of its arch by length, beyond which the tets are too large to know the border.
constexpr double most_bend = 0.12;
/// Tets that hold less of their volume are left out, as by lattices.
constexpr double negligible_share = 1e-9;

struct Piece {
    Tet tet;
    int parent;
    double coverage;
    std::vector<double> moments; ///< empty where the surface cuts nothing off
    bool changed = false;        ///< coverage and moments are those of another shape
};

class Fitting {
  public:
    Fitting(const TetMesh& tets, const Points& surface, const std::vector<Triangle>& triangles,
            const MeshingControl& control)
        : vertices_(tets.vertices)
        , borders_(tets.vertices.size())
        , degree_(tets.cut.degree)
        , knows_coverage_(!tets.coverage.empty())
        , tissue_(tets.cut.tets.empty() ? std::optional<Solid>() : tissue_solid(surface, triangles, control)) {
        pieces_.resize(tets.tets.size());
        for (std::size_t t = 0; t < pieces_.size(); ++t)
            pieces_[t] = {tets.tets[t], static_cast<int>(t), knows_coverage_ ? tets.coverage[t] : 1.0, {}};
        const auto count = static_cast<std::ptrdiff_t>(moment_count(degree_));
        for (std::size_t k = 0; k < tets.cut.tets.size(); ++k)
            pieces_[at(tets.cut.tets[k])].moments.assign(tets.cut.of(k), tets.cut.of(k) + count);
        if (tissue_) skin_.emplace(*tissue_);
        is_sound_ = find_sound();
    }

    /// Whether the surface cuts the tets as they say.
    bool is_sound() const { return is_sound_; }
    bool find_sound() const {
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

    /// Fits the tets to one smooth part of a border. `number`: of the patch, over all places.
    void fit(const BorderPatch& patch, int number) {
        patches_.push_back(&patch);
        find_crossed(patch);
        if (crossed_.empty()) return;
        find_stars();
        find_heights(patch);
        find_edges(patch);
        for (const auto& [v, height] : heights_)
            if (height == 0) touch(v, number);
        move_vertices(patch, number);
        split_edges(number);
        balance(patch, number);
        measure_changed();
    }

    FittedTets result(const std::vector<std::vector<BorderPatch>>& patches) const;
    /// What a tet's flat sides leave of patches that its vertices lie on, per volume of the tet.
    double slack(const Tet& tet, const BorderPatch& patch, int number) const;

  private:
    std::array<Vec3, 4> corners(const Tet& tet) const { return corners_of(vertices_, tet); }
    double solid_share(const std::array<Vec3, 4>& c) const { return closed_share(*tissue_, c, skin_->touching(c)); }
    void touch(int v, int number) {
        std::vector<int>& list = borders_[at(v)];
        if (list.empty() || list.back() != number) list.push_back(number);
    }

    /// Tets through whose solid part the patch runs.
    void find_crossed(const BorderPatch& patch) {
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
    bool runs_inside(const BarycentricPolygon& part, const std::array<Vec3, 4>& c, bool is_cut) const;

    void find_stars() {
        stars_.assign(vertices_.size(), {});
        for (std::size_t i = 0; i < pieces_.size(); ++i)
            for (const int v : pieces_[i].tet) stars_[at(v)].push_back(static_cast<int>(i));
        std::vector<Tet> tets;
        for (const Piece& p : pieces_) tets.push_back(p.tet);
        sides_.assign(vertices_.size(), {});
        for (const Triangle& t : boundary_triangles(tets)) {
            const Vec3& a = vertices_[at(t[0])];
            const Vec3 normal = (vertices_[at(t[1])] - a).cross(vertices_[at(t[2])] - a).normalized();
            for (const int v : t) sides_[at(v)].push_back(normal);
        }
    }

    void find_heights(const BorderPatch& patch) {
        heights_.clear();
        for (const std::size_t i : crossed_)
            for (const int v : pieces_[i].tet) heights_[v] = 0;
        for (auto& [v, height] : heights_) {
            height = patch.height(vertices_[at(v)]);
            const Tet& any = pieces_[at(stars_[at(v)].front())].tet;
            if (std::abs(height) < 1e-9 * (vertices_[at(any[0])] - vertices_[at(any[1])]).norm()) height = 0;
        }
    }

    /// Where the patch cuts the edges of crossed tets.
    void find_edges(const BorderPatch& patch) {
        edges_.clear();
        for (const std::size_t i : crossed_)
            for (std::size_t a = 0; a < 4; ++a)
                for (std::size_t b = a + 1; b < 4; ++b) {
                    const auto [low, high] = std::minmax(pieces_[i].tet[a], pieces_[i].tet[b]);
                    if (heights_[low] * heights_[high] < 0) edges_[{low, high}] = 0;
                }
        for (auto& [edge, place] : edges_) place = patch.crossing(vertices_[at(edge[0])], vertices_[at(edge[1])]);
    }

    void move_vertices(const BorderPatch& patch, int number);
    Vec3 foot(int v, const BorderPatch& patch) const;
    bool may_move(int v, const Vec3& to, int along) const;
    void split_edges(int number);
    void balance(const BorderPatch& patch, int number);
    void measure_changed();
    bool is_on(int v, int number) const {
        return std::binary_search(borders_[at(v)].begin(), borders_[at(v)].end(), number);
    }

    Points vertices_;
    std::vector<std::vector<int>> borders_; ///< of each vertex: patches that it lies on, increasing
    std::vector<Piece> pieces_;
    int degree_;
    bool knows_coverage_, is_sound_ = false;
    std::vector<const BorderPatch*> patches_; ///< by number
    std::optional<Solid> tissue_;             ///< where tets are solid in part
    std::optional<TriangleFinder> skin_;
    // of the patch in hand
    std::vector<std::size_t> crossed_;
    std::vector<std::vector<int>> stars_;        ///< pieces about each vertex
    std::vector<Points> sides_;                  ///< of each vertex: normals of the mesh's boundary there
    std::map<int, double> heights_;              ///< of the crossed tets' vertices
    std::map<std::array<int, 2>, double> edges_; ///< that the patch cuts, and where
};

bool Fitting::runs_inside(const BarycentricPolygon& part, const std::array<Vec3, 4>& c, bool is_cut) const {
    const auto place = [&](const Barycentric& b) -> Vec3 {
        return b[0] * c[0] + b[1] * c[1] + b[2] * c[2] + b[3] * c[3];
    };
    const double scale = (c[1] - c[0]).squaredNorm();
    for (std::size_t k = 2; k < part.size(); ++k) {
        const Vec3 p = place(part[0]), u = place(part[k - 1]) - p, v = place(part[k]) - p;
        if (!(u.cross(v).norm() > 1e-9 * scale)) continue;
        if (!is_cut) return true;
        // The middles of equal parts: inside, and not on the skin that layer and tissue may share.
        constexpr int n = 12;
        for (int i = 0; i < n; ++i)
            for (int j = 0; i + j < n; ++j)
                for (int half = 0; half < (i + j + 1 < n ? 2 : 1); ++half) {
                    const double offset = (half + 1) / 3.0;
                    const Vec3 middle = p + ((i + offset) * u + (j + offset) * v) / n;
                    if (tissue_->tree.inside_either_way(middle) &&
                        tissue_->tree.closest(middle, 1e-6 * std::sqrt(scale)).triangle < 0)
                        return true;
                }
    }
    return false;
}

bool Fitting::may_move(int v, const Vec3& to, int along) const {
    // What lies on other parts of the border stays on them.
    const std::vector<int>&own = borders_[at(v)], &others = borders_[at(along)];
    if (!std::includes(others.begin(), others.end(), own.begin(), own.end())) return false;
    // The boundary keeps its shape, or what is solid stays covered.
    const Vec3 way = to - vertices_[at(v)];
    const bool covers_solid = tissue_ && !sides_[at(v)].empty();
    for (const Vec3& normal : sides_[at(v)])
        if (!tissue_ && std::abs(way.dot(normal)) > 1e-9 * way.norm()) return false;
    double before = 0, after = 0, all = 0;
    for (const int i : stars_[at(v)]) {
        const Tet& tet = pieces_[at(i)].tet;
        const std::array<Vec3, 4> old = corners(tet);
        std::array<Vec3, 4> c = old;
        for (std::size_t k = 0; k < 4; ++k)
            if (tet[k] == v) c[k] = to;
        const double was = tet_quality(old[0], old[1], old[2], old[3]);
        if (!(tet_quality(c[0], c[1], c[2], c[3]) >= std::min(least_quality, 0.5 * was))) return false;
        if (!covers_solid) continue;
        const double volume = tet_volume(old[0], old[1], old[2], old[3]);
        all += volume;
        before += volume * solid_share(old);
        after += tet_volume(c[0], c[1], c[2], c[3]) * solid_share(c);
    }
    return !covers_solid || std::abs(after - before) <= 1e-9 * all;
}

/// The place nearest to a vertex on the patch, and on all parts of the border that it lies on.
Vec3 Fitting::foot(int v, const BorderPatch& patch) const {
    const Vec3& p = vertices_[at(v)];
    const Vec3 normal = patch.normal(p);
    Vec3 along = normal;
    Points kept; // directions in which it stays, orthonormal
    const auto keep = [&](Vec3 n) {
        for (const Vec3& k : kept) n -= k.dot(n) * k;
        if (!(n.norm() > 1e-3)) return;
        kept.push_back(n.normalized());
        along -= kept.back().dot(along) * kept.back();
    };
    for (const int other : borders_[at(v)]) keep(patches_[at(other)]->normal(p));
    for (const Vec3& n : sides_[at(v)])
        if (!tissue_) keep(n);
    const double slope = along.dot(normal);
    return slope > 0.01 ? Vec3(p - patch.height(p) / slope * along) : p;
}

void Fitting::move_vertices(const BorderPatch& patch, int number) {
    std::map<int, std::vector<std::array<int, 2>>> of_vertex;
    for (const auto& [edge, place] : edges_)
        for (const int v : edge) of_vertex[v].push_back(edge);
    struct Goal {
        double share; ///< of the edge, from the vertex
        Vec3 place;
        int along; ///< the edge's other end
    };
    std::vector<Goal> goals;
    for (const auto& [v, all] : of_vertex) {
        goals.clear();
        for (const std::array<int, 2>& edge : all) {
            const auto found = edges_.find(edge);
            if (found == edges_.end()) continue;
            const int along = edge[0] == v ? edge[1] : edge[0];
            const double share = edge[0] == v ? found->second : 1 - found->second;
            if (share < near_share)
                goals.push_back({share, vertices_[at(v)] + share * (vertices_[at(along)] - vertices_[at(v)]), along});
        }
        std::stable_sort(goals.begin(), goals.end(), [](const Goal& a, const Goal& b) { return a.share < b.share; });
        if (!goals.empty()) {
            const Vec3 place = foot(v, patch);
            const double moved = (place - vertices_[at(v)]).norm();
            double longest = 0;
            for (const Goal& g : goals) longest = std::max(longest, (vertices_[at(g.along)] - vertices_[at(v)]).norm());
            if (moved > 0 && moved < near_share * longest) goals.push_back({moved / longest, place, v});
        }
        const auto goal =
            std::find_if(goals.begin(), goals.end(), [&](const Goal& g) { return may_move(v, g.place, g.along); });
        if (goal != goals.end()) {
            vertices_[at(v)] = goal->place;
            touch(v, number);
            for (const int i : stars_[at(v)]) pieces_[at(i)].changed = true;
        } else if (goals.empty() || goals.front().share > least_share)
            continue;
        for (const std::array<int, 2>& edge : all) edges_.erase(edge);
    }
}

void Fitting::split_edges(int number) {
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

/// Flat sides of tets that end on a curved border lie on one side of it. So their vertices go over it, until the sides
/// have as much of it on the one as on the other: then volumes are right.
void Fitting::balance(const BorderPatch& patch, int number) {
    find_stars();
    std::map<std::array<int, 3>, std::array<int, 2>> sides; // of faces on the border: tets above and below
    for (const Piece& p : pieces_) {
        const auto on = std::count_if(p.tet.begin(), p.tet.end(), [&](int v) { return is_on(v, number); });
        if (on < 3) continue;
        Vec3 middle = Vec3::Zero();
        for (const int v : p.tet)
            if (on == 4 || !is_on(v, number)) middle += vertices_[at(v)] / (on == 4 ? 4 : 1);
        const bool above = patch.height(middle) > 0;
        for (std::size_t left_out = 0; left_out < 4; ++left_out) {
            std::array<int, 3> face;
            for (std::size_t k = 0; k < 3; ++k) face[k] = p.tet[(left_out + 1 + k) % 4];
            if (!std::all_of(face.begin(), face.end(), [&](int v) { return is_on(v, number); })) continue;
            std::sort(face.begin(), face.end());
            ++sides[face][above ? 0 : 1];
        }
    }
    struct Sum {
        double area = 0, height = 0, longest = 0;
    };
    std::map<int, Sum> sums;
    for (const auto& [face, tets] : sides) {
        if (tets[0] != 1 || tets[1] != 1) continue;
        const Vec3 &a = vertices_[at(face[0])], &b = vertices_[at(face[1])], &c = vertices_[at(face[2])];
        const double area = 0.5 * (b - a).cross(c - a).norm();
        // Exact for a border that bends evenly, where the vertices lie on it.
        const double height =
            (patch.height(0.5 * (a + b)) + patch.height(0.5 * (b + c)) + patch.height(0.5 * (c + a))) / 3;
        for (const int v : face) {
            Sum& sum = sums[v];
            sum.area += area, sum.height += area * height;
            sum.longest = std::max({sum.longest, (b - a).norm(), (c - a).norm()});
        }
    }
    std::vector<std::pair<int, Vec3>> goals;
    for (const auto& [v, sum] : sums) {
        const double over = -sum.height / sum.area;
        if (borders_[at(v)].size() != 1 || std::abs(over) < 1e-9 * sum.longest) continue;
        goals.emplace_back(v, vertices_[at(v)] + over * patch.normal(vertices_[at(v)]));
    }
    for (const auto& [v, goal] : goals) {
        if (!may_move(v, goal, v)) continue;
        vertices_[at(v)] = goal;
        for (const int i : stars_[at(v)]) pieces_[at(i)].changed = true;
    }
}

void Fitting::measure_changed() {
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

double Fitting::slack(const Tet& tet, const BorderPatch& patch, int number) const {
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

FittedTets Fitting::result(const std::vector<std::vector<BorderPatch>>& patches) const {
    FittedTets out;
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

} // namespace

FittedTets fit_to_borders(const TetMesh& tets, const std::vector<const Solid*>& places, const Points& surface,
                          const std::vector<Triangle>& triangles, const MeshingControl& control) {
    Fitting fitting(tets, surface, triangles, control);
    std::vector<std::vector<BorderPatch>> patches;
    int number = 0;
    for (const Solid* place : places) {
        patches.push_back(border_patches(*place));
        for (std::size_t k = 0; k < patches.back().size() && fitting.is_sound(); ++k) {
            control.report(0, "fitting tets to layers");
            fitting.fit(patches.back()[k], number++);
        }
    }
    return fitting.result(patches);
}

std::vector<double> fitted_shares(const FittedTets& tets, std::size_t place_number, const Solid& place,
                                  const Points& surface, const std::vector<Triangle>& triangles,
                                  const MeshingControl& control) {
    std::vector<double> shares = layer_shares(tets.mesh, place, surface, triangles, control);
    for (std::size_t t = 0; t < shares.size(); ++t) {
        const double slack = tets.slack[place_number][t];
        if (std::min(shares[t], 1 - shares[t]) <= slack) shares[t] = shares[t] < 0.5 ? 0 : 1;
    }
    return shares;
}

} // namespace sinew::solver
