// JSON data files (motion tracks, painted maps, curves) with errors that say file and place.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/file_access.h"
#include "engine/value.h"

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::nodes {

/// Throws solver::Error IO401, IO402, IO410, IO412 as FileAccess::read does, IO403 (not JSON, with line and column).
nlohmann::json read_json(const engine::FileAccess& files, const std::string& path);
/// The same from the bytes of a file; messages name `path`. Also IO403 for brackets within brackets, most_json_depth of
/// them and more.
nlohmann::json parse_json(std::string_view text, const std::string& path);
/// Whether brackets lie in so many brackets that walking down them is not safe. The text need not be JSON.
bool is_too_deep(std::string_view text);
inline constexpr int most_json_depth = 200;
/// No JSON data file may be larger [bytes]: read, its values take about ten times the text.
inline constexpr std::uintmax_t most_json_bytes = std::uintmax_t{512} << 20;
/// What the library says is wrong, without its own name of the error.
std::string fault_of(const nlohmann::json::exception& e);
/// The part of `json` that an RFC 6901 pointer names; empty = all. Throws solver::Error IO403.
const nlohmann::json& part_of(const nlohmann::json& json, const std::string& pointer, const std::string& path);
/// A list of finite numbers; lists of lists are flattened. Throws solver::Error IO403 naming `what`.
engine::NumberList numbers_of(const nlohmann::json& json, const std::string& what, const std::string& path);
/// All bytes of a file. Throws solver::Error IO401, IO402, IO410, IO412.
std::string read_text(const engine::FileAccess& files, const std::string& path,
                      std::uintmax_t most = engine::FileAccess::most_bytes);

} // namespace sinew::nodes
