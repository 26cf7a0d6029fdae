// What a graph may say but hardly means: units mistaken by powers of ten, tissues that nothing holds, paint forgotten.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"

#include <vector>

namespace sinew::doubts {

/// How closely meshes are looked at: all of them, or so little that a run does not wait for it.
enum class Look { closely, in_passing };

/// Warnings, each with the cure:
/// FE260 a tissue, or a piece of one, that falls because nothing holds it; FE261 tissues of no size that flesh has,
/// with the scales that would give them one; FE262 tets over four times as large as parts of what they fill are thick,
/// or three times all of it, or, linear and of flesh, one and a half times, larger than all of it, or reaching across
/// to what lies near but far along the surface; FE263 flesh softer or stiffer than any; FE264 a tissue nearly all of
/// whose surface is attached; FE265 a scale or matrix that mirrors; FE320 bodies whose files are in another unit than
/// the others', and bodies of kilometres; FE321 meshes with faces turned against each other, doubled, or all inwards,
/// and cloths that fall into parts; FE322 gravity that is hardly in m/s², or points up; FE323 flesh lighter or heavier
/// than any; FE324 fibres weaker than any; FE325 paint that reaches no part of its mesh; FE326 an attachment too soft,
/// or too faintly painted, to hold anything; FE327 values of a material that its bodies do not read; FE328 painted
/// layers and fibres that are nowhere; FE329 muscles that never pull; FE331 a tissue that is held as a whole; FE336
/// cloth heavier, FE337 thicker than any; FE338 a field that pushes cloth by hundreds of its weights; FE340 an open
/// surface whose points lie too far apart to stop anything; FE341 bodies that collide and begin deep within each other,
/// or bodies in one place; FE343 cloth that touches in a solver with too few Newton iterations for it; FE344 rest
/// scales of another order; FE345 a scene so far from the origin that what is written loses its shape.
///
/// What cannot be computed is left out: find_problems tells. Throws Cancelled.
/// \param nodes to look at
/// \param frame the first that they are simulated at
std::vector<engine::Diagnostic> find_doubts(const std::shared_ptr<const engine::Graph>& graph,
                                            engine::Evaluator& evaluator, const std::vector<std::string>& nodes,
                                            double frame, Look look, std::stop_token stop,
                                            const std::shared_ptr<engine::Failures>& failures);

/// Of a graph that has errors, which may come from it: FE320 and FE325 alone, by meshes where bodies cannot be made.
std::vector<engine::Diagnostic> find_unit_doubts(const std::shared_ptr<const engine::Graph>& graph,
                                                 engine::Evaluator& evaluator, const std::vector<std::string>& nodes,
                                                 double frame, std::stop_token stop,
                                                 const std::shared_ptr<engine::Failures>& failures);

} // namespace sinew::doubts
