// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/node_facts.h"

#include "tools/cli/print.h"

#include <cmath>

namespace sinew::cli {

using Json = nlohmann::ordered_json;

Json limits_json(const engine::Limits& limits) {
    Json out = Json::object();
    if (std::isfinite(limits.min)) out[limits.open_min ? "above" : "min"] = limits.min;
    if (std::isfinite(limits.max)) out[limits.open_max ? "below" : "max"] = limits.max;
    return out;
}

std::string facts(const engine::AttributeInfo& a) {
    std::string out(a.type_name);
    if (a.kind == engine::AttributeKind::wire) out = "connection to a " + out;
    if (a.kind == engine::AttributeKind::wire_list) out = "connections to " + out;
    if (!a.unit.empty() && a.unit != "1") out += " [" + std::string(a.unit) + "]";
    if (a.required) out += ", required";
    if (a.kind == engine::AttributeKind::literal) {
        if (!a.required) {
            std::string text = a.from_timing == engine::FromTiming::start ? "the graph's timing.start"
                               : a.from_timing == engine::FromTiming::fps ? "the graph's timing.fps"
                                                                          : as_text(describe_value(a.def));
            text.erase(text.find_last_not_of('\n') + 1);
            if (!text.empty() && text.find('\n') == std::string::npos) out += ", default " + text;
        }
        const Json limits = limits_json(a.limits);
        for (const auto& [word, limit] : limits.items()) out += ", " + word + " " + limit.dump();
        if (a.keyable) out += ", keyable";
        for (std::size_t i = 0; i < a.options.size(); ++i) out += (i ? " | " : ", one of ") + std::string(a.options[i]);
        for (std::size_t i = 0; i < a.presets.size(); ++i)
            out += (i ? ", " : ", presets: ") + std::string(a.presets[i].name);
    }
    return out;
}

} // namespace sinew::cli
