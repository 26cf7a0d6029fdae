// Lines of action as zSolver takes them. What a path comes to hangs on its length at the start frame and in the steps
// before, which are part of the solver's state; the path itself hangs on inputs alone, so it is known before a step.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/marks.h"
#include "nodes/solver_setup.h"

#include <span>
#include <vector>

namespace sinew::nodes {

/// What the curves of a line are bound to; the same at all frames, or their lengths are not of one thing.
engine::Digest bound_digest(const LineOfAction& line);
/// Fails with FE282 where a line is bound to something else than at the start frame.
void refuse_unbound_lines(const engine::Reads& in, const Setup& setup, const SceneKey& known);

/// At the start frame. Fails with FE280 for a line without length.
std::vector<solver::LineMemory> start_lines(const engine::Reads& in, const Setup& setup);
/// After a step [s] that ends at the time of `setup`. One entry a line of `setup`, as in `before`.
std::vector<solver::LineMemory> follow_lines(const Setup& setup, std::span<const solver::LineMemory> before,
                                             double step);
/// Gives the fibres what their lines come to (Setup::followed): excitation, and growth that follows.
void use_lines(std::span<const solver::LineMemory> lines, Setup& setup);

/// Warns (FE281) of lines that run nowhere in or near their muscle as it is modelled.
void warn_of_lines_elsewhere(const engine::Reads& in, const Setup& setup);
/// One entry a line; use_lines has been called. `run_up`: what runupWeight leaves of excitations.
std::vector<LineReport> line_reports(const Setup& setup, std::span<const solver::LineMemory> lines, double run_up);
/// The curves with their loaValue, as a group of their own; none where there is no line.
void add_line_marks(const Setup& setup, std::span<const solver::LineMemory> lines, MarkList& marks);

} // namespace sinew::nodes
