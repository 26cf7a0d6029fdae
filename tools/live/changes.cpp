// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/live/changes.h"

#include "engine/check.h"
#include "engine/format/graph_file.h"
#include "engine/format/text_patch.h"
#include "engine/units.h"
#include "nodes/register_all.h"
#include "tools/cli/graph_diff.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace sinew::live {

using Json = nlohmann::ordered_json;

namespace {

bool is_keyed(const engine::Graph& graph, const engine::Plug& input) {
    const engine::Node* node = graph.find(input.node);
    if (!node) return false;
    const auto it = node->inputs.find(input.attribute);
    return it != node->inputs.end() && std::holds_alternative<engine::Curve>(it->second);
}

/// The keys with another one, whose value is read as in a graph file: vectors, words, numbers with a unit. A key that
/// is there keeps its tangents.
engine::Curve with_key_read(const std::shared_ptr<const engine::Graph>& graph, const Change& c, const Json& value) {
    const bool has_form = value.is_object();
    if (has_form && !value.contains("value")) {
        engine::Diagnostic d;
        d.code = "DG043";
        d.node = c.input.node, d.attribute = c.input.attribute;
        d.message = "a key among others needs one value, not " + c.json.substr(0, 100);
        d.hint =
            "Give a number, a vector or { \"value\": …, \"unit\": … }, or set the input itself, without a frame, with "
            "all its keys.";
        throw engine::Failure(d);
    }
    Json alone = {{"keys", Json::array({Json::array({*c.frame, has_form ? value.at("value") : value})})}};
    if (has_form && value.contains("unit")) alone["unit"] = value.at("unit");
    const auto read = engine::Edit(graph).set_json(c.input, alone.dump()).commit().graph;
    const auto curve_of = [&](const engine::Graph& g) -> const engine::Curve& {
        return std::get<engine::Curve>(g.find(c.input.node)->inputs.find(c.input.attribute)->second);
    };
    const engine::Key& key = curve_of(*read).keys.front();
    engine::Curve out = curve_of(*graph);
    const auto at = std::lower_bound(out.keys.begin(), out.keys.end(), key.frame,
                                     [](const engine::Key& k, double frame) { return k.frame < frame; });
    if (at != out.keys.end() && at->frame == key.frame)
        at->value = key.value;
    else
        out.keys.insert(at, key);
    return out;
}

/// The graph was saved without what the change is for, say.
engine::Diagnostic no_longer_fits(const Change& c, const engine::Diagnostic& why) {
    engine::Diagnostic d;
    d.code = "DG175";
    d.node = c.input.node, d.attribute = c.input.attribute;
    if (c.frame) d.frame = *c.frame;
    d.message = "the change to " + c.json.substr(0, 100) +
                ", made in the page and not yet in the file, no longer fits the file: " + why.message;
    d.hint = "Nothing runs until the page's changes are discarded, or the file is such that this one fits again.";
    return d;
}

const engine::Binding* binding_at(const engine::Graph& graph, const engine::Plug& input) {
    const engine::Node& node = *graph.find(input.node);
    const auto it = node.inputs.find(input.attribute);
    return it == node.inputs.end() ? nullptr : &it->second;
}

/// The value of the key at a frame, in a unit of this factor.
std::string key_text(const engine::Curve& curve, double frame, double factor, bool is_exact) {
    const auto key =
        std::find_if(curve.keys.begin(), curve.keys.end(), [&](const engine::Key& k) { return k.frame == frame; });
    if (key == curve.keys.end()) return "";
    std::string out;
    for (const double v : key->value) {
        char rounded[32];
        std::snprintf(rounded, sizeof rounded, "%.15g", v / factor);
        out += (out.empty() ? "" : ", ") + (is_exact ? Json(v / factor).dump() : std::string(rounded));
    }
    return key->value.size() == 1 ? out : "[" + out + "]";
}

/// How a change may stand in the file, best first: as it was typed, else as Sinew writes it.
std::vector<std::string> ways_to_write(const std::string& text, const engine::Graph& before, const engine::Graph& after,
                                       const Change& c) {
    const engine::AttributeInfo& info = *after.find(c.input.node)->type->find_input(c.input.attribute);
    std::vector<std::optional<std::string>> ways;
    if (!c.frame) ways.push_back(engine::with_input(text, c.input, c.json));
    if (c.frame && is_keyed(before, c.input)) {
        const auto unit = engine::keys_unit(text, c.input);
        std::optional<double> factor;
        if (unit) factor = engine::unit_factor(*unit, info.unit);
        if (!factor) ways.push_back(engine::with_key(text, c.input, *c.frame, c.json));
        if (info.options.empty() && !info.def.is<bool>()) {
            const auto& curve = std::get<engine::Curve>(*binding_at(after, c.input));
            for (const bool is_exact : {false, true}) // 1.2, not 1.2000000000000002, where that reads the same
                ways.push_back(
                    engine::with_key(text, c.input, *c.frame, key_text(curve, *c.frame, factor.value_or(1), is_exact)));
        }
    }
    const std::string folder = std::filesystem::path(after.file()).parent_path().string();
    ways.push_back(engine::with_input(text, c.input, engine::binding_json(info, *binding_at(after, c.input), folder)));
    std::vector<std::string> out;
    for (std::optional<std::string>& way : ways)
        if (way) out.push_back(std::move(*way));
    return out;
}

/// An edit may leave a required list empty for a while, a graph file may not: it could not be read again.
void check_file_would_have_it(const engine::Graph& graph, const engine::Plug& input) {
    const engine::Node& node = *graph.find(input.node);
    std::vector<engine::Diagnostic> wrong;
    for (engine::Problem& p : engine::check_required(graph, input.node, node, graph.node_names()))
        if (p.diagnostic.attribute == input.attribute) wrong.push_back(std::move(p.diagnostic));
    if (!wrong.empty()) throw engine::Failure(std::move(wrong));
}

/// No text of the file reads as what is wanted.
engine::Diagnostic without_place(const Change& c, const std::string& file) {
    engine::Diagnostic d;
    d.code = "DG181";
    d.node = c.input.node, d.attribute = c.input.attribute;
    if (c.frame) d.frame = *c.frame;
    d.message = "the text of " + file + " has no place for the change to " + c.json.substr(0, 100);
    d.hint = "Write it into the file by hand, or discard the page's changes.";
    return d;
}

} // namespace

engine::Diagnostic unwritable(const std::string& file, const std::string& why) {
    engine::Diagnostic d;
    d.code = "IO405";
    d.message = "cannot write " + file + ": " + why;
    d.hint = "Make the file and its folder writable.";
    return d;
}

std::shared_ptr<const engine::Graph> with_change(const std::shared_ptr<const engine::Graph>& graph, const Change& c) {
    engine::Edit edit(graph);
    if (c.frame && is_keyed(*graph, c.input)) {
        const Json value = Json::parse(c.json);
        if (value.is_number() || value.is_boolean())
            edit.set_key(c.input, *c.frame, value.is_boolean() ? (value.get<bool>() ? 1 : 0) : value.get<double>());
        else
            edit.set(c.input, with_key_read(graph, c, value));
    } else if (c.frame) {
        // As a host sends it: the frames before stay as they are.
        const auto read = engine::Edit(graph).set_json(c.input, c.json).commit().graph;
        const engine::Binding& binding = read->find(c.input.node)->inputs.find(c.input.attribute)->second;
        const auto* value = std::get_if<engine::Value>(&binding);
        if (value)
            edit.set_input(c.input, *c.frame, *value);
        else
            edit.set_json(c.input, c.json); // keys themselves
    } else
        edit.set_json(c.input, c.json);
    auto out = edit.commit().graph;
    check_file_would_have_it(*out, c.input);
    return out;
}

std::shared_ptr<const engine::Graph> with_changes(std::shared_ptr<const engine::Graph> graph,
                                                  const std::vector<Change>& changes) {
    std::vector<engine::Diagnostic> wrong;
    for (const Change& c : changes) {
        try {
            graph = with_change(graph, c);
        } catch (const engine::Failure& failure) {
            wrong.push_back(no_longer_fits(c, failure.diagnostics().front()));
        }
    }
    if (!wrong.empty()) throw engine::Failure(std::move(wrong));
    return graph;
}

std::string written_into(std::string text, const std::string& file, const engine::FileAccess& files,
                         const std::vector<Change>& changes) {
    const auto registry = nodes::make_registry();
    std::shared_ptr<const engine::Graph> graph = engine::read_graph(registry, text, file, files).graph;
    for (const Change& c : changes) {
        const std::shared_ptr<const engine::Graph> wanted = with_changes(graph, {c});
        bool is_written = false;
        std::vector<engine::Diagnostic> why;
        for (std::string& way : ways_to_write(text, *graph, *wanted, c)) {
            try { // it is read as it will be, so that no text can come to mean something else
                auto read = engine::read_graph(registry, way, file, files).graph;
                if (!cli::differences(*wanted, *read).empty()) continue;
                graph = std::move(read);
                text = std::move(way);
                is_written = true;
                break;
            } catch (const engine::Failure& failure) {
                why.assign(failure.diagnostics().begin(), failure.diagnostics().end());
            }
        }
        if (is_written) continue;
        why.push_back(without_place(c, file));
        throw engine::Failure(std::move(why));
    }
    return text;
}

} // namespace sinew::live
