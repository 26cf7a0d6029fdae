// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/surface/quadrature.h"

#include "solver/parallel.h"
#include "solver/surface/triangle_rule.h"

namespace sinew::solver {
std::vector<SurfaceSample> quadrature_samples(const SampledSurface& surface, const CornerWeights& paint,
                                              const SurfaceDensity& density) {
    const std::size_t n = surface.triangles.size();
    std::vector<int> degree(n);
    const auto corner = [&](std::size_t t, std::size_t i) -> const Vec3& {
        return surface.points[static_cast<std::size_t>(surface.triangles[t][i])];
    };
    parallel_for(n, 64, [&](std::size_t t) { degree[t] = density.degree(corner(t, 0), corner(t, 1), corner(t, 2)); });
    std::vector<SurfaceSample> out;
    for (std::size_t t = 0; t < n; ++t) {
        const Vec3 &a = corner(t, 0), &b = corner(t, 1), &c = corner(t, 2);
        const double area = 0.5 * (b - a).cross(c - a).norm();
        if (!(area > 0)) continue;
        const std::array<double, 3>& w = paint[static_cast<std::size_t>(surface.source[t])];
        const std::array<Vec3, 3>& places = surface.places[t];
        for (const RulePoint& p : triangle_rule(degree[t])) {
            SurfaceSample s;
            s.triangle = surface.source[t];
            s.place = p.place[0] * places[0] + p.place[1] * places[1] + p.place[2] * places[2];
            s.point = p.place[0] * a + p.place[1] * b + p.place[2] * c;
            s.area = p.share * area;
            s.weight = s.place[0] * w[0] + s.place[1] * w[1] + s.place[2] * w[2];
            if (s.weight > 0) out.push_back(s);
        }
    }
    return out;
}

} // namespace sinew::solver
