// Scenes in which pressure or tension acts on the surface of a tissue.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/primitives.h"
#include "solver/term/layered_surfaces.h"
#include "tests/support/lattice_tissue.h"
#include "tests/support/solver_scenes.h"

namespace sinew::test {

/// A force on the surface of one body: its value in each layer, with painted weights where they are not 1 everywhere.
inline solver::Part on_surface(const solver::TermType& type, int body,
                               std::vector<solver::SurfaceLayers::Layer> layers) {
    auto rest = std::make_shared<solver::SurfaceLayers>();
    rest->layers = std::move(layers);
    return {&type, {body}, rest};
}

/// A ball of the lattice: its tets reach beyond its surface.
inline std::shared_ptr<solver::TissueRest> lattice_ball(double radius, double tet_size, solver::ElasticLaw law,
                                                        solver::ElementKind kind, int subdivisions = 12) {
    return lattice_tissue(solver::make_sphere(radius, subdivisions, subdivisions), tet_size, law, kind);
}

} // namespace sinew::test
