// Rest shapes towards targets: a tissue of which other shapes are given is at rest in a blend of them. Each target says
// of every tet how it is stretched there: F = R U from the model, of which the turn R means nothing for a material and
// the stretch U is all. Targets blend by their logarithms,
//   U = exp(sum over the targets of weight x paint x log U_k),
// so that a weight of 1 gives the target, 0 the model, -1 the reciprocal; that volumes multiply, and half of a change
// done twice is the whole of it; that no blend of whatever weights turns a tet inside out, as one of positions or of
// Green's strains can; and that a uniform scale blends as restScale does (Hencky strain: Neff et al. 2016).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/fields.h"
#include "solver/mesh/paint_samples.h"
#include "solver/scene.h"
#include "solver/step_inputs.h"
#include "solver/term/type.h"

#include <array>
#include <span>
#include <vector>

namespace sinew::solver {

/// The static part of one target. The part acts on one body, a tissue.
struct RestShape final : PartRest {
    std::vector<std::array<double, 6>> strains; ///< per tet: paint x log U; xx, yy, zz, yz, zx, xy
    double largest = 0;                         ///< of the principal ones, either way
};

struct RestShapeValues {
    double weight = 0;
    static constexpr auto fields() {
        using T = RestShapeValues;
        return std::to_array<Field<T>>({{"targetWeight", "1", &T::weight}});
    }
};

/// No force of its own: the tets' rest shapes change (rest_change.h).
extern const TermType rest_shape_type;

/// The vertices of the tets where their surface has taken the shape `target` (a point for each of the surface's): the
/// affine map that fits it best, which is met exactly, and what is left of it extended harmonically. Any unit of
/// length. Throws Error as harmonic_extensions does.
Points carried_to_target(const TetMesh& mesh, const PaintedSurface& surface, const Points& target);
/// \param target vertices of the mesh's tets in the target shape
/// \param paint per tet, 0…1
/// Throws Error FE286 where painted tets are flat or inside out in the target.
RestShape make_rest_shape(const TetMesh& mesh, const Points& target, const std::vector<double>& paint);

/// The targets of a tissue, with their weights at one time.
struct RestShapes {
    std::vector<const RestShape*> shapes;
    std::vector<double> weights;
    /// Whether any of them acts.
    bool act() const;
    /// U of a tet.
    Mat3 stretch(std::size_t tet) const;
};
RestShapes rest_shapes_of(const Scene& scene, int body, std::span<const PartValues> values);
/// The same into what is there, without new memory where it has been as many before.
void find_rest_shapes(const Scene& scene, int body, std::span<const PartValues> values, RestShapes& out);
/// Throws Error FE247 where lengths at rest could become more than a thousand times larger or smaller.
void check_rest_shapes(const RestShapes& shapes);

} // namespace sinew::solver
