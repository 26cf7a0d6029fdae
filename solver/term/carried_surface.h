// The surface of a body and what it rides on: where its points are when what carries them has moved.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/embedded_point.h"
#include "solver/index.h"
#include "solver/mesh/bvh.h"
#include "solver/scene.h"

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace sinew::solver {

inline bool has_vertex(const Triangle& t, int vertex) { return t[0] == vertex || t[1] == vertex || t[2] == vertex; }

/// A carrier's vertex and its weight.
struct RideTerm {
    int vertex;
    double weight;
};

/// A surface in place of a body's own: where it was modelled, and what carries each of its vertices, by the tissue's
/// own vertex numbers.
struct SurfaceInPlace {
    const Points& points; ///< [m]
    const std::vector<Triangle>& triangles;
    const std::vector<PointWeights>& carriers;
};

/// Immutable. Its triangles are those of the body's surface, cut to a longest edge and, on a tissue's own surface, to
/// the size of its tets; their corners are its points, the surface's vertices first. What carries them are the scene's
/// vertices where the body deforms, else the vertices of the bone.
class CarriedSurface {
  public:
    /// \param longest_edge of the triangles [m]; 0: no limit.
    /// \param instead of the body's own surface.
    /// Throws Error FE232 if the longest edge asks for more than 4 million triangles.
    CarriedSurface(const Scene& scene, int body, double longest_edge,
                   const std::optional<SurfaceInPlace>& instead = {});

    int body() const { return body_; }
    bool deforms() const { return deforms_; }
    std::size_t point_count() const { return first_term_.size() - 1; }
    const std::vector<Triangle>& triangles() const { return triangles_; }
    /// Of which triangle of the whole surface each is a part.
    const std::vector<int>& parts_of() const { return parts_of_; }
    std::span<const RideTerm> ride(int point) const {
        return {terms_.data() + first_term_[at(point)],
                static_cast<std::size_t>(first_term_[at(point) + 1] - first_term_[at(point)])};
    }
    /// The same of what has unknowns or is held; empty for bones.
    std::span<const RideTerm> free_ride(int point) const {
        return deforms_ ? ride(point) : std::span<const RideTerm>();
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
    /// Adds what acts at every point to what carries it, 3 numbers a vertex; nothing where that is a bone.
    void add_to_carriers(const Points& at_points, double* by_vertices) const {
        for (std::size_t p = 0; deforms_ && p < point_count(); ++p) {
            if (at_points[p].isZero(0)) continue;
            for (const RideTerm& t : ride(static_cast<int>(p)))
                Eigen::Map<Vec3>(by_vertices + 3 * at(t.vertex)) += t.weight * at_points[p];
        }
    }
    /// No point moves farther than this times the farthest of what carries it.
    double leverage() const { return leverage_; }
    /// Triangles at a point.
    std::span<const int> fan(int vertex) const {
        return {fans_.data() + fan_start_[at(vertex)],
                static_cast<std::size_t>(fan_start_[at(vertex) + 1] - fan_start_[at(vertex)])};
    }
    const Points& modelled() const { return modelled_; } ///< of all points [m]
    const Vec3& modelled(int point) const { return modelled_[at(point)]; }
    const Bvh& bvh() const { return bvh_; }         ///< over the triangles as modelled
    double mean_edge() const { return mean_edge_; } ///< of the triangles as modelled [m]

  private:
    void make_triangles(const Scene& scene, double longest_edge, const std::optional<SurfaceInPlace>& instead);
    void make_search_tree();
    int body_;
    bool deforms_;
    std::vector<Triangle> triangles_;
    std::vector<int> parts_of_;
    Points modelled_;
    std::vector<int> first_term_;
    std::vector<RideTerm> terms_;
    double leverage_ = 1;
    std::pair<std::size_t, std::size_t> carrier_range_; ///< first and count of the vertices that carry it
    std::vector<int> fan_start_, fans_;
    Bvh bvh_;
    double mean_edge_ = 0;
};

/// Boxes of a surface's triangles at one time.
class SurfaceBoxes {
  public:
    /// Around the triangles where `carriers` are.
    void fit(const CarriedSurface& surface, const double* carriers);
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
