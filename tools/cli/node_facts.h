// What a declaration says about an attribute, in one line; for `sinew nodes` and the reference pages.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/attribute.h"

#include <nlohmann/json.hpp>
#include <string>

namespace sinew::cli {

/// {"above": 0, "max": 1}; only the limits that there are.
nlohmann::ordered_json limits_json(const engine::Limits& limits);
/// "number [Pa], default 12000, above 0, keyable"
std::string facts(const engine::AttributeInfo& attribute);

} // namespace sinew::cli
