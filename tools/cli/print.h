// Values and diagnostics for people and for programs. One description serves both: JSON, and the same as
// text.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/diagnostics.h"
#include "engine/value.h"
#include "nodes/values.h"
#include "solver/state.h"

#include <filesystem>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

namespace sinew::cli {

/// "file:///tmp/a%20b/view.html", with everything escaped that a link cannot hold (RFC 3986).
std::string file_url(const std::filesystem::path& absolute);

/// What is in a value: numbers as they are, meshes by size, bounding box and digest.
nlohmann::ordered_json describe_value(const engine::Value& value);
/// "key: value" lines; nested objects are indented, long lists shortened.
std::string as_text(const nlohmann::ordered_json& description);

/// As text to `err`, or one JSON object a line to `out`.
void print_diagnostics(std::span<const engine::Diagnostic> diagnostics, bool as_json, std::ostream& out,
                       std::ostream& err);

} // namespace sinew::cli
