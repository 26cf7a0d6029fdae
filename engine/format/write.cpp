// Graph -> JSON text that a person can read and edit: one node a block, one input a line.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "engine/format/migrate.h"
#include "engine/format/read_value.h"
#include "engine/format/typed_text.h"
#include "engine/text.h"

#include <algorithm>
#include <filesystem>
#include <set>

namespace sinew::engine {

namespace {

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
    if (v.is<Vec3>()) return list_text(v.as<Vec3>());
    if (v.is<Matrix4>()) return list_text(v.as<Matrix4>());
    if (v.is<NumberList>()) return list_text(v.as<NumberList>());
    const std::string& path = v.as<File>().path;
    return json_quoted(path.empty() ? path : relative_path(path, folder));
}

std::string keyed_text(const AttributeInfo& info, const std::vector<double>& v) {
    if (info.def.is<bool>()) return v[0] != 0 ? "true" : "false";
    if (!info.options.empty()) return json_quoted(info.options[static_cast<std::size_t>(v[0])]);
    return v.size() == 1 ? number_text(v[0]) : list_text(v);
}

std::string curve_text(const AttributeInfo& info, const Curve& c) {
    static constexpr const char* words[] = {"step", "linear", "smooth"};
    std::string keys;
    for (const Key& k : c.keys) {
        keys += (keys.empty() ? "[" : ", [") + number_text(k.frame) + ", " + keyed_text(info, k.value.list());
        std::string tangents;
        if (!k.tangent_in.empty()) tangents += "\"in\": " + keyed_text(info, k.tangent_in);
        if (!k.tangent_out.empty())
            tangents += (tangents.empty() ? "\"out\": " : ", \"out\": ") + keyed_text(info, k.tangent_out);
        if (!tangents.empty()) keys += ", { " + tangents + " }";
        keys += "]";
    }
    return "{ \"keys\": [" + keys + "], \"interp\": \"" + words[static_cast<int>(c.interpolation)] + "\" }";
}

/// Comments, each on a line of its own.
std::string lines_of(const std::vector<std::string>& comments, std::string_view indent) {
    std::string out;
    for (const std::string& c : comments) out += "\n" + std::string(indent) + c;
    return out;
}

const Remark& remark_of(const Remarks& all, std::string_view key) {
    static const Remark none;
    const auto it = all.find(key);
    return it == all.end() ? none : it->second;
}

std::string plug_text(const Plug& p) { return "{ \"from\": " + json_quoted(p.text()) + " }"; }

/// Whether a value that is the default is written.
enum class Defaults { left_out, written };

// Empty: the binding says no more than the default does, and nobody says anything of it.
std::string binding_text(const AttributeInfo& info, const Binding& b, const Remark& remark, const Timing& timing,
                         const std::string& folder, Defaults defaults = Defaults::left_out) {
    const bool has_comment = !remark.json.empty();
    if (const Value* v = std::get_if<Value>(&b)) {
        const bool is_default = v->digest() == default_value(info, timing).digest() && !v->is<File>();
        if (is_default && defaults == Defaults::left_out && !info.required && remark.lines.empty() && !has_comment)
            return "";
        const std::string text = literal_text(*v, folder);
        return has_comment ? "{ \"value\": " + text + ", \"comment\": " + remark.json + " }" : text;
    }
    const auto with_comment = [&](std::string object) {
        if (has_comment) object.replace(object.size() - 2, 2, ", \"comment\": " + remark.json + " }");
        return object;
    };
    if (const Curve* c = std::get_if<Curve>(&b)) return with_comment(curve_text(info, *c));
    if (const Plug* p = std::get_if<Plug>(&b)) return with_comment(plug_text(*p));
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
        const Remark& remark = remark_of(n.remarks, name);
        const std::string text =
            binding_text(*n.type->find_input(name), n.inputs.find(name)->second, remark, timing, folder);
        if (!text.empty())
            inputs += (inputs.empty() ? "" : ",") + lines_of(remark.lines, "        ") + "\n        " +
                      json_quoted(name) + ": " + text;
    }
    std::string out = "{ \"type\": " + json_quoted(n.type_name);
    if (const Remark& remark = remark_of(n.remarks, ""); !remark.json.empty()) out += ", \"comment\": " + remark.json;
    if (!inputs.empty()) out += ", \"inputs\": {" + inputs + "\n      }";
    return out + " }";
}

// "node.input" of all that this graph says of an included one, in the order of its file.
std::vector<std::string> overridden(const Graph& graph, const std::string& prefix, const Include& include) {
    std::set<std::string> all;
    for (const std::string& name : include.graph->node_names())
        for (const auto& [input, place] : graph.find(prefix + "." + name)->overrides) all.insert(name + "." + input);
    std::vector<std::string> out;
    for (const std::string& plug : include.override_order)
        if (all.erase(plug) > 0) out.push_back(plug);
    out.insert(out.end(), all.begin(), all.end());
    return out;
}

std::string include_text(const Graph& graph, const std::string& prefix, const Include& include,
                         const std::string& folder) {
    std::string overrides;
    for (const std::string& text : overridden(graph, prefix, include)) {
        const Plug plug = parse_plug(text).value();
        const Node& n = *graph.find(prefix + "." + plug.node);
        const Remark& remark = remark_of(n.remarks, plug.attribute);
        overrides += (overrides.empty() ? "" : ",") + lines_of(remark.lines, "        ") + "\n        " +
                     json_quoted(text) + ": " +
                     binding_text(*n.type->find_input(plug.attribute), n.inputs.find(plug.attribute)->second, remark,
                                  graph.timing(), folder, Defaults::written);
    }
    std::string out = "{ \"file\": " + json_quoted(relative_path(include.file, folder));
    if (!include.remark.json.empty()) out += ", \"comment\": " + include.remark.json;
    if (!overrides.empty()) out += ", \"overrides\": {" + overrides + "\n      }";
    return out + " }";
}

} // namespace

std::string binding_json(const AttributeInfo& input, const Binding& binding, const std::string& folder) {
    return binding_text(input, binding, Remark{}, Timing{}, folder, Defaults::written);
}

std::string write_graph(const Graph& graph) {
    const Timing& t = graph.timing();
    std::string out = "{";
    const auto member = [&](std::string_view key, const std::string& text) {
        out += (out.size() > 1 ? "," : "") + lines_of(remark_of(graph.remarks(), key).lines, "  ") + "\n  " +
               json_quoted(key) + ": " + text;
    };
    const auto own = [&](std::string_view key) {
        if (const Remark& remark = remark_of(graph.remarks(), key); !remark.json.empty()) member(key, remark.json);
    };
    own("$schema");
    member("format", json_quoted("sinew " + std::to_string(current_format)));
    own("comment");
    const auto comment_on = [&](std::string_view key) -> const std::string& {
        return remark_of(graph.remarks(), key).json;
    };
    const auto begin_list = [&](std::string_view key) {
        return comment_on(key).empty() ? std::string() : "\n    \"comment\": " + comment_on(key);
    };
    member("timing", "{ \"fps\": " + number_text(t.fps) + ", \"start\": " + std::to_string(t.start) +
                         ", \"end\": " + std::to_string(t.end) +
                         (comment_on("timing").empty() ? "" : ", \"comment\": " + comment_on("timing")) + " }");
    const std::string folder = folder_of(graph.file());
    std::string includes = begin_list("includes");
    for (const auto& [prefix, include] : graph.includes())
        includes += (includes.empty() ? "" : ",") + lines_of(include->remark.lines, "    ") + "\n    " +
                    json_quoted(prefix) + ": " + include_text(graph, prefix, *include, folder);
    if (!includes.empty()) {
        includes += lines_of(remark_of(graph.remarks(), "includes").last, "    ");
        member("includes", "{" + includes + "\n  }");
    }
    std::string nodes = begin_list("nodes");
    for (const std::string& name : graph.node_names()) {
        if (is_included(name)) continue;
        const Node& n = *graph.find(name);
        nodes += (nodes.empty() ? "" : ",") + lines_of(remark_of(n.remarks, "").lines, "    ") + "\n    " +
                 json_quoted(name) + ": " + node_text(n, t, folder);
    }
    nodes += lines_of(remark_of(graph.remarks(), "nodes").last, "    ");
    member("nodes", "{" + nodes + (nodes.empty() ? "}" : "\n  }"));
    member("editor", graph.editor_json());
    return out + "\n}" + lines_of(remark_of(graph.remarks(), "").lines, "") + "\n";
}

} // namespace sinew::engine
