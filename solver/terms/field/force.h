// What a field does at one point: force, exact tangent, and the energies that a line search compares.
//
// SPDX-License-Identifier: GPL-3.0-or-later
//
// With d the distance from the field's place, n the attenuation and r the reference distance, w(d) = 1 up to r and
// (r/d)^n beyond; with a maximum distance m it goes down to 0 between 0.8 m and m as u^2 (3 - 2u), u = (m - d)/(0.2 m).
// M is the magnitude, e the direction as a unit vector:
//   uniform, gravity   M w e
//   air                M w (e - v/U), U the air's speed: M on matter at rest, 0 on what moves with the air;
//                      with one component only M w max(0, 1 - e.v/U) e
//   drag               -M w min(1, |v|/s) v, s the speed below which it weakens; with a direction of e.v e for v
//   newton, radial     M w times the unit vector from the place, newton's with a minus; within r linear in d
//   vortex             M w times the unit vector around the axis; distances from the axis; within r linear in d
//   turbulence         M w times noise of root mean square 1, of (x - place)/wavelength + phase and of evolution
//   volume axis        in a sphere or cylinder M times the sum of directions away from centre and axis, along and
//                      around it, and e; q = distance from centre (sphere) or axis over the radius:
//                      times (1 - q)^n, inverted q^n, and down to 0 in the last fifth before the border
#pragma once
#include "solver/terms/field/values.h"
#include "solver/types.h"

#include <span>

namespace sinew::solver {

/// A field at one time. `rest` must outlive it.
struct FieldAt {
    const FieldRest* rest = nullptr;
    FieldValues values;
    Vec3 place = Vec3::Zero(), direction = Vec3::Zero(), axis = Vec3::Zero(); ///< unit vectors

    /// Force per mass instead of volume.
    bool by_mass() const { return rest->kind == FieldKind::gravity || rest->kind == FieldKind::newton; }
    /// Depends on velocity: a coefficient times the gradient of a convex function of it.
    bool resists() const { return rest->kind == FieldKind::air || rest->kind == FieldKind::drag; }
    /// The strength depends on the place.
    bool varies() const { return values.attenuation != 0 || rest->use_max_distance; }
    /// Has a potential: newton, radial, and what is the same everywhere.
    bool is_conservative() const;
    /// The force is the same for all places and velocities.
    bool is_constant() const { return is_conservative() && !is_central(); }
    bool is_central() const { return rest->kind == FieldKind::newton || rest->kind == FieldKind::radial; }
};

/// From the numbers of a part. Throws Error FE304 where a direction is zero or a number out of range.
FieldAt field_at(const FieldRest& rest, std::span<const double> numbers);

/// Force density at place x [m] and velocity v [m/s]: [N/m^3], or [m/s^2] of a field by mass.
Vec3 field_force(const FieldAt& field, const Vec3& x, const Vec3& v);
/// d force / d x, where v = velocity_factor x + something.
Mat3 field_tangent(const FieldAt& field, const Vec3& x, const Vec3& v, double velocity_factor);

/// Of a conservative field: potential at x less that at `from` [J/m^3 or J/kg]; its gradient is minus the force.
double field_potential(const FieldAt& field, const Vec3& x, const Vec3& from);
/// Size of the numbers that this is the difference of.
double field_potential_scale(const FieldAt& field, const Vec3& x);
/// Of a field that resists: force = -resistance(x) d dissipation(v)/dv.
double field_resistance(const FieldAt& field, const Vec3& x);
double field_dissipation(const FieldAt& field, const Vec3& v);

} // namespace sinew::solver
