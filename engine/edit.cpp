// Transactions. A draft takes the operations one by one on a copy of the snapshot (nodes are shared until
// touched) and notes for each the operation that takes it back.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/check.h"
#include "engine/format/read_value.h"
#include "engine/format/value_meant.h"
#include "engine/graph.h"
#include "engine/origin.h"
#include "engine/text.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace sinew::engine {

struct Edit::Operation {
    enum class Kind { add, remove, rename, bind, bind_json, key, input, reset, editor, timing, restore };
    Kind kind = Kind::reset;
    Plug plug;        ///< the node, and the attribute where there is one
    std::string text; ///< type, new name or JSON
    Binding binding = {};
    double frame = 0, value = 0;
    Value at_frame = {};
    Timing time = {};
    // restore: a removed node comes back at its place, with what its consumers had bound
    std::shared_ptr<const Node> node = nullptr;
    std::size_t position = 0;
    std::vector<std::pair<Plug, Binding>> consumers = {};
};

namespace {

// Does the binding read the node? Lists may read it several times.
bool reads_node(const Binding& b, std::string_view node) {
    if (const Plug* p = std::get_if<Plug>(&b)) return p->node == node;
    if (const auto* all = std::get_if<std::vector<Plug>>(&b))
        return std::any_of(all->begin(), all->end(), [&](const Plug& p) { return p.node == node; });
    return false;
}

// The raw text of a node of unknown type with its connections renamed; everything else stays byte for byte.
std::string with_renamed_sources(const std::string& raw, const std::string& from, const std::string& to) {
    const JsonDocument doc = parse_json(raw);
    std::vector<std::pair<const Json*, std::string>> changes; // in file order
    std::vector<const Json*> stack{&doc.root};
    while (!stack.empty()) {
        const Json* j = stack.back();
        stack.pop_back();
        if (const auto* list = j->as<Json::List>())
            for (const Json& e : *list) stack.push_back(&e);
        const auto* object = j->as<Json::Object>();
        if (!object) continue;
        for (const JsonMember& m : *object) {
            stack.push_back(&m.value);
            const auto* text = m.value.as<std::string>();
            const auto plug = m.key == "from" && text ? parse_plug(*text) : std::nullopt;
            if (plug && plug->node == from) changes.emplace_back(&m.value, to + "." + plug->attribute);
        }
    }
    std::sort(changes.begin(), changes.end(),
              [](const auto& a, const auto& b) { return a.first->begin > b.first->begin; });
    std::string out = raw;
    for (const auto& [where, text] : changes) out.replace(where->begin, where->end - where->begin, json_quoted(text));
    return out;
}

} // namespace

class Edit::Draft {
  public:
    using Op = Operation;
    explicit Draft(const Graph& base)
        : graph_(base) {}

    void apply(const Op& op) {
        switch (op.kind) {
        case Op::Kind::add:
            return add(op);
        case Op::Kind::remove:
            return remove(op);
        case Op::Kind::rename:
            return rename(op);
        case Op::Kind::bind:
            return bind(op.plug, op.binding);
        case Op::Kind::bind_json:
            return bind_json(op);
        case Op::Kind::key:
            return key(op);
        case Op::Kind::input:
            return set_input(op);
        case Op::Kind::reset:
            return reset(op.plug);
        case Op::Kind::editor:
            return editor(op);
        case Op::Kind::timing:
            return timing(op);
        case Op::Kind::restore:
            return restore(op);
        }
    }

    Edit::Done finish() {
        for (const Plug& p : touched_) {
            const Node* n = graph_.find(p.node);
            const AttributeInfo* info = n && n->type ? n->type->find_input(p.attribute) : nullptr;
            const auto bound = n ? n->inputs.find(p.attribute) : decltype(n->inputs.find(p.attribute)){};
            if (!info || bound == n->inputs.end()) continue;
            for (Problem& f : check_binding(graph_, p.node, *n->type, *info, bound->second))
                problems_.push_back(std::move(f.diagnostic));
        }
        if (problems_.empty() && rewired_)
            if (const std::string cycle = find_cycle(graph_); !cycle.empty())
                problem("DG030", {cycle.substr(0, cycle.find('.')), ""}, "connections form a cycle: " + cycle);
        if (!problems_.empty()) throw Failure(std::move(problems_));
        std::reverse(undo_.begin(), undo_.end());
        Edit::Done out;
        out.graph = std::make_shared<const Graph>(std::move(graph_));
        auto inverse = std::make_shared<Edit>(out.graph);
        inverse->operations_ = std::move(undo_);
        out.inverse = std::move(inverse);
        return out;
    }

  private:
    void problem(std::string_view code, const Plug& at, std::string message, std::string hint = {}) {
        Diagnostic d;
        d.code = code;
        d.node = at.node, d.attribute = at.attribute;
        d.spot = graph_.spot(at.node, at.attribute);
        d.message = std::move(message), d.hint = std::move(hint);
        problems_.push_back(std::move(d));
    }

    void undo(Op op) { undo_.push_back(std::make_shared<const Op>(std::move(op))); }

    const Node* node(const Plug& at) {
        const Node* n = graph_.find(at.node);
        std::string hint = n ? "" : node_hint(graph_, at.node);
        if (hint.empty() && at.node == "timing")
            hint = "it is no node: write \"timing\": { " + json_quoted(at.attribute) + ": … } in the graph file";
        if (!n) problem("DG040", at, "there is no node \"" + at.node + "\"", std::move(hint));
        return n;
    }

    const AttributeInfo* input(const Plug& at) {
        const Node* n = node(at);
        if (!n) return nullptr;
        if (!n->type) {
            problem("DG101", at, "inputs of the unknown type \"" + n->type_name + "\" cannot be edited");
            return nullptr;
        }
        const AttributeInfo* info = n->type->find_input(at.attribute);
        if (!info) problem("DG011", at, "no such input on " + n->type_name, input_hint(graph_, *n->type, at.attribute));
        return info;
    }

    std::shared_ptr<Node> own(const std::string& name) {
        auto copy = std::make_shared<Node>(*graph_.find(name));
        graph_.nodes_[name] = copy;
        return copy;
    }

    /// Nodes of included graphs are what their file says; only their inputs can be others here.
    bool refuse_included(const Plug& at, const char* what) {
        if (!is_included(at.node)) return false;
        const Include* include = graph_.find_include(included_name(at.node).prefix);
        problem("DG137", at, std::string("an included node cannot be ") + what + " here",
                include ? "edit " + include->file : std::string());
        return true;
    }

    bool free_name(const std::string& name) {
        if (const std::string fault = name_fault(name); !fault.empty())
            problem("DG028", {name, ""}, fault);
        else if (graph_.find_include(name))
            problem("DG041", {name, ""}, "a graph is included under this prefix");
        else if (graph_.find(name))
            problem("DG041", {name, ""}, "there is a node of this name already");
        else
            return true;
        return false;
    }

    void add(const Op& op) {
        if (!free_name(op.plug.node)) return;
        auto n = std::make_shared<Node>();
        n->type_name = op.text;
        n->type = graph_.registry().find(op.text);
        if (!n->type)
            return problem("DG010", op.plug, "there is no node type " + json_quoted(op.text),
                           name_hint(op.text, graph_.registry().names(), {}));
        graph_.nodes_.emplace(op.plug.node, std::move(n));
        graph_.order_.push_back(op.plug.node);
        undo({.kind = Op::Kind::remove, .plug = op.plug, .text = {}});
    }

    // What every consumer of a node had bound; needed before the node goes.
    std::vector<std::pair<Plug, Binding>> consumers(const std::string& name) const {
        std::vector<std::pair<Plug, Binding>> out;
        for (const auto& [other, n] : graph_.nodes_)
            for (const auto& [attribute, binding] : n->inputs)
                if (other != name && reads_node(binding, name)) out.push_back({{other, attribute}, binding});
        return out;
    }

    void remove(const Op& op) {
        if (!node(op.plug) || refuse_included(op.plug, "removed")) return;
        const std::string& name = op.plug.node;
        Op back{.kind = Op::Kind::restore, .plug = op.plug, .text = {}};
        back.node = graph_.nodes_.find(name)->second;
        const auto at = std::find(graph_.order_.begin(), graph_.order_.end(), name);
        back.position = static_cast<std::size_t>(at - graph_.order_.begin());
        back.consumers = consumers(name);
        for (const auto& [plug, binding] : back.consumers) {
            auto n = own(plug.node);
            auto bound = n->inputs.find(plug.attribute);
            auto* list = std::get_if<std::vector<Plug>>(&bound->second);
            if (list) std::erase_if(*list, [&](const Plug& p) { return p.node == name; });
            if (!list || list->empty()) unbind(*n, plug);
        }
        graph_.order_.erase(at);
        graph_.nodes_.erase(name);
        undo(std::move(back));
    }

    void restore(const Op& op) {
        const std::string name = op.plug.node;
        if (!free_name(name)) return;
        graph_.nodes_.emplace(name, op.node);
        const std::size_t position = std::min(op.position, graph_.order_.size());
        graph_.order_.insert(graph_.order_.begin() + static_cast<std::ptrdiff_t>(position), name);
        undo({.kind = Op::Kind::remove, .plug = op.plug, .text = {}});
        for (const auto& [attribute, binding] : op.node->inputs) touched_.insert({name, attribute});
        for (const auto& [plug, binding] : op.consumers)
            if (graph_.find(plug.node)) { // consumers that are gone by now are no reason to refuse
                auto n = own(plug.node);
                n->inputs[plug.attribute] = binding;
                if (is_included(plug.node)) n->overrides[plug.attribute] = std::string::npos;
                touched_.insert(plug);
            }
        rewired_ = true;
    }

    void rename(const Op& op) {
        const std::string from = op.plug.node, to = op.text;
        if (!node(op.plug) || from == to || refuse_included(op.plug, "renamed") || !free_name(to)) return;
        rename_entries(from, to);
        auto moved = graph_.nodes_.extract(from);
        moved.key() = to;
        graph_.nodes_.insert(std::move(moved));
        *std::find(graph_.order_.begin(), graph_.order_.end(), from) = to;
        const auto follow = [&](Plug& p) {
            if (p.node == from) p.node = to;
        };
        for (const std::string& name : graph_.order_) {
            const Node& n = *graph_.find(name);
            if (!n.type) {
                if (!is_included(name) && n.raw_json.find(from) != std::string::npos)
                    own(name)->raw_json = with_renamed_sources(n.raw_json, from, to);
                continue;
            }
            const bool reads = std::any_of(n.inputs.begin(), n.inputs.end(),
                                           [&](const auto& i) { return reads_node(i.second, from); });
            if (!reads) continue;
            for (auto& [attribute, binding] : own(name)->inputs) {
                if (Plug* p = std::get_if<Plug>(&binding)) follow(*p);
                if (auto* all = std::get_if<std::vector<Plug>>(&binding))
                    std::for_each(all->begin(), all->end(), follow);
            }
        }
        undo({.kind = Op::Kind::rename, .plug = {to, ""}, .text = from});
    }

    // Texts that name the node as an entry of a list.
    void rename_entries(const std::string& from, const std::string& to) {
        for (const std::string& name : graph_.order_) {
            const Node& n = *graph_.find(name);
            if (!n.type) continue;
            for (const AttributeInfo& info : n.type->inputs) {
                if (info.names_entry_of.empty()) continue;
                const auto bound = n.inputs.find(info.name);
                const auto* text = bound == n.inputs.end() ? nullptr : std::get_if<Value>(&bound->second);
                if (!text || !text->is<std::string>() || text->as<std::string>() != from) continue;
                const std::vector<std::string> names = entry_names(graph_, n, info);
                if (std::find(names.begin(), names.end(), from) == names.end()) continue;
                auto changed = own(name);
                changed->inputs.find(info.name)->second = Value::of<std::string>(to);
                if (is_included(name)) changed->overrides.try_emplace(std::string(info.name), std::string::npos);
                break; // n is the old node now
            }
        }
    }

    // The inverse of whatever stands at the input now.
    void undo_binding(const Plug& at) {
        const Node& n = *graph_.find(at.node);
        const auto bound = n.inputs.find(at.attribute);
        const bool from_include = is_included(at.node) && !n.overrides.contains(at.attribute);
        if (bound == n.inputs.end() || from_include) return undo({.kind = Op::Kind::reset, .plug = at, .text = {}});
        undo({.kind = Op::Kind::bind, .plug = at, .text = {}, .binding = bound->second});
    }

    // Back to what stands here without this graph: the default, or what an included file says.
    void unbind(Node& n, const Plug& at) {
        n.inputs.erase(at.attribute);
        n.overrides.erase(at.attribute);
        if (!is_included(at.node)) return forget_origin(n, at.attribute);
        if (auto included = graph_.included_binding(at.node, at.attribute))
            n.inputs.emplace(at.attribute, std::move(*included));
    }

    // The file no longer says what stands here.
    static void forget_origin(Node& n, const std::string& attribute) {
        if (!n.origin || !n.origin->inputs.contains(attribute)) return;
        auto origin = std::make_shared<NodeOrigin>(*n.origin);
        origin->inputs.erase(attribute);
        n.origin = std::move(origin);
    }

    void bind(const Plug& at, Binding binding, bool check = true) {
        const AttributeInfo* info = input(at);
        if (!info) return;
        const Value* v = std::get_if<Value>(&binding);
        if (v && v->is<std::int64_t>() && info->def.is<double>()) // 5 is a number too
            binding = Value::of<double>(static_cast<double>(v->as<std::int64_t>()));
        undo_binding(at);
        rewired_ =
            rewired_ || std::holds_alternative<Plug>(binding) || std::holds_alternative<std::vector<Plug>>(binding);
        auto n = own(at.node);
        n->inputs[at.attribute] = std::move(binding);
        if (std::find(n->input_order.begin(), n->input_order.end(), at.attribute) == n->input_order.end())
            n->input_order.push_back(at.attribute);
        if (is_included(at.node))
            n->overrides[at.attribute] = std::string::npos;
        else
            forget_origin(*n, at.attribute);
        if (check) touched_.insert(at);
    }

    void bind_json(const Op& op) {
        const AttributeInfo* info = input(op.plug);
        if (!info) return;
        const JsonDocument doc = parse_json(op.text);
        for (const JsonProblem& p : doc.problems) problem(p.code, op.plug, p.message + " in " + op.text, p.hint);
        if (!doc.problems.empty()) return;
        std::vector<Problem> found;
        auto binding = read_binding(graph_, *info, doc.root, folder_of(graph_.file()), found);
        for (Problem& f : found) problem(f.diagnostic.code, op.plug, f.diagnostic.message, f.diagnostic.hint);
        if (!binding) return;
        if (is_rounded_to_zero(op.text)) // commit only sees the 0
            for (Problem& f : check_binding(graph_, op.plug.node, *graph_.find(op.plug.node)->type, *info, *binding))
                return problem(f.diagnostic.code, op.plug, rounded_to_zero(op.text, f.diagnostic.message),
                               f.diagnostic.hint);
        bind(op.plug, std::move(*binding));
    }

    void connected(const Plug& at, const Binding& binding) {
        const Plug* from = std::get_if<Plug>(&binding);
        const std::string sender = from ? ", or send to an input of \"" + from->node + "\", which it follows" : "";
        problem("DG042", at, "a connected input cannot be keyed", "give it a plain value first" + sender);
    }

    void key(const Op& op) {
        const AttributeInfo* info = input(op.plug);
        if (!info) return;
        const Node& n = *graph_.find(op.plug.node);
        const auto bound = n.inputs.find(op.plug.attribute);
        Curve curve;
        curve.interpolation = info->is_stepped() ? Interpolation::step : Interpolation::linear;
        if (bound != n.inputs.end()) {
            if (const Curve* c = std::get_if<Curve>(&bound->second))
                curve = *c;
            else if (!std::holds_alternative<Value>(bound->second))
                return connected(op.plug, bound->second);
        }
        const auto at = std::lower_bound(curve.keys.begin(), curve.keys.end(), op.frame,
                                         [](const Key& k, double f) { return k.frame < f; });
        if (at != curve.keys.end() && at->frame == op.frame)
            at->value = {op.value}, at->keeps = false;
        else
            curve.keys.insert(at, Key{op.frame, {op.value}});
        bind(op.plug, std::move(curve));
    }

    // A value as a key holds it, or nothing if it is of another type.
    std::optional<std::vector<double>> key_value(const AttributeInfo& info, const Value& v) {
        if (v.is<std::int64_t>() && info.def.is<double>())
            return std::vector{static_cast<double>(v.as<std::int64_t>())};
        if (!v || v.type() != info.type) return {};
        if (v.is<bool>()) return std::vector{v.as<bool>() ? 1.0 : 0.0};
        if (v.is<std::int64_t>()) return std::vector{static_cast<double>(v.as<std::int64_t>())};
        if (v.is<double>()) return std::vector{v.as<double>()};
        if (v.is<Vec3>()) return std::vector<double>(v.as<Vec3>().begin(), v.as<Vec3>().end());
        if (v.is<Matrix4>()) return std::vector<double>(v.as<Matrix4>().begin(), v.as<Matrix4>().end());
        if (v.is<NumberList>()) return v.as<NumberList>();
        const auto word = v.is<std::string>() ? std::find(info.options.begin(), info.options.end(), v.as<std::string>())
                                              : info.options.end();
        if (word == info.options.end()) return {};
        return std::vector{static_cast<double>(word - info.options.begin())};
    }

    void set_input(const Op& op) {
        const AttributeInfo* info = input(op.plug);
        if (!info) return;
        if (info->kind != AttributeKind::literal || !info->keyable) { // said as for any other curve
            bind(op.plug, Curve{});
            return;
        }
        Value given = op.at_frame;
        if (given.is<std::string>() && !info->def.is<std::string>()) { // "12 kPa": read as in a file
            std::vector<Problem> found;
            const Json text = parse_json(json_quoted(given.as<std::string>())).root;
            const auto binding = read_binding(graph_, *info, text, folder_of(graph_.file()), found);
            for (Problem& f : found) problem(f.diagnostic.code, op.plug, f.diagnostic.message, f.diagnostic.hint);
            if (!binding) return;
            given = std::get<Value>(*binding);
        }
        const auto value = key_value(*info, given);
        const KeyNumbers sent = value ? KeyNumbers(*value) : KeyNumbers();
        if (!value) {
            for (Problem& p : check_binding(graph_, op.plug.node, *graph_.find(op.plug.node)->type, *info, given))
                problem(p.diagnostic.code, op.plug, p.diagnostic.message, p.diagnostic.hint);
            return;
        }
        const Node& n = *graph_.find(op.plug.node);
        const auto bound = n.inputs.find(op.plug.attribute);
        Curve curve;
        curve.interpolation = info->is_stepped() ? Interpolation::step : Interpolation::linear;
        Value before = default_value(*info, graph_.timing());
        if (bound != n.inputs.end()) {
            if (const Curve* c = std::get_if<Curve>(&bound->second))
                curve = *c;
            else if (const Value* v = std::get_if<Value>(&bound->second))
                before = *v;
            else
                return connected(op.plug, bound->second);
        }
        if (curve.interpolation == Interpolation::smooth)
            return problem("DG043", op.plug, "a frame of a smooth curve cannot be set alone",
                           "give the input a plain value first, or linear keys");
        const auto earlier = [](const Key& k, double f) { return k.frame < f; };
        const double kept = std::ceil(op.frame) - 1; // up to here nothing changes
        auto at = std::lower_bound(curve.keys.begin(), curve.keys.end(), kept, earlier);
        if (at == curve.keys.end() || at->frame >= op.frame) {
            KeyNumbers stays;
            if (curve.keys.empty()) {
                stays = key_value(*info, before).value();
                if (stays.empty()) stays = sent; // there was no list yet: nothing before that could stay
            } else if (at == curve.keys.begin())
                stays = at->value;
            else if (at == curve.keys.end() || curve.interpolation == Interpolation::step ||
                     (at - 1)->value == at->value)
                stays = (at - 1)->value;
            else
                return problem("DG043", op.plug,
                               "frame " + number_text(op.frame) + " lies between the keys at " +
                                   number_text((at - 1)->frame) + " and " + number_text(at->frame) +
                                   ", whose values differ: the frames before it would change",
                               "give the input a plain value first, or set its keys");
            curve.keys.insert(at, Key{.frame = kept, .value = std::move(stays), .keeps = true});
        }
        at = std::lower_bound(curve.keys.begin(), curve.keys.end(), op.frame, earlier);
        if (at != curve.keys.end() && at->frame == op.frame)
            at->value = sent, at->keeps = false;
        else
            at = curve.keys.insert(at, Key{op.frame, sent});
        // What is sent holds until the next frame that was, in whatever order they come.
        if (const auto next = at + 1; next != curve.keys.end() && next->keeps) next->value = sent;
        if (bound == n.inputs.end() || !std::holds_alternative<Curve>(bound->second)) {
            bind(op.plug, std::move(curve));
            return;
        }
        // The other keys stood there and are sound: a host that sends frame by frame must not pay for all of them
        // again.
        Curve changed;
        changed.interpolation = curve.interpolation;
        const auto i = static_cast<std::size_t>(at - curve.keys.begin());
        for (std::size_t k = i - std::min<std::size_t>(i, 2); k < std::min(i + 2, curve.keys.size()); ++k)
            changed.keys.push_back(curve.keys[k]);
        for (Problem& p : check_binding(graph_, op.plug.node, *n.type, *info, changed))
            problem(p.diagnostic.code, op.plug, p.diagnostic.message, p.diagnostic.hint);
        bind(op.plug, std::move(curve), false);
    }

    void reset(const Plug& at) {
        if (!input(at) || !graph_.find(at.node)->inputs.contains(at.attribute)) return;
        if (is_included(at.node) && !graph_.find(at.node)->overrides.contains(at.attribute)) return;
        undo_binding(at);
        unbind(*own(at.node), at);
        rewired_ = rewired_ || is_included(at.node); // what its file says may be a connection
    }

    void editor(const Op& op) {
        const JsonDocument doc = parse_json(op.text);
        for (const JsonProblem& p : doc.problems) problem(p.code, {}, p.message + " in the editor's data", p.hint);
        if (doc.problems.empty() && !doc.root.as<Json::Object>())
            problem("DG008", {}, "the editor's data is an object");
        undo({.kind = Op::Kind::editor, .plug = {}, .text = graph_.editor_json_});
        graph_.editor_json_ = op.text;
    }

    void timing(const Op& op) {
        for (const TimingFault& f : timing_faults(op.time)) problem("DG009", {}, f.message, f.hint);
        undo({.kind = Op::Kind::timing,
              .plug = {},
              .text = {},
              .binding = {},
              .frame = 0,
              .value = 0,
              .time = graph_.timing_});
        graph_.timing_ = op.time;
    }

    Graph graph_;
    std::vector<std::shared_ptr<const Op>> undo_;
    std::vector<Diagnostic> problems_;
    std::set<Plug> touched_;
    bool rewired_ = false;
};

Edit::Edit(std::shared_ptr<const Graph> base)
    : base_(std::move(base)) {}

Edit& Edit::push(Operation op) {
    operations_.push_back(std::make_shared<const Operation>(std::move(op)));
    return *this;
}

Edit& Edit::add_node(std::string name, std::string type) {
    return push({.kind = Operation::Kind::add, .plug = {std::move(name), ""}, .text = std::move(type)});
}
Edit& Edit::remove_node(std::string name) {
    return push({.kind = Operation::Kind::remove, .plug = {std::move(name), ""}, .text = {}});
}
Edit& Edit::rename_node(std::string from, std::string to) {
    return push({.kind = Operation::Kind::rename, .plug = {std::move(from), ""}, .text = std::move(to)});
}
Edit& Edit::set(Plug input, Binding binding) {
    return push({.kind = Operation::Kind::bind, .plug = std::move(input), .text = {}, .binding = std::move(binding)});
}
Edit& Edit::set_json(Plug input, std::string json) {
    return push({.kind = Operation::Kind::bind_json, .plug = std::move(input), .text = std::move(json)});
}
Edit& Edit::set_key(Plug input, double frame, double value) {
    return push({.kind = Operation::Kind::key,
                 .plug = std::move(input),
                 .text = {},
                 .binding = {},
                 .frame = frame,
                 .value = value});
}
Edit& Edit::set_input(Plug input, double frame, Value value) {
    return push({.kind = Operation::Kind::input,
                 .plug = std::move(input),
                 .text = {},
                 .binding = {},
                 .frame = frame,
                 .value = 0,
                 .at_frame = std::move(value)});
}
Edit& Edit::reset(Plug input) { return push({.kind = Operation::Kind::reset, .plug = std::move(input), .text = {}}); }
Edit& Edit::set_editor_json(std::string json) {
    return push({.kind = Operation::Kind::editor, .plug = {}, .text = std::move(json)});
}
Edit& Edit::set_timing(Timing timing) {
    return push({.kind = Operation::Kind::timing,
                 .plug = {},
                 .text = {},
                 .binding = {},
                 .frame = 0,
                 .value = 0,
                 .time = timing});
}

Edit::Done Edit::commit() const {
    Draft draft(*base_);
    for (const auto& op : operations_) draft.apply(*op);
    return draft.finish();
}

Edit Edit::rebased(std::shared_ptr<const Graph> base) const {
    Edit out(std::move(base));
    out.operations_ = operations_;
    return out;
}

} // namespace sinew::engine
