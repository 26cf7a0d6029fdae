// A body as contact sees it: points that are tested, triangles that they are tested against, and what both ride on.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/carried_surface.h"
#include "solver/terms/contact/contact_rest.h"

namespace sinew::solver {

/// Immutable. Its triangles are cut to the spacing, and their corners are the points that are tested.
class CollisionBody : public CarriedSurface {
  public:
    /// Throws Error FE232 if the spacing asks for more than 4 million triangles.
    CollisionBody(const Scene& scene, int body, const ContactRest& rest);

    bool is_cloth() const { return has_two_sides_; }
    /// Whether a place of a triangle, zeros in it say that it is on an edge or a vertex, is at the rim of the surface.
    bool is_at_rim(int triangle, const Vec3& place) const;
    /// What carries a point, by number: a set of vertices, such as those of a tet. -1 for bones.
    int carrier(int point) const { return carriers_of_point_[at(point)]; }
    /// Likewise of the corners of a triangle; empty for bones.
    std::span<const int> carriers_at(int triangle) const { return carriers_at_[at(triangle)]; }
    int carrier_count() const { return static_cast<int>(carrier_vertices_.size()); }
    std::span<const int> carrier_vertices(int carrier) const { return carrier_vertices_[at(carrier)]; }
    /// Of each point the triangles that are nearer than `apart` to it as modelled, by a corner, but not along the
    /// surface: what of the surface is as near does not connect them. Sorted. Other parts of a body that lie beside
    /// each other at rest, such as the coils of a spring, are far from each other in this sense, the two sides of an
    /// edge are not.
    std::vector<std::vector<int>> elsewhere(double apart) const;
    /// Areas that points stand for, a third of that of the triangles about each [m^2]; of bones where they are now.
    void areas(const Points& places, std::vector<double>& out) const;
    /// The area that a point stands for as a surface of this outward normal sees it: what looks the other way, like
    /// the sides of a box that stands on it, does not count [m^2]. Where all looks past it, as where a flat floor's
    /// point has come in through a side of the box, what looks one way counts, by `past`, 0 to 1: else energy would
    /// vanish where the nearest place goes from the box's bottom to its side, and a box that leans would be pushed
    /// along. Where all looks away a twentieth counts. A cloth looks to both sides.
    double facing_area(int point, const Vec3& normal, double past, double whole, const Points& places) const;

  private:
    void find_carriers();
    bool has_two_sides_; ///< a cloth
    std::vector<int> carriers_of_point_;
    std::vector<std::vector<int>> carriers_at_, carrier_vertices_;
    std::vector<double> modelled_areas_; ///< of triangles
    std::vector<double> rest_areas_;     ///< of bodies that deform
};

} // namespace sinew::solver
