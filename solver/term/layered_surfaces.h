// Surfaces of tissues cut to the size of their tets, with a value painted on them in layers: what pressure and surface
// tension act on.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/part.h"
#include "solver/term/stencils.h"
#include "solver/term/type.h"

#include <array>
#include <memory>
#include <vector>

namespace sinew::solver {

/// What the material layers of a tissue give a value on its surface, from bottom to top. Composited as the material is,
/// but at the surface's vertices: M_n = a m_n + (1 - a) M_(n-1) with a = envelope of the layer x painted weight; the
/// first layer covers all.
struct SurfaceLayers final : PartRest {
    struct Layer {
        double value = 0;
        std::vector<double> weights; ///< per vertex of the surface; one = for all, none = 1
    };
    std::vector<Layer> layers; ///< as many as the tissue has
};

/// All parts of one type. Each acts on one tissue, keeps SurfaceLayers, and has one value: an envelope that multiplies
/// what the layers give.
class LayeredSurfaces {
  public:
    /// Throws Error FE204 (body set) if a map does not fit its surface, FE232 if there are too many triangles.
    LayeredSurfaces(const Scene& scene, const TermType& type);
    /// Whether the scene has a part of the type whose value is not zero everywhere.
    static bool used(const Scene& scene, const TermType& type);

    /// Takes a step's values. False: they are those of the last time.
    bool take(const StepInputs& inputs);
    /// Per point; linear between the vertices of the triangle that was cut.
    const std::vector<double>& values() const { return values_; }
    bool all_zero() const { return all_zero_; }

    Stencils<3>& triangles() { return *triangles_; }
    const Stencils<3>& triangles() const { return *triangles_; }
    /// Place of each point's body among the deformables.
    const std::vector<std::size_t>& deformable() const { return deformable_; }
    /// One in so many triangles is enough to show what acts: some hundreds in all.
    std::size_t shown_step() const { return triangles_->count() / most_shown + 1; }
    /// Of the scene's parts: the one that acts on a point.
    int part(int point) const { return part_[at(point)]; }
    /// Of the points, 3 each [m].
    const std::vector<double>& rest() const { return rest_; }
    /// Adds to each deformable's the sum of squares of size(triangle).
    template <class Size>
    void add_squares(const Size& size, std::span<double> of_deformables) const {
        for (std::size_t t = 0; t < triangles_->count(); ++t) {
            const double s = size(t);
            of_deformables[deformable_[at(triangles_->corners(t)[0])]] += s * s;
        }
    }

  private:
    static constexpr std::size_t most_shown = 600;
    struct Surface {
        int body;
        std::size_t part; ///< of the scene's
        std::size_t first_point, point_count;
    };
    struct Place {
        Triangle vertices; ///< of the surface
        Vec3 coordinates;
    };
    struct Building;
    void add_surface(std::size_t part, Building& building);

    const Scene& scene_;
    std::vector<Surface> surfaces_;
    std::vector<Place> places_; ///< per point
    std::vector<std::size_t> deformable_;
    std::vector<int> part_; ///< per point
    std::vector<double> rest_, values_;
    std::unique_ptr<Stencils<3>> triangles_;
    std::vector<double> taken_, wanted_, of_vertices_; ///< the envelopes that values_ were made with; scratch
    bool all_zero_ = true;
};

} // namespace sinew::solver
