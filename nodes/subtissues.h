// What zTissue and zSubtissue have in common: layers and fibres painted on a mesh, and the parts within.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/node_type.h"
#include "nodes/painted_volume.h"
#include "nodes/tissue_rest.h"

#include <functional>
#include <string_view>
#include <vector>

namespace sinew::nodes {

inline const engine::WireList<Body> subtissues{
    .name = "subtissues",
    .doc = "Parts inside of it with materials and fibres of their own, each a zSubtissue. They may be connected to "
           "zSolver.bodies as well, for their meshes.",
};

/// The connected parts. Fails with FE228 where one is no zSubtissue, or is within another one already; FE213 where one
/// is connected twice.
std::vector<std::shared_ptr<const Subtissue>> read_subtissues(const engine::Reads& in);

/// Fails with FE206 where there is no layer, FE204 where a map does not fit the mesh.
void check_layers(const engine::Reads& in, std::string_view attribute,
                  const std::vector<std::reference_wrapper<const Material>>& layers, const Mesh& mesh);
/// Fails with FE204 where a map does not fit the mesh, FE205 where a fibre has no end points and no direction.
void check_fibers(const engine::Reads& in, std::string_view attribute,
                  const std::vector<std::reference_wrapper<const Fiber>>& fibers, const Mesh& mesh);

/// Of a part alone, without those within it.
engine::Digest static_digest(const Subtissue& part);
/// A part's values as the tissue takes them, without its fibres, which stand among the tissue's.
solver::SubtissueInputs part_inputs(const Subtissue& part);

/// The lines of action among fibres, by their places.
std::vector<FiberLine> lines_of(const std::vector<std::reference_wrapper<const Fiber>>& fibers);

/// Fails with FE229 where nothing of a part lies in the tissue, warns where more than a little lies outside or is
/// shared with another part (FE249).
void warn_of_parts(const engine::Reads& in, const std::vector<NestedPart>& nested, const FoundParts& found);

/// Fails with FE228 where the body is a subtissue, which has no tets for what `whose` does.
void refuse_subtissue(const engine::Reads& in, std::string_view attribute, const Body& body, const std::string& name);

} // namespace sinew::nodes
