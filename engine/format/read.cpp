// JSON text -> Graph. Stages: syntax, format number, migrations, then everything inside at once.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/comments.h"
#include "engine/format/format_number.h"
#include "engine/format/graph_file.h"
#include "engine/format/graph_text.h"
#include "engine/format/key_meant.h"
#include "engine/format/migrate.h"
#include "engine/format/read_value.h"
#include "engine/format/typed_text.h"
#include "engine/format/value_meant.h"
#include "engine/include.h"
#include "engine/origin.h"
#include "engine/text.h"

#include <algorithm>
#include <cmath>

namespace sinew::engine {

namespace {

constexpr std::size_t most_levels = 32, most_included_nodes = 1000000;

/// What one file gives.
struct Part {
    std::shared_ptr<const Graph> graph; ///< nullptr: not even its nodes are known. Else as far as it is right
    std::vector<Diagnostic> problems, notes;
    /// Nodes of types that this program does not know. The graph is read in spite of them, but where it cannot be used
    /// for other reasons they are wrong as well.
    std::vector<Diagnostic> unknown_types;
    std::optional<double> fps; ///< if the file says it
};

/// What the files of one graph have in common while they are read.
struct Reading {
    std::map<std::string, Part> parts; ///< by file: a graph that is included twice is read once
    struct Open {
        std::string key, path; ///< file_key, and as it was named
    };
    std::vector<Open> open; ///< the files that include the one at work, the outermost first
    std::size_t included_nodes = 0;
};

} // namespace

class GraphReader {
  public:
    GraphReader(std::shared_ptr<const Registry> registry, std::string_view text, const std::string& file,
                const FileAccess& files, Reading& reading)
        : graph_(std::move(registry))
        , source_(std::make_shared<SourceText>(file, text))
        , folder_(folder_of(file))
        , reading_(reading)
        , is_outermost_(reading.open.empty()) {
        graph_.file_ = file;
        graph_.files_ = files;
    }

    Part read() {
        Part out;
        JsonDocument doc = parse_json(source_->text);
        if (!doc.problems.empty() && is_nothing_but_comments(source_->text, doc.comments)) {
            problem("DG004", 0, "", {}, {}, "there is nothing but comments in the file",
                    "write { \"format\": … } below them");
            doc.problems.clear();
        }
        for (JsonProblem& p : doc.problems)
            problem(p.code, p.offset, p.pointer, {}, {}, std::move(p.message), std::move(p.hint));
        const FormatNumber format = problems_.empty() ? format_number(doc.root) : FormatNumber();
        if (!format.code.empty()) problem(format.code, format.at, format.pointer, {}, {}, format.message, format.hint);
        if (problems_.empty() && format.number < current_format)
            return GraphReader(graph_.registry_,
                               migrated(source_->text, format.number, current_format, migration_steps()).value(),
                               source_->file, graph_.files_, reading_)
                .read();
        if (problems_.empty()) {
            reading_.open.push_back({file_key(source_->file), source_->file});
            top(doc.root);
            reading_.open.pop_back();
            if (problems_.empty()) remarks(doc.comments);
            if (is_outermost_ && problems_.empty())
                for (Diagnostic& d : check_timing(graph_)) notes_.push_back(std::move(d));
            if (says_fps_) out.fps = graph_.timing_.fps;
            out.graph = std::make_shared<const Graph>(std::move(graph_));
        }
        out.problems = std::move(problems_), out.notes = std::move(notes_);
        out.unknown_types = std::move(unknown_types_);
        return out;
    }

  private:
    struct Pending { // a node whose bindings are checked once all nodes are known
        std::string name, pointer;
        const Json* inputs;
        std::size_t at;
    };

    Diagnostic& problem(std::string_view code, std::size_t offset, const std::string& pointer, std::string_view node,
                        std::string_view attribute, std::string message, std::string hint = {}) {
        Diagnostic d;
        d.code = code;
        d.node = node, d.attribute = attribute;
        d.message = std::move(message), d.hint = std::move(hint);
        const TextPlace place = source_->lines.at(offset);
        d.spot = SourceSpot{source_->file, pointer, place.line, place.column};
        problems_.push_back(std::move(d));
        return problems_.back();
    }

    /// \param inputs of the node's type, for keys of a node
    void unknown_keys(const Json::Object& object, Level level, const std::string& pointer, std::string_view node,
                      std::span<const std::string> inputs = {}) {
        const auto known = keys_of(level);
        for (const JsonMember& m : object)
            if (std::find(known.begin(), known.end(), m.key) == known.end())
                problem("DG007", m.key_begin, pointer + pointer_token(m.key), node, {},
                        "unknown key " + json_quoted(m.key), key_hint(m.key, level, inputs));
    }

    void top(const Json& root) {
        unknown_keys(*root.as<Json::Object>(), Level::document, "", {});
        for (const JsonMember& m : *root.as<Json::Object>()) {
            anchors_.push_back({m.key_begin, m.value.end, std::string::npos, "", m.key});
            if (m.key == "editor") anchors_.back().kept_from = m.value.begin;
            if (m.key == "$schema" || m.key == "comment") graph_.remarks_[m.key].json = raw(m.value);
        }
        if (const Json* t = root.find("timing")) {
            timing(*t);
            says_fps_ = t->find("fps") != nullptr;
        }
        if (const Json* e = root.find("editor")) {
            if (!e->as<Json::Object>()) wrong_kind(*e, "/editor", {}, "an object");
            graph_.editor_json_ = raw(*e);
        }
        if (const Json* i = root.find("includes")) includes(*i, root.find("nodes"));
        const Json* all = root.find("nodes");
        if (!all) {
            if (!meant_as(root, "nodes", Level::document)) // else it has been said
                problem("DG008", root.begin, "", {}, {}, "the key \"nodes\" is missing", "write \"nodes\": { … }");
            return;
        }
        if (!all->as<Json::Object>()) return wrong_kind(*all, "/nodes", {}, "an object, one entry a node");
        for (const JsonMember& m : *all->as<Json::Object>())
            if (!is_comment_on("nodes", m)) node(m);
        for (const Pending& p : pending_) bindings(p);
        if (const Json* i = root.find("includes")) overrides(*i);
        if (!is_outermost_) return; // who includes it may connect what is missing here
        for (const Pending& p : pending_) required(p);
        required_of_included();
        const std::string cycle = find_cycle(graph_);
        if (!cycle.empty()) {
            const std::string first = parse_plug(cycle.substr(0, cycle.find(' '))).value_or(Plug{}).node;
            const auto spot = graph_.spot(first);
            problem("DG030", 0, "", first, {}, "connections form a cycle: " + cycle).spot = spot;
        }
    }

    /// Of all nodes or all includes, where no object can be meant: a node or a prefix may be called "comment".
    bool is_comment_on(const char* list, const JsonMember& m) {
        if (m.key != "comment" || m.value.as<Json::Object>()) return false;
        anchors_.push_back({m.key_begin, m.value.end, std::string::npos, "", list});
        graph_.remarks_[list].json = raw(m.value);
        return true;
    }

    std::string raw(const Json& json) const { return source_->text.substr(json.begin, json.end - json.begin); }

    // Gives every comment to what it belongs to.
    void remarks(const std::vector<JsonComment>& comments) {
        std::sort(anchors_.begin(), anchors_.end(), [](const Anchor& a, const Anchor& b) { return a.begin < b.begin; });
        const auto owners = comment_owners(source_->text, comments, anchors_);
        for (std::size_t i = 0; i < comments.size(); ++i) {
            const CommentOwner& owner = owners[i];
            if (owner.anchor == CommentOwner::kept) continue;
            const JsonComment& c = comments[i];
            const Anchor* a = owner.anchor < 0 ? nullptr : &anchors_[static_cast<std::size_t>(owner.anchor)];
            Remark* remark = nullptr;
            if (a && !a->include.empty()) {
                remark = &own_include(a->include).remark;
            } else if (a && !a->node.empty()) {
                auto n = std::make_shared<Node>(*graph_.find(a->node));
                remark = &n->remarks[a->input];
                graph_.nodes_[a->node] = std::move(n);
            } else {
                remark = &graph_.remarks_[a ? a->input : ""];
            }
            // Only the lists of nodes and includes have a place behind what they hold.
            const bool last = a && a->node.empty() && (a->input == "nodes" || a->input == "includes") && owner.at_end;
            (last ? remark->last : remark->lines).push_back(source_->text.substr(c.begin, c.end - c.begin));
        }
    }

    void wrong_kind(const Json& json, const std::string& pointer, std::string_view node, std::string_view expected) {
        const auto* text = json.as<std::string>();
        const auto typed = text && expected.ends_with("number") ? parse_quantity(*text) : std::nullopt;
        problem("DG008", json.begin, pointer, node, {},
                "expected " + std::string(expected) + ", found " + std::string(json.kind()),
                typed && typed->unit.empty() ? "write " + number_text(typed->number) + " without quotes" : "");
    }

    /// Of the last problem.
    void hint(std::string text) { problems_.back().hint = std::move(text); }

    void timing(const Json& json) {
        const auto* object = json.as<Json::Object>();
        if (!object) return wrong_kind(json, "/timing", {}, "an object");
        unknown_keys(*object, Level::timing, "/timing", {});
        if (const Json* comment = json.find("comment")) graph_.remarks_["timing"].json = raw(*comment);
        const auto number = [&](const char* key, bool whole, double fallback) {
            const Json* j = json.find(key);
            if (!j) return fallback;
            const auto* i = j->as<std::int64_t>();
            const auto* d = j->as<double>();
            const double v = i ? static_cast<double>(*i) : d ? *d : fallback;
            const std::string pointer = std::string("/timing/") + key;
            if (!i && !d)
                wrong_kind(*j, pointer, {}, whole ? "a whole number" : "a number");
            else if (const std::string fault = whole ? frame_fault(v) : ""; !fault.empty())
                problem("DG009", j->begin, pointer, {}, {}, fault);
            else
                return v;
            return fallback;
        };
        Timing t;
        t.fps = number("fps", false, 24);
        t.start = static_cast<int>(number("start", true, 1));
        t.end = static_cast<int>(number("end", true, t.start));
        for (const TimingFault& f : timing_faults(t)) {
            const Json* at = json.find(f.key);
            problem("DG009", at ? at->begin : json.begin, "/timing" + (at ? "/" + std::string(f.key) : ""), {}, {},
                    f.message, f.hint);
        }
        graph_.timing_ = t;
    }

    void node(const JsonMember& m) {
        const std::string pointer = "/nodes" + pointer_token(m.key);
        if (const std::string fault = name_fault(m.key); !fault.empty())
            problem("DG028", m.key_begin, pointer, m.key, {}, fault);
        auto n = std::make_shared<Node>();
        auto origin = std::make_shared<NodeOrigin>();
        origin->source = source_, origin->name = m.key, origin->at = m.key_begin;
        n->origin = origin;
        graph_.order_.push_back(m.key);
        // Also a node that is wrong is there, so that connections to it are not reported as dangling.
        graph_.nodes_.emplace(m.key, n);
        anchors_.push_back({m.key_begin, m.value.end, std::string::npos, m.key, ""});
        const auto* object = m.value.as<Json::Object>();
        if (!object) return wrong_kind(m.value, pointer, m.key, "an object with \"type\" and \"inputs\"");
        const Json* type = m.value.find("type");
        const auto* name = type ? type->as<std::string>() : nullptr;
        if (!name) {
            const JsonMember* meant = meant_as(m.value, "type", Level::node);
            const std::size_t at = type ? type->begin : meant ? meant->key_begin : m.key_begin;
            const std::string below = type ? "/type" : meant ? pointer_token(meant->key) : "";
            problem("DG008", at, pointer + below, m.key, {}, "a node needs a \"type\" in quotes",
                    meant ? "write \"type\" instead of " + json_quoted(meant->key) : "");
            return;
        }
        n->type_name = *name;
        n->type = graph_.registry().find(*name);
        const Json* inputs = m.value.find("inputs");
        if (!n->type) {
            n->raw_json = raw(m.value);
            anchors_.back().kept_from = m.value.begin;
            unknown_type(m, *name, type->begin, pointer);
        } else {
            unknown_keys(*object, Level::node, pointer, m.key, input_names(*n->type));
            for (const JsonMember& part : *object)
                anchors_.push_back({part.key_begin, part.value.end, std::string::npos, m.key, ""});
            if (const Json* comment = m.value.find("comment")) n->remarks[""].json = raw(*comment);
            if (inputs && !inputs->as<Json::Object>()) {
                wrong_kind(*inputs, pointer + "/inputs", m.key, "an object, one entry an input");
                inputs = nullptr;
            }
            if (inputs)
                for (const JsonMember& input : *inputs->as<Json::Object>()) {
                    origin->inputs.emplace(input.key, input.value.begin);
                    anchors_.push_back({input.key_begin, input.value.end, std::string::npos, m.key, input.key});
                    if (const Json* comment = input.value.find("comment")) n->remarks[input.key].json = raw(*comment);
                }
            pending_.push_back({m.key, pointer, inputs, m.key_begin});
        }
    }

    void unknown_type(const JsonMember& m, const std::string& name, std::size_t offset, const std::string& pointer) {
        Diagnostic d = std::move(problem("DG010", offset, pointer + "/type", m.key, {},
                                         "this program does not know the type " + json_quoted(name)));
        problems_.pop_back();
        d.hint = name_hint(name, graph_.registry().names(), {});
        if (d.hint.empty())
            d.hint = "correct the type, or take the node out of the graph; `sinew nodes` lists the types";
        unknown_types_.push_back(std::move(d));
    }

    void report(std::vector<Problem>&& found, const Plug& at, const std::string& pointer, const Json& value) {
        for (Problem& f : found) {
            const Json& part = offending_part(value, f.below);
            Diagnostic& d = f.diagnostic;
            if (d.code == "DG013" && is_rounded_to_zero(raw(part))) d.message = rounded_to_zero(raw(part), d.message);
            problem(d.code, part.begin, pointer + f.below, at.node, at.attribute, std::move(d.message),
                    std::move(d.hint));
        }
    }

    // ---- includes ----

    Include& own_include(std::string_view prefix) {
        const auto at = std::find_if(graph_.includes_.begin(), graph_.includes_.end(),
                                     [&](const auto& i) { return i.first == prefix; });
        auto copy = std::make_shared<Include>(*at->second);
        at->second = copy;
        return *copy;
    }

    void includes(const Json& json, const Json* nodes) {
        if (!json.as<Json::Object>()) {
            wrong_kind(json, "/includes", {}, "an object, one entry a prefix");
            return hint(include_form(json, nodes, ""));
        }
        for (const JsonMember& m : *json.as<Json::Object>()) {
            if (is_comment_on("includes", m)) continue;
            std::string fault;
            if (m.key.empty())
                fault = "the nodes of an included graph need a prefix";
            else if (m.key.find('.') != std::string::npos)
                fault = "the prefix holds a dot, which separates it from the node";
            else if (!name_fault(m.key).empty())
                fault = "the prefix holds a control character";
            else if (const Json* node = nodes ? nodes->find(m.key) : nullptr;
                     node && (m.key != "comment" || node->as<Json::Object>()))
                fault = "there is a node of this name, too";
            if (!fault.empty())
                problem("DG131", m.key_begin, "/includes" + pointer_token(m.key), m.key, {}, fault,
                        "choose another prefix");
            if (!fault.empty() || !include(m)) unread_.push_back(m.key);
        }
    }

    /// False if its nodes are not known.
    bool include(const JsonMember& m) {
        const std::string pointer = "/includes" + pointer_token(m.key);
        anchors_.push_back({m.key_begin, m.value.end, std::string::npos, "", "", m.key});
        auto out = std::make_shared<Include>();
        out->source = source_, out->at = m.key_begin;
        out->graph = std::make_shared<const Graph>(graph_.registry_);
        graph_.includes_.emplace_back(m.key, out); // also one that is wrong has its prefix
        const auto* object = m.value.as<Json::Object>();
        if (!object) {
            wrong_kind(m.value, pointer, m.key, "an object with the \"file\" to include");
            return hint(include_form(m.value, nullptr, m.key)), false;
        }
        unknown_keys(*object, Level::include, pointer, m.key);
        for (const JsonMember& part : *object)
            anchors_.push_back({part.key_begin, part.value.end, std::string::npos, "", "", m.key});
        if (const Json* comment = m.value.find("comment")) out->remark.json = raw(*comment);
        const Json* file = m.value.find("file");
        const auto* path = file ? file->as<std::string>() : nullptr;
        if (!path || path->empty()) {
            if (file || !meant_as(m.value, "file", Level::include)) // else it has been said
                problem("DG130", file ? file->begin : m.value.begin, pointer + (file ? "/file" : ""), m.key, {},
                        "an include needs the \"file\" to include, in quotes", "write { \"file\": \"graph.json\" }");
            return false;
        }
        out->file = resolved_path(*path, folder_);
        const Part* part = included_part(m.key, out->file, file->begin, pointer + "/file");
        if (!part) return false;
        out->graph = part->graph;
        merge(m.key, *out->graph, file->begin, pointer + "/file");
        if (part->fps && *part->fps != graph_.timing_.fps && (is_outermost_ || says_fps_)) {
            Diagnostic d = std::move(problem("DG136", file->begin, pointer + "/file", m.key, {},
                                             "the included graph is made for " + number_text(*part->fps) +
                                                 " frames a second, this one for " + number_text(graph_.timing_.fps) +
                                                 ": its keys are played by frame",
                                             "write the same timing.fps in both"));
            problems_.pop_back();
            d.severity = Severity::warning;
            notes_.push_back(std::move(d));
        }
        return true;
    }

    /// nullptr if its nodes are not known; what is wrong with it has been said then.
    const Part* included_part(const std::string& prefix, const std::string& path, std::size_t offset,
                              const std::string& pointer) {
        const auto wrong = [&](std::string_view code, std::string message, std::string hint = {}) {
            problem(code, offset, pointer, prefix, {}, std::move(message), std::move(hint));
            return nullptr;
        };
        const std::string key = file_key(path);
        const auto open = std::find_if(reading_.open.begin(), reading_.open.end(),
                                       [&](const Reading::Open& o) { return o.key == key; });
        if (open != reading_.open.end()) {
            std::string way;
            for (auto f = open; f != reading_.open.end(); ++f) way += f->path + " -> ";
            return wrong("DG132", "these graphs include each other in a circle: " + way + open->path,
                         "take one of these includes out");
        }
        if (reading_.open.size() >= most_levels)
            return wrong("DG135",
                         "more than " + std::to_string(most_levels) + " graphs are included one inside the other");
        const auto known = reading_.parts.find(key);
        if (known != reading_.parts.end()) return known->second.graph ? &known->second : nullptr;
        const GraphText text = graph_text(path, graph_.files_);
        if (!text.code.empty()) {
            reading_.parts[key]; // said once
            const bool names_it = text.message.find(path) != std::string::npos;
            return wrong(text.code, text.message + (names_it ? "" : ": " + path),
                         text.code == "IO401" ? "the path starts at the folder of the file that includes" : text.hint);
        }
        Part part = GraphReader(graph_.registry_, text.text, path, graph_.files_, reading_).read();
        const SourceSpot here = include_spot(*graph_.find_include(prefix), prefix);
        const auto hand_on = [&](std::vector<Diagnostic>& from, std::vector<Diagnostic>& to) {
            for (Diagnostic& d : from) {
                if (!d.node.empty()) d.node.insert(0, prefix + ".");
                if (d.spot) d.spot->included_by.push_back(here);
                to.push_back(std::move(d));
            }
            from.clear();
        };
        hand_on(part.problems, problems_);
        hand_on(part.notes, notes_);
        hand_on(part.unknown_types, unknown_types_);
        const Part& kept = reading_.parts[key] = std::move(part);
        return kept.graph ? &kept : nullptr;
    }

    void merge(const std::string& prefix, const Graph& part, std::size_t offset, const std::string& pointer) {
        const bool was_too_many = reading_.included_nodes > most_included_nodes; // said once
        reading_.included_nodes += part.order_.size();
        if (reading_.included_nodes > most_included_nodes) {
            if (was_too_many) return;
            problem("DG135", offset, pointer, prefix, {},
                    "more than " + std::to_string(most_included_nodes) + " nodes are included");
            return;
        }
        for (const std::string& name : part.order_) {
            const Node& from = *part.find(name);
            auto n = std::make_shared<Node>(from);
            n->remarks.clear(); // they stay in their file
            n->overrides.clear();
            for (auto& [input, binding] : n->inputs) binding = prefixed_binding(part, from, input, prefix);
            graph_.order_.push_back(prefix + "." + name);
            graph_.nodes_.emplace(graph_.order_.back(), std::move(n));
        }
    }

    void overrides(const Json& json) {
        if (!json.as<Json::Object>()) return;
        for (const JsonMember& m : *json.as<Json::Object>()) {
            const Json* all = m.value.find("overrides");
            if (!all || !graph_.find_include(m.key)) continue;
            const std::string pointer = "/includes" + pointer_token(m.key) + "/overrides";
            if (!all->as<Json::Object>()) {
                wrong_kind(*all, pointer, m.key, "an object, one entry an input");
                continue;
            }
            const bool is_read = std::find(unread_.begin(), unread_.end(), m.key) == unread_.end();
            if (!is_read) continue;
            for (const JsonMember& one : *all->as<Json::Object>())
                override_input(m.key, one, pointer + pointer_token(one.key));
        }
    }

    void override_input(const std::string& prefix, const JsonMember& m, const std::string& pointer) {
        const auto local = parse_plug(m.key);
        if (!local) {
            problem("DG134", m.key_begin, pointer, prefix, {}, json_quoted(m.key) + " names no input of a node",
                    "write \"node.input\": value");
            return;
        }
        Include& include = own_include(prefix);
        const Plug plug{prefix + "." + local->node, local->attribute};
        const Node* old = graph_.find(plug.node);
        if (!old) {
            problem("DG133", m.key_begin, pointer, plug.node, {},
                    "there is no node " + json_quoted(local->node) + " in " + include.file,
                    name_hint(local->node, include.graph->node_names(), "nodes"));
            return;
        }
        if (!old->type) {
            problem("DG101", m.key_begin, pointer, plug.node, plug.attribute,
                    "inputs of the unknown type " + json_quoted(old->type_name) + " cannot be overridden");
            return;
        }
        const AttributeInfo* info = old->type->find_input(plug.attribute);
        if (!info) {
            problem("DG011", m.key_begin, pointer, plug.node, plug.attribute, "no such input on " + old->type_name,
                    input_hint(graph_, *old->type, plug.attribute));
            return;
        }
        anchors_.push_back({m.key_begin, m.value.end, std::string::npos, plug.node, plug.attribute});
        auto n = std::make_shared<Node>(*old);
        if (const Json* comment = m.value.find("comment")) n->remarks[plug.attribute].json = raw(*comment);
        if (!n->inputs.contains(plug.attribute)) n->input_order.push_back(plug.attribute);
        n->overrides[plug.attribute] = m.value.begin;
        include.override_order.push_back(m.key);
        n->inputs[plug.attribute] = checked(*n, plug, *info, pointer, m.value);
        graph_.nodes_[plug.node] = std::move(n);
    }

    void required_of_included() {
        for (const std::string& name : graph_.order_) {
            const Node& n = *graph_.find(name);
            if (!is_included(name) || !n.type) continue;
            for (Problem& f : check_required(graph_, name, n, graph_.order_)) {
                Diagnostic& d = f.diagnostic;
                d.spot = graph_.spot(name, d.attribute);
                if (!d.spot) d.spot = graph_.spot(name);
                const std::string here = "override \"" + std::string(included_name(name).name) + "." + d.attribute +
                                         "\" where it is included";
                d.hint += d.hint.empty() ? here : ", or " + here;
                problems_.push_back(std::move(d));
            }
        }
    }

    /// A wrong input still counts as present, so that it is not reported as missing too.
    Binding checked(const Node& n, const Plug& at, const AttributeInfo& info, const std::string& pointer,
                    const Json& value) {
        std::vector<Problem> found;
        auto binding = read_binding(graph_, info, value, folder_, found);
        if (!binding) {
            Diagnostic& d = found.front().diagnostic;
            if (std::string wires = wires_hint(*n.type, info, value); !wires.empty() && d.code != "DG020")
                d.hint = std::move(wires);
            if (d.hint.empty()) d.hint = preset_elsewhere(*n.type, info, value);
        }
        if (binding && !reads_unread(*binding)) found = check_binding(graph_, at.node, *n.type, info, *binding);
        report(std::move(found), at, pointer, value);
        return binding ? std::move(*binding) : Binding(Value());
    }

    /// Whether it is connected to what could not be read; why has been said.
    bool reads_unread(const Binding& b) const {
        const auto unread = [&](const Plug& p) {
            return std::find(unread_.begin(), unread_.end(), included_name(p.node).prefix) != unread_.end();
        };
        if (const Plug* p = std::get_if<Plug>(&b)) return unread(*p);
        const auto* all = std::get_if<std::vector<Plug>>(&b);
        return all && std::any_of(all->begin(), all->end(), unread);
    }

    void bindings(const Pending& p) {
        if (!p.inputs) return;
        auto n = std::make_shared<Node>(*graph_.find(p.name));
        for (const JsonMember& input : *p.inputs->as<Json::Object>()) {
            const AttributeInfo* info = n->type->find_input(input.key);
            if (!info) {
                problem("DG011", input.key_begin, p.pointer + "/inputs" + pointer_token(input.key), p.name, input.key,
                        "no such input on " + n->type_name, input_hint(graph_, *n->type, input.key));
                continue;
            }
            n->input_order.push_back(input.key);
            n->inputs.emplace(input.key, checked(*n, {p.name, input.key}, *info,
                                                 p.pointer + "/inputs" + pointer_token(input.key), input.value));
        }
        graph_.nodes_[p.name] = std::move(n);
    }

    void required(const Pending& p) {
        for (Problem& f : check_required(graph_, p.name, *graph_.find(p.name), graph_.order_)) {
            const auto& d = f.diagnostic;
            const Json* input = p.inputs ? p.inputs->find(d.attribute) : nullptr;
            problem(d.code, input ? input->begin : p.at,
                    p.pointer + (input ? "/inputs" + pointer_token(d.attribute) : ""), p.name, d.attribute, d.message,
                    d.hint);
        }
    }

    Graph graph_;
    std::shared_ptr<const SourceText> source_;
    std::string folder_;
    Reading& reading_;
    bool is_outermost_, says_fps_ = false;
    std::vector<Diagnostic> problems_, notes_, unknown_types_;
    std::vector<Pending> pending_;
    std::vector<Anchor> anchors_;     // what comments can belong to
    std::vector<std::string> unread_; // prefixes of files whose nodes are not known
};

Loaded read_graph(std::shared_ptr<const Registry> registry, std::string_view json_text, const std::string& file_name,
                  const FileAccess& files) {
    Reading reading;
    Part part = GraphReader(std::move(registry), json_text, file_name, files, reading).read();
    const bool is_usable = part.problems.empty();
    for (Diagnostic& d : part.unknown_types) {
        d.severity = is_usable ? Severity::warning : Severity::error;
        part.notes.push_back(std::move(d));
    }
    if (is_usable) return {std::move(part.graph), std::move(part.notes)};
    // What is wrong may follow from the notes.
    part.problems.insert(part.problems.end(), part.notes.begin(), part.notes.end());
    throw Failure(std::move(part.problems));
}

} // namespace sinew::engine
