// JSON text -> Graph. Stages: syntax, format number, migrations, then everything inside at once.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/comments.h"
#include "engine/format/graph_file.h"
#include "engine/format/migrate.h"
#include "engine/format/read_value.h"
#include "engine/origin.h"
#include "engine/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace sinew::engine {

class GraphReader {
  public:
    GraphReader(std::shared_ptr<const Registry> registry, std::string_view text, const std::string& file)
        : graph_(std::move(registry))
        , source_(std::make_shared<SourceText>(file, text))
        , folder_(folder_of(file)) {
        graph_.file_ = file;
    }

    Loaded read() {
        JsonDocument doc = parse_json(source_->text);
        for (JsonProblem& p : doc.problems) problem(p.code, p.offset, p.pointer, {}, {}, std::move(p.message));
        give_up_if_wrong();
        const int format = format_number(doc.root);
        give_up_if_wrong();
        if (format < current_format) return migrated(format);
        top(doc.root);
        give_up_if_wrong();
        remarks(doc.comments);
        Loaded out;
        out.notes = std::move(notes_);
        out.graph = std::make_shared<const Graph>(std::move(graph_));
        for (Diagnostic& d : check_timing(*out.graph)) out.notes.push_back(std::move(d));
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

    void give_up_if_wrong() {
        if (problems_.empty()) return;
        problems_.insert(problems_.end(), notes_.begin(), notes_.end()); // what is wrong may follow from them
        throw Failure(std::move(problems_));
    }

    int format_number(const Json& root) {
        if (!root.as<Json::Object>()) {
            problem("DG004", root.begin, "", {}, {},
                    "a graph file is one JSON object, found " + std::string(root.kind()));
            return 0;
        }
        const Json* format = root.find("format");
        const auto* text = format ? format->as<std::string>() : nullptr;
        const std::string wanted = "write \"format\": \"sinew " + std::to_string(current_format) + "\"";
        int number = 0;
        if (!format) {
            problem("DG004", root.begin, "", {}, {}, "the key \"format\" is missing", wanted);
            return 0;
        }
        const std::string_view digits = text && text->rfind("sinew ", 0) == 0 ? std::string_view(*text).substr(6) : "";
        const auto [end, ec] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
        if (digits.empty() || ec != std::errc() || end != digits.data() + digits.size())
            problem("DG004", format->begin, "/format", {}, {},
                    (text ? json_quoted(*text) : std::string(format->kind())) + " is not a Sinew format", wanted);
        else if (number > current_format)
            problem("DG005", format->begin, "/format", {}, {},
                    "the file has format " + std::to_string(number) + ", this program reads up to " +
                        std::to_string(current_format),
                    "use a newer program");
        else if (number < current_format && !migration_from(number))
            problem("DG006", format->begin, "/format", {}, {},
                    "there is no way from format " + std::to_string(number) + " to " + std::to_string(current_format),
                    wanted);
        return number;
    }

    Loaded migrated(int format) {
        std::string text = source_->text;
        for (; format < current_format; ++format) text = migration_from(format)->apply(text);
        return read_graph(graph_.registry_, text, source_->file);
    }

    void unknown_keys(const Json::Object& object, const std::vector<std::string>& known, const std::string& pointer,
                      std::string_view node) {
        for (const JsonMember& m : object)
            if (std::find(known.begin(), known.end(), m.key) == known.end())
                problem("DG007", m.key_begin, pointer + pointer_token(m.key), node, {},
                        "unknown key " + json_quoted(m.key), name_hint(m.key, known, "keys"));
    }

    void top(const Json& root) {
        unknown_keys(*root.as<Json::Object>(), {"$schema", "format", "comment", "timing", "nodes", "editor"}, "", {});
        for (const JsonMember& m : *root.as<Json::Object>()) {
            anchors_.push_back({m.key_begin, m.value.end, std::string::npos, "", m.key});
            if (m.key == "editor") anchors_.back().kept_from = m.value.begin;
            if (m.key == "$schema" || m.key == "comment") graph_.remarks_[m.key].json = raw(m.value);
        }
        if (const Json* t = root.find("timing")) timing(*t);
        if (const Json* e = root.find("editor")) {
            if (!e->as<Json::Object>()) wrong_kind(*e, "/editor", {}, "an object");
            graph_.editor_json_ = raw(*e);
        }
        const Json* all = root.find("nodes");
        if (!all) {
            problem("DG008", root.begin, "", {}, {}, "the key \"nodes\" is missing", "write \"nodes\": { … }");
            return;
        }
        if (!all->as<Json::Object>()) return wrong_kind(*all, "/nodes", {}, "an object, one entry a node");
        for (const JsonMember& m : *all->as<Json::Object>()) node(m);
        for (const Pending& p : pending_) bindings(p);
        for (const Pending& p : pending_) required(p);
        const std::string cycle = find_cycle(graph_);
        if (!cycle.empty()) {
            const std::string first = cycle.substr(0, cycle.find('.'));
            const auto spot = graph_.spot(first);
            problem("DG030", 0, "", first, {}, "connections form a cycle: " + cycle).spot = spot;
        }
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
            if (a && !a->node.empty()) {
                auto n = std::make_shared<Node>(*graph_.find(a->node));
                remark = &n->remarks[a->input];
                graph_.nodes_[a->node] = std::move(n);
            } else {
                remark = &graph_.remarks_[a ? a->input : ""];
            }
            // Only the list of nodes has a place behind what it holds.
            const bool last = a && a->node.empty() && a->input == "nodes" && owner.at_end;
            (last ? remark->last : remark->lines).push_back(source_->text.substr(c.begin, c.end - c.begin));
        }
    }

    void wrong_kind(const Json& json, const std::string& pointer, std::string_view node, std::string_view expected) {
        problem("DG008", json.begin, pointer, node, {},
                "expected " + std::string(expected) + ", found " + std::string(json.kind()));
    }

    void timing(const Json& json) {
        const auto* object = json.as<Json::Object>();
        if (!object) return wrong_kind(json, "/timing", {}, "an object");
        unknown_keys(*object, {"fps", "start", "end"}, "/timing", {});
        const auto number = [&](const char* key, bool whole, double fallback) {
            const Json* j = json.find(key);
            if (!j) return fallback;
            const auto* i = j->as<std::int64_t>();
            const auto* d = j->as<double>();
            const double v = i ? static_cast<double>(*i) : d ? *d : fallback;
            const std::string pointer = std::string("/timing/") + key;
            if (!i && !d)
                wrong_kind(*j, pointer, {}, whole ? "a whole number" : "a number");
            else if (whole ? v != std::floor(v) || std::abs(v) > 1e9 : !(v > 0))
                problem("DG009", j->begin, pointer, {}, {},
                        number_text(v) + (whole ? " is not a whole frame" : " frames a second do not exist"),
                        whole ? "" : "fps is above 0");
            else
                return v;
            return fallback;
        };
        Timing t;
        t.fps = number("fps", false, 24);
        t.start = static_cast<int>(number("start", true, 1));
        t.end = static_cast<int>(number("end", true, t.start));
        if (t.end < t.start)
            problem("DG009", json.find("end") ? json.find("end")->begin : json.begin, "/timing/end", {}, {},
                    "the end " + std::to_string(t.end) + " comes before the start " + std::to_string(t.start));
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
            problem("DG008", type ? type->begin : m.key_begin, pointer + (type ? "/type" : ""), m.key, {},
                    "a node needs a \"type\" in quotes");
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
            unknown_keys(*object, {"type", "comment", "inputs"}, pointer, m.key);
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
        d.severity = Severity::warning;
        const std::string near = nearest_name(name, graph_.registry().names());
        d.hint = near.empty() ? "the node is kept as it is and fails only when it is needed"
                              : "did you mean \"" + near + "\"?";
        notes_.push_back(std::move(d));
    }

    void report(std::vector<Problem>&& found, const Pending& p, const JsonMember& input) {
        for (Problem& f : found) {
            const Json& part = offending_part(input.value, f.below);
            Diagnostic& d = f.diagnostic;
            problem(d.code, part.begin, p.pointer + "/inputs" + pointer_token(input.key) + f.below, p.name, input.key,
                    std::move(d.message), std::move(d.hint));
        }
    }

    void bindings(const Pending& p) {
        if (!p.inputs) return;
        auto n = std::make_shared<Node>(*graph_.find(p.name));
        for (const JsonMember& input : *p.inputs->as<Json::Object>()) {
            const AttributeInfo* info = n->type->find_input(input.key);
            if (!info) {
                problem("DG011", input.key_begin, p.pointer + "/inputs" + pointer_token(input.key), p.name, input.key,
                        "no such input on " + n->type_name, name_hint(input.key, input_names(*n->type), "inputs"));
                continue;
            }
            n->input_order.push_back(input.key);
            std::vector<Problem> found;
            auto binding = read_binding(*info, input.value, folder_, found);
            if (binding) found = check_binding(graph_, p.name, *n->type, *info, *binding);
            // A wrong input still counts as present, so that it is not reported as missing too.
            n->inputs.emplace(input.key, binding ? std::move(*binding) : Binding(Value()));
            report(std::move(found), p, input);
        }
        graph_.nodes_[p.name] = std::move(n);
    }

    void required(const Pending& p) {
        for (Problem& f : check_required(graph_, p.name, *graph_.find(p.name))) {
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
    std::vector<Diagnostic> problems_, notes_;
    std::vector<Pending> pending_;
    std::vector<Anchor> anchors_; // what comments can belong to
};

Loaded read_graph(std::shared_ptr<const Registry> registry, std::string_view json_text, const std::string& file_name) {
    return GraphReader(std::move(registry), json_text, file_name).read();
}

Loaded load_graph(std::shared_ptr<const Registry> registry, const std::string& path) {
    const auto unreadable = [&](std::string_view code, std::string message) {
        Diagnostic d;
        d.code = code;
        d.spot = SourceSpot{path, "", 0, 0};
        d.message = std::move(message);
        return Failure(std::move(d));
    };
    std::error_code ec;
    const auto status = std::filesystem::status(path, ec);
    if (!std::filesystem::exists(status)) throw unreadable("IO401", "there is no such graph file");
    if (std::filesystem::is_directory(status)) throw unreadable("IO402", "this is a folder, not a graph file");
    if (!std::filesystem::is_regular_file(status))
        throw unreadable("IO402", "this is a pipe or a device, not a graph file");
    std::ifstream in(path, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    const std::string text = out.str();
    if (!in || !out) throw unreadable("IO402", "the graph file cannot be read");
    // A mesh, say: better than to say what JSON lacks in it.
    const std::size_t first = text.find_first_not_of("\xEF\xBB\xBF \t\r\n");
    if (first != std::string::npos && std::string_view("{[/").find(text[first]) == std::string_view::npos)
        throw unreadable("DG004", "this is no graph file: a graph is one JSON object and begins with {");
    return read_graph(std::move(registry), text, path);
}

} // namespace sinew::engine
