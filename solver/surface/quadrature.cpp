// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/surface/quadrature.h"

#include "solver/parallel.h"

#include <span>

namespace sinew::solver {
namespace {

struct RulePoint {
    Vec3 place;
    double share; ///< of the triangle's area
};

/// Degree 4: two orbits of three points, roots of the moment equations in closed form.
std::array<RulePoint, 6> degree_4() {
    // The points (1 - 2 a, a, a); orbit 1 and 2.
    constexpr double a[2] = {0.445948490915964886318329253883, 0.091576213509770743459571463402};
    constexpr double share[2] = {0.223381589678011465944973466630, 0.109951743655321867388359866704};
    std::array<RulePoint, 6> out;
    for (std::size_t orbit = 0; orbit < 2; ++orbit)
        for (std::size_t i = 0; i < 3; ++i) {
            Vec3 place = Vec3::Constant(a[orbit]);
            place[static_cast<Eigen::Index>(i)] = 1 - 2 * a[orbit];
            out[3 * orbit + i] = {place, share[orbit]};
        }
    return out;
}

std::span<const RulePoint> rule(int degree) {
    static const RulePoint one[] = {{Vec3::Constant(1.0 / 3), 1}};
    static const RulePoint two[] = {{Vec3(2.0 / 3, 1.0 / 6, 1.0 / 6), 1.0 / 3},
                                    {Vec3(1.0 / 6, 2.0 / 3, 1.0 / 6), 1.0 / 3},
                                    {Vec3(1.0 / 6, 1.0 / 6, 2.0 / 3), 1.0 / 3}};
    static const std::array<RulePoint, 6> four = degree_4();
    if (degree <= 1) return one;
    if (degree == 2) return two;
    return four;
}

} // namespace

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
        for (const RulePoint& p : rule(degree[t])) {
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
