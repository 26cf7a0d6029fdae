// Which format a graph file says that it has.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/format/json_text.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace sinew::engine {

struct FormatNumber {
    int number = 0;
    /// What is wrong with it, if `code` is not empty: DG004, DG005 or DG006, the byte and the pointer where.
    std::string_view code = {};
    std::size_t at = 0;
    std::string pointer = {}, message = {}, hint = {};
};

FormatNumber format_number(const Json& root);

} // namespace sinew::engine
