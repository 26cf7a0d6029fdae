// The winding numbers just below and above the triangles of a surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/triangle_sides.h"

#include "solver/index.h"
#include "solver/meshing/calm_parts.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

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

/// The places just below and above a triangle, in turn; none if it has no area.
Neighbourhood places_about(const Points& points, const Triangle& triangle, double longest_side) {
    const Vec3 &a = points[at(triangle[0])], u = points[at(triangle[1])] - a, v = points[at(triangle[2])] - a;
    const Vec3 normal = u.cross(v);
    const double twice_area = normal.norm();
    if (!(twice_area > 0)) return {};
    const double longest_edge = std::max({u.norm(), v.norm(), (u - v).norm()});
    const int n = std::clamp(static_cast<int>(std::ceil(20 * longest_edge / longest_side)), 1, 12);
    const Vec3 step = normal * (1e-3 / std::sqrt(twice_area) / n);
    Neighbourhood out{{}, step.norm()};
    for_places_on(a, u, v, longest_side, [&](const Vec3& middle) {
        out.places.push_back(middle - step), out.places.push_back(middle + step);
        return true;
    });
    return out;
}

/// Two numbers that are whole, or nearly; nothing for others.
std::optional<Solid::Sides> sides_at(double below, double above) {
    for (const double x : {below, above})
        if (std::abs(x - std::round(x)) > 0.25 || std::abs(x) > 100) return {};
    return Solid::Sides{static_cast<signed char>(std::lround(below)), static_cast<signed char>(std::lround(above))};
}

Solid::Sides first_sides(const Points& places, const SurfaceTree& tree) {
    const std::vector<double> two = tree.winding_numbers({places[0], places[1]});
    return sides_at(two[0], two[1]).value_or(Solid::Sides{});
}

/// The sides at all places, if they are the same.
Solid::Sides sides_all_over(const Points& places, const SurfaceTree& tree, std::size_t& asked) {
    // A few places often tell that there is nothing to be known. All the others are asked at once, which costs a
    // long triangle, that all the rest of the mesh is near of, a fraction.
    asked = 2;
    const std::vector<double> two = tree.winding_numbers({places[0], places[1]});
    const auto first = sides_at(two[0], two[1]);
    if (!first) return {};
    for (std::size_t from = 2, several = 4; from < places.size(); from += several, several *= 4) {
        const auto begin = places.begin() + static_cast<std::ptrdiff_t>(from),
                   end = places.begin() + static_cast<std::ptrdiff_t>(std::min(from + several, places.size()));
        asked += static_cast<std::size_t>(end - begin);
        const std::vector<double> w = tree.winding_numbers(Points(begin, end));
        for (std::size_t k = 0; k < w.size(); k += 2)
            if (sides_at(w[k], w[k + 1]) != first) return {};
    }
    return *first;
}

} // namespace

FoundSides find_sides(const Points& points, const std::vector<Triangle>& triangles, const SurfaceTree& tree,
                      const SidesOptions& options, const MeshingPhase& phase) {
    const auto places_of = [&](std::size_t t) { return places_about(points, triangles[t], options.longest_side); };
    std::vector<int> part(triangles.size(), -1);
    const double middle = 0.5 * (phase.from + phase.to);
    if (options.is_closed)
        part = calm_parts(points, triangles, places_of, {phase.control, phase.from, middle, phase.what});
    FoundSides found{std::vector<Solid::Sides>(triangles.size())};
    std::atomic<std::size_t> asked = 0;
    const MeshingPhase asking{phase.control, options.is_closed ? middle : phase.from, phase.to, phase.what};
    asking.run(triangles.size(), 16, [&](std::size_t t) {
        const bool is_alone = part[t] < 0;
        if (!is_alone && at(part[t]) != t) return; // another one is asked for it
        const Points places = places_of(t).places;
        if (places.empty()) return;
        std::size_t count = 2;
        found.sides[t] = is_alone ? sides_all_over(places, tree, count) : first_sides(places, tree);
        asked += count;
    });
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (part[t] >= 0) found.sides[t] = found.sides[at(part[t])];
    found.asked = asked;
    return found;
}

} // namespace sinew::solver
