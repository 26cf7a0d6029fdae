// Smooth extension of painted surface values into the volume, on the tets that the simulation uses.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/embedding.h"
#include "solver/mesh/paint_samples.h"

#include <vector>

namespace sinew::solver {

/// Which values the extension may take at the tet vertices.
enum class HarmonicRange {
    painted, ///< within [min, max] of the painted values, so weights stay weights
    free     ///< vertices outside the solid may lie beyond, so that gradients are right up to the border
};

/// Harmonic (Laplace) extension: minimises the coverage-weighted Dirichlet energy subject to the painted
/// values at the embedded surface points. The values are met exactly where the mesh can; where several points
/// in one tet ask for more than it can give, their area-weighted squares of errors are least. With
/// HarmonicRange::painted the result is then cut off at the bounds and relaxed within them, so maps take one
/// factorisation whether bounds bite or not; where they do, the map is flattened towards them over a tet's width, an
/// error of first order. Parts of the mesh without a painted point take the value of the nearest painted point. A
/// point's influence shrinks with the tets about it: paint that stands for an area is given by a PaintedSurface, below.
/// Direct solve, the same bits on every run.
/// \param areas   weight of each point [m^2]
/// \param values  one per embedded point
/// \param painted which of the points are prescribed; the others are free
/// \return one value per vertex of the tet mesh
/// Throws Error FE204 (sizes), FE202 (a painted value is not finite), FE212 (no point is painted), FE215 (a tet without
/// volume).
std::vector<double> harmonic_extension(const TetMesh& mesh, const Embedding& surface, const std::vector<double>& areas,
                                       const std::vector<double>& values, const std::vector<char>& painted,
                                       HarmonicRange range = HarmonicRange::painted);
/// Several maps over the same painted points with one factorisation: maps[k][point] -> result[k][vertex].
std::vector<std::vector<double>> harmonic_extensions(const TetMesh& mesh, const Embedding& surface,
                                                     const std::vector<double>& areas,
                                                     const std::vector<std::vector<double>>& maps,
                                                     const std::vector<char>& painted,
                                                     HarmonicRange range = HarmonicRange::painted);
/// The same for paint that is linear on each triangle with three painted corners, however small the tets are
/// (paint_samples.h): maps[k][vertex of the surface] -> result[k][vertex of the tets]. A vertex none of whose
/// triangles is painted whole counts as a point.
std::vector<std::vector<double>> harmonic_extensions(const TetMesh& mesh, const PaintedSurface& surface,
                                                     const std::vector<std::vector<double>>& maps,
                                                     const std::vector<char>& painted,
                                                     HarmonicRange range = HarmonicRange::painted);
/// Mean of a per-vertex field over what is solid of each tet.
std::vector<double> tet_means(const TetMesh& mesh, const std::vector<double>& per_vertex);
/// Unit gradient per tet of a per-vertex field; zero vectors where the gradient vanishes (is less than 1e-9
/// of the largest). Throws Error FE215 (a tet without volume).
Points unit_gradients(const TetMesh& mesh, const std::vector<double>& per_vertex);

} // namespace sinew::solver
