// `sinew nodes`: the node types and their attributes, from the registry.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "tools/cli/arguments.h"
#include "tools/cli/commands.h"
#include "tools/cli/json_text.h"
#include "tools/cli/node_facts.h"
#include "tools/cli/print.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

using Json = nlohmann::ordered_json;

namespace {

std::string_view word_of(engine::AttributeKind kind) {
    switch (kind) {
    case engine::AttributeKind::literal:
        return "value";
    case engine::AttributeKind::wire:
        return "connection";
    case engine::AttributeKind::wire_list:
        return "connections";
    case engine::AttributeKind::output:
        break;
    }
    return "output";
}

std::string_view word_of(engine::Affects affects) {
    switch (affects) {
    case engine::Affects::result:
        return "result";
    case engine::Affects::initial_state:
        return "initial state";
    case engine::Affects::nothing:
        break;
    }
    return "nothing";
}

Json attribute_json(const engine::AttributeInfo& a) {
    Json out = {{"name", a.name}, {"kind", word_of(a.kind)}, {"type", a.type_name}};
    if (!a.unit.empty()) out["unit"] = a.unit;
    if (a.kind == engine::AttributeKind::literal) {
        if (a.from_timing != engine::FromTiming::nothing)
            out["default_from"] = a.from_timing == engine::FromTiming::start ? "timing.start" : "timing.fps";
        else if (!a.required)
            out["default"] = describe_value(a.def);
        if (Json limits = limits_json(a.limits); !limits.empty()) out["limits"] = std::move(limits);
        out["keyable"] = a.keyable;
        if (!a.options.empty()) out["options"] = a.options;
        for (const engine::Preset& p : a.presets) out["presets"][std::string(p.name)] = p.value;
    }
    if (a.kind == engine::AttributeKind::wire_list) out["min_count"] = a.min_count;
    if (a.kind != engine::AttributeKind::output) {
        out["required"] = a.required;
        out["affects"] = word_of(a.affects);
    }
    out["doc"] = a.doc;
    return out;
}

Json type_json(const engine::NodeType& type) {
    Json out = {{"name", type.name},
                {"version", type.version},
                {"numerics", type.numerics},
                {"doc", type.doc},
                {"inputs", Json::array()},
                {"outputs", Json::array()},
                {"simulation", type.simulation != nullptr}};
    for (const auto& a : type.inputs) out["inputs"].push_back(attribute_json(a));
    for (const auto& a : type.outputs) out["outputs"].push_back(attribute_json(a));
    return out;
}

void print_type(const engine::NodeType& type, std::ostream& out) {
    out << type.name << ": " << type.doc << "\n";
    for (const auto* list : {&type.inputs, &type.outputs}) {
        if (list->empty()) continue;
        out << (list == &type.inputs ? "\nInputs\n" : "\nOutputs\n");
        for (const engine::AttributeInfo& a : *list)
            out << "  " << a.name << ": " << facts(a) << "\n      " << a.doc << "\n";
    }
}

ExitCode list_nodes(const Invocation& in) {
    const auto registry = nodes::make_registry();
    const std::vector<std::string> names = registry->names();
    if (in.arguments.has("--schema")) {
        in.out << engine::graph_schema(*registry) << "\n";
        return done;
    }
    if (const auto name = in.arguments.operand(0)) {
        const engine::NodeType* type = registry->find(*name);
        if (!type) throw UsageError("there is no node type '" + *name + "'." + did_you_mean(*name, names));
        if (in.arguments.has("--json"))
            in.out << json_text(type_json(*type), 1) << "\n";
        else
            print_type(*type, in.out);
        return done;
    }
    if (in.arguments.has("--json")) {
        Json all = Json::array();
        for (const std::string& name : names) all.push_back(type_json(*registry->find(name)));
        in.out << json_text(all, 1) << "\n";
        return done;
    }
    std::size_t width = 0;
    for (const std::string& name : names) width = std::max(width, name.size());
    for (const std::string& name : names)
        in.out << name << std::string(width - name.size() + 2, ' ') << registry->find(name)->doc << "\n";
    return done;
}

} // namespace

Command nodes_command() {
    return {"nodes",
            "list the node types, or explain one",
            {{"TYPE", "a node type, for example zTissue", false}},
            {{"--json", "", "every declaration as JSON"},
             {"--schema", "", "the JSON Schema of graph files, for editors that complete and check"}},
            "sinew nodes zTissue",
            list_nodes};
}

} // namespace sinew::cli
