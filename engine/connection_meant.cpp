// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/connection_meant.h"

#include "engine/check.h"
#include "engine/format/read_value.h"
#include "engine/text.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <tuple>

namespace sinew::engine {

namespace {

constexpr std::string_view endings[] = {".obj", ".ply", ".off", ".stl",  ".glb", ".mesh", ".vtk",
                                        ".msh", ".veg", ".ele", ".node", ".pc2", ".mdd",  ".json"};

constexpr std::size_t most_named = 6;
// As this is said of each input that is wrong, and there may be many: nodes that are asked what they give, and what
// they depend on.
constexpr std::size_t most_asked = 1000, most_followed = 2000;

/// The only output of a type that the input takes; nullptr if there are none or several.
const AttributeInfo* only_fitting(const NodeType& type, const AttributeInfo& input) {
    const AttributeInfo* fits = nullptr;
    for (const AttributeInfo& out : type.outputs) {
        if (out.type != input.type) continue;
        if (fits) return nullptr;
        fits = &out;
    }
    return fits;
}

bool gives(const NodeType& type, const AttributeInfo& input) {
    return std::any_of(type.outputs.begin(), type.outputs.end(),
                       [&](const AttributeInfo& out) { return out.type == input.type; });
}

/// Whether `node` is among what `from` reads, or is it. True also where that takes too long to find out.
/// \param steps nodes that may be looked at; what is left of them
bool depends(const Graph& graph, const std::string& from, std::string_view node, std::size_t& steps) {
    std::set<std::string, std::less<>> seen{from};
    std::vector<std::string> open{from};
    while (!open.empty()) {
        const std::string name = std::move(open.back());
        open.pop_back();
        if (name == node || steps == 0) return true;
        --steps;
        const Node* n = graph.find(name);
        if (!n) continue;
        const auto add = [&](const Plug& p) {
            if (seen.insert(p.node).second) open.push_back(p.node);
        };
        for (const auto& [input, binding] : n->inputs) {
            if (const auto* one = std::get_if<Plug>(&binding)) add(*one);
            if (const auto* all = std::get_if<std::vector<Plug>>(&binding))
                std::for_each(all->begin(), all->end(), add);
        }
    }
    return false;
}

/// "tissue" of zTissue: what texts call the type.
std::string plain_name(std::string_view type) {
    if (type.size() > 2 && type[0] == 'z' && std::isupper(static_cast<unsigned char>(type[1]))) type.remove_prefix(1);
    return lower_case(type);
}

std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> out(1);
    for (const char c : text)
        if (std::isalpha(static_cast<unsigned char>(c)))
            out.back() += c;
        else if (!out.back().empty())
            out.emplace_back();
    return out;
}

/// What the input's documentation calls the types that it is meant for; empty: it names none that give its value, or
/// only examples of them.
std::vector<std::string> kinds_named(const Registry& registry, const AttributeInfo& input) {
    std::string text = meaning_of(input);
    for (const char* example : {"such as", "for example", "most often"}) text = text.substr(0, text.find(example));
    const std::vector<std::string> words = words_of(text);
    std::vector<std::string> out;
    for (const std::string& name : registry.names())
        if (gives(*registry.find(name), input))
            for (const std::string& word : words)
                if (word == name || lower_case(word) == plain_name(name)) out.push_back(plain_name(name));
    return out;
}

/// A subtissue is a tissue.
bool is_of_kind(const NodeType& type, std::span<const std::string> kinds) {
    const std::string name = plain_name(type.name);
    return kinds.empty() ||
           std::any_of(kinds.begin(), kinds.end(), [&](const std::string& kind) { return name.ends_with(kind); });
}

/// A type's way to read a file: by an input that it needs, or by a mode of that input's name.
struct FileInput {
    const NodeType* type = nullptr;
    const AttributeInfo *file = nullptr, *mode = nullptr, *output = nullptr;
};

FileInput file_input(const NodeType& type, const AttributeInfo& input) {
    const AttributeInfo* output = only_fitting(type, input);
    for (const AttributeInfo& file : type.inputs) {
        if (!output || !file.def.is<File>()) continue;
        if (file.required) return {&type, &file, nullptr, output};
        for (const AttributeInfo& mode : type.inputs)
            if (std::find(mode.options.begin(), mode.options.end(), file.name) != mode.options.end())
                return {&type, &file, &mode, output};
    }
    return {};
}

/// A name for the node of a file that nothing has.
std::string free_name(const Graph& graph, const std::string& path) {
    std::string out;
    for (const char c : std::filesystem::path(path).stem().string())
        out += std::isalnum(static_cast<unsigned char>(c)) || c == '-' ? c : '_';
    while (graph.find(out) || graph.find_include(out)) out += "_file";
    return out;
}

} // namespace

std::string output_meant(const Graph& graph, const AttributeInfo& input, const std::string& text, bool near) {
    const auto plug = parse_plug(text);
    std::string name = plug ? plug->node : text;
    const Node* n = graph.find(name);
    const bool is_exact = n != nullptr;
    if (!n) {
        const std::string found = nearest_name(name, graph.node_names());
        if (near || plug || lower_case(found) == lower_case(name)) n = graph.find(name = found);
    }
    if (!n) return {};
    if (!n->type) return is_exact && plug ? text : ""; // a type that this program does not know
    if (plug)
        if (const AttributeInfo* out = n->type->find_output(plug->attribute); out && out->type == input.type)
            return name + "." + plug->attribute;
    if (plug && !near && !is_exact) return {};
    const AttributeInfo* only = only_fitting(*n->type, input);
    return only ? name + "." + std::string(only->name) : "";
}

std::vector<std::string> fitting_outputs(const Graph& graph, std::string_view node, const AttributeInfo& input,
                                         std::span<const std::string> names, std::size_t most) {
    const std::vector<std::string> kinds = kinds_named(graph.registry(), input);
    std::vector<std::string> out;
    std::size_t steps = most_followed;
    for (std::size_t i = 0; i < std::min(names.size(), most_asked) && out.size() <= most; ++i) {
        const Node* n = graph.find(names[i]);
        if (!n || !n->type || !gives(*n->type, input) || !is_of_kind(*n->type, kinds)) continue;
        if (depends(graph, names[i], node, steps)) continue;
        for (const AttributeInfo& output : n->type->outputs)
            if (output.type == input.type) out.push_back(names[i] + "." + std::string(output.name));
    }
    return out;
}

std::string file_node_form(const Graph& graph, const AttributeInfo& input, const std::string& text) {
    const std::string ending = lower_case(std::filesystem::path(text).extension().string());
    if (std::find(std::begin(endings), std::end(endings), ending) == std::end(endings)) return {};
    if (input.kind == AttributeKind::literal && !input.def.is<NumberList>()) return {};
    // The plainest: one that needs the file, and of those the one with the fewest inputs.
    FileInput best;
    const bool is_sequence = text.find('#') != std::string::npos;
    const auto rank = [&](const FileInput& f) {
        return std::tuple(f.mode != nullptr, is_sequence != f.type->uses_time, f.type->inputs.size());
    };
    for (const std::string& name : graph.registry().names()) {
        const FileInput found = file_input(*graph.registry().find(name), input);
        if (found.type && (!best.type || rank(found) < rank(best))) best = found;
    }
    if (!best.type) return {};
    std::string inputs, choice;
    const auto add = [&](std::string_view key, const std::string& value) {
        inputs.append(inputs.empty() ? "" : ", ").append(json_quoted(key)).append(": ").append(value);
    };
    for (const AttributeInfo& a : best.type->inputs) {
        if (!a.required || a.kind != AttributeKind::wire) continue;
        std::vector<std::string> there = fitting_outputs(graph, {}, a, graph.node_names(), most_named);
        add(a.name, "{ \"from\": " + json_quoted(there.size() == 1 ? there.front() : "node.output") + " }");
        for (std::string& plug : there) plug = json_quoted(plug);
        if (there.size() > 1 && there.size() <= most_named) choice += "; " + std::string(a.name) + ": " + listed(there);
    }
    if (best.mode) add(best.mode->name, json_quoted(best.file->name));
    add(best.file->name, json_quoted(text));
    const std::string name = free_name(graph, text);
    const std::string from = "{ \"from\": " + json_quoted(name + "." + std::string(best.output->name)) + " }";
    return "add " + json_quoted(name) + ": { \"type\": " + json_quoted(best.type->name) + ", \"inputs\": { " + inputs +
           " } } to the nodes and write " + (input.kind == AttributeKind::wire_list ? "[ " + from + " ]" : from) +
           choice;
}

std::string fitting_place(const Node& source, const AttributeInfo& out, const Plug& plug, const NodeType& type,
                          const AttributeInfo& input) {
    if (const AttributeInfo* other = only_fitting(*source.type, input))
        return "did you mean " + json_quoted(plug.node + "." + std::string(other->name)) + "?";
    std::vector<std::string> names;
    for (const AttributeInfo& a : type.inputs)
        if (a.type == out.type && a.kind != AttributeKind::literal) names.emplace_back(a.name);
    const std::string near = names.size() == 1 ? names.front() : nearest_name(input.name, names);
    if (near.empty()) return {};
    const std::string from = "{ \"from\": " + json_quoted(plug.text()) + " }";
    const bool is_list = type.find_input(near)->kind == AttributeKind::wire_list;
    return "did you mean " + json_quoted(near) + ": " + (is_list ? "[ " + from + " ]" : from) + "?";
}

std::span<const std::string_view> readable_endings() { return endings; }

} // namespace sinew::engine
