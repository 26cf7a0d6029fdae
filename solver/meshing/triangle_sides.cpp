// The winding numbers just below and above the triangles of a surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/triangle_sides.h"

#include "solver/index.h"
#include "solver/meshing/calm_parts.h"
#include "solver/meshing/winding_changes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

namespace sinew::solver {
namespace {

/// Places on a triangle with corner a and edges u, v, no farther apart than a twentieth of the mesh or so: the middles
/// of n * n equal parts, or of strips across the longest edge where the triangle is much longer than high. Calls
/// use(place) until it returns false.
template <class Use>
void for_places_on(const Vec3& a, const Vec3& u, const Vec3& v, double longest_side, const Use& use) {
    const double longest_edge = std::max({u.norm(), v.norm(), (u - v).norm()});
    const auto parts = [&](double length) {
        return std::clamp(static_cast<int>(std::ceil(20 * length / longest_side)), 1, 12);
    };
    const int n = parts(longest_edge), high = parts(u.cross(v).norm() / longest_edge);
    if (4 * high <= n) {
        // From the longest edge towards the corner opposite.
        Vec3 from = a, along = u, top = a + v;
        if (v.norm() == longest_edge) along = v, top = a + u;
        if ((u - v).norm() == longest_edge) from = a + u, along = v - u, top = a;
        for (int row = 0; row < high; ++row)
            for (int i = 0; i < n; ++i) {
                const double up = (row + 1.0 / 3) / high;
                if (!use((1 - up) * (from + (i + 0.5) / n * along) + up * top)) return;
            }
        return;
    }
    for (int p = 0; p < n; ++p)
        for (int q = 0; p + q < n; ++q)
            for (int half = 0; half < (p + q + 1 < n ? 2 : 1); ++half) {
                const double offset = half == 0 ? 1.0 / 3 : 2.0 / 3;
                if (!use(a + ((p + offset) * u + (q + offset) * v) / n)) return;
            }
}

/// The places just below and above a triangle, in turn; none if it has no area. `nearer`: how many times so.
Neighbourhood places_about(const Points& points, const Triangle& triangle, double longest_side, double nearer = 1) {
    const Vec3 &a = points[at(triangle[0])], u = points[at(triangle[1])] - a, v = points[at(triangle[2])] - a;
    const Vec3 normal = u.cross(v);
    const double twice_area = normal.norm();
    if (!(twice_area > 0)) return {};
    const double longest_edge = std::max({u.norm(), v.norm(), (u - v).norm()});
    const int n = std::clamp(static_cast<int>(std::ceil(20 * longest_edge / longest_side)), 1, 12);
    const Vec3 step = normal * (1e-3 / std::sqrt(twice_area) / n / nearer);
    Neighbourhood out{{}, step.norm()};
    for_places_on(a, u, v, longest_side, [&](const Vec3& middle) {
        out.places.push_back(middle - step), out.places.push_back(middle + step);
        return true;
    });
    return out;
}

/// How many times nearer than at first it is looked where places do not agree, in turn.
constexpr std::array ever_nearer{1.0, 8.0, 64.0, 512.0};

/// Calls look(nearer) until it returns true, or the places would hardly be told from the triangle.
template <class Look>
void look_ever_nearer(const Points& points, const Triangle& triangle, double step, const Look& look) {
    double farthest = 0;
    for (const int c : triangle) farthest = std::max(farthest, points[at(c)].cwiseAbs().maxCoeff());
    for (const double nearer : ever_nearer)
        if ((nearer > 1 && step < 1e-12 * nearer * farthest) || look(nearer)) return;
}

/// Two numbers that are whole, or nearly; nothing for others.
std::optional<Solid::Sides> sides_at(double below, double above) {
    for (const double x : {below, above})
        if (std::abs(x - std::round(x)) > 0.25 || std::abs(x) > 100) return {};
    return Solid::Sides{static_cast<signed char>(std::lround(below)), static_cast<signed char>(std::lround(above))};
}

std::optional<Solid::Sides> first_sides(const Points& places, const SurfaceTree& tree, std::size_t& asked) {
    asked += 2;
    const std::vector<double> two = tree.winding_numbers({places[0], places[1]});
    return sides_at(two[0], two[1]).value_or(Solid::Sides{});
}

/// The sides at all places (none where they cannot be told); nothing if they are not the same.
std::optional<Solid::Sides> sides_all_over(const Points& places, const SurfaceTree& tree, std::size_t& asked) {
    // A few places often tell that there is nothing to be known. All the others are asked at once, which costs a
    // long triangle, that all the rest of the mesh is near of, a fraction.
    asked += 2;
    const std::vector<double> two = tree.winding_numbers({places[0], places[1]});
    const auto first = sides_at(two[0], two[1]);
    if (!first) return Solid::Sides{};
    for (std::size_t from = 2, several = 4; from < places.size(); from += several, several *= 4) {
        const auto begin = places.begin() + static_cast<std::ptrdiff_t>(from),
                   end = places.begin() + static_cast<std::ptrdiff_t>(std::min(from + several, places.size()));
        asked += static_cast<std::size_t>(end - begin);
        const std::vector<double> w = tree.winding_numbers(Points(begin, end));
        for (std::size_t k = 0; k < w.size(); k += 2)
            if (sides_at(w[k], w[k + 1]) != first) return {};
    }
    return first;
}

/// How the winding numbers at a triangle's places differ.
enum class Spread : char {
    doubtful, ///< not told by counting: they must be asked
    uneven,   ///< not the same all over the triangle
    even
};

struct Rise {
    Spread spread = Spread::doubtful;
    int by = 0;        ///< even: the number above less that below
    double nearer = 1; ///< where that was seen
};

Rise rise_at(const Points& places, const WindingChanges& changes) {
    const std::vector<int> near = changes.near(places);
    const std::optional<int> first = changes.along(places[0], places[1], near);
    if (!first) return {};
    for (std::size_t k = 2; k < places.size(); k += 2) {
        const std::optional<int> aside = changes.along(places[k - 2], places[k], near);
        if (!aside) return {};
        if (*aside != 0) return {Spread::uneven, 0};
        const std::optional<int> up = changes.along(places[k], places[k + 1], near);
        if (!up) return {};
        if (*up != *first) return {Spread::uneven, 0};
    }
    return {Spread::even, *first};
}

/// Numbers of which only differences are known.
class Differences {
  public:
    explicit Differences(std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) links_.push_back({i, 0});
    }
    /// The first of those whose differences to i are known, and how much more i's number is.
    std::pair<std::size_t, int> root(std::size_t i) {
        int sum = 0;
        while (links_[i].to != i) {
            const Link next = links_[links_[i].to];
            links_[i] = {next.to, links_[i].more + next.more};
            sum += links_[i].more, i = links_[i].to;
        }
        return {i, sum};
    }
    /// The second one's number is that of the first and `more`.
    void tie(std::size_t first, std::size_t second, int more) {
        const auto [a, first_more] = root(first);
        const auto [b, second_more] = root(second);
        const int apart = first_more + more - second_more;
        if (a < b) links_[b] = {a, apart};
        if (b < a) links_[a] = {b, -apart};
    }

  private:
    struct Link {
        std::size_t to;
        int more;
    };
    std::vector<Link> links_;
};

/// A closed surface and what is asked of it.
struct Asking {
    const Points& points;
    const std::vector<Triangle>& triangles;
    const SidesOptions& options;

    Neighbourhood places(std::size_t t, double nearer = 1) const {
        return places_about(points, triangles[t], options.longest_side, nearer);
    }
    template <class Look>
    void look(std::size_t t, const Look& look) const {
        const Neighbourhood first = places(t);
        if (first.places.empty()) return;
        look_ever_nearer(points, triangles[t], first.step, [&](double nearer) {
            return look(nearer > 1 ? places(t, nearer).places : first.places, nearer);
        });
    }
};

/// What counting tells of one triangle of each calm part, and of all that belong to none.
struct Counted {
    std::vector<Rise> rises;
    std::vector<std::pair<std::size_t, int>> roots; ///< Differences::root of the numbers below
};

/// Ties the triangles of a closed surface together by counting what lies between the places of neighbours.
Counted count_between(const Asking& asking, const std::vector<int>& part, const MeshingPhase& phase) {
    const std::size_t count = asking.triangles.size();
    const auto one_for = [&](std::size_t t) { return part[t] < 0 ? t : at(part[t]); };
    const WindingChanges changes(asking.points, asking.triangles);
    Counted found{std::vector<Rise>(count), {}};
    phase.run(count, 16, [&](std::size_t t) {
        if (one_for(t) != t) return;
        asking.look(t, [&](Points places, double nearer) {
            if (part[t] >= 0) places.resize(2); // it is calm: so are the others
            found.rises[t] = rise_at(places, changes);
            found.rises[t].nearer = nearer;
            return found.rises[t].spread != Spread::uneven;
        });
    });
    const auto is_even = [&](std::size_t t) { return found.rises[one_for(t)].spread == Spread::even; };
    const auto below_of = [&](std::size_t t) { return asking.places(t, found.rises[one_for(t)].nearer).places[0]; };
    const std::vector<std::array<int, 3>> neighbours = find_neighbours(asking.triangles);
    std::vector<std::array<std::optional<int>, 3>> more(count);
    phase.run(count, 16, [&](std::size_t t) {
        for (std::size_t k = 0; k < 3 && is_even(t); ++k) {
            const int other = neighbours[t][k];
            if (other < static_cast<int>(t) || one_for(t) == one_for(at(other)) || !is_even(at(other))) continue;
            const Points ends{below_of(t), below_of(at(other))};
            more[t][k] = changes.along(ends[0], ends[1], changes.near(ends));
        }
    });
    Differences below(count);
    for (std::size_t t = 0; t < count; ++t)
        for (std::size_t k = 0; k < 3; ++k)
            if (more[t][k]) below.tie(one_for(t), one_for(at(neighbours[t][k])), *more[t][k]);
    for (std::size_t t = 0; t < count; ++t) found.roots.push_back(below.root(t));
    return found;
}

} // namespace

FoundSides find_sides(const Points& points, const std::vector<Triangle>& triangles, const SurfaceTree& tree,
                      const SidesOptions& options, const MeshingPhase& phase) {
    const Asking asking{points, triangles, options};
    const bool is_spared = options.is_closed && !options.is_each_asked;
    std::vector<int> part(triangles.size(), -1);
    const double middle = 0.5 * (phase.from + phase.to);
    if (is_spared)
        part = calm_parts(points, triangles, [&](std::size_t t) { return asking.places(t); },
                          {phase.control, phase.from, middle, phase.what});
    const bool is_calm = std::ranges::all_of(part, [](int p) { return p >= 0; }); // each part asks for itself
    Counted counted{std::vector<Rise>(triangles.size()), {}};
    if (is_spared && !is_calm) counted = count_between(asking, part, {phase.control, middle, middle, phase.what});
    FoundSides found{std::vector<Solid::Sides>(triangles.size())};
    std::atomic<std::size_t> asked = 0;
    const auto ask = [&](std::size_t t) {
        std::size_t count = 0;
        asking.look(t, [&](const Points& places, double) {
            const auto sides = part[t] < 0 ? sides_all_over(places, tree, count) : first_sides(places, tree, count);
            found.sides[t] = sides.value_or(Solid::Sides{});
            return sides || !options.is_closed;
        });
        asked += count;
    };
    const auto stands_for_itself = [&](std::size_t t) { return part[t] < 0 || at(part[t]) == t; };
    const auto is_even = [&](std::size_t t) { return counted.rises[t].spread == Spread::even; };
    // By counting, one number tells all that hang together.
    std::vector<double> below(triangles.size());
    const MeshingPhase last{phase.control, is_spared ? middle : phase.from, phase.to, phase.what};
    last.run(triangles.size(), 16, [&](std::size_t t) {
        if (!stands_for_itself(t)) return; // another one is asked for it
        if (counted.rises[t].spread == Spread::doubtful) ask(t);
        if (!is_even(t) || counted.roots[t].first != t) return;
        below[t] = tree.winding_numbers({asking.places(t, counted.rises[t].nearer).places[0]})[0];
        ++asked;
    });
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (!stands_for_itself(t) || !is_even(t)) continue;
        const auto [root, more] = counted.roots[t];
        const double one = below[root] + more;
        found.sides[t] = sides_at(one, one + counted.rises[t].by).value_or(Solid::Sides{});
    }
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (part[t] >= 0) found.sides[t] = found.sides[at(part[t])];
    found.asked = asked;
    return found;
}

} // namespace sinew::solver
