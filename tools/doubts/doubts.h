// What a graph may say but hardly means: units mistaken by powers of ten, tissues that nothing holds, paint forgotten.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"

#include <vector>

namespace sinew::cli {

/// How closely meshes are looked at: all of them, or so little that a run does not wait for it.
enum class Look { closely, in_passing };

/// Warnings, each with the cure:
/// FE260 a tissue that falls because nothing holds it; FE261 tissues of no size that flesh has, with the scales that
/// would give them one; FE262 tets over four times as large as parts of what they fill are thick; FE263 flesh softer
/// than any; FE264 a tissue nearly all of whose surface is attached; FE265 a scale or matrix that mirrors; FE320
/// bodies whose files are in another unit than the others'; FE321 tissues with faces turned against each other or
/// doubled; FE322 gravity that is hardly in m/s²; FE323 flesh lighter than any; FE324 fibres weaker than any; FE326 an
/// attachment too soft to hold anything; FE327 values of a material that its bodies do not read; FE331 a tissue that is
/// held as a whole.
/// FE328 painted layers and fibres that are nowhere; FE329 muscles that never pull.
/// What cannot be computed is left out: find_problems tells. Throws Cancelled.
/// \param nodes to look at
std::vector<engine::Diagnostic> find_doubts(const std::shared_ptr<const engine::Graph>& graph,
                                            engine::Evaluator& evaluator, const std::vector<std::string>& nodes,
                                            Look look, std::stop_token stop,
                                            const std::shared_ptr<engine::Failures>& failures);

/// Of a graph that has errors, which may come from it: FE320 alone, by the meshes that bodies are to be made of.
std::vector<engine::Diagnostic> find_unit_doubts(const std::shared_ptr<const engine::Graph>& graph,
                                                 engine::Evaluator& evaluator, const std::vector<std::string>& nodes,
                                                 std::stop_token stop,
                                                 const std::shared_ptr<engine::Failures>& failures);

} // namespace sinew::cli
