// A body as contact sees it: points that are tested, triangles that they are tested against, and what both ride on.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/index.h"
#include "solver/mesh/bvh.h"
#include "solver/scene.h"
#include "solver/terms/contact/contact_rest.h"

#include <span>
#include <utility>
#include <vector>

namespace sinew::solver {

/// A carrier's vertex and its weight.
struct RideTerm {
    int vertex;
    double weight;
};

/// Immutable. Its triangles are those of the body's surface, cut to the spacing and, on a tissue's own surface, to the
/// size of its tets; their corners are the points that are tested, the surface's vertices first. What carries them are
/// the scene's vertices where the body deforms, else the vertices of the bone.
class CollisionBody {
  public:
    /// Throws Error FE232 if the spacing asks for more than 4 million triangles.
    CollisionBody(const Scene& scene, int body, const ContactRest& rest);

    int body() const { return body_; }
    bool deforms() const { return deforms_; }
    std::size_t point_count() const { return first_term_.size() - 1; }
    const std::vector<Triangle>& triangles() const { return triangles_; }
    std::span<const RideTerm> ride(int point) const {
        return {terms_.data() + first_term_[at(point)],
                static_cast<std::size_t>(first_term_[at(point) + 1] - first_term_[at(point)])};
    }
    /// Of `carriers`, 3 numbers a vertex, those of the vertices that carry the body.
    std::span<const double> own(const double* carriers) const {
        return {carriers + 3 * carrier_range_.first, 3 * carrier_range_.second};
    }
    /// Where a point is. `carriers`: 3 numbers a vertex of what carries it.
    Vec3 place(int point, const double* carriers) const {
        Vec3 p = Vec3::Zero();
        for (const RideTerm& t : ride(point)) p += t.weight * Eigen::Map<const Vec3>(carriers + 3 * at(t.vertex));
        return p;
    }
    std::array<Vec3, 3> corners(int triangle, const double* carriers) const {
        const Triangle& t = triangles_[at(triangle)];
        return {place(t[0], carriers), place(t[1], carriers), place(t[2], carriers)};
    }
    std::array<Vec3, 3> corners(int triangle, const Points& places) const {
        const Triangle& t = triangles_[at(triangle)];
        return {places[at(t[0])], places[at(t[1])], places[at(t[2])]};
    }
    /// What carries a point, by number: a set of vertices, such as those of a tet. -1 for bones.
    int carrier(int point) const { return carriers_of_point_[at(point)]; }
    /// Likewise of the corners of a triangle; empty for bones.
    std::span<const int> carriers_at(int triangle) const { return carriers_at_[at(triangle)]; }
    int carrier_count() const { return static_cast<int>(carrier_vertices_.size()); }
    std::span<const int> carrier_vertices(int carrier) const { return carrier_vertices_[at(carrier)]; }
    /// No point moves farther than this times the farthest of what carries it.
    double leverage() const { return leverage_; }
    /// Triangles at a point.
    std::span<const int> fan(int vertex) const {
        return {fans_.data() + fan_start_[at(vertex)],
                static_cast<std::size_t>(fan_start_[at(vertex) + 1] - fan_start_[at(vertex)])};
    }
    /// Areas that points stand for, a third of that of the triangles about each [m^2]; of bones where they are now.
    void areas(const Points& places, std::vector<double>& out) const;
    /// The area that a point stands for as a surface of this outward normal sees it: what looks the other way, like
    /// the sides of a box that stands on it, does not count; but at least a twentieth of all [m^2].
    double facing_area(int point, const Vec3& normal, double whole, const Points& places) const;
    const Points& modelled() const { return modelled_; } ///< of all points [m]
    const Vec3& modelled(int point) const { return modelled_[at(point)]; }
    const Bvh& bvh() const { return bvh_; }         ///< over the triangles as modelled
    double mean_edge() const { return mean_edge_; } ///< of the triangles as modelled [m]

  private:
    void find_carriers();
    int body_;
    bool deforms_;
    std::vector<Triangle> triangles_;
    Points modelled_;
    std::vector<int> first_term_;
    std::vector<RideTerm> terms_;
    std::vector<int> carriers_of_point_;
    std::vector<std::vector<int>> carriers_at_, carrier_vertices_;
    double leverage_ = 1;
    std::pair<std::size_t, std::size_t> carrier_range_; ///< first and count of the vertices that carry it
    std::vector<int> fan_start_, fans_;
    std::vector<double> modelled_areas_; ///< of triangles
    std::vector<double> rest_areas_;     ///< of bodies that deform
    Bvh bvh_;
    double mean_edge_ = 0;
};

/// Boxes of a body's triangles at one time.
class CollisionBoxes {
  public:
    /// Around the triangles where `carriers` are.
    void fit(const CollisionBody& body, const double* carriers);
    const Vec3& low() const { return low_; }
    const Vec3& high() const { return high_; }
    const std::vector<BvhNode>& nodes() const { return nodes_; }
    const Points& places() const { return places_; } ///< of all points

  private:
    Points places_;
    std::vector<BvhNode> nodes_;
    Vec3 low_ = Vec3::Zero(), high_ = Vec3::Zero();
};

} // namespace sinew::solver
