// Parts whose values say where something is (TermType::mix): where they are at times within a step, and where bones
// take them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"
#include "solver/state.h"

#include <vector>

namespace sinew::solver {

/// Whether the scene has parts whose values say where something is; whether some of them follow bones.
bool has_moving_parts(const Scene& scene);
bool has_followers(const Scene& scene);

/// Puts in the values of parts that follow from where bones are. `memories`: of the start frame or later. `bones`: per
/// body [m]. Throws Error (body set) where a bone cannot be followed.
void follow_bones(const Scene& scene, const std::vector<TermMemory>& memories, const std::vector<Points>& bones,
                  std::vector<PartValues>& parts);
/// Moves `parts` to `share` of the way to them from `before`, as State::parts keeps them.
void go_part_way(const Scene& scene, const std::vector<PartValues>& before, double share,
                 std::vector<PartValues>& parts);
/// What State::parts keeps of `parts`.
void keep_places(const Scene& scene, const std::vector<PartValues>& parts, std::vector<PartValues>& kept);

} // namespace sinew::solver
