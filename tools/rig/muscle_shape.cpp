// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/muscle_shape.h"

#include "solver/index.h"
#include "solver/mesh/edge_ways.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/thickness.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sinew::rig {

namespace {

using solver::Points;
using solver::Triangle;

constexpr double unreached = solver::EdgeWays::unreached;

/// The farthest that can be reached.
std::size_t farthest(const std::vector<double>& distances) {
    std::size_t out = 0;
    double most = -1;
    for (std::size_t v = 0; v < distances.size(); ++v)
        if (distances[v] < unreached && distances[v] > most) most = distances[v], out = v;
    return out;
}

/// A vertex of the part with the largest surface.
std::size_t vertex_of_largest_part(const solver::EdgeWays& edges, const std::vector<double>& areas) {
    std::vector<char> seen(edges.size(), 0);
    std::size_t out = 0;
    double most = -1;
    for (std::size_t v = 0; v < edges.size(); ++v) {
        if (seen[v]) continue;
        double area = 0;
        std::vector<std::size_t> open{v};
        seen[v] = 1;
        while (!open.empty()) {
            const std::size_t at = open.back();
            open.pop_back();
            area += areas[at];
            for (const auto& n : edges.of(at))
                if (!seen[n.vertex]) seen[n.vertex] = 1, open.push_back(n.vertex);
        }
        if (area > most) most = area, out = v;
    }
    return out;
}

void fill_apart(const Points& points, std::vector<double>& along) {
    const std::vector<double> known = along;
    for (std::size_t v = 0; v < along.size(); ++v) {
        if (known[v] >= 0) continue;
        double least = unreached;
        for (std::size_t w = 0; w < along.size(); ++w) {
            const double distance = (points[v] - points[w]).squaredNorm();
            if (known[w] >= 0 && distance < least) least = distance, along[v] = known[w];
        }
        along[v] = std::max(along[v], 0.0);
    }
}

constexpr std::size_t bins = 20;
constexpr double thin = 0.4; ///< of the thickest bin

/// Mean thickness by area in each bin; what a bin without rays lacks it takes from the one before.
std::array<double, bins> profile(const std::vector<solver::Thickness>& rays, const std::vector<Triangle>& triangles,
                                 const std::vector<double>& along) {
    std::array<double, bins> sum{}, area{};
    for (const solver::Thickness& ray : rays) {
        if (!std::isfinite(ray.distance)) continue;
        const Triangle& t = triangles[static_cast<std::size_t>(ray.triangle)];
        double s = 0;
        for (const int v : t) s += along[static_cast<std::size_t>(v)] / 3;
        const auto bin = std::min(bins - 1, static_cast<std::size_t>(s * static_cast<double>(bins)));
        sum[bin] += ray.area * ray.distance;
        area[bin] += ray.area;
    }
    for (std::size_t i = 0; i < bins; ++i) sum[i] = area[i] > 0 ? sum[i] / area[i] : i > 0 ? sum[i - 1] : 0;
    return sum;
}

/// The thickness that `share` of the surface is thicker than.
double exceeded_by(double share, std::vector<solver::Thickness> rays) {
    std::erase_if(rays, [](const solver::Thickness& r) { return !std::isfinite(r.distance); });
    std::sort(rays.begin(), rays.end(), [](const auto& a, const auto& b) { return a.distance > b.distance; });
    double all = 0, sum = 0;
    for (const auto& r : rays) all += r.area;
    for (const auto& r : rays)
        if ((sum += r.area) >= share * all) return r.distance;
    return 0;
}

} // namespace

MuscleShape measure_muscle(const Points& points, const std::vector<Triangle>& triangles) {
    MuscleShape out;
    out.areas = solver::vertex_areas(points, triangles);
    const solver::EdgeWays edges(points, triangles);
    std::size_t a = farthest(edges.from(vertex_of_largest_part(edges, out.areas)));
    std::vector<double> from_a = edges.from(a);
    std::size_t b = farthest(from_a);
    std::vector<double> from_b = edges.from(b);
    for (int round = 0; round < 10; ++round) {
        const std::size_t c = farthest(from_b);
        if (!(from_b[c] > from_a[b])) break;
        a = b, b = c;
        from_a = std::move(from_b);
        from_b = edges.from(b);
    }
    out.tips = {static_cast<int>(a), static_cast<int>(b)};
    out.length = from_a[b];
    for (std::size_t v = 0; v < points.size(); ++v) {
        const double sum = from_a[v] + from_b[v];
        out.along.push_back(sum < unreached && sum > 0 ? from_a[v] / sum : -1);
    }
    fill_apart(points, out.along);

    const auto rays = solver::thickness(points, triangles, 4000);
    out.thickness = exceeded_by(0.4, rays);
    const auto thicknesses = profile(rays, triangles, out.along);
    const double least = thin * *std::max_element(thicknesses.begin(), thicknesses.end());
    const auto thin_bins = [&](auto first, auto last) {
        return static_cast<double>(std::find_if(first, last, [&](double t) { return t >= least; }) - first);
    };
    out.tendons = {thin_bins(thicknesses.begin(), thicknesses.end()) / bins,
                   thin_bins(thicknesses.rbegin(), thicknesses.rend()) / bins};
    // A tip alone is thin everywhere.
    for (double& t : out.tendons) t = t > 1.5 / bins ? t : 0;
    return out;
}

} // namespace sinew::rig
