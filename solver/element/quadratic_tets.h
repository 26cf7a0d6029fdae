// Quadratic (P2, ten-node) tets with straight edges at rest: four integration points, each of which is a linear tet
// whose corners are weighted sums of the ten nodes. Tets that are solid in part have four points of their own
// (cut_rule.h). So the laws, the fibres and the projection are those of
// elastic_point.h. The part of the volumetric stiffness beyond lambda_mean and volumeConservation act on means over the
// tet, one condition a tet, so that nearly incompressible flesh does not lock.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/elastic_point.h"

#include <memory>

namespace sinew::solver {

inline constexpr int quadratic_nodes = 10, quadratic_pairs = 55, quadratic_points = 4;
/// Corners that each edge joins; node 4 + e lies in its middle.
inline constexpr int tet_edge_corners[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/// Barycentric coordinates of the four integration points of a whole tet: near at one corner, far at the others.
constexpr double usual_coordinate(bool near) { return near ? 0.58541019662496852 : 0.13819660112501051; }

/// Integration points of a batch that holds tets solid in part, by their barycentric coordinates.
struct PointPlaces {
    double coordinate[quadratic_points][4][lanes];
    bool outside[4][lanes]; ///< corners where there is no solid
    /// Springs between the middle of each edge and the mean of its ends, per modulus [m]: what holds the curved shapes
    /// of tets of which little is solid.
    double straightness[lanes];
};

/// Vertices at the middles of the edges of a batch's tets.
struct EdgeBatch {
    int vertex[6][lanes];
    std::shared_ptr<const PointPlaces> places = nullptr; ///< null: all tets are whole
};

/// Per tet the vertices at the middles of its edges: `first` plus their place in edges_of(tets).
std::vector<std::array<int, 6>> edge_vertices(const std::vector<Tet>& tets,
                                              const std::vector<std::array<int, 2>>& edges, int first);

/// Values of the ten shape functions at a point given by its barycentric coordinates.
void quadratic_shape(const double* barycentric, double* values);

/// E_ref at each of the points, out[point][component of list_strain][lane].
void quadratic_reference_strain(const TetBatch& batch, const EdgeBatch& edges, const StrainReference& reference,
                                double* out);

/// g[node][component][lane]; the summary's energy includes those on means if `means` (some of moduli.lambda_mean or
/// moduli.volume are not zero). `in.share` and `in.pressures` are not read;
/// `in.reference_strain` is that of all points.
void quadratic_gradient(const PointInputs& in, const EdgeBatch& edges, bool means, const double* x, double* g,
                        ElementSummary& summary);
/// h[pair (a, b), a <= b, rows of a][row*3+column][lane].
void quadratic_hessian(const PointInputs& in, const EdgeBatch& edges, bool means, const double* x, bool project,
                       double* h);

/// Least det F where each tet is solid: at its points and corners, where a bent tet folds first; of a tet that is solid
/// in part at points inside that part and at the corners in it.
void quadratic_least_j(const TetBatch& batch, const EdgeBatch& edges, const double* x, double* least);

} // namespace sinew::solver
