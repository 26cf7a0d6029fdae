// What elements make of tets that the solid's surface cuts: where quadratic ones are integrated, and how the mass of
// the part inside lies on the nodes of both kinds.
//
// Nodes that hang on quadratic tets of which little is inside would hardly be held by anything, and shape functions
// that differ over the whole tet are alike over a small part of it. So such tets count for a little more than what is
// inside, at the points inside (affine motions of their nodes stay held), and weak springs keep their edges straight
// (which no affine motion bends, so rotations are free; an error of the order of the bend, like that of a penalty on
// the jump of gradients). Linear tets have least_coverage for the same. The mass of the whole tissue stays exact.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/cut_rule.h"
#include "solver/element/quadratic_tets.h"

#include <span>
#include <vector>

namespace sinew::solver {

/// Entries of a symmetric 10 x 10 matrix that are kept: its upper triangle, row by row.
constexpr std::size_t quadratic_mass_entries = 55;

/// The cut tets of one tissue.
struct CutElements {
    std::vector<int> tets;            ///< numbers in the tissue's mesh, increasing
    std::vector<double> share;        ///< of the tet's volume that counts as solid
    std::vector<FourPoints> points;   ///< quadratic tets only, as the next
    std::vector<double> straightness; ///< PointPlaces::straightness, for a tet of one volume per squared length
    /// Of tets of mass 1: linear ones the share of each corner; quadratic ones the consistent mass matrix.
    std::vector<double> mass;
    double mass_factor = 1; ///< on the density of all tets, so that the tissue weighs what its solid does
};

/// \param mesh cut.degree 4 if the element is quadratic
CutElements make_cut_elements(const TetMesh& mesh, ElementKind element);

/// Sets the volumes of cut tets in the batches of the tissue.
void set_cut_volumes(const TetMesh& mesh, const CutElements& cut, std::vector<TetBatch>& batches);
/// Gives points of their own to those batches of quadratic tets that hold cut ones.
void place_points(const TetMesh& mesh, const CutElements& cut, std::span<EdgeBatch> edges);

} // namespace sinew::solver
