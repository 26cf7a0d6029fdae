// Where a force on a body's volume is taken: points that the vertices carry, with the volume and mass that lie there.
// Linear tets: the vertices themselves, with what is lumped on them, as inertia and gravity have it. Quadratic ones:
// the four points of elasticity (degree 2), because what lies on their corners is negative, and drag there would drive.
// Of tets that are solid in part the part inside counts, where it lies. On cloth: its vertices, with the area in place
// of a volume.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/mass_matrix.h"
#include "solver/term/term.h"

namespace sinew::solver {

class VolumePoints {
  public:
    /// The points of these bodies, tissues and cloth, one after the other.
    VolumePoints(const Scene& scene, const std::vector<int>& bodies);

    struct OfBody {
        const TissueBatches* tissue; ///< null: a cloth
        int body;
        std::size_t deformable;
        std::size_t first, count; ///< points
    };
    const std::vector<OfBody>& bodies() const { return bodies_; }
    std::size_t count() const { return bodies_.empty() ? 0 : bodies_.back().first + bodies_.back().count; }

    void add_couplings(Couplings& couplings) const;
    /// Finds where the Hessian's entries go. The pattern must outlive this.
    void bind(const BlockPattern& pattern);
    /// What lies at each point of what lies in the tets: `of_tet` by slots of all batches; of points of cloth nothing
    /// is changed. After bind.
    void share_out(const std::vector<double>& of_tet, std::vector<double>& of_point);
    /// What the vertices carry to a point, of 3 numbers a vertex: its place, or its velocity.
    Vec3 carried(std::size_t point, const std::vector<double>& of_vertices) const;
    /// Adds forces at the points [N] to those at the vertices, 3 numbers each.
    void add_to_vertices(const std::vector<Vec3>& at_points, std::vector<double>& at_vertices) const;
    /// Adds to the Hessian what symmetric stiffnesses at the points [N/m] make of it.
    void add_to_hessian(const std::vector<Mat3>& at_points, BlockMatrix& a) const;

  private:
    void add(const TissueBatches& tissue);
    bool is_quadratic(const OfBody& b) const { return b.tissue && b.tissue->kind == ElementKind::quadratic; }
    int vertex(const OfBody& b, std::size_t tet, int node) const {
        return system_.node(*b.tissue, tet / lanes, node)[tet % lanes];
    }

    using Shapes = std::array<std::array<double, quadratic_nodes>, quadratic_points>;
    /// Shape functions at the points of a quadratic tet, named by a fourth of its first point.
    const Shapes& shapes(std::size_t tet) const { return shapes_[static_cast<std::size_t>(shapes_of_[tet])]; }

    const Scene::System& system_;
    std::vector<OfBody> bodies_;
    std::vector<Shapes> shapes_; ///< those of whole tets, then those of cut ones
    std::vector<int> shapes_of_; ///< per quadratic tet
    /// Quadratic: tets that meet at each vertex of a body, as 10 tet + node, in fixed order.
    std::vector<std::vector<int>> tet_start_, tets_;
    /// Quadratic: element pairs that meet at each block of the pattern, as 55 t + pair; the tet's points start
    /// at 4 t.
    std::vector<int> pair_start_, pairs_;
    const BlockPattern* pattern_ = nullptr;
    MassMatrix lumped_;
};

} // namespace sinew::solver
