// Limits of attributes: is a value inside, which entry is not, and how the limits read in a message.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/attribute.h"

#include <optional>
#include <string>

namespace sinew::engine {

/// False for NaN. An infinite number is inside only if it is the limit itself (never the case for files).
bool inside(const Limits& limits, double v);

struct Outside {
    double value;   ///< the offending number
    int index = -1; ///< its place in a vector, matrix or list; -1 for a single number
    bool finite = true;
};

/// The first number of a literal that is not finite or not inside; empty for text, files and booleans.
std::optional<Outside> outside(const Limits& limits, const Value& v);

/// "(0, 0.5]", with the unit if there is one: "above 0 Pa" reads "(0, inf) Pa".
std::string limits_text(const Limits& limits, std::string_view unit);

} // namespace sinew::engine
