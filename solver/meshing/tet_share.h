// How much of a tet lies inside a closed surface, exactly, from the triangles that cross the tet.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_moments.h"
#include "solver/meshing/solid.h"

#include <optional>
#include <vector>

namespace sinew::solver {

/// Corners of a triangle in the barycentric coordinates of a tet.
using BarycentricTriangle = std::array<Barycentric, 3>;

/// Whether the triangle comes within `slack` (in barycentric coordinates) of the closed tet.
bool touches_tet(const BarycentricTriangle& triangle, double slack);

/// A triangle touches a tet when it comes this near, in barycentric coordinates. Far above rounding, so that
/// a mesh aligned with a lattice touches on all sides alike.
constexpr double touch_slack = 1e-9;

/// Those of some triangles of a solid that touch a tet, in their order.
std::vector<int> touching_triangles(const Solid& solid, const std::array<Vec3, 4>& corners,
                                    const std::vector<int>& candidates);

/// What one triangle adds to the share of the tet that its surface encloses.
///
/// By the divergence theorem with the origin at a corner, the volume inside is a sum over the surface's
/// pieces in the tet and the piece of the opposite face that is inside; the area of that piece is a sum over
/// the segments in which the surface cuts the face and the piece of one edge that is inside; its length
/// follows from the points at which the surface cuts the edge and the winding number w of the edge's start.
/// So, for a closed surface,
///
///     share = w(reference corner) + sum over the triangles of share_of_triangle
///
/// is exact up to rounding: the integral of the winding number over the tet, per tet volume. Cuts are
/// computed from mesh vertices and edges in a way that neighbouring triangles repeat bit for bit, so no cut
/// is counted twice or lost.
///
/// Each term is the signed volume of a smaller tet (with the origin, with the edge's end …), so the same sum over
/// the integrals of a polynomial on these tets gives its integral inside: `moments`, where wanted, takes them.
double share_of_triangle(const BarycentricTriangle& triangle, int reference_corner, TetMoments* moments = nullptr);

/// Share of the tet inside the solid, whose surface must be closed. `triangles` are those that touch the tet.
/// Exact up to rounding where all the triangles separate the same two winding numbers (1 and 0 on an ordinary
/// surface); elsewhere, where parts cross, the tet is split three times into eight, and only small tets at
/// the crossing itself are approximate. `moments`, where wanted, takes the moments of the part inside, which are
/// as exact as the share; they start at zero, and count only where the share lies between 0 and 1.
double closed_share(const Solid& solid, const std::array<Vec3, 4>& corners, const std::vector<int>& triangles,
                    TetMoments* moments = nullptr);

/// closed_share where the winding number is 0 or 1 everywhere, whatever is known of the triangles: one integral and no
/// parts, as exact but for rounding.
double share_of_simple(const Solid& solid, const std::array<Vec3, 4>& corners, const std::vector<int>& triangles);

/// The winding numbers at corners of tets, whole; NaN on the surface, where they tell nothing. Corners that lie near to
/// each other cost less together.
/// \param edges the length of an edge at each
std::vector<double> corner_windings(const Solid& solid, const Points& corners, const std::vector<double>& edges);

/// closed_share of one among tets that share their corners: the winding numbers there, of corner_windings, are asked
/// once and not for every tet.
double closed_share(const Solid& solid, const std::array<Vec3, 4>& corners, const std::vector<int>& triangles,
                    const std::array<double, 4>& windings);

/// Share of the tet that is inside both of two closed solids, of each the triangles that touch the tet. Exact up to
/// rounding where the triangles of one of them all separate the same two winding numbers, and as exact as
/// closed_share of the other; elsewhere the tet is split as there. Surfaces may coincide.
double share_of_both(const Solid& a, const Solid& b, const std::array<Vec3, 4>& corners,
                     const std::vector<int>& triangles_a, const std::vector<int>& triangles_b);

/// closed_share of a surface with large holes, where the tet is so far from them that the winding number is
/// whole but for a fifth on both sides of all of the triangles and at the tet's corners, and none of the
/// triangles is at a border: then the solid ends at the triangles alone, and the share is exact. Nothing
/// elsewhere.
std::optional<double> share_away_from_holes(const Solid& solid, const std::array<Vec3, 4>& corners,
                                            const std::vector<int>& triangles, TetMoments* moments = nullptr);

} // namespace sinew::solver
