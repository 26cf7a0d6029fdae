// What a solver's bodies carry besides their shape: fibres, painted maps, attachments.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"
#include "nodes/marks.h"
#include "nodes/values.h"
#include "solver/terms/attachment/anchors.h"
#include "tools/viewer/view_data.h"

#include <functional>
#include <string>
#include <vector>

namespace sinew::viewer {

/// Gives a plug's value at the first frame.
using Puller = std::function<engine::Value(const engine::Plug&)>;

/// What is connected to an input, in order; empty where it is not connected.
std::vector<engine::Plug> connections(const engine::Graph& graph, const std::string& node, std::string_view attribute);

/// Fibre fields of the zTissue `node`, without excitations.
std::vector<ViewFibres> fibres_of(const engine::Graph& graph, const std::string& node,
                                  const solver::TissueRest& tissue);

/// What is painted on the body `node`: material and fibre weights, end points, attachment weights. Maps that
/// are the same everywhere are left out.
std::vector<ViewMap> maps_of(const engine::Graph& graph, const std::string& node, const Puller& pull);

/// Adds the marks of a solver, to groups of the same kind where there are some. `bodies`: of the scene, for each of the
/// solver's.
void add_marks(const nodes::MarkList& list, const std::vector<std::size_t>& bodies, std::vector<ViewMarks>& out);

struct ActingAttachment {
    std::string node;
    bool holds = true; ///< at the places that it found at the start frame; else it slides, or is off
};
/// The attachments that take part in `solver`, in the order of its anchors.
std::vector<ActingAttachment> acting_attachments(const engine::Graph& graph, const std::string& solver,
                                                 const nodes::Solved& solved, const Puller& pull);

/// Anchors in scene units, some hundreds evenly chosen where there are more; node and bodies are left for the caller.
ViewAttachment attachment_of(std::span<const solver::Anchor> anchors, const nodes::BodyRest& source,
                             const nodes::BodyRest& target, double units_per_metre);

} // namespace sinew::viewer
