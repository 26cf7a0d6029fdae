// Polygon soups made ready.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/soup.h"

#include "solver/error.h"
#include "solver/mesh/surface_mesh.h"

#include <algorithm>
#include <numeric>

namespace sinew::solver {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// For each vertex the first one at the same place.
std::vector<int> first_at_place(const Points& points) {
    std::vector<int> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    const auto key = [&](int i) {
        const Vec3& p = points[at(i)];
        return std::array<double, 3>{p.x(), p.y(), p.z()};
    };
    std::sort(order.begin(), order.end(), [&](int a, int b) {
        const auto ka = key(a), kb = key(b);
        return ka != kb ? ka < kb : a < b;
    });
    std::vector<int> first(points.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        first[at(order[i])] =
            i > 0 && key(order[i]) == key(order[i - 1]) ? first[at(order[i - 1])] : order[i];
    return first;
}

/// The triangle beginning with its lowest corner, its direction kept.
Triangle rotated(const Triangle& t) {
    const auto low = static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
    return {t[low], t[(low + 1) % 3], t[(low + 2) % 3]};
}

void drop_repeated(std::vector<Triangle>& triangles) {
    std::vector<std::size_t> order(triangles.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [&](std::size_t i) { return rotated(triangles[i]); };
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
    std::vector<char> repeated(triangles.size(), 0);
    for (std::size_t i = 1; i < order.size(); ++i)
        if (key(order[i]) == key(order[i - 1])) repeated[order[i]] = 1;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i)
        if (!repeated[i]) triangles[kept++] = triangles[i];
    triangles.resize(kept);
}

struct Use {
    int low, high;
    int triangle;
    bool forward;
};

std::vector<Use> edge_uses(const std::vector<Triangle>& triangles) {
    std::vector<Use> uses;
    uses.reserve(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            uses.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
        }
    std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
        if (a.low != b.low) return a.low < b.low;
        if (a.high != b.high) return a.high < b.high;
        return a.triangle < b.triangle;
    });
    return uses;
}

/// Calls visit(first, last) for the uses of each edge.
template <class Visit>
void for_each_edge(const std::vector<Use>& uses, const Visit& visit) {
    for (std::size_t i = 0, j; i < uses.size(); i = j) {
        for (j = i + 1; j < uses.size() && uses[j].low == uses[i].low && uses[j].high == uses[i].high;) ++j;
        visit(i, j);
    }
}

void find_open_edges(Soup& soup) {
    const std::vector<Use> uses = edge_uses(soup.triangles);
    soup.open_edges = 0;
    for_each_edge(uses, [&](std::size_t first, std::size_t last) {
        int balance = 0;
        for (std::size_t i = first; i < last; ++i) balance += uses[i].forward ? 1 : -1;
        if (balance == 0) return;
        if (soup.open_edges++ == 0) soup.first_open = {uses[first].low, uses[first].high};
    });
    soup.is_closed = soup.open_edges == 0;
}

/// The triangles, those of each part turned the same way.
struct Turning {
    const std::vector<Triangle>& triangles;
    std::vector<std::array<int, 3>> neighbour; ///< over each edge
    std::vector<std::array<char, 3>> agrees;   ///< whether the neighbour runs through the edge the other way
    bool every_edge_has_two = true;

    explicit Turning(const std::vector<Triangle>& all)
        : triangles(all)
        , neighbour(all.size(), {-1, -1, -1})
        , agrees(all.size()) {
        const std::vector<Use> uses = edge_uses(all);
        for_each_edge(uses, [&](std::size_t first, std::size_t last) {
            if (last - first != 2) {
                every_edge_has_two = false;
                return;
            }
            join(uses[first], uses[first + 1]);
            join(uses[first + 1], uses[first]);
        });
    }

    void join(const Use& from, const Use& to) {
        const Triangle& t = triangles[at(from.triangle)];
        for (std::size_t k = 0; k < 3; ++k)
            if (std::min(t[k], t[(k + 1) % 3]) == from.low && std::max(t[k], t[(k + 1) % 3]) == from.high) {
                neighbour[at(from.triangle)][k] = to.triangle;
                agrees[at(from.triangle)][k] = from.forward != to.forward;
            }
    }

    /// The part of triangle `start`; `turned` is filled in for it.
    std::vector<int> part(int start, std::vector<signed char>& turned) const {
        std::vector<int> members{start};
        turned[at(start)] = 0;
        for (std::size_t i = 0; i < members.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t t = at(members[i]);
                const int n = neighbour[t][k];
                if (turned[at(n)] >= 0) continue;
                turned[at(n)] = agrees[t][k] ? turned[t] : static_cast<signed char>(1 - turned[t]);
                members.push_back(n);
            }
        return members;
    }
};

void turn(Triangle& t) { std::swap(t[1], t[2]); }

/// Orients a surface whose edges all have two triangles; leaves parts alone that are oriented already.
void orient(const Points& points, std::vector<Triangle>& triangles) {
    const Turning turning(triangles);
    if (!turning.every_edge_has_two) return;
    std::vector<signed char> turned(triangles.size(), -1);
    for (std::size_t s = 0; s < triangles.size(); ++s) {
        if (turned[s] >= 0) continue;
        const std::vector<int> part = turning.part(static_cast<int>(s), turned);
        bool any = false;
        for (const int t : part) any = any || turned[at(t)] == 1;
        if (!any) continue;
        std::vector<Triangle> alike;
        for (const int t : part) {
            if (turned[at(t)] == 1) turn(triangles[at(t)]);
            alike.push_back(triangles[at(t)]);
        }
        if (enclosed_volume(points, alike) < 0)
            for (const int t : part) turn(triangles[at(t)]);
    }
}

/// Renumbers the vertices that are used, in their order. \return the old number of each
std::vector<int> compact(Soup& soup, const Points& all) {
    std::vector<char> used(all.size(), 0);
    for (const Triangle& t : soup.triangles)
        for (const int v : t) used[at(v)] = 1;
    std::vector<int> number(all.size(), -1), old;
    for (std::size_t v = 0; v < all.size(); ++v)
        if (used[v]) {
            number[v] = static_cast<int>(soup.points.size());
            soup.points.push_back(all[v]);
            old.push_back(static_cast<int>(v));
        }
    for (Triangle& t : soup.triangles)
        for (int& v : t) v = number[at(v)];
    return old;
}

} // namespace

Soup make_soup(const Points& points, const std::vector<Triangle>& triangles) {
    check_usable(SurfaceMesh::from_triangles(points, triangles));
    const std::vector<int> first = first_at_place(points);
    Soup soup;
    for (const Triangle& t : triangles) {
        const Triangle w{first[at(t[0])], first[at(t[1])], first[at(t[2])]};
        if (w[0] != w[1] && w[1] != w[2] && w[2] != w[0]) soup.triangles.push_back(w);
    }
    if (soup.triangles.empty())
        throw Error("FE201",
                    "all " + std::to_string(triangles.size()) + " triangles have two corners in one place",
                    "Give a mesh with at least one triangle that has an area.");
    drop_repeated(soup.triangles);
    const std::vector<int> old = compact(soup, points);
    find_open_edges(soup);
    if (!soup.is_closed) {
        const std::vector<Triangle> as_given = soup.triangles;
        orient(soup.points, soup.triangles);
        find_open_edges(soup);
        if (!soup.is_closed) {
            soup.triangles = as_given;
            find_open_edges(soup);
            for (int& v : soup.first_open) v = old[at(v)];
        }
    }
    return soup;
}

} // namespace sinew::solver
