// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/layer_border.h"

#include "solver/meshing/layer_place.h"
#include "solver/meshing/tet_fitting.h"

#include <algorithm>

namespace sinew::solver {

FittedTets fit_to_borders(const TetMesh& tets, const std::vector<const Solid*>& places, const Points& surface,
                          const std::vector<Triangle>& triangles, const MeshingControl& control) {
    TetFitting fitting(tets, surface, triangles, control);
    std::vector<std::vector<BorderPatch>> patches;
    for (const Solid* place : places) {
        patches.push_back(border_patches(*place));
        for (std::size_t k = 0; k < patches.back().size() && fitting.is_sound(); ++k) {
            control.report(0, "fitting tets to layers");
            fitting.fit(patches.back()[k]);
        }
    }
    return fitting.result(patches);
}

std::vector<double> fitted_shares(const FittedTets& tets, std::size_t place_number, const Solid& place,
                                  const Points& surface, const std::vector<Triangle>& triangles,
                                  const MeshingControl& control) {
    std::vector<double> shares = layer_shares(tets.mesh, place, surface, triangles, control, tets.tissue.get());
    for (std::size_t t = 0; t < shares.size(); ++t) {
        const double slack = tets.slack[place_number][t];
        if (std::min(shares[t], 1 - shares[t]) <= slack) shares[t] = shares[t] < 0.5 ? 0 : 1;
    }
    return shares;
}

} // namespace sinew::solver
