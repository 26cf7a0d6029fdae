// What the forces of a solver show of one frame, as a value on a wire.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/value.h"
#include "nodes/solver_space.h"
#include "solver/term/marks.h"

#include <vector>

namespace sinew::nodes {

/// Points and lines with a number each, one group for each force's kind and quantity. Positions in scene units; values
/// in the group's unit, which is SI. Bodies are places in zSolver.bodies.
struct MarkList {
    solver::Marks groups;
};

/// From metres to scene units; groups of the same kind become one, where the first of them stands.
/// \param simulated places in zSolver.bodies of those of the scene
MarkList mark_list(solver::Marks groups, const std::vector<int>& simulated, const SolverSpace& space);

} // namespace sinew::nodes

namespace sinew::engine {

template <>
struct ValueTraits<nodes::MarkList> {
    static constexpr std::string_view name = "marks";
    static void hash(Hasher& h, const nodes::MarkList& v);
    static std::size_t bytes(const nodes::MarkList& v);
};

} // namespace sinew::engine
