// The static part of a tissue: tets, embedding, layer maps and fibre directions, made from meshes and painted
// maps. Knows no values that are keyed (stiffness, excitation), so that keying them never meshes anew.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/values.h"
#include "solver/meshing/meshing_control.h"

#include <functional>
#include <memory>
#include <vector>

namespace sinew::nodes {

/// Raised when the same parts give rest data with other bits; part of the digest below, and zTissue's `numerics`.
/// 3: paint holds on triangles, not only at vertices, where they are larger than the tets. 4: maps and fibre
/// directions are solved for by supernodal Cholesky. 5: the default lattice knows the moments of what it cuts. 6: tets
/// are fitted to the borders of layers.
constexpr int tissue_numerics = 6;

/// The rest data, and what its maker has to say.
struct MadeTissue {
    std::shared_ptr<const BodyRest> rest;
    std::vector<std::size_t> empty_places; ///< layers whose mesh holds nothing of the tissue, in order
    std::size_t outside = 0;               ///< vertices of the mesh outside of all tets
    double farthest = 0;                   ///< of these from the tet that carries it, in widths of that tet
};

/// What the rest data is made from. References must outlive the call.
struct TissueParts {
    const Mesh* mesh = nullptr;
    const TetMeshValue* tets = nullptr; ///< nullptr: the default lattice
    solver::ElasticLaw law = solver::ElasticLaw::stvk;
    std::vector<std::reference_wrapper<const Material>> materials; ///< painted maps fit the mesh (adapters.h)
    std::vector<std::reference_wrapper<const Fiber>> fibers;       ///< and both ends are painted
};

/// Painted fibre ends: up to 0.1 the source, from 0.9 on the sink.
bool is_source(double end_point);
bool is_sink(double end_point);

engine::Digest static_digest(const TissueParts& parts);
/// `control` watches the making of the default lattice. Throws solver::Error FE2xx, solver::Stopped.
MadeTissue make_tissue_rest(const TissueParts& parts, const solver::MeshingControl& control = {});

} // namespace sinew::nodes
