// What a graph may say but hardly means: units mistaken by powers of ten, tissues that nothing holds, paint forgotten.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"

#include <vector>

namespace sinew::cli {

/// Warnings, each with the cure:
/// FE260 a tissue that falls because nothing holds it; FE261 tissues of no size that flesh has, with the scale that
/// would give them one; FE262 tets over four times as large as parts of what they fill are thick; FE263 flesh softer
/// than any; FE264 a tissue all of whose surface is attached; FE265 a scale that mirrors. What cannot be computed is
/// left out: find_problems tells. Throws Cancelled.
std::vector<engine::Diagnostic> find_doubts(const std::shared_ptr<const engine::Graph>& graph,
                                            engine::Evaluator& evaluator, std::stop_token stop,
                                            const std::shared_ptr<engine::Failures>& failures);

} // namespace sinew::cli
