// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/open_graph.h"

#include "tools/cli/long_task.h"
#include "tools/cli/machine.h"

#include "engine/check.h"
#include "engine/digest.h"
#include "engine/format/graph_file.h"
#include "engine/format/json_text.h"
#include "engine/format/typed_text.h"
#include "engine/memory_limit.h"
#include "engine/near_file.h"
#include "engine/text.h"
#include "nodes/mesh_names.h"
#include "nodes/register_all.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <set>

namespace sinew::cli {

using embed::sources;
using embed::split_plug;
using engine::Binding;
using engine::Graph;
using engine::Node;
using engine::Plug;

namespace {

/// "+5" and ".2" are no JSON, but numbers where no word is asked for.
std::optional<double> typed_number(const Graph& graph, const Plug& plug, const std::string& text) {
    const Node* n = graph.find(plug.node);
    const engine::AttributeInfo* info = n && n->type ? n->type->find_input(plug.attribute) : nullptr;
    if (info && (info->def.is<std::string>() || info->def.is<engine::File>())) return {};
    const auto quantity = engine::parse_quantity(text);
    return quantity && quantity->unit.empty() ? std::optional(quantity->number) : std::nullopt;
}

void apply_setting(engine::Edit& edit, const Graph& graph, const std::string& setting) {
    const std::size_t equals = setting.find('=');
    const Plug plug = split_plug(setting.substr(0, equals));
    if (equals == std::string::npos || plug.node.empty())
        throw UsageError("--set needs NODE.ATTR=JSON, not '" + setting + "'.");
    const std::string json = setting.substr(equals + 1);
    // What is no JSON is a word, but for what begins as a list or an object does; a number that is too large stays one.
    // Both are told so.
    const auto problems = engine::parse_json(json).problems;
    const bool is_json =
        std::all_of(problems.begin(), problems.end(), [](const engine::JsonProblem& p) { return p.code == "DG027"; });
    const bool is_bracketed = json.starts_with('[') || json.starts_with('{');
    if (is_json || is_bracketed)
        edit.set_json(plug, json);
    else if (const auto number = typed_number(graph, plug, json))
        edit.set_json(plug, engine::number_text(*number));
    else
        edit.set_json(plug, engine::json_quoted(json));
}

/// What stands beside the nodes in a file: "timing.end" is no input of one.
bool is_timing(const Plug& plug) {
    static const std::vector<std::string> keys = {"fps", "start", "end"};
    static const std::vector<std::string> name = {"timing"};
    return !engine::nearest_name(plug.node, name).empty() &&
           std::find(keys.begin(), keys.end(), plug.attribute) != keys.end();
}

std::string timing_hint(const Plug& plug, const std::string& setting) {
    return "it is no node: write \"timing\": { " + engine::json_quoted(plug.attribute) + ": " +
           setting.substr(setting.find('=') + 1) + " } in the graph file" +
           (plug.attribute == "fps" ? "" : ", or choose the frames by --frames or --frame");
}

/// The same with the --set that each is about as its place: what stands there in the file is not what is wrong.
std::vector<engine::Diagnostic> in_settings(std::span<const engine::Diagnostic> problems,
                                            const std::vector<std::string>& settings) {
    std::vector<engine::Diagnostic> out(problems.begin(), problems.end());
    for (engine::Diagnostic& d : out)
        for (const std::string& setting : settings) {
            const Plug plug = split_plug(setting.substr(0, setting.find('=')));
            if (plug.node != d.node || plug.attribute != d.attribute) continue;
            d.spot = {"--set " + setting, "", 0, 0, {}};
            if (d.code == "DG040" && is_timing(plug)) d.hint = timing_hint(plug, setting);
        }
    return out;
}

/// The literal at an input, or its default. Empty if it is connected, keyed or unknown.
engine::Value literal(const Graph& graph, const std::string& node, std::string_view attribute) {
    const Node* n = graph.find(node);
    if (!n) return {};
    if (const auto it = n->inputs.find(attribute); it != n->inputs.end()) {
        const auto* value = std::get_if<engine::Value>(&it->second);
        return value ? *value : engine::Value();
    }
    const engine::AttributeInfo* info = n->type ? n->type->find_input(attribute) : nullptr;
    return info ? engine::default_value(*info, graph.timing()) : engine::Value();
}

render::BodyKind kind_of_node(const Graph& graph, const std::string& node) {
    const Node* n = graph.find(node);
    if (!n) return render::BodyKind::plain;
    if (n->type_name == "zBone") return render::BodyKind::bone;
    if (n->type_name == "zTissue" || n->type_name == "zSubtissue") return render::BodyKind::tissue;
    return n->type_name == "zCloth" ? render::BodyKind::cloth : render::BodyKind::plain;
}

/// What a body node writes of its look. A mesh that rides on a body through zEmbedder is none itself.
render::Appearance appearance_of_node(const Graph& graph, const std::string& node) {
    render::Appearance out;
    const Node* n = graph.find(node);
    if (!n || !n->type || !n->type->find_input("appearance")) return out;
    // Literals: neither can be keyed, and no output gives a text or a colour that could be connected.
    const auto written = [&](std::string_view attribute) {
        const auto it = n->inputs.find(attribute);
        const auto* value = it == n->inputs.end() ? nullptr : std::get_if<engine::Value>(&it->second);
        return value ? *value : engine::Value();
    };
    if (const engine::Value v = written("appearance"); v.is<std::string>())
        out.matter = render::matter_of(v.as<std::string>());
    if (const engine::Value v = written("colour"); v.is<engine::Vec3>()) {
        const engine::Vec3& c = v.as<engine::Vec3>();
        out.colour = Eigen::Vector3d(c[0], c[1], c[2]).cast<float>();
    }
    return out;
}

BodyLabel label_of(const Graph& graph, std::string name, const std::string& node) {
    return {std::move(name), kind_of_node(graph, node), appearance_of_node(graph, node)};
}

} // namespace

std::string file_name(const std::string& node) {
    std::string out;
    for (const char c : node) out += std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ? c : '_';
    // File systems take 255 bytes; the frame, an ending and what numbers names apart come after it.
    constexpr std::size_t most = 200, hash = 16;
    if (out.size() > most)
        out = out.substr(0, most - hash - 1) + "_" + engine::Hasher().add(node).finish().hex().substr(0, hash);
    return out;
}

engine::FileAccess file_access(const Arguments& arguments) {
    const auto root = arguments.value("--root");
    if (!root) return {};
    if (root->empty()) throw UsageError("--root needs the name of a folder, not ''.");
    return engine::FileAccess::within(*root);
}

OpenGraph open_graph(const Arguments& arguments) { return open_graph(arguments, arguments.operand(0).value()); }

OpenGraph open_graph(const Arguments& arguments, const std::string& file) {
    const LongTask task(std::cerr, "reading " + file, arguments.has("--quiet"));
    engine::Loaded loaded = engine::load_graph(nodes::make_registry(), file, file_access(arguments));
    if (arguments.has("--set")) {
        engine::Edit edit(loaded.graph);
        for (const std::string& setting : arguments.values("--set")) apply_setting(edit, *loaded.graph, setting);
        try {
            loaded.graph = edit.commit().graph;
        } catch (const engine::Failure& failure) { // what the reader noted may be why
            std::vector<engine::Diagnostic> all = std::move(loaded.notes);
            for (engine::Diagnostic& d : in_settings(failure.diagnostics(), arguments.values("--set")))
                all.push_back(std::move(d));
            throw engine::Failure(std::move(all));
        }
        // What was said of the timing holds for the graph as it is now.
        std::erase_if(loaded.notes, [](const engine::Diagnostic& d) { return d.code == "DG031" || d.code == "DG104"; });
        for (engine::Diagnostic& d : engine::check_timing(*loaded.graph)) loaded.notes.push_back(std::move(d));
    }
    return {std::move(loaded.graph), std::move(loaded.notes)};
}

bool may_be_graph(const std::string& file) {
    std::error_code unknown;
    if (!std::filesystem::is_regular_file(file, unknown)) return true; // what reads graphs says what it is
    std::ifstream in(file, std::ios::binary);
    char first = '{';
    in >> first;
    return first == '{' || first == '[' || first == '/' || first == '\xEF';
}

void check_source(const std::filesystem::path& source, const engine::FileAccess& files) {
    std::error_code error;
    if (files.is_confined() || std::filesystem::status(source, error).type() != std::filesystem::file_type::not_found)
        return;
    const std::string near = engine::near_file(std::filesystem::path(source).replace_extension(".json"), {});
    engine::Diagnostic d;
    d.code = "IO401";
    d.spot = {source.string(), "", 0, 0, {}};
    d.message = "there is neither a folder of a run nor a graph file of this name";
    d.hint = near.empty() ? "`sinew run GRAPH.json --out " + source.string() + "` makes such a folder"
                          : "did you mean \"" + (source.parent_path() / near).string() + "\"?";
    throw engine::Failure(std::move(d));
}

OpenGraph open_graph(const std::string& file, const engine::FileAccess& files) {
    const LongTask task(std::cerr, "reading " + file, false);
    engine::Loaded loaded = engine::load_graph(nodes::make_registry(), file, files);
    return {std::move(loaded.graph), std::move(loaded.notes)};
}

Plug parse_plug(const Graph& graph, const std::string& text) {
    const Plug plug = split_plug(text);
    if (plug.node.empty())
        throw UsageError("'" + text + "' is no plug; write NODE.PLUG, for example solver.outMeshes.");
    const Node* node = graph.find(plug.node);
    if (!node)
        throw UsageError("the graph has no node '" + plug.node + "'." + did_you_mean(plug.node, graph.node_names()));
    if (node->type && !node->type->find_output(plug.attribute)) {
        std::vector<std::string> known;
        for (const auto& output : node->type->outputs) known.emplace_back(output.name);
        std::string list;
        for (const std::string& name : known) list += (list.empty() ? " Its outputs: " : ", ") + name;
        const std::string near = did_you_mean(plug.attribute, known);
        throw UsageError("a " + node->type_name + " has no output '" + plug.attribute + "'." +
                         (near.empty() ? list + "." : near));
    }
    return plug;
}

Plug default_plug(const Graph& graph) {
    const std::vector<std::string> found = embed::last_solvers(graph, graph.node_names());
    if (found.size() == 1) return {found.front(), "outMeshes"};
    if (found.empty()) throw UsageError("the graph has no zSolver; name what to evaluate with --pull NODE.PLUG.");
    std::string list;
    for (const std::string& name : found) list += (list.empty() ? "" : ", ") + name + ".outMeshes";
    throw UsageError("the graph has several solvers; choose with --pull: " + list + ".");
}

std::size_t memory_budget(const Arguments& arguments) {
    const auto text = arguments.value("--memory");
    if (!text) return engine::StorePolicy::default_bytes();
    const auto bytes = to_bytes(*text);
    if (!bytes)
        throw UsageError("--memory needs a size with its unit, for example 500MB or \"2 GB\", not '" + *text + "'.");
    const auto most = static_cast<double>(engine::memory_limit());
    if (*bytes > most) throw UsageError("--memory " + *text + " is more than there is: " + rounded_bytes(most) + ".");
    if (*bytes < 1e6) throw UsageError("--memory needs at least 1 MB, not '" + *text + "'.");
    return static_cast<std::size_t>(*bytes);
}

engine::StorePolicy store_policy(const Arguments& arguments, const Graph& graph) {
    return store_policy(arguments, graph.file());
}

engine::StorePolicy store_policy(const Arguments& arguments, const std::string& file) {
    if (arguments.has("--cache") && arguments.has("--no-cache"))
        throw UsageError("--cache and --no-cache contradict each other.");
    if (arguments.value("--cache") == "")
        throw UsageError("--cache needs the name of a folder, not ''; --no-cache keeps nothing on disk.");
    engine::StorePolicy policy = engine::StorePolicy::within(memory_budget(arguments));
    if (arguments.has("--no-cache")) return policy;
    const std::filesystem::path beside = std::filesystem::path(file).replace_extension(".sinew-cache");
    policy.disk_folder = arguments.value("--cache").value_or(beside.string());
    policy.files = file_access(arguments);
    policy.files.check(policy.disk_folder, "--cache");
    const char* keeps = std::getenv("SINEW_KEEP_FRAMES");
    if (keeps && std::string_view(keeps) != "off" && std::string_view(keeps) != "on")
        throw UsageError("SINEW_KEEP_FRAMES is on or off, not '" + std::string(keeps) + "'.");
    policy.keeps_frames = arguments.has("--cache") || !keeps || std::string_view(keeps) == "on";
    policy.build = build_mark();
    if (const auto text = arguments.value("--cache-size")) {
        const auto bytes = to_bytes(*text);
        if (!bytes || *bytes < 1e6)
            throw UsageError("--cache-size needs a size of at least 1 MB with its unit, for example \"20 GB\", not '" +
                             *text + "'.");
        policy.disk_bytes = static_cast<std::uintmax_t>(std::min(*bytes, 1e18));
    }
    return policy;
}

int start_frame(const Graph& graph, const std::vector<std::string>& nodes) {
    std::vector<int> starts;
    for (const std::string& name : simulations(graph, nodes)) {
        const auto value = literal(graph, name, graph.find(name)->type->simulation->start_frame_input);
        if (value.is<double>() && std::abs(value.as<double>()) < 1e9)
            starts.push_back(static_cast<int>(std::floor(value.as<double>())));
    }
    return starts.empty() ? graph.timing().start : *std::min_element(starts.begin(), starts.end());
}

SceneAxes scene_axes(const Graph& graph, const std::vector<std::string>& nodes) {
    SceneAxes axes;
    const auto found = simulations(graph, nodes);
    if (found.empty()) return axes;
    if (const auto scale = literal(graph, found.front(), "scale"); scale.is<double>())
        axes.units_per_metre = scale.as<double>();
    if (const auto gravity = literal(graph, found.front(), "gravity"); gravity.is<engine::Vec3>()) {
        const engine::Vec3& g = gravity.as<engine::Vec3>();
        if (std::abs(g[2]) > std::max(std::abs(g[0]), std::abs(g[1]))) axes.up = 'z';
    }
    return axes;
}

std::vector<BodyLabel> body_labels(const Graph& graph, const Plug& plug, std::size_t count) {
    const Node* node = graph.find(plug.node);
    std::vector<BodyLabel> labels;
    const bool is_collision = plug.attribute == "outCollisionMeshes"; // of the body, not of the meshes that ride on it
    if (node && is_collision && count == 1)
        if (const auto body = node->inputs.find("body"); body != node->inputs.end())
            for (const Plug& source : sources(body->second))
                labels.push_back(label_of(graph, file_name(source.node) + "_collision", source.node));
    if (!is_collision)
        for (const std::string& name : nodes::mesh_names(graph, plug, count))
            labels.push_back(label_of(graph, file_name(name), name));
    if (labels.empty())
        for (std::size_t i = 0; i < count; ++i)
            labels.push_back(
                label_of(graph, file_name(plug.node) + (count > 1 ? "_" + std::to_string(i + 1) : ""), plug.node));
    std::set<std::string> taken;
    for (BodyLabel& label : labels) {
        const std::string base = label.name;
        for (int number = 2; !taken.insert(label.name).second; ++number)
            label.name = base + "_" + std::to_string(number);
    }
    return labels;
}

std::vector<nodes::Mesh> meshes_in(const engine::Value& value) {
    if (value.is<nodes::MeshList>()) return value.as<nodes::MeshList>().meshes;
    if (value.is<nodes::Mesh>()) return {value.as<nodes::Mesh>()};
    return {};
}

} // namespace sinew::cli
