// The numbers of a frame's report as JSON: what `sinew run --report`, hosts and progress lines tell alike
// (docs/concepts/report.md).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/values.h"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace sinew::embed {

/// How a step went: the fields that every frame has in a report.
nlohmann::ordered_json step_json(const solver::StepRecord& record);
/// A line of action at a frame: lengths in metres, bodies and fibres by their places.
nlohmann::ordered_json line_json(const nodes::LineReport& line);
/// Where the numbers of a frame are at their worst.
/// \param bodies names in the order of zSolver.bodies
/// \param attachments names in the order of zSolver.attachments
nlohmann::ordered_json where_json(const nodes::WorstPlaces& worst, const std::vector<std::string>& bodies,
                                  const std::vector<std::string>& attachments);
/// Bodies, tets, triangles, unknowns, attachments and terms.
nlohmann::ordered_json size_json(const nodes::SolveReport& report);
/// The name at a place, or the place where there is none.
std::string name_at(const std::vector<std::string>& names, int place);

} // namespace sinew::embed
