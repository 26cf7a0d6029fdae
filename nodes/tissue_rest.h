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
/// are fitted to the borders of layers. 7: fibres follow a field on smaller tets. 9: paint is that of the
/// solid part of each tet. 10: as many fibres begin on each piece of an end.
constexpr int tissue_numerics = 10;

/// What is noticed of a tissue's parts, each in the order of BodyRest::parts.
struct FoundParts {
    std::vector<double> inside; ///< share of the part's own volume that lies in the tissue
    /// Share of the part's volume that another part beside it holds as well, or that lies outside of the part it is in.
    std::vector<double> shared;
};

/// The rest data, and what its maker has to say.
struct MadeTissue {
    std::shared_ptr<const BodyRest> rest;
    FoundParts parts;
    std::vector<std::size_t> empty_places; ///< layers whose mesh holds nothing of the tissue, in order
    std::size_t outside = 0;               ///< vertices of the mesh outside of all tets
    /// Of these, such as no face has, and such as have faces with an open edge there, which enclose nothing.
    std::size_t without_face = 0, at_open_edges = 0;
    double farthest = 0; ///< of these from the tet that carries it, in widths of that tet
};

/// What the rest data is made from. References must outlive the call.
struct TissueParts {
    const Mesh* mesh = nullptr;
    const TetMeshValue* tets = nullptr; ///< nullptr: the default lattice
    solver::ElasticLaw law = solver::ElasticLaw::stvk;
    std::vector<std::reference_wrapper<const Material>> materials; ///< painted maps fit the mesh (adapters.h)
    std::vector<std::reference_wrapper<const Fiber>> fibers;       ///< and both ends are painted
    std::vector<std::shared_ptr<const Subtissue>> subtissues = {}; ///< directly within the tissue
};

/// A tissue's parts, those within parts too, a part before those within it.
struct NestedPart {
    const Subtissue* part;
    int within = -1;     ///< place in this list; -1: directly in the tissue
    std::size_t top = 0; ///< which of the tissue's direct parts it is or lies in
};
std::vector<NestedPart> nested_parts(const std::vector<std::shared_ptr<const Subtissue>>& direct);

engine::Digest static_digest(const TissueParts& parts);
/// `control` watches the making of the default lattice. Throws solver::Error FE2xx, solver::Stopped.
MadeTissue make_tissue_rest(const TissueParts& parts, const solver::MeshingControl& control = {});

} // namespace sinew::nodes
