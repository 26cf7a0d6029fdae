// Graph -> JSON text that a person can read and edit: one node a block, one input a line.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "engine/format/migrate.h"
#include "engine/format/read_value.h"
#include "engine/text.h"

#include <algorithm>
#include <filesystem>

namespace sinew::engine {

namespace {

std::string joined(std::span<const double> values) {
    std::string out;
    for (double v : values) out += (out.empty() ? "" : ", ") + number_text(v);
    return "[" + out + "]";
}

std::string relative_path(const std::string& path, const std::string& folder) {
    const std::filesystem::path base = folder.empty() ? std::filesystem::path(".") : std::filesystem::path(folder);
    const auto relative = std::filesystem::path(path).lexically_relative(base.lexically_normal());
    return relative.empty() ? path : relative.generic_string();
}

std::string literal_text(const Value& v, const std::string& folder) {
    if (v.is<bool>()) return v.as<bool>() ? "true" : "false";
    if (v.is<std::int64_t>()) return number_text(v.as<std::int64_t>());
    if (v.is<double>()) return number_text(v.as<double>());
    if (v.is<std::string>()) return json_quoted(v.as<std::string>());
    if (v.is<Vec3>()) return joined(v.as<Vec3>());
    if (v.is<Matrix4>()) return joined(v.as<Matrix4>());
    if (v.is<NumberList>()) return joined(v.as<NumberList>());
    const std::string& path = v.as<File>().path;
    return json_quoted(path.empty() ? path : relative_path(path, folder));
}

std::string keyed_text(const AttributeInfo& info, const std::vector<double>& v) {
    if (info.def.is<bool>()) return v[0] != 0 ? "true" : "false";
    if (!info.options.empty()) return json_quoted(info.options[static_cast<std::size_t>(v[0])]);
    return v.size() == 1 ? number_text(v[0]) : joined(v);
}

std::string curve_text(const AttributeInfo& info, const Curve& c) {
    static constexpr const char* words[] = {"step", "linear", "smooth"};
    std::string keys;
    for (const Key& k : c.keys) {
        keys += (keys.empty() ? "[" : ", [") + number_text(k.frame) + ", " + keyed_text(info, k.value);
        std::string tangents;
        if (!k.tangent_in.empty()) tangents += "\"in\": " + keyed_text(info, k.tangent_in);
        if (!k.tangent_out.empty())
            tangents += (tangents.empty() ? "\"out\": " : ", \"out\": ") + keyed_text(info, k.tangent_out);
        if (!tangents.empty()) keys += ", { " + tangents + " }";
        keys += "]";
    }
    return "{ \"keys\": [" + keys + "], \"interp\": \"" + words[static_cast<int>(c.interpolation)] + "\" }";
}

std::string plug_text(const Plug& p) { return "{ \"from\": " + json_quoted(p.text()) + " }"; }

// Empty: the binding says no more than the default does.
std::string binding_text(const AttributeInfo& info, const Binding& b, const Timing& timing, const std::string& folder) {
    if (const Value* v = std::get_if<Value>(&b)) {
        const bool is_default = v->digest() == default_value(info, timing).digest() && !v->is<File>();
        return is_default && !info.required ? "" : literal_text(*v, folder);
    }
    if (const Curve* c = std::get_if<Curve>(&b)) return curve_text(info, *c);
    if (const Plug* p = std::get_if<Plug>(&b)) return plug_text(*p);
    std::string out;
    for (const Plug& p : std::get<std::vector<Plug>>(b)) out += (out.empty() ? " " : ",\n          ") + plug_text(p);
    return out.empty() ? "[]" : "[" + out + " ]";
}

std::vector<std::string> ordered_inputs(const Node& n) {
    std::vector<std::string> out;
    for (const std::string& name : n.input_order)
        if (n.inputs.contains(name)) out.push_back(name);
    for (const auto& [name, binding] : n.inputs)
        if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(name);
    return out;
}

std::string node_text(const Node& n, const Timing& timing, const std::string& folder) {
    if (!n.type) return n.raw_json;
    std::string inputs;
    for (const std::string& name : ordered_inputs(n)) {
        const std::string text = binding_text(*n.type->find_input(name), n.inputs.find(name)->second, timing, folder);
        if (!text.empty())
            inputs += (inputs.empty() ? "" : ",") + std::string("\n        ") + json_quoted(name) + ": " + text;
    }
    std::string out = "{ \"type\": " + json_quoted(n.type_name);
    if (!inputs.empty()) out += ", \"inputs\": {" + inputs + "\n      }";
    return out + " }";
}

} // namespace

std::string write_graph(const Graph& graph) {
    const Timing& t = graph.timing();
    std::string out = "{\n  \"format\": \"sinew " + std::to_string(current_format) + "\",\n";
    out += "  \"timing\": { \"fps\": " + number_text(t.fps) + ", \"start\": " + std::to_string(t.start) +
           ", \"end\": " + std::to_string(t.end) + " },\n  \"nodes\": {";
    const std::string folder = folder_of(graph.file());
    bool first = true;
    for (const std::string& name : graph.node_names()) {
        out += first ? "\n    " : ",\n    ";
        first = false;
        out += json_quoted(name) + ": " + node_text(*graph.find(name), t, folder);
    }
    return out + (first ? "},\n" : "\n  },\n") + "  \"editor\": " + graph.editor_json() + "\n}\n";
}

} // namespace sinew::engine
