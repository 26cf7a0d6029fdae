// The space that a simulation runs in. At the start frame it is the scene itself, in metres; from there on it is
// carried by how zSolver.matrix, translate, rotate and scale move. Bones go into it, results come out of it, so what
// all of them do together is felt by nothing inside.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/node_type.h"
#include "nodes/values.h"

#include <array>

namespace sinew::nodes {

/// Scene units of the start frame to those of now: p' = stretch turn p + shift.
struct SolverSpace {
    double units = 1; ///< scene units per metre at the start frame
    bool moved = false;
    double stretch = 1;
    solver::Mat3 turn = solver::Mat3::Identity();
    solver::Vec3 shift = solver::Vec3::Zero();

    solver::Points to_metres(const solver::Points& scene) const;
    solver::Points to_scene(solver::Points metres) const;
    solver::Vec3 place_in_scene(const solver::Vec3& metres) const;
    solver::Vec3 direction_in_scene(const solver::Vec3& v) const { return moved ? solver::Vec3(turn * v) : v; }
    std::array<double, 3> numbers_in_scene(const solver::Vec3& metres) const {
        const solver::Vec3 p = place_in_scene(metres);
        return {p.x(), p.y(), p.z()};
    }
};

/// zSolver's transform at this time. Fails with FE291 where its matrix shears, mirrors or scales unevenly.
engine::Matrix4 solver_frame(const engine::Reads& in);

/// \param at_start, now as solver_frame gives them; equal ones give a space that has not moved, to the bit
SolverSpace solver_space(double units, const engine::Matrix4& at_start, const engine::Matrix4& now);

/// Values of a hold by a matrix, in metres, as they are in the space. Fails with FE292 where that has changed its size:
/// what is held keeps its own.
void take_into_space(const engine::Reads& in, const SolverSpace& space, Force& hold);

} // namespace sinew::nodes
