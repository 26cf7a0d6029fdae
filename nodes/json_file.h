// JSON data files (motion tracks, painted maps, curves) with errors that say file and place.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/value.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sinew::nodes {

/// Throws solver::Error IO401 (missing), IO402 (unreadable), IO403 (not JSON, with line and column).
nlohmann::json read_json(const std::string& path);
/// What the library says is wrong, without its own name of the error.
std::string fault_of(const nlohmann::json::exception& e);
/// The part of `json` that an RFC 6901 pointer names; empty = all. Throws solver::Error IO403.
const nlohmann::json& part_of(const nlohmann::json& json, const std::string& pointer, const std::string& path);
/// A list of finite numbers; lists of lists are flattened. Throws solver::Error IO403 naming `what`.
engine::NumberList numbers_of(const nlohmann::json& json, const std::string& what, const std::string& path);
/// All bytes of a file. Throws solver::Error IO401, IO402.
std::string read_text(const std::string& path);

} // namespace sinew::nodes
