// What a term keeps from step to step, as bytes that only the term reads. Part of the state: saved, loaded and digested
// with it, so that none can be forgotten.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/shared_bytes.h"

#include <string>
#include <string_view>
#include <vector>

namespace sinew::solver {

struct TermMemory {
    std::string term; ///< the type's name
    int version = 0;  ///< of the bytes' layout
    SharedBytes bytes;
    friend bool operator==(const TermMemory&, const TermMemory&) = default;
};

/// The memory of a term; null if it keeps none.
const TermMemory* find_memory(const std::vector<TermMemory>& memories, std::string_view term);

} // namespace sinew::solver
