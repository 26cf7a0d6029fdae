// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/fiber/curve.h"

#include "solver/error.h"
#include "solver/index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace sinew::solver {

namespace {

constexpr int degree = 3;

int span_count(const Curve& curve) { return static_cast<int>(curve.points.size()) - degree; }

/// Of the uniform knots that repeat at both ends; the first of the repeated ones is number 0.
double knot(int spans, int i) { return std::clamp(i - degree, 0, spans); }

/// A span's point and its derivative at t (knots count from 0, so span s is from s to s + 1).
struct OnCurve {
    Vec3 point, derivative;
};

OnCurve at_parameter(const Curve& curve, int span, double t) {
    const int spans = span_count(curve);
    std::array<Vec3, degree + 1> d;
    for (int j = 0; j <= degree; ++j) d[at(j)] = curve.points[at(span + j)];
    Vec3 derivative = Vec3::Zero();
    for (int r = 1; r <= degree; ++r) {
        if (r == degree) derivative = degree * (d[3] - d[2]); // the last two lie a knot interval of 1 apart
        for (int j = degree; j >= r; --j) {
            const double from = knot(spans, span + j), to = knot(spans, span + j + degree + 1 - r);
            const double share = (t - from) / (to - from);
            d[at(j)] = (1 - share) * d[at(j - 1)] + share * d[at(j)];
        }
    }
    return {d[degree], derivative};
}

double speed(const Curve& curve, int span, double t) { return at_parameter(curve, span, t).derivative.norm(); }

double gauss(const Curve& curve, int span, double from, double to) {
    static constexpr std::array<double, 3> places{0, 0.5384693101056831, 0.9061798459386640};
    static constexpr std::array<double, 3> weights{0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    double sum = weights[0] * speed(curve, span, middle);
    for (std::size_t i = 1; i < places.size(); ++i)
        sum += weights[i] *
               (speed(curve, span, middle - half * places[i]) + speed(curve, span, middle + half * places[i]));
    return half * sum;
}

double refined(const Curve& curve, int span, double from, double to, double whole, double tolerance, int levels) {
    const double middle = 0.5 * (from + to);
    const double first = gauss(curve, span, from, middle), second = gauss(curve, span, middle, to);
    if (levels == 0 || std::abs(first + second - whole) <= tolerance) return first + second;
    return refined(curve, span, from, middle, first, tolerance, levels - 1) +
           refined(curve, span, middle, to, second, tolerance, levels - 1);
}

double polygon_length(const Points& points) {
    double length = 0;
    for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
    return length;
}

} // namespace

void check_curve(const Curve& curve) {
    const bool cubic = curve.form == CurveForm::cubic;
    if (curve.points.size() >= (cubic ? 4u : 2u)) return;
    throw Error("FE216",
                std::to_string(curve.points.size()) + " points do not make a " + (cubic ? "cubic curve" : "polyline"),
                cubic ? "Give four points or more, or choose the form polyline." : "Give two points or more.");
}

double curve_length(const Curve& curve) {
    const double polygon = polygon_length(curve.points);
    if (curve.form == CurveForm::polyline) return polygon;
    double length = 0;
    for (int span = 0; span < span_count(curve); ++span)
        length += refined(curve, span, span, span + 1, gauss(curve, span, span, span + 1), 1e-14 * polygon, 12);
    return length;
}

Points curve_samples(const Curve& curve, int per_span) {
    if (curve.form == CurveForm::polyline) return curve.points;
    Points out;
    for (int span = 0; span < span_count(curve); ++span)
        for (int i = 0; i < per_span; ++i)
            out.push_back(at_parameter(curve, span, span + static_cast<double>(i) / per_span).point);
    out.push_back(curve.points.back());
    return out;
}

} // namespace sinew::solver
