// Share of a tet inside any surface, by subdivision.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/tet_quadrature.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {
namespace {

constexpr int parts = 8; // along an edge
constexpr int point_count = (parts + 1) * (parts + 2) * (parts + 3) / 6;

struct Sample {
    double inside;   ///< |winding number| - 1/2
    double distance; ///< to the surface, at most the search radius
};

int index(int x, int y, int z) { return (z * (parts + 1) + y) * (parts + 1) + x; }

} // namespace

double positive_share(const std::array<double, 4>& values) {
    std::array<double, 4> f = values;
    std::sort(f.begin(), f.end(), std::greater<>());
    const auto ratio = [](double in, double out) { return in / (in - out); };
    if (f[3] > 0) return 1;
    if (f[2] > 0) return 1 - ratio(-f[3], -f[0]) * ratio(-f[3], -f[1]) * ratio(-f[3], -f[2]);
    if (f[1] > 0) {
        const double a = ratio(f[0], f[2]), b = ratio(f[0], f[3]), c = ratio(f[1], f[2]), d = ratio(f[1], f[3]);
        return a * b + (1 - a) * c * d + a * (1 - b) * d;
    }
    if (f[0] > 0) return ratio(f[0], f[1]) * ratio(f[0], f[2]) * ratio(f[0], f[3]);
    return 0;
}

void add_positive_part(const std::array<double, 4>& values, const std::array<Barycentric, 4>& corners, double volume,
                       TetMoments& moments) {
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] > values[b]; });
    const auto f = [&](std::size_t i) { return values[order[i]]; };
    const auto corner = [&](std::size_t i) -> const Barycentric& { return corners[order[i]]; };
    /// Share of the way from corner i to j where the function vanishes, and the point there.
    const auto ratio = [&](std::size_t i, std::size_t j) { return f(i) / (f(i) - f(j)); };
    const auto zero = [&](std::size_t i, std::size_t j) {
        Barycentric out;
        for (std::size_t c = 0; c < 4; ++c) out[c] = corner(i)[c] + ratio(i, j) * (corner(j)[c] - corner(i)[c]);
        return out;
    };
    if (f(2) > 0) {
        moments.add(corners, volume);
        if (f(3) < 0)
            moments.add({corner(3), zero(3, 0), zero(3, 1), zero(3, 2)},
                        -volume * ratio(3, 0) * ratio(3, 1) * ratio(3, 2));
    } else if (f(1) > 0) {
        const double a = ratio(0, 2), b = ratio(0, 3), c = ratio(1, 2), d = ratio(1, 3);
        moments.add({corner(0), corner(1), zero(0, 2), zero(0, 3)}, volume * a * b);
        moments.add({corner(1), zero(0, 2), zero(1, 2), zero(1, 3)}, volume * (1 - a) * c * d);
        moments.add({corner(1), zero(0, 2), zero(0, 3), zero(1, 3)}, volume * a * (1 - b) * d);
    } else if (f(0) > 0) {
        moments.add({corner(0), zero(0, 1), zero(0, 2), zero(0, 3)}, volume * ratio(0, 1) * ratio(0, 2) * ratio(0, 3));
    }
}

double quadrature_share(const Solid& solid, const std::array<Vec3, 4>& corners, bool is_near, TetMoments* moments) {
    // Kuhn's coordinates 1 >= x >= y >= z >= 0 of the tet, on a grid of `parts` cells, each of six equal
    // tets.
    const Vec3 ex = (corners[1] - corners[0]) / parts, ey = (corners[2] - corners[1]) / parts,
               ez = (corners[3] - corners[2]) / parts;
    const double cell = std::max({ex.norm(), ey.norm(), ez.norm()}), radius = 2 * cell;
    Points points;
    points.reserve(point_count);
    for (int x = 0; x <= parts; ++x)
        for (int y = 0; y <= x; ++y)
            for (int z = 0; z <= y; ++z) points.push_back(corners[0] + x * ex + y * ey + z * ez);
    const std::vector<double> winding = solid.tree.winding_numbers(points);
    std::vector<double> distance;
    if (is_near) distance = solid.tree.distances(points, radius);
    std::array<Sample, (parts + 1) * (parts + 1) * (parts + 1)> samples;
    std::size_t next = 0;
    for (int x = 0; x <= parts; ++x)
        for (int y = 0; y <= x; ++y)
            for (int z = 0; z <= y; ++z, ++next)
                samples[static_cast<std::size_t>(index(x, y, z))] = {std::abs(winding[next]) - 0.5,
                                                                     is_near ? distance[next] : radius};

    constexpr int walks[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    double sum = 0;
    int count = 0;
    for (int x = 0; x < parts; ++x)
        for (int y = 0; y <= x; ++y)
            for (int z = 0; z <= y; ++z)
                for (const auto& walk : walks) {
                    int at[3] = {x, y, z};
                    std::array<Sample, 4> s;
                    std::array<Barycentric, 4> place;
                    bool in_tet = true;
                    for (std::size_t k = 0; k < 4 && in_tet; ++k) {
                        if (k > 0) ++at[walk[k - 1]];
                        in_tet = at[0] >= at[1] && at[1] >= at[2];
                        if (!in_tet) break;
                        s[k] = samples[static_cast<std::size_t>(index(at[0], at[1], at[2]))];
                        for (int c = 0; c < 4; ++c)
                            place[k][static_cast<std::size_t>(c)] =
                                ((c == 0 ? parts : at[c - 1]) - (c == 3 ? 0 : at[c])) / static_cast<double>(parts);
                    }
                    if (!in_tet) continue;
                    const bool near_surface =
                        std::any_of(s.begin(), s.end(), [&](const Sample& q) { return q.distance < cell; });
                    std::array<double, 4> f;
                    for (std::size_t k = 0; k < 4; ++k)
                        f[k] = near_surface ? std::copysign(s[k].distance, s[k].inside) : s[k].inside;
                    sum += positive_share(f);
                    ++count;
                    if (moments) add_positive_part(f, place, 1.0 / (parts * parts * parts), *moments);
                }
    return sum / count;
}

} // namespace sinew::solver
