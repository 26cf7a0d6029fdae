// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/surface/sampled_surface.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/ties.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <unordered_map>
#include <unordered_set>

namespace sinew::solver {
namespace {

/// Longest side of a triangle that one point stands for, in widths of the tets along it.
constexpr double one_point_share = 0.17;
constexpr std::size_t most_triangles = 4'000'000;

/// The least width of the carriers at p along a direction.
double width_at(const std::vector<SurfaceDensity::Carrier>& carriers, const Vec3& p, const Vec3& direction) {
    double width = 1e300;
    for (const auto& c : carriers) width = std::min(width, c.tets->width(p, direction));
    return width;
}

/// An edge by its ends, lower one first.
std::uint64_t key_of(int a, int b) {
    const auto [low, high] = std::minmax(a, b);
    return static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high);
}

[[noreturn]] void refuse_so_many() {
    throw Error(
        "FE232",
        "cutting a surface to the size of the tets that carry it, or to collisionPointSpacing, gives more than " +
            std::to_string(most_triangles) + " triangles",
        "paint a smaller part of it, choose larger tets or a larger spacing");
}

/// How many triangles without a longer edge an area takes at least: none is larger than the equilateral one.
double least_count(const SampledSurface& s, double longest_edge) {
    double area = 0;
    for (const auto& [a, b, c] : s.triangles)
        area += 0.5 * (s.points[at(b)] - s.points[at(a)]).cross(s.points[at(c)] - s.points[at(a)]).norm();
    return area / (0.25 * std::sqrt(3.0) * longest_edge * longest_edge);
}

class Cutter {
  public:
    Cutter(SampledSurface& surface, const SurfaceDensity& density)
        : s_(surface)
        , density_(density) {}

    /// Cuts every edge that is too long once. False: there was none.
    bool pass() {
        find_middles();
        if (middles_.empty()) return false;
        SampledSurface old;
        std::swap(old.triangles, s_.triangles), std::swap(old.source, s_.source), std::swap(old.places, s_.places);
        for (std::size_t t = 0; t < old.triangles.size(); ++t) cut(old.triangles[t], old.source[t], old.places[t]);
        if (s_.triangles.size() > most_triangles) refuse_so_many();
        return true;
    }

  private:
    /// Decides about the edges that have not been looked at yet, and puts a vertex into the middle of the long ones.
    void find_middles() {
        std::vector<std::uint64_t> edges;
        for (const Triangle& t : s_.triangles)
            for (std::size_t i = 0; i < 3; ++i) {
                const std::uint64_t key = key_of(t[i], t[(i + 1) % 3]);
                if (!short_.contains(key)) edges.push_back(key);
            }
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        std::vector<char> too_long(edges.size());
        parallel_for(edges.size(), 64, [&](std::size_t e) {
            too_long[e] = density_.too_long(s_.points[at(edges[e] >> 32)], s_.points[at(edges[e] & 0xffffffffu)]);
        });
        middles_.clear();
        std::vector<std::uint64_t> cuts;
        for (std::size_t e = 0; e < edges.size(); ++e) {
            if (too_long[e])
                cuts.push_back(edges[e]);
            else
                short_.insert(edges[e]);
        }
        add_longest(cuts);
        std::sort(cuts.begin(), cuts.end());
        for (const std::uint64_t edge : cuts) {
            const Vec3 middle = 0.5 * (s_.points[at(edge >> 32)] + s_.points[at(edge & 0xffffffffu)]);
            middles_.emplace(edge, static_cast<int>(s_.points.size()));
            s_.points.push_back(middle);
        }
    }

    /// A triangle that is cut at an edge is cut at its longest one too if that is much longer, and so on. An edge may
    /// pass for short, judged at a few places, and parts of it not: without this its triangles would be cut at the
    /// others for ever, ever flatter.
    void add_longest(std::vector<std::uint64_t>& cuts) {
        std::unordered_set<std::uint64_t> is_cut(cuts.begin(), cuts.end());
        const auto squared = [&](const Triangle& t, std::size_t i) {
            return (s_.points[at(t[i])] - s_.points[at(t[(i + 1) % 3])]).squaredNorm();
        };
        for (bool more = !cuts.empty(); more;) {
            more = false;
            for (const Triangle& t : s_.triangles) {
                std::size_t longest = 0;
                double of_cuts = 0;
                for (std::size_t i = 0; i < 3; ++i) {
                    if (clearly_less(squared(t, longest), squared(t, i))) longest = i;
                    if (is_cut.contains(key_of(t[i], t[(i + 1) % 3]))) of_cuts = std::max(of_cuts, squared(t, i));
                }
                if (of_cuts == 0 || !clearly_less(2 * of_cuts, squared(t, longest))) continue;
                const std::uint64_t key = key_of(t[longest], t[(longest + 1) % 3]);
                is_cut.insert(key), short_.erase(key), cuts.push_back(key);
                more = true;
            }
        }
    }

    void cut(const Triangle& t, int source, const std::array<Vec3, 3>& place) {
        // Corners 0, 1, 2, then the middles of the edges that begin there; -1 = not cut.
        int vertex[6];
        Vec3 places[6];
        int cuts = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            vertex[i] = t[i], places[i] = place[i];
            const auto it = middles_.find(key_of(t[i], t[(i + 1) % 3]));
            vertex[3 + i] = it == middles_.end() ? -1 : it->second;
            places[3 + i] = 0.5 * (place[i] + place[(i + 1) % 3]);
            cuts += vertex[3 + i] >= 0;
        }
        const auto add = [&](int a, int b, int c) {
            s_.triangles.push_back({vertex[a], vertex[b], vertex[c]});
            s_.source.push_back(source);
            s_.places.push_back({places[a], places[b], places[c]});
        };
        if (cuts == 0) return add(0, 1, 2);
        if (cuts == 3) {
            for (int i = 0; i < 3; ++i) add(i, 3 + i, 3 + (i + 2) % 3);
            return add(3, 4, 5);
        }
        if (cuts == 1) {
            int i = 0;
            while (vertex[3 + i] < 0) ++i;
            add(i, 3 + i, (i + 2) % 3);
            return add(3 + i, (i + 1) % 3, (i + 2) % 3);
        }
        int whole = 0; // the edge that is not cut, from a to b; the others meet in c
        while (vertex[3 + whole] >= 0) ++whole;
        const int a = whole, b = (whole + 1) % 3, c = (whole + 2) % 3, bc = 3 + b, ca = 3 + c;
        add(c, ca, bc);
        const auto squared = [&](int p, int q) {
            return (s_.points[at(vertex[p])] - s_.points[at(vertex[q])]).squaredNorm();
        };
        const double one = squared(a, bc), other = squared(b, ca);
        if (clearly_less(one, other) || (!clearly_less(other, one) && vertex[a] < vertex[b])) {
            add(a, b, bc);
            add(a, bc, ca);
        } else {
            add(a, b, ca);
            add(b, bc, ca);
        }
    }

    SampledSurface& s_;
    const SurfaceDensity& density_;
    std::unordered_set<std::uint64_t> short_;
    std::unordered_map<std::uint64_t, int> middles_;
};

} // namespace

bool SurfaceDensity::too_long(const Vec3& a, const Vec3& b) const {
    const double length = (b - a).norm();
    if (longest_edge > 0 && clearly_less(longest_edge, length)) return true;
    const bool may_be = std::any_of(carriers.begin(), carriers.end(),
                                    [&](const Carrier& c) { return length > widths * c.tets->least_width(); });
    if (!may_be) return false;
    const Vec3 direction = (b - a) / length;
    for (const double share : {0.5, 0.25, 0.75, 0.0, 1.0})
        if (clearly_less(widths * width_at(carriers, (1 - share) * a + share * b, direction), length)) return true;
    return false;
}

int SurfaceDensity::degree(const Vec3& a, const Vec3& b, const Vec3& c) const {
    if (carriers.empty()) return 1;
    const Vec3 centre = (a + b + c) / 3;
    int degree = 1;
    for (const Carrier& carrier : carriers) {
        // Quadratic tets bend within half of their width.
        const bool quadratic = carrier.element == ElementKind::quadratic;
        const double share = quadratic ? 0.5 * one_point_share : one_point_share;
        for (const Vec3& edge : {Vec3(b - a), Vec3(c - b), Vec3(a - c)}) {
            const double length = edge.norm();
            if (clearly_less(share * carrier.tets->least_width(), length) &&
                clearly_less(share * carrier.tets->width(centre, edge / length), length))
                degree = std::max(degree, quadratic ? 4 : 2);
        }
    }
    return degree;
}

SampledSurface cut_surface(const Points& points, const std::vector<Triangle>& triangles, const std::vector<int>& which,
                           const SurfaceDensity& density) {
    SampledSurface s;
    s.points = points;
    for (const int t : which) {
        s.triangles.push_back(triangles[at(t)]);
        s.source.push_back(t);
        s.places.push_back({Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)});
    }
    // Found out before seconds are spent on it.
    if (density.longest_edge > 0 && least_count(s, density.longest_edge) > most_triangles) refuse_so_many();
    Cutter cutter(s, density);
    while (cutter.pass()) {
    }
    return s;
}

} // namespace sinew::solver
