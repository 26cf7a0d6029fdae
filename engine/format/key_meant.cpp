// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/key_meant.h"

#include "engine/diagnostics.h"
#include "engine/text.h"

#include <algorithm>
#include <array>

namespace sinew::engine {

namespace {

struct Other {
    Level level;
    std::string_view written, meant;
};

/// What the same thing is called elsewhere, where letters alone do not tell.
constexpr Other others[] = {
    {Level::document, "version", "format"}, {Level::document, "graph", "nodes"},
    {Level::document, "objects", "nodes"},  {Level::document, "imports", "includes"},
    {Level::document, "time", "timing"},    {Level::document, "comments", "comment"},
    {Level::timing, "framerate", "fps"},    {Level::timing, "framespersecond", "fps"},
    {Level::timing, "begin", "start"},      {Level::timing, "first", "start"},
    {Level::timing, "startframe", "start"}, {Level::timing, "last", "end"},
    {Level::timing, "stop", "end"},         {Level::timing, "endframe", "end"},
    {Level::node, "attributes", "inputs"},  {Level::node, "parameters", "inputs"},
    {Level::node, "params", "inputs"},      {Level::node, "connections", "inputs"},
    {Level::node, "kind", "type"},          {Level::node, "nodetype", "type"},
    {Level::include, "path", "file"},       {Level::include, "override", "overrides"},
};

bool is_known(std::string_view key, Level level) {
    const auto known = keys_of(level);
    return std::find(known.begin(), known.end(), key) != known.end();
}

} // namespace

std::span<const std::string> keys_of(Level level) {
    static const std::vector<std::string> document{"$schema",  "format", "comment", "timing",
                                                   "includes", "nodes",  "editor"},
        timing{"fps", "start", "end", "comment"}, node{"type", "comment", "inputs"},
        include{"file", "comment", "overrides"};
    switch (level) {
    case Level::document:
        return document;
    case Level::timing:
        return timing;
    case Level::node:
        return node;
    default:
        return include;
    }
}

std::string key_meant(std::string_view key, Level level) {
    const std::string small = key.size() > 100 ? std::string() : lower_case(key);
    for (const Other& o : others)
        if (o.level == level && o.written == small) return std::string(o.meant);
    for (const std::string& known : keys_of(level))
        if (small == known) return known;
    return nearest_name(key, keys_of(level));
}

std::string key_hint(std::string_view key, Level level, std::span<const std::string> inputs) {
    if (std::find(inputs.begin(), inputs.end(), key) != inputs.end())
        return "write it within \"inputs\": { " + json_quoted(key) + ": … }";
    if (const std::string meant = key_meant(key, level); !meant.empty()) return "did you mean \"" + meant + "\"?";
    if (level == Level::document && !key_meant(key, Level::timing).empty())
        return "write it within \"timing\": { \"" + key_meant(key, Level::timing) + "\": … }";
    return "keys: " + listed(keys_of(level));
}

const JsonMember* meant_as(const Json& object, std::string_view wanted, Level level) {
    const auto* members = object.as<Json::Object>();
    if (!members || object.find(wanted)) return nullptr;
    for (const JsonMember& m : *members)
        if (!is_known(m.key, level) && key_meant(m.key, level) == wanted) return &m;
    return nullptr;
}

} // namespace sinew::engine
