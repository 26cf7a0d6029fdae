// Scenes in which pressure or tension acts on the surface of a tissue.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/primitives.h"
#include "solver/meshing/lattice.h"
#include "solver/term/layered_surfaces.h"
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
    using namespace solver;
    const SurfaceMesh sphere = make_sphere(radius, subdivisions, subdivisions);
    auto t = std::make_shared<TissueRest>();
    t->surface = sphere.points;
    t->triangles = sphere.triangles;
    LatticeOptions options;
    options.tet_size = tet_size;
    options.moments = kind == ElementKind::quadratic ? 4 : 1;
    t->tets = make_lattice(t->surface, t->triangles, options);
    t->embedding = embed(t->tets, t->surface);
    t->law = law;
    t->element = kind;
    t->layer_weights = {std::vector<double>(t->tets.tets.size(), 1.0)};
    return t;
}

} // namespace sinew::test
