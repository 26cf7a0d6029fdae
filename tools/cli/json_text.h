// JSON as text. Names of files are bytes that need be no UTF-8, and the library throws on those.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace sinew::cli {

/// On one line, or indented; what is no UTF-8 as U+FFFD.
template <class Json>
std::string json_text(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

} // namespace sinew::cli
