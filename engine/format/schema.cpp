// JSON Schema (draft 2020-12) of graph files, generated from the declarations, so that editors complete and
// check.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "engine/format/migrate.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace sinew::engine {

namespace {

using Tree = nlohmann::ordered_json;

void add_limits(Tree& number, const Limits& l) {
    if (std::isfinite(l.min)) number[l.open_min ? "exclusiveMinimum" : "minimum"] = l.min;
    if (std::isfinite(l.max)) number[l.open_max ? "exclusiveMaximum" : "maximum"] = l.max;
}

Tree numbers(const AttributeInfo& a, std::size_t count) {
    Tree item = {{"type", "number"}};
    add_limits(item, a.limits);
    return {{"type", "array"}, {"items", item}, {"minItems", count}, {"maxItems", count}};
}

Tree literal(const AttributeInfo& a) {
    if (a.def.is<bool>()) return {{"type", "boolean"}};
    if (a.def.is<Vec3>()) return numbers(a, 3);
    if (a.def.is<Matrix4>())
        return {{"anyOf",
                 {numbers(a, 16), {{"type", "array"}, {"items", numbers(a, 4)}, {"minItems", 4}, {"maxItems", 4}}}}};
    if (a.def.is<File>()) return {{"type", "string"}};
    if (a.def.is<std::string>()) {
        Tree out = {{"type", "string"}};
        for (std::string_view option : a.options) out["enum"].push_back(option);
        return out;
    }
    Tree number = {{"type", a.def.is<std::int64_t>() ? "integer" : "number"}};
    add_limits(number, a.limits);
    if (!a.def.is<NumberList>()) return number;
    return {{"anyOf", {number, {{"type", "array"}, {"items", number}}}}};
}

Tree default_of(const AttributeInfo& a) {
    const Value& d = a.def;
    if (d.is<bool>()) return d.as<bool>();
    if (d.is<std::int64_t>()) return d.as<std::int64_t>();
    if (d.is<double>()) return d.as<double>();
    if (d.is<std::string>()) return d.as<std::string>();
    if (d.is<Vec3>()) return d.as<Vec3>();
    if (d.is<Matrix4>()) return d.as<Matrix4>();
    if (d.is<NumberList>()) return d.as<NumberList>();
    return d.as<File>().path;
}

Tree object(Tree properties, std::vector<std::string> required) {
    return {{"type", "object"},
            {"properties", std::move(properties)},
            {"required", std::move(required)},
            {"additionalProperties", false}};
}

/// An object beside whose data people may write what they like.
Tree with_comment(Tree properties, std::vector<std::string> required) {
    properties["comment"] = true;
    return object(std::move(properties), std::move(required));
}

/// The key "comment" of a list by name: one of what it lists may be called so, anything else is a comment.
Tree comment_or(const Tree& listed) { return {{"comment", {{"if", {{"type", "object"}}}, {"then", listed}}}}; }

Tree input(const AttributeInfo& a) {
    const Tree connection = {{"$ref", "#/$defs/connection"}};
    std::string doc(a.doc);
    if (!a.unit.empty() && a.unit != "1") doc += " [" + std::string(a.unit) + "]";
    Tree out = {{"description", doc}};
    if (a.kind == AttributeKind::wire) return out["$ref"] = "#/$defs/connection", out;
    if (a.kind == AttributeKind::wire_list) {
        out["type"] = "array";
        out["items"] = {{"$ref", "#/$defs/entry"}};
        if (a.min_count > 0) out["minItems"] = a.min_count;
        return out;
    }
    if (a.from_timing == FromTiming::nothing) out["default"] = default_of(a);
    Tree& forms = out["anyOf"] = Tree::array();
    forms.push_back(literal(a));
    if (a.unit.empty()) {
        forms.push_back(with_comment({{"value", literal(a)}}, {"value"}));
    } else { // in another unit the numbers are others, so the limits cannot be told here
        forms.push_back(
            with_comment({{"value", {{"type", {"number", "array"}}}}, {"unit", {{"type", "string"}}}}, {"value"}));
    }
    if (!a.presets.empty()) {
        Tree words = Tree::array();
        for (const Preset& p : a.presets) words.push_back(p.name);
        forms.push_back(with_comment({{"preset", {{"enum", words}}}}, {"preset"}));
        forms.push_back({{"enum", words}});
    }
    if (!a.unit.empty() && (a.def.is<double>() || a.def.is<NumberList>()))
        forms.push_back({{"type", "string"}, {"pattern", "^ *[-+]?[0-9.]"}}); // "30 kPa"
    if (a.keyable) forms.push_back({{"$ref", "#/$defs/keys"}});
    forms.push_back(connection);
    return out;
}

Tree node(const NodeType& t) {
    Tree properties = Tree::object(), required = Tree::array();
    for (const AttributeInfo& a : t.inputs) {
        properties[std::string(a.name)] = input(a);
        if (a.required) required.push_back(a.name);
    }
    Tree inputs = {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
    if (!required.empty()) inputs["required"] = required;
    Tree out = with_comment({{"type", {{"const", t.name}, {"description", t.doc}}}, {"inputs", inputs}}, {"type"});
    if (!required.empty()) out["required"].push_back("inputs");
    out["description"] = t.doc;
    return out;
}

Tree keys_definition() {
    const Tree value = {{"anyOf",
                         {{{"type", "number"}},
                          {{"type", "boolean"}},
                          {{"type", "string"}},
                          {{"type", "array"}, {"items", {{"type", "number"}}}}}}};
    const Tree tangents = {
        {"type", "object"}, {"properties", {{"in", value}, {"out", value}}}, {"additionalProperties", false}};
    Tree key = {{"type", "array"}, {"minItems", 2}, {"maxItems", 3}};
    key["prefixItems"] = Tree::array({Tree{{"type", "number"}}, value, tangents});
    return with_comment({{"keys", {{"type", "array"}, {"items", key}, {"minItems", 1}}},
                         {"interp", {{"enum", {"step", "linear", "smooth"}}}},
                         {"unit", {{"type", "string"}}}},
                        {"keys"});
}

Tree includes_definition() {
    const Tree overrides = {
        {"type", "object"},
        {"description", "\"node.input\" of the included graph: what stands there instead. Connections are to nodes as "
                        "they are called in this file."},
        {"propertyNames", {{"pattern", "^[^.]+(\\.[^.]+)+$"}}}};
    const Tree file = {{"type", "string"},
                       {"minLength", 1},
                       {"description", "The graph file to include; its path starts at this file's folder."}};
    const Tree include = with_comment({{"file", file}, {"overrides", overrides}}, {"file"});
    return {{"type", "object"},
            {"description", "Other graphs, each under a prefix: their node \"biceps\" is \"prefix.biceps\" here."},
            {"properties", comment_or(include)},
            {"propertyNames", {{"pattern", "^[^.]+$"}}},
            {"additionalProperties", include}};
}

} // namespace

std::string graph_schema(const Registry& registry) {
    Tree types = Tree::array(), definitions = Tree::object();
    const Tree plug = {{"from", {{"type", "string"}, {"pattern", "^[^.]+(\\.[^.]+)+$"}}}};
    definitions["connection"] = with_comment(plug, {"from"});
    definitions["entry"] = object(plug, {"from"}); // of a list
    definitions["keys"] = keys_definition();
    for (const std::string& name : registry.names()) {
        definitions["node_" + name] = node(*registry.find(name));
        types.push_back({{"$ref", "#/$defs/node_" + name}});
    }
    // The choice by type keeps an editor's messages to the one type that was meant.
    Tree any_node = {{"type", "object"}, {"required", {"type"}}};
    if (!types.empty()) any_node["oneOf"] = types;
    const Tree numbers = {{"fps", {{"type", "number"}, {"minimum", 0.001}, {"maximum", 1e6}, {"default", 24}}},
                          {"start", {{"type", "integer"}, {"default", 1}}},
                          {"end", {{"type", "integer"}, {"description", "The last frame; default: the first."}}}};
    Tree timing = with_comment(numbers, {});
    timing["description"] = "Frames of a run; those of included graphs do not count.";
    Tree root = with_comment({{"$schema", {{"type", "string"}}},
                              {"format", {{"const", "sinew " + std::to_string(current_format)}}},
                              {"timing", timing},
                              {"includes", includes_definition()},
                              {"nodes",
                               {{"type", "object"},
                                {"properties", comment_or(any_node)},
                                {"propertyNames", {{"pattern", "^[^.]+$"}}},
                                {"additionalProperties", any_node}}},
                              {"editor", {{"type", "object"}}}},
                             {"format", "nodes"});
    Tree out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Sinew graph"}};
    out.update(root);
    out["$defs"] = definitions;
    return out.dump(2) + "\n";
}

} // namespace sinew::engine
