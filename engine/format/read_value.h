// One value of a graph file -> Binding: literal, "30 kPa", {value, unit}, {preset} or its name, {keys, interp, unit},
// {from}, [ {from}, … ]. Says what is malformed; limits, options and connections are checked afterwards by
// check_binding.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/check.h"
#include "engine/file_access.h"
#include "engine/format/json_text.h"

#include <optional>
#include <string>
#include <vector>

namespace sinew::engine {

/// `folder`: what relative paths start at. Problems are appended with `below` set and no node; nothing is
/// returned if there was one. `graph`: whose nodes a connection may mean, for hints.
std::optional<Binding> read_binding(const Graph& graph, const AttributeInfo& input, const Json& json,
                                    const std::string& folder, std::vector<Problem>& problems);

/// The part of `json` that `below` means, also when the literal is wrapped as {value, unit}.
const Json& offending_part(const Json& json, const std::string& below);

/// What is wrong with a file's name before anything is asked of the disk: a character of code 0 in it (IO402), where
/// the system would take what is before it.
std::optional<FileFault> file_name_fault(const std::string& path);

/// `path` as it stands in a graph file -> the path to open.
std::string resolved_path(const std::string& path, const std::string& folder);

/// "a.b" -> Plug; empty if it has no dot or an empty side.
std::optional<Plug> parse_plug(std::string_view text);

/// The folder of a graph file, or "" for the current one.
std::string folder_of(const std::string& graph_file);

} // namespace sinew::engine
