// The list of all forces but dynamics. A new one is a folder beside this file and a line in all_terms.cpp.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/type.h"

#include <span>

namespace sinew::solver {

/// In the order in which they are summed.
std::span<const TermType* const> all_terms();

} // namespace sinew::solver
