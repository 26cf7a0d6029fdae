// Curves in space by control points: lines of action, the paths of muscles. A polyline goes through all of its points;
// a cubic is the uniform B-spline that begins at the first point and ends at the last, as Maya's curves of degree 3 do
// (knots 0 0 0 0 1 2 … m m m m; de Boor 1972), and lies near those between.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

namespace sinew::solver {

enum class CurveForm { polyline, cubic };

struct Curve {
    Points points; ///< control points
    CurveForm form = CurveForm::polyline;
};

/// Throws Error FE216 where there are too few points for the form (two, four for a cubic).
void check_curve(const Curve& curve);
/// Length in the unit of the points: of a cubic by adaptive Gauss quadrature, to rounding where it has no cusps. The
/// curve must pass check_curve.
double curve_length(const Curve& curve);
/// Points on the curve in order, for drawing: a polyline's own, `per_span` a span of a cubic and its end.
Points curve_samples(const Curve& curve, int per_span);

} // namespace sinew::solver
