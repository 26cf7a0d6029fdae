// The order of rows in which a factor fills in little.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"

#include <cholmod.h>
#include <vector>

namespace sinew::solver {

/// The pattern as CHOLMOD sees it, one row and column a row of blocks, without a copy; it lives as long as the pattern.
/// CHOLMOD does not write to it.
cholmod_sparse vertex_graph(const BlockPattern& pattern);

/// The row at each place: by minimum degree (AMD) of the graph whose edges are the pattern's blocks where the factor is
/// small, else by nested dissection (METIS); where neither is found (memory), rows stay as they are. Needs
/// analysis_mutex().
std::vector<int> order_rows(const BlockPattern& pattern, cholmod_common& common);

} // namespace sinew::solver
