// Welding and turning.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/welding.h"

#include "solver/index.h"
#include "solver/mesh/surface_mesh.h"

#include <algorithm>
#include <numeric>

namespace sinew::solver {
namespace {

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
        first[at(order[i])] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[at(order[i - 1])] : order[i];
    return first;
}

/// Keeps the first of triangles with the same corners in the same direction.
void drop_repeated(std::vector<Triangle>& triangles) {
    std::vector<std::pair<Triangle, std::size_t>> keys;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        Triangle key = triangles[t];
        std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
        keys.emplace_back(key, t);
    }
    std::sort(keys.begin(), keys.end());
    std::vector<char> is_repeated(triangles.size(), 0);
    for (std::size_t i = 1; i < keys.size(); ++i) is_repeated[keys[i].second] = keys[i].first == keys[i - 1].first;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (!is_repeated[t]) triangles[kept++] = triangles[t];
    triangles.resize(kept);
}

struct Use {
    int low, high, triangle;
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
        return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
    });
    return uses;
}

/// The triangles over the edges with two of them.
struct Neighbours {
    std::vector<std::array<int, 3>> triangle;
    std::vector<std::array<char, 3>> agrees; ///< whether the neighbour runs through the edge the other way

    explicit Neighbours(const std::vector<Triangle>& all)
        : triangle(all.size(), {-1, -1, -1})
        , agrees(all.size()) {
        const std::vector<Use> uses = edge_uses(all);
        const auto join = [&](const Use& from, const Use& to) {
            const Triangle& t = all[at(from.triangle)];
            for (std::size_t k = 0; k < 3; ++k)
                if (std::min(t[k], t[(k + 1) % 3]) == from.low && std::max(t[k], t[(k + 1) % 3]) == from.high) {
                    triangle[at(from.triangle)][k] = to.triangle;
                    agrees[at(from.triangle)][k] = from.forward != to.forward;
                }
        };
        for (std::size_t i = 0, j; i < uses.size(); i = j) {
            for (j = i + 1; j < uses.size() && uses[j].low == uses[i].low && uses[j].high == uses[i].high;) ++j;
            if (j - i != 2) continue;
            join(uses[i], uses[i + 1]);
            join(uses[i + 1], uses[i]);
        }
    }
};

double volume_about_middle(const Points& points, const std::vector<Triangle>& triangles) {
    Points corners;
    for (const Triangle& t : triangles)
        for (const int v : t) corners.push_back(points[at(v)]);
    const Vec3 middle = bounding_box(corners).centre();
    double volume = 0;
    for (std::size_t i = 0; i < corners.size(); i += 3)
        volume += (corners[i] - middle).dot((corners[i + 1] - middle).cross(corners[i + 2] - middle)) / 6;
    return volume;
}

void turn(Triangle& t) { std::swap(t[1], t[2]); }

} // namespace

Welded weld(const Points& points, const std::vector<Triangle>& triangles) {
    Welded out{first_at_place(points), {}};
    for (const Triangle& t : triangles) {
        const Triangle w{out.place[at(t[0])], out.place[at(t[1])], out.place[at(t[2])]};
        if (w[0] != w[1] && w[1] != w[2] && w[2] != w[0]) out.triangles.push_back(w);
    }
    drop_repeated(out.triangles);
    return out;
}

OneSided turn_alike(const Points& points, std::vector<Triangle>& triangles) {
    const Neighbours over(triangles);
    OneSided found;
    std::vector<signed char> turned(triangles.size(), -1);
    for (std::size_t s = 0; s < triangles.size(); ++s) {
        if (turned[s] >= 0) continue;
        std::vector<int> part{static_cast<int>(s)};
        turned[s] = 0;
        bool any = false, is_one_sided = false;
        for (std::size_t i = 0; i < part.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t t = at(part[i]);
                const int n = over.triangle[t][k];
                if (n < 0) continue;
                const auto side = static_cast<signed char>(over.agrees[t][k] ? turned[t] : 1 - turned[t]);
                if (turned[at(n)] < 0) {
                    turned[at(n)] = side;
                    any = any || side == 1;
                    part.push_back(n);
                } else if (turned[at(n)] != side && !is_one_sided) {
                    is_one_sided = true;
                    if (found.parts++ == 0) found.first = {triangles[t][k], triangles[t][(k + 1) % 3]};
                }
            }
        if (!any || is_one_sided) continue;
        std::vector<Triangle> alike;
        for (const int t : part) {
            if (turned[at(t)] == 1) turn(triangles[at(t)]);
            alike.push_back(triangles[at(t)]);
        }
        if (volume_about_middle(points, alike) < 0)
            for (const int t : part) turn(triangles[at(t)]);
    }
    return found;
}

} // namespace sinew::solver
