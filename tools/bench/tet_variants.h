// A scene with other tets: all of one element, all sizes scaled alike.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::bench {

std::vector<std::string> nodes_of_type(const engine::Graph& graph, std::string_view type);

/// The graph with `element` (a value of zTet.element; empty: as it is) in every zTet and its tetSize times `scale`.
/// Throws engine::Failure DG110 where a tetSize that is to be scaled is no plain number.
std::shared_ptr<const engine::Graph> with_tets(const std::shared_ptr<const engine::Graph>& graph,
                                               const std::string& element, double scale);

} // namespace sinew::bench
