// All four corners are in one plane at the roots of a cubic; an odd number of those at which they meet is a way
// through.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/crossed.h"

#include <cmath>

namespace sinew::solver {

namespace {

/// What counts as inside, in shares of the triangle or edge: of neighbours that share an edge one must take what comes
/// through there.
constexpr double slack = 1e-9;

double triple(const Vec3& a, const Vec3& b, const Vec3& c) { return a.cross(b).dot(c); }

/// Ways between corners that move straight: a + t b.
struct Way {
    Vec3 a, b;
    Vec3 at(double t) const { return a + t * b; }
};

/// Calls visit(t) for the roots in (0, 1) of the triple product of three ways, in order.
template <class Visit>
void visit_roots(const Way& e, const Way& f, const Way& g, const Visit& visit) {
    const double c0 = triple(e.a, f.a, g.a), c3 = triple(e.b, f.b, g.b);
    const double c1 = triple(e.b, f.a, g.a) + triple(e.a, f.b, g.a) + triple(e.a, f.a, g.b);
    const double c2 = triple(e.b, f.b, g.a) + triple(e.b, f.a, g.b) + triple(e.a, f.b, g.b);
    const auto value = [&](double t) { return ((c3 * t + c2) * t + c1) * t + c0; };
    // Between the extremes it rises or falls all the way.
    double ends[4] = {0};
    int count = 1;
    const double a = 3 * c3, b = 2 * c2, c = c1, inside = b * b - 4 * a * c;
    if (inside > 0) {
        const double q = -0.5 * (b + std::copysign(std::sqrt(inside), b));
        double one = a != 0 ? q / a : 2, other = q != 0 ? c / q : 2;
        if (one > other) std::swap(one, other);
        for (const double t : {one, other})
            if (t > 0 && t < 1) ends[count++] = t;
    }
    ends[count] = 1;
    for (int i = 0; i < count; ++i) {
        double low = ends[i], high = ends[i + 1];
        const double at_low = value(low), at_high = value(high);
        if (!(at_low * at_high < 0)) continue;
        // Newton's method between bounds, from where the chord says.
        constexpr double near = 1e-15;
        double t = low + at_low / (at_low - at_high) * (high - low);
        for (int step = 0; step < 60 && high - low > near; ++step) {
            const double here = value(t), slope = (3 * c3 * t + 2 * c2) * t + c1;
            if (std::abs(here) <= near * std::abs(slope)) break;
            ((here < 0) == (at_low < 0) ? low : high) = t;
            const double next = t - here / slope;
            t = next > low && next < high ? next : 0.5 * (low + high);
        }
        visit(t);
    }
}

} // namespace

bool crosses_face(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to) {
    const auto way = [&](std::size_t i) { return Way{from[i] - from[1], to[i] - to[1] - (from[i] - from[1])}; };
    const Way e = way(2), f = way(3), g = way(0);
    bool through = false;
    visit_roots(e, f, g, [&](double t) {
        const Vec3 u = e.at(t), v = f.at(t), w = g.at(t), n = u.cross(v);
        const double n2 = n.squaredNorm();
        if (!(n2 > 0)) return;
        const double b1 = w.cross(v).dot(n) / n2, b2 = u.cross(w).dot(n) / n2;
        if (b1 >= -slack && b2 >= -slack && b1 + b2 <= 1 + slack) through = !through;
    });
    return through;
}

bool crosses_edge(const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to) {
    const auto way = [&](std::size_t i, std::size_t j) {
        return Way{from[i] - from[j], to[i] - to[j] - (from[i] - from[j])};
    };
    const Way e = way(1, 0), f = way(3, 2), g = way(2, 0);
    bool through = false;
    visit_roots(e, f, g, [&](double t) {
        const Vec3 u = e.at(t), v = f.at(t), w = g.at(t), n = u.cross(v);
        const double n2 = n.squaredNorm();
        if (!(n2 > 0)) return;
        // u s - v r = w
        const double s = w.cross(v).dot(n) / n2, r = w.cross(u).dot(n) / n2;
        if (s >= -slack && s <= 1 + slack && r >= -slack && r <= 1 + slack) through = !through;
    });
    return through;
}

} // namespace sinew::solver
