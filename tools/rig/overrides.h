// What the user says of muscles whose names match a pattern: --set 'triceps*:tetSize=1.2'.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/rig/parts.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::rig {

/// Of one muscle; what is not said is guessed. Lengths in scene units, the rest in SI units.
struct MuscleOptions {
    std::optional<double> tet_size, reach, youngs_modulus, tendon_modulus, density, strength, excitation;
    std::string preset;                 ///< "muscle", "tendon" or "fat"; empty: told from the name
    std::string law;                    ///< of zTissue.material
    std::string overlaps;               ///< "tie", "slide" or "none"; empty: as for the whole rig
    std::vector<std::string> attach_to; ///< names of what the two ends shall reach
};

struct Override {
    std::string pattern, name, value;
};

/// "PATTERN:NAME=VALUE". Throws std::invalid_argument, in words for the user.
Override parse_override(const std::string& text);
/// '*' stands for any letters, '?' for one; upper and lower case count alike.
bool matches(std::string_view pattern, std::string_view name);
/// Of a muscle with this node and file name; a later override replaces an earlier one. Throws std::invalid_argument for
/// a name or value that is none.
MuscleOptions options_of(const Part& muscle, const std::vector<Override>& overrides);
/// The first pattern that matches no muscle; nothing if all do.
std::optional<std::string> unmatched(const std::vector<Override>& overrides, const std::vector<Part>& parts);
/// The names that overrides may have, with what they mean: for help and messages.
std::string override_names();

} // namespace sinew::rig
