// A tissue in zTet's lattice, whose tets reach beyond its surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/embedding.h"
#include "solver/mesh/primitives.h"
#include "solver/meshing/lattice.h"
#include "solver/scene.h"

#include <memory>
#include <vector>

namespace sinew::test {

inline std::shared_ptr<solver::TissueRest> lattice_tissue(const solver::SurfaceMesh& surface, double tet_size,
                                                          solver::ElasticLaw law, solver::ElementKind kind) {
    auto t = std::make_shared<solver::TissueRest>();
    t->surface = surface.points;
    t->triangles = surface.triangles;
    solver::LatticeOptions options;
    options.tet_size = tet_size;
    options.moments = kind == solver::ElementKind::quadratic ? 4 : 1;
    t->tets = solver::make_lattice(t->surface, t->triangles, options);
    t->embedding = solver::embed(t->tets, t->surface);
    t->law = law;
    t->element = kind;
    t->layer_weights = {std::vector<double>(t->tets.tets.size(), 1.0)};
    return t;
}

} // namespace sinew::test
