// Self-intersections by CGAL's box pairs and exact predicates.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/self_intersections.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/meshing/soup.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace sinew::solver {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int>;

/// Which side of a line through a and b a point is on in the plane of two axes: 1, -1, or 0 where rounding decides.
int surely_beside(const Point& a, const Point& b, const Point& p, int u, int v) {
    constexpr double rounding = 1e-14; // of four differences, two products and their difference, many times over
    const double one = (b[u] - a[u]) * (p[v] - a[v]), other = (b[v] - a[v]) * (p[u] - a[u]);
    const double margin = rounding * (std::abs(one) + std::abs(other));
    return one - other > margin ? 1 : other - one > margin ? -1 : 0;
}

class Finder {
  public:
    Finder(const Points& points, const std::vector<Triangle>& triangles) {
        std::map<std::array<double, 3>, int> number;
        std::vector<int> place(points.size());
        for (std::size_t v = 0; v < points.size(); ++v) {
            const Vec3& p = points[v];
            // + 0.0 makes -0 and 0 the same place.
            place[v] = number.try_emplace({p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}, static_cast<int>(v)).first->second;
            points_.emplace_back(p.x(), p.y(), p.z());
        }
        for (const auto& [a, b, c] : triangles) triangles_.push_back({place[at(a)], place[at(b)], place[at(c)]});
    }

    /// Of the triangles whose boxes overlap, of which so many are looked at. `stop` is asked now and then.
    std::vector<std::array<int, 2>> pairs(std::size_t most, const std::function<bool()>& stop, bool& all) const {
        std::vector<Box> boxes;
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            const auto& [a, b, c] = triangles_[t];
            if (!CGAL::collinear(p(a), p(b), p(c)))
                boxes.emplace_back(p(a).bbox() + p(b).bbox() + p(c).bbox(), static_cast<int>(t));
        }
        std::vector<std::array<int, 2>> out;
        struct Enough {};
        std::size_t looked_at = 0;
        try {
            CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& s, const Box& t) {
                if (++looked_at > most) throw Enough{};
                if (looked_at % 4096 == 0 && stop && stop()) throw Stopped();
                if (meet(triangles_[at(s.info())], triangles_[at(t.info())]))
                    out.push_back({std::min(s.info(), t.info()), std::max(s.info(), t.info())});
            });
        } catch (const Enough&) {
        }
        all = looked_at <= most;
        std::sort(out.begin(), out.end());
        return out;
    }

  private:
    const Point& p(int v) const { return points_[at(v)]; }
    Kernel::Triangle_3 solid(const Triangle& t) const { return {p(t[0]), p(t[1]), p(t[2])}; }

    /// Whether they have more in common than their common corners and edges.
    bool meet(const Triangle& s, const Triangle& t) const {
        std::vector<std::size_t> common_s, common_t;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                if (s[i] == t[j]) common_s.push_back(i), common_t.push_back(j);
        if (common_s.size() == 3) return false;
        if (common_s.size() == 2) {
            // Apart, unless they lie in one plane on the same side of the common edge.
            const int apex_s = s[3 - common_s[0] - common_s[1]], apex_t = t[3 - common_t[0] - common_t[1]];
            const Point &a = p(s[common_s[0]]), &b = p(s[common_s[1]]);
            return CGAL::coplanar(a, b, p(apex_s), p(apex_t)) &&
                   CGAL::coplanar_orientation(a, b, p(apex_s), p(apex_t)) == CGAL::POSITIVE;
        }
        if (surely_apart(s, t)) return false;
        if (common_s.size() == 1) {
            // What else they have in common reaches to the side opposite the common corner of one of them.
            const auto opposite = [&](const Triangle& of, std::size_t corner) {
                return Kernel::Segment_3(p(of[(corner + 1) % 3]), p(of[(corner + 2) % 3]));
            };
            return CGAL::do_intersect(solid(t), opposite(s, common_s[0])) ||
                   CGAL::do_intersect(solid(s), opposite(t, common_t[0]));
        }
        return CGAL::do_intersect(solid(s), solid(t));
    }

    /// Whether a side of one of them, seen along an axis, has the other one beyond it, but for a corner that they have
    /// in common at most. Of triangles in one plane exact predicates take a hundred times as long to say so.
    bool surely_apart(const Triangle& s, const Triangle& t) const {
        const auto along = [&](int v, int axis) { return p(s[at(v)])[axis] - p(s[0])[axis]; };
        double most = -1;
        int axis = 0;
        for (int d = 0; d < 3; ++d) {
            const int u = (d + 1) % 3, v = (d + 2) % 3;
            const double area = std::abs(along(1, u) * along(2, v) - along(1, v) * along(2, u));
            if (area > most) most = area, axis = d;
        }
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const auto& [own, others] : {std::pair(&s, &t), std::pair(&t, &s)})
            for (std::size_t c = 0; c < 3; ++c) {
                const int one = (*own)[c], other = (*own)[(c + 1) % 3];
                const Point &a = p(one), &b = p(other);
                const int inside = surely_beside(a, b, p((*own)[(c + 2) % 3]), u, v);
                const auto is_beyond = [&](int w) {
                    return w == one || w == other || surely_beside(a, b, p(w), u, v) == -inside;
                };
                if (inside != 0 && std::ranges::all_of(*others, is_beyond)) return true;
            }
        return false;
    }

    std::vector<Point> points_;
    std::vector<Triangle> triangles_;
};

} // namespace

Flaw self_intersections(const Points& points, const std::vector<Triangle>& triangles, const std::function<bool()>& stop,
                        std::size_t most_pairs) {
    Flaw flaw;
    for (const auto& [s, t] : Finder(points, triangles).pairs(most_pairs, stop, flaw.is_whole)) flaw.add(s, t);
    return flaw;
}

MeshCheck inspect_mesh(const Points& points, const std::vector<Triangle>& triangles) {
    for (std::size_t v = 0; v < points.size(); ++v)
        if (!points[v].allFinite()) throw Error("FE202", "vertex " + std::to_string(v) + " is not finite");
    MeshCheck found = check_mesh(points, triangles);
    // Triangles of a mesh made for something have some ten neighbours each. A fan of hundreds of thousands around one
    // corner has all pairs.
    found.crossing_triangles = self_intersections(points, triangles, {}, 10'000'000 + 30 * triangles.size());
    found.encloses = is_closed_once_welded(points, triangles);
    return found;
}

} // namespace sinew::solver
