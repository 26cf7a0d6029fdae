// Shells of a surface: nesting, and what the fill modes make of it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/shells.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/joined_sets.h"
#include "solver/mesh/closest_point.h"
#include "solver/mesh/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <utility>

namespace sinew::solver {
namespace {

/// An edge of a triangle: its ends in rising order, its direction, and where it comes from.
struct Side {
    int low, high, sign, triangle;
};

std::vector<Side> sorted_sides(const std::vector<Triangle>& triangles) {
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1, static_cast<int>(t)});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        if (a.low != b.low) return a.low < b.low;
        return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
    });
    return sides;
}

/// Calls use(sides of one edge) for each edge.
template <class Use>
void for_each_edge(std::span<const Side> sides, const Use& use) {
    while (!sides.empty()) {
        const auto end = std::find_if(sides.begin(), sides.end(), [&](const Side& s) {
            return s.low != sides.front().low || s.high != sides.front().high;
        });
        const std::size_t count = static_cast<std::size_t>(end - sides.begin());
        use(sides.first(count));
        sides = sides.subspan(count);
    }
}

int sum_of_signs(std::span<const Side> sides) {
    int sum = 0;
    for (const Side& s : sides) sum += s.sign;
    return sum;
}

struct Shell {
    std::vector<Triangle> triangles;
    std::vector<int> vertices; ///< sorted
    Box box;
    double volume = 0; ///< signed; of an open one about the middle of its box, so by what it wraps
    bool is_closed = true;
    int winding() const { return volume < 0 ? -1 : 1; } ///< around what is in a closed one
};

struct Shells {
    std::vector<Shell> shells;
    std::vector<int> of_triangle;
};

double volume_about(const Points& points, const std::vector<Triangle>& triangles, const Vec3& middle) {
    double volume = 0;
    for (const Triangle& t : triangles)
        volume += (points[at(t[0])] - middle).dot((points[at(t[1])] - middle).cross(points[at(t[2])] - middle)) / 6;
    return volume;
}

Shells find_shells(const Points& points, const std::vector<Triangle>& triangles) {
    const std::vector<Side> sides = sorted_sides(triangles);
    JoinedSets joined(triangles.size());
    for_each_edge(sides, [&](std::span<const Side> edge) {
        for (const Side& side : edge) joined.join(edge.front().triangle, side.triangle);
    });
    std::vector<char> is_open(triangles.size(), 0); // by root
    for_each_edge(sides, [&](std::span<const Side> edge) {
        if (sum_of_signs(edge) != 0) is_open[at(joined.root(edge.front().triangle))] = 1;
    });
    Shells result;
    std::map<int, int> number; // of a root; the open ones share -1
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const int r = joined.root(static_cast<int>(t));
        const bool open = is_open[at(r)] != 0;
        const auto [place, is_new] = number.emplace(open ? -1 : r, static_cast<int>(result.shells.size()));
        if (is_new) result.shells.emplace_back();
        Shell& shell = result.shells[at(place->second)];
        shell.is_closed = !open;
        shell.triangles.push_back(triangles[t]);
        shell.vertices.insert(shell.vertices.end(), triangles[t].begin(), triangles[t].end());
        result.of_triangle.push_back(place->second);
    }
    for (Shell& shell : result.shells) {
        std::sort(shell.vertices.begin(), shell.vertices.end());
        shell.vertices.erase(std::unique(shell.vertices.begin(), shell.vertices.end()), shell.vertices.end());
        shell.box = {points[at(shell.vertices[0])], points[at(shell.vertices[0])]};
        for (int v : shell.vertices) {
            shell.box.min = shell.box.min.cwiseMin(points[at(v)]);
            shell.box.max = shell.box.max.cwiseMax(points[at(v)]);
        }
        shell.volume = volume_about(points, shell.triangles, shell.box.centre());
    }
    return result;
}

bool may_lie_in(const Shell& inner, const Shell& outer) {
    // The larger volume keeps two shells at the same place from lying in each other.
    if (outer.is_closed && !(std::abs(inner.volume) < std::abs(outer.volume))) return false;
    return inner.is_closed && (outer.box.min.array() <= inner.box.min.array()).all() &&
           (outer.box.max.array() >= inner.box.max.array()).all();
}

struct Nesting {
    std::vector<int> depth;   ///< of each shell: in how many others it lies
    std::vector<int> root;    ///< the first of these that lies in no other; itself, if it lies in none
    std::vector<int> winding; ///< by those that it lies in: of closed ones 1 or -1 each, as they face
};

Nesting find_nesting(const Points& points, const std::vector<Shell>& shells) {
    Nesting found{std::vector<int>(shells.size(), 0), {}, std::vector<int>(shells.size(), 0)};
    std::vector<std::vector<std::size_t>> holders(shells.size());
    for (std::size_t outer = 0; outer < shells.size(); ++outer) {
        std::vector<std::size_t> inner;
        for (std::size_t i = 0; i < shells.size(); ++i)
            if (i != outer && may_lie_in(shells[i], shells[outer])) inner.push_back(i);
        if (inner.empty()) continue;
        const SurfaceTree tree(points, shells[outer].triangles);
        for (std::size_t i : inner)
            if (std::all_of(shells[i].vertices.begin(), shells[i].vertices.end(),
                            [&](int v) { return tree.inside_either_way(points[at(v)]); })) {
                ++found.depth[i];
                if (shells[outer].is_closed) found.winding[i] += shells[outer].winding();
                holders[i].push_back(outer);
            }
    }
    for (std::size_t i = 0; i < shells.size(); ++i) {
        const auto outermost =
            std::find_if(holders[i].begin(), holders[i].end(), [&](std::size_t h) { return found.depth[h] == 0; });
        found.root.push_back(static_cast<int>(outermost == holders[i].end() ? i : *outermost));
    }
    return found;
}

void turn(std::vector<Triangle>& triangles) {
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
}

} // namespace

std::vector<std::array<int, 2>> border_edges_of(const std::vector<Triangle>& triangles) {
    const std::vector<Side> sides = sorted_sides(triangles);
    std::vector<std::array<int, 2>> border;
    for_each_edge(sides, [&](std::span<const Side> edge) {
        const Side& side = edge.front();
        int sum = sum_of_signs(edge);
        for (; sum > 0; --sum) border.push_back({side.low, side.high});
        for (; sum < 0; ++sum) border.push_back({side.high, side.low});
    });
    return border;
}

void check_watertight(const std::vector<std::array<int, 2>>& border) {
    if (border.empty()) return;
    std::string first;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, border.size()); ++i)
        first += (i > 0 ? ", " : "") + std::to_string(border[i][0]) + "-" + std::to_string(border[i][1]);
    throw Error("FE220",
                "empty cavities need a watertight mesh; this one has " + std::to_string(border.size()) +
                    " border edges, the first between vertices " + first,
                "close the holes at these vertices, or choose filled cavities, which closes them by itself");
}

double apply_fill(const Points& points, std::vector<Triangle>& triangles, Fill fill) {
    Shells found = find_shells(points, triangles);
    const std::vector<int> depth = find_nesting(points, found.shells).depth;
    const bool keeps_all = fill != Fill::filled_cavities;
    double volume = 0;
    for (std::size_t s = 0; s < found.shells.size(); ++s) {
        if (!keeps_all && depth[s] > 0) continue;
        // Solids outwards, cavities inwards.
        Shell& shell = found.shells[s];
        if ((shell.volume < 0) == (depth[s] % 2 == 0)) turn(shell.triangles);
        volume += std::abs(shell.volume);
    }
    std::vector<std::size_t> next(found.shells.size(), 0);
    std::vector<Triangle> kept;
    for (int shell : found.of_triangle) {
        const Triangle& t = found.shells[at(shell)].triangles[next[at(shell)]++];
        if (keeps_all || depth[at(shell)] == 0) kept.push_back(t);
    }
    triangles = std::move(kept);
    return volume;
}

std::size_t turn_outwards(const Points& points, std::vector<Triangle>& triangles) {
    const Shells found = find_shells(points, triangles);
    const Nesting nesting = find_nesting(points, found.shells);
    const auto faces_inwards = [](const Shell& s) { return s.is_closed && s.volume < 0; };
    if (std::any_of(found.shells.begin(), found.shells.end(), faces_inwards))
        for (std::size_t t = 0; t < triangles.size(); ++t)
            if (faces_inwards(found.shells[at(nesting.root[at(found.of_triangle[t])])]))
                std::swap(triangles[t][1], triangles[t][2]);
    // What is turned is turned with what it lies in, so nothing of this changes but signs.
    std::size_t buried = 0;
    for (std::size_t s = 0; s < found.shells.size(); ++s) {
        const int outside = nesting.winding[s];
        if (found.shells[s].is_closed && outside != 0 && outside + found.shells[s].winding() != 0) ++buried;
    }
    return buried;
}

} // namespace sinew::solver
