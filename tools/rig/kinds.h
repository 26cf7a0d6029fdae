// Whether what was given as bones and as muscles is that: told from the names of files and folders.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/rig/parts.h"

#include <optional>
#include <string>
#include <vector>

namespace sinew::rig {

/// Of a file's or folder's name ("humerus_L", "M_biceps_brachii", "Muscles"); nothing if it tells neither, or both.
/// Knows the bones and muscles of anatomy books by their Latin and English names; "ulnaris" is no ulna.
std::optional<Kind> kind_told_by(const std::string& name);

/// A warning (DG177) if the names of the bones tell muscles and those of the muscles tell bones, and none tells what it
/// was given as: the two folders seem to be swapped.
/// \param is_one_muscle of `new muscle`: bones that are right say nothing for the order of the others
std::optional<engine::Diagnostic> doubt_of_kinds(const std::vector<Part>& parts, bool is_one_muscle);

} // namespace sinew::rig
