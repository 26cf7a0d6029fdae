// What `sinew check --meshes` says: the state of every mesh in a graph.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"
#include "solver/mesh/mesh_check.h"

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace sinew::cli {

/// One surface, or the tets of one plug with the check of their boundary.
struct MeshReport {
    std::string name;  ///< "node.output", or a file
    engine::Plug plug; ///< empty for a file
    std::size_t vertices = 0, faces = 0, triangles = 0;
    std::size_t tets = 0;                   ///< 0: a surface
    std::array<double, 2> dihedral{180, 0}; ///< of tets: smallest and largest angle, degrees
    solver::MeshCheck check;
};

/// Every output of every node that is a mesh or tets, at a frame at which nothing has been stepped yet. What
/// cannot be computed is left out: find_problems tells.
std::vector<MeshReport> mesh_reports(const std::shared_ptr<const engine::Graph>& graph, engine::Evaluator& evaluator,
                                     std::stop_token stop, const std::shared_ptr<engine::Failures>& failures);
/// The report of a mesh file; nothing if it may be a graph. Throws Failure if it cannot be read.
std::optional<MeshReport> report_of_file(const std::string& path, const engine::FileAccess& files = {});

/// Warnings FE238: inputs that do less than they could because of their mesh.
std::vector<engine::Diagnostic> features_off(const engine::Graph& graph, const std::vector<MeshReport>& reports);

/// A table, or one JSON object a line.
void print_meshes(const std::vector<MeshReport>& reports, bool as_json, std::ostream& out);

} // namespace sinew::cli
