// The Dirichlet energy of fields that are linear in each tet, 1/2 sum c V |grad f|^2 with c the tet's coverage: what
// maps and fibres in the volume minimise.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"

#include <Eigen/SparseCore>

#include <vector>

namespace sinew::solver {

/// Its matrix, compressed, over the vertices with a number from 0 to count - 1; those with -1 are left out, which holds
/// them at 0. Throws Error FE215 (a tet without volume).
Eigen::SparseMatrix<double> dirichlet_matrix(const TetMesh& mesh, const std::vector<int>& number, int count);
/// The gradient in each tet of a field given by vertices; of a constant one exactly zero. Throws as dirichlet_matrix.
Points gradients_of(const TetMesh& mesh, const std::vector<double>& per_vertex);
/// Makes gradients unit vectors; those that are no longer than this share of the longest become zero.
void make_unit(Points& gradients, double least_share);
/// Number of the connected part (through shared vertices) that each vertex belongs to: its lowest vertex.
std::vector<int> connected_parts(const TetMesh& mesh);

} // namespace sinew::solver
