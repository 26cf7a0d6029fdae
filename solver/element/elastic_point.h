// What one integration point of a tet contributes, in closed form for any law in principal stretches: a linear tet with
// the given corners and a share of the volume. A linear tet is one such point; a quadratic one is four, each with
// corners that its ten nodes give (quadratic_tets.h).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/tet_batch.h"
#include "solver/fiber/active_stress.h"
#include "solver/integrate/strain_reference.h"
#include "solver/scene.h"

#include <span>

namespace sinew::solver {

/// Moduli of a batch's tets [Pa].
struct TetModuli {
    double mu[lanes], lambda[lanes], compression[lanes]; ///< taken at every point
    /// Taken on means: lambda_mean on the law's measure of volume over the tet, volume on J over the tet or patch.
    double lambda_mean[lanes], volume[lanes];
};

/// Fibre direction and (stiffness across / along)^(1/4) of a batch's tets, for the anisotropic law.
struct Anisotropy {
    double direction[3][lanes], root[lanes];
};

/// Derivatives of the energies on means by the measure and by J [Pa], as fixed numbers at this point.
struct Pressures {
    Pack measure, j;
};

struct PointInputs {
    LawInUse law;
    const TetBatch& batch;
    const TetModuli& moduli;
    double share = 1;                       ///< of the tet's volume
    const Anisotropy* anisotropy = nullptr; ///< law anisotropic only
    const Pressures* pressures = nullptr;
    double viscosity = 0; ///< of damping: this times mu and lambda act on E - E_ref (material/viscosity.h)
    const double* reference_strain = nullptr; ///< E_ref, [component of list_strain][lane]
    std::span<const ActiveFiber> fibers = {};
};

struct ElementSummary {
    double energy[lanes];        ///< [J]
    double j[lanes];             ///< det F; the least over the points
    double fiber_squares[lanes]; ///< sum of squared fibre forces [N^2]: they may cancel the elastic ones within a tet
};

/// Doubles that the reference strain of one point takes.
inline constexpr int strain_size = 6 * lanes;
/// E_ref of a point, out[component of list_strain][lane], from the corners of its linear tet, where the reference looks
/// at these times, and their velocities.
void reference_strain(const TetBatch& batch, const StrainReference& reference, const Corners& x,
                      const Corners& x_between, const Corners& v, double* out);

/// dE/d corners, g[corner][component][lane] [N], without the energies on means.
void point_gradient(const PointInputs& in, const Corners& corners, double* g, ElementSummary& summary);
/// d2E/d corners2, h[block of block_pairs][row*3+column][lane] [N/m]. `project`: clamped to positive semi-definite.
void point_hessian(const PointInputs& in, const Corners& corners, bool project, double* h);

/// The law's measure of volume (tr E for StVK, J - 1, ln J, tr S - 3), J, and their gradients by the corners.
struct PointMeasures {
    Pack measure, j, d_measure[4][3], d_j[4][3];
};
/// `with_measure` false leaves the measure out, and with it the singular values.
void point_measures(LawInUse law, const TetBatch& batch, const Corners& corners, bool with_measure, PointMeasures& out);

/// First Piola-Kirchhoff stress and energy density of one deformation gradient (row-major), for tests and users.
/// `direction` and `transverse` for the anisotropic law only.
void elastic_stress(ElasticLaw law, double mu, double lambda, double compression, const double* f, double* p,
                    double* energy, const double* direction = nullptr, double transverse = 1);

} // namespace sinew::solver
