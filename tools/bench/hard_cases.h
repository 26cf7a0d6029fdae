// The hard cases of the physics contract, each a function that makes a scene, treats it badly and says where it must
// end. A new one is a function and a line of the list.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/hard_trial.h"

#include <span>

namespace sinew::bench {

struct HardCase {
    std::string_view name;
    std::string_view variant; ///< of a case that is tried in several ways; may be empty
    std::string_view must;    ///< where it must end, in words
    void (*run)(HardTrial&);  ///< throws WrongAnswer, solver::Error, solver::Stopped
    bool quick = true;        ///< also in a quick run
    bool cloth = false;       ///< has neither elements nor laws: tried under the first of each
};

/// All of them.
std::span<const HardCase> hard_cases();
/// Of them those of contact, and those of cloth.
std::span<const HardCase> hard_contact_cases();
std::span<const HardCase> hard_cloth_cases();

} // namespace sinew::bench
