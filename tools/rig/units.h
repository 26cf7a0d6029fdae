// In which unit meshes are, and which way is up: told from bounding boxes, by what bodies measure.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/rig/parts.h"

#include <optional>
#include <string>
#include <vector>

namespace sinew::rig {

struct Unit {
    std::string name;      ///< "mm", "cm", "m", "in"
    double per_metre = 1;  ///< zSolver.scale
    std::string how_known; ///< a sentence for the graph's comment
};

/// Of "mm", "cm", "dm", "m", "in" or "ft", in letters of any case; nothing for another word.
std::optional<Unit> unit_of(const std::string& word);

/// mm, cm or m: in which the bones are nearest to the lengths of the human bones that their names tell (each within a
/// factor of 2.5 in the mean), or, if no name is known, the longest mesh to half a metre (within a factor of 4).
/// Throws engine::Failure DG151 where that cannot be told. Lengths of bones: rounded from what anatomy books give for
/// grown people; how near they are matters little, as the units are ten apart.
Unit guess_unit(const std::vector<Part>& parts);

/// A warning (DG179) if in a unit that is not among the guessed ones (inches, feet, dm) the meshes have such sizes as
/// nearly as in the one that was guessed, or more so.
std::optional<engine::Diagnostic> doubt_of_guess(const std::vector<Part>& parts, const Unit& guessed);

/// A warning (DG176) if bones whose names tell their size, or else the largest mesh, are plainly not so large in this
/// unit.
std::optional<engine::Diagnostic> doubt_of_unit(const std::vector<Part>& parts, const Unit& unit);

/// Throws engine::Failure DG152 with every mesh that lies away from the others, or among them as a giant or a dwarf,
/// but would be among them ten, a hundred or a thousand times larger or smaller; warnings, which are given back, if the
/// user said which unit all are in. Or DG157 if all muscles are apart from the bones but would be among them mirrored.
std::vector<engine::Diagnostic> check_same_space(const std::vector<Part>& parts, bool is_unit_said);

/// A warning (DG152) if all muscles together are tiny beside the bones, among which they would still be ten, a hundred
/// or a thousand times larger: such a muscle lies inside a bone, where it is near to what it is attached to.
std::optional<engine::Diagnostic> doubt_of_scale(const std::vector<Part>& parts);

struct Up {
    char axis = 'y'; ///< 'y' or 'z'
    std::string how_known;
};
/// z if everything lies above 0 along z but not along y, by what is usual; else y.
Up guess_up(const std::vector<Part>& parts);

} // namespace sinew::rig
