// The scene's numbering and element batches: derived from the description once, read by the potential.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/linear_tets.h"
#include "solver/fiber/active_stress.h"
#include "solver/scene.h"

namespace sinew::solver {

/// The batches of one tissue.
struct TissueElements {
    int body = -1;
    ElasticLaw law = ElasticLaw::stvk;
    std::size_t first_batch = 0, batch_count = 0, tet_count = 0;
    std::vector<std::vector<FiberBatch>> fibers; ///< [fibre field][batch within the tissue]
};

struct Scene::System {
    std::vector<TetBatch> batches;
    std::vector<TissueElements> tissues;
    std::vector<int> unknown;           ///< per vertex: its row among the unknowns; -1 if it is held fixed
    std::vector<int> vertex_of_unknown; ///< the inverse
    std::vector<double> rest;           ///< rest positions, 3 a vertex [m]
    /// Element corners that meet at each unknown, in fixed order: slot = (batch * 4 + corner) * lanes + lane.
    std::vector<int> corner_start, corners;
};

} // namespace sinew::solver
