// Numbers in quotes as people type them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/value.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sinew::engine {

/// "30 kPa", "1e5Pa", "-3".
struct Quantity {
    double number = 0;
    std::string unit = {}; ///< whatever follows the number; not checked; empty: nothing
};
/// Empty if the text does not begin with a finite number.
std::optional<Quantity> parse_quantity(std::string_view text);

/// The numbers in "1, 2, 3", "1 2 3" or "[1, 2, 3]"; none if the text holds anything else.
NumberList numbers_in(std::string text);

/// "[1, 2, 3]".
std::string list_text(std::span<const double> numbers);

} // namespace sinew::engine
