// Where vertices near the border of a layer go.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/tet_quality.h"
#include "solver/meshing/tet_fitting.h"
#include "solver/ties.h"

#include <cmath>

namespace sinew::solver {

namespace {

/// A vertex moves onto the border if it lies nearer to it than this share of an edge.
constexpr double near_share = 0.3;
/// One that may not move counts as on the border if it lies nearer than this: tets must not become flat.
constexpr double least_share = 0.04;
/// Moved vertices leave tets at least this good (tet_quality), or half as good as they were …
constexpr double least_quality = 0.35;
/// … or, if they are so near that splitting would leave worse ones, this good.
double quality_for(double share) { return std::clamp(2 * share, 0.1, least_quality); }

} // namespace

bool TetFitting::may_move(int v, const Vec3& to, int along, double quality) const {
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
        if (!(tet_quality(c[0], c[1], c[2], c[3]) >= std::min(quality, 0.5 * was))) return false;
        if (!covers_solid) continue;
        const double volume = tet_volume(old[0], old[1], old[2], old[3]);
        all += volume;
        before += volume * solid_share(old);
        after += tet_volume(c[0], c[1], c[2], c[3]) * solid_share(c);
    }
    return !covers_solid || std::abs(after - before) <= 1e-9 * all;
}

Vec3 TetFitting::foot(int v, const BorderPatch& patch) const {
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

void TetFitting::move(int v, const Vec3& to) {
    vertices_[at(v)] = to;
    for (const int i : stars_[at(v)]) pieces_[at(i)].changed = true;
}

void TetFitting::move_vertices(const BorderPatch& patch, int number) {
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
        std::stable_sort(goals.begin(), goals.end(), [](const Goal& a, const Goal& b) {
            return rounded_off(a.share, 1) < rounded_off(b.share, 1);
        });
        if (!goals.empty()) {
            const Vec3 place = foot(v, patch);
            const double moved = (place - vertices_[at(v)]).norm();
            double longest = 0;
            for (const Goal& g : goals) longest = std::max(longest, (vertices_[at(g.along)] - vertices_[at(v)]).norm());
            if (moved > 0 && moved < near_share * longest) goals.push_back({moved / longest, place, v});
        }
        const auto find = [&](double quality) {
            return std::find_if(goals.begin(), goals.end(),
                                [&](const Goal& g) { return may_move(v, g.place, g.along, quality); });
        };
        auto goal = find(least_quality);
        if (goal == goals.end() && !goals.empty()) goal = find(quality_for(goals.front().share));
        if (goal != goals.end()) {
            move(v, goal->place);
            touch(v, number);
        } else if (goals.empty() || goals.front().share > least_share)
            continue;
        for (const std::array<int, 2>& edge : all) edges_.erase(edge);
    }
}

void TetFitting::balance(const BorderPatch& patch, int number) {
    std::vector<char> on_border(vertices_.size(), 0);
    for (std::size_t v = 0; v < vertices_.size(); ++v) on_border[v] = is_on(static_cast<int>(v), number);
    find_stars(on_border);
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
    for (const auto& [v, goal] : goals)
        if (may_move(v, goal, v, least_quality)) move(v, goal);
}

} // namespace sinew::solver
