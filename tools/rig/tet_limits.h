// Tet sizes that zTet refuses: told before a graph with them is written.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/rig/guess.h"

namespace sinew::rig {

/// What zTet says of tets of this size in a mesh (FE210: too many of them, or too large for it), with the option that
/// gave the size as the cure.
std::optional<engine::Diagnostic> refused_tets(const std::string& name, const solver::Points& points,
                                               const std::vector<solver::Triangle>& triangles, double tet_size,
                                               const std::string& option, const std::function<bool()>& stop);

/// Throws engine::Failure with all muscles whose tets are refused, where the user gave a size or scaled it.
void check_tets(const Rig& rig, const GuessOptions& options);

} // namespace sinew::rig
