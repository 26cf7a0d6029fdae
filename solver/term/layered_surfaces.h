// Surfaces of tissues, cut along their tets, and of cloth, with a value painted on them in layers: what pressure and
// surface tension act on.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/quadratic_tets.h"
#include "solver/surface/clipped_surface.h"
#include "solver/term/carried_points.h"
#include "solver/term/part.h"
#include "solver/term/type.h"

#include <array>
#include <memory>
#include <vector>

namespace sinew::solver {

/// What the material layers of a tissue or cloth give a value on its surface, from bottom to top. Composited as the
/// material is, but at the surface's vertices: M_n = a m_n + (1 - a) M_(n-1) with a = envelope of the layer x painted
/// weight; the first layer covers all.
struct SurfaceLayers final : PartRest {
    struct Layer {
        double value = 0;
        std::vector<double> weights; ///< per vertex of the surface; one = for all, none = 1
    };
    std::vector<Layer> layers; ///< as many as the body has
};

/// All parts of one type. Each acts on one tissue or cloth, keeps SurfaceLayers, and has one value: an envelope that
/// multiplies what the layers give.
class LayeredSurfaces {
  public:
    struct Surface {
        int body;
        std::size_t deformable; ///< place of the body among the deformables
        std::size_t part;       ///< of the scene's
        std::size_t first_vertex, vertex_count;
        std::size_t first_triangle, triangle_count;
        ClippedSurface clipped; ///< pieces and triangles as numbered in the body; a cloth's triangles are its "tets"
        double envelope = 0;    ///< as taken
    };

    /// Throws Error FE204 (body set) if a map does not fit its surface, FE202 if it is not finite, FE232 if there are
    /// too many pieces.
    LayeredSurfaces(const Scene& scene, const TermType& type);
    /// Whether the scene has a part of the type whose value is not zero everywhere.
    static bool used(const Scene& scene, const TermType& type);

    struct Taken {
        bool envelopes = false; ///< of the parts
        bool values = false;    ///< what the layers give
    };
    /// Takes a step's values. Returns which are others than those of the last time.
    Taken take(const StepInputs& inputs);
    const std::vector<Surface>& surfaces() const { return surfaces_; }
    /// What the layers give, not yet multiplied by the envelope, at each vertex of all surfaces.
    const std::vector<double>& values() const { return values_; }
    /// The same at a place of a triangle of the tissue, linear between its corners.
    double value_at(const Surface& surface, int triangle, const Vec3& place) const;
    bool all_zero() const { return all_zero_; }
    /// Vertices of a tet of a surface's body: corners, then of a quadratic one the middles of edges (tet_edge_corners);
    /// of a cloth's triangle its corners.
    std::array<int, quadratic_nodes> nodes(const Surface& surface, int tet) const;
    /// How many those are.
    int node_count(const Surface& surface) const {
        const TissueRest* tissue = scene_.tissue(surface.body);
        return !tissue ? 3 : tissue->element == ElementKind::linear ? 4 : quadratic_nodes;
    }

    /// Of all surfaces as they were modelled.
    const std::vector<Triangle>& triangles() const { return triangles_; }
    std::size_t vertex_count() const { return values_.size(); }
    /// Where the vertices are for the tets' at x, 3 each.
    void move(const Positions& x, std::span<double> places) const { vertices_->move(x, places); }
    /// One in so many triangles is enough to show what acts: some hundreds in all.
    std::size_t shown_step() const { return triangles_.size() / most_shown + 1; }
    const Surface& surface_of(std::size_t triangle) const;

  private:
    static constexpr std::size_t most_shown = 600;

    const Scene& scene_;
    std::vector<Surface> surfaces_;
    std::vector<Triangle> triangles_;
    std::unique_ptr<CarriedPoints> vertices_;
    std::vector<double> values_;
    std::vector<double> taken_, wanted_; ///< envelopes of each part's layers
    bool all_zero_ = true;
};

} // namespace sinew::solver
