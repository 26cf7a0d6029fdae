// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/graph_diff.h"

#include "engine/check.h"
#include "engine/eval/file_digests.h"
#include "engine/format/graph_file.h"
#include "engine/text.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace sinew::cli {

using engine::AttributeInfo;
using engine::AttributeKind;
using engine::Binding;
using engine::Curve;
using engine::Graph;
using engine::Node;
using engine::Plug;
using engine::Value;

namespace {

using Names = std::map<std::string, std::string, std::less<>>; // of the first graph -> of the second

bool same_curve(const Curve& a, const Curve& b) {
    return a.interpolation == b.interpolation && std::equal(a.keys.begin(), a.keys.end(), b.keys.begin(), b.keys.end(),
                                                            [](const engine::Key& x, const engine::Key& y) {
                                                                return x.frame == y.frame && x.value == y.value &&
                                                                       x.tangent_in == y.tangent_in &&
                                                                       x.tangent_out == y.tangent_out;
                                                            });
}

/// The last part of an included node's name.
std::string_view local_name(std::string_view name) {
    const std::size_t dot = name.rfind('.');
    return dot == std::string_view::npos ? name : name.substr(dot + 1);
}

/// "a.left.arm.biceps" and "a.right.arm.biceps" -> "a.left" and "a.right"; empty where not just a prefix differs.
std::pair<std::string, std::string> prefixes(const std::string& from, const std::string& to) {
    std::size_t same = 0; // bytes from the end, whole parts with the dot in front
    for (std::size_t n = 1; n <= std::min(from.size(), to.size()); ++n) {
        if (from[from.size() - n] != to[to.size() - n]) break;
        if (from[from.size() - n] == '.') same = n;
    }
    if (same == 0 || same == from.size() || same == to.size()) return {};
    return {from.substr(0, from.size() - same), to.substr(0, to.size() - same)};
}

/// Nodes that only one graph has, and how many of those they wait for.
class Unmatched {
  public:
    /// \param ready takes those that wait for none
    Unmatched(const Graph& graph, const Graph& other, std::vector<std::string>& ready) {
        for (const std::string& name : graph.node_names()) {
            const Node& n = *graph.find(name);
            if (other.find(name) || !n.type) continue;
            int& count = waits_[name];
            const auto source = [&](const std::string& node) {
                if (!graph.find(node) || other.find(node)) return;
                ++count;
                readers_[node].push_back(name);
            };
            for (const auto& [input, binding] : n.inputs) {
                if (const Plug* p = std::get_if<Plug>(&binding)) source(p->node);
                if (const auto* all = std::get_if<std::vector<Plug>>(&binding))
                    for (const Plug& p : *all) source(p.node);
                const Value* v = std::get_if<Value>(&binding);
                if (v && v->is<std::string>() && !n.type->find_input(input)->names_entry_of.empty())
                    source(v->as<std::string>());
            }
            if (count == 0) ready.push_back(name);
        }
    }

    void matched(const std::string& name, std::vector<std::string>& ready) {
        for (const std::string& reader : readers_[name])
            if (--waits_[reader] == 0) ready.push_back(reader);
    }

  private:
    std::map<std::string, int> waits_;
    std::map<std::string, std::vector<std::string>> readers_;
};

class Comparison {
  public:
    Comparison(const Graph& a, const Graph& b)
        : a_(a)
        , b_(b) {}

    std::vector<Difference> run() {
        timing();
        match();
        std::set<std::string> found;
        for (const auto& [from, to] : names_) found.insert(to);
        for (const std::string& name : a_.node_names())
            if (!names_.contains(name)) add({Difference::Kind::removed, name, "", a_.find(name)->type_name, "", ""});
        for (const std::string& name : b_.node_names())
            if (!found.contains(name)) add({Difference::Kind::added, name, "", "", b_.find(name)->type_name, ""});
        renamed_prefixes();
        for (const std::string& name : a_.node_names())
            if (const auto match = names_.find(name); match != names_.end()) node(name, match->second);
        return std::move(out_);
    }

  private:
    void add(Difference d) { out_.push_back(std::move(d)); }

    void timing() {
        const auto compare = [&](const char* what, double a, double b) {
            if (a != b) add({Difference::Kind::timing, "", what, engine::number_text(a), engine::number_text(b), ""});
        };
        compare("fps", a_.timing().fps, b_.timing().fps);
        compare("start", a_.timing().start, b_.timing().start);
        compare("end", a_.timing().end, b_.timing().end);
    }

    // ---- which node is which ----

    /// From the sources on: a node is known by what it says, once those that it reads are known.
    void match() {
        for (const std::string& name : a_.node_names())
            if (b_.find(name)) names_.emplace(name, name);
        std::vector<std::string> removed, added; // those whose sources have become known
        Unmatched left(a_, b_, removed), right(b_, a_, added);
        while (!removed.empty() && !added.empty()) {
            std::map<std::string, Alike> alike;
            for (const std::string& name : removed) alike[says(a_, name)].removed.push_back(name);
            for (const std::string& name : added) alike[says(b_, name)].added.push_back(name);
            removed.clear(), added.clear();
            for (const auto& [what, nodes] : alike)
                for (const auto& [from, to] : pairs(nodes)) {
                    names_.emplace(from, to);
                    left.matched(from, removed);
                    right.matched(to, added);
                }
        }
    }

    struct Alike {
        std::vector<std::string> removed, added;
    };

    /// Of several nodes that say the same, only one with the same name but for prefixes can be meant.
    static std::vector<std::pair<std::string, std::string>> pairs(const Alike& all) {
        std::vector<std::pair<std::string, std::string>> out;
        std::map<std::string_view, Alike> by_name;
        for (const std::string& name : all.removed) by_name[local_name(name)].removed.push_back(name);
        for (const std::string& name : all.added) by_name[local_name(name)].added.push_back(name);
        Alike rest;
        for (const auto& [name, nodes] : by_name)
            if (nodes.removed.size() == 1 && nodes.added.size() == 1) {
                out.emplace_back(nodes.removed.front(), nodes.added.front());
            } else {
                rest.removed.insert(rest.removed.end(), nodes.removed.begin(), nodes.removed.end());
                rest.added.insert(rest.added.end(), nodes.added.begin(), nodes.added.end());
            }
        if (rest.removed.size() == 1 && rest.added.size() == 1)
            out.emplace_back(rest.removed.front(), rest.added.front());
        return out;
    }

    /// Equal for nodes of both graphs that say the same. What it reads is known.
    std::string says(const Graph& graph, const std::string& name) {
        const Node& n = *graph.find(name);
        std::string out = n.type_name;
        const auto name_of = [&](const std::string& node) {
            const auto it = &graph == &a_ ? names_.find(node) : names_.end();
            return it == names_.end() ? node : it->second;
        };
        const auto plug = [&](const Plug& p) { out += " " + name_of(p.node) + "." + p.attribute; };
        for (const AttributeInfo& info : n.type->inputs) {
            const auto bound = n.inputs.find(info.name);
            if (bound == n.inputs.end()) continue;
            const Binding& b = bound->second;
            const Value* v = std::get_if<Value>(&b);
            if (v && v->digest() == engine::default_value(info, graph.timing()).digest()) continue;
            out += "\n" + std::string(info.name) + ":";
            if (const Plug* p = std::get_if<Plug>(&b))
                plug(*p);
            else if (const auto* all = std::get_if<std::vector<Plug>>(&b))
                std::for_each(all->begin(), all->end(), plug);
            else if (v && v->is<engine::File>())
                out += content(v->as<engine::File>().path);
            else if (v && v->is<std::string>() && !info.names_entry_of.empty())
                out += name_of(v->as<std::string>());
            else
                out += engine::binding_json(info, b);
        }
        return out;
    }

    /// Throws Failure IO410: of numbered files each may lead somewhere else.
    std::string content(const std::string& path) {
        const auto digest = files_.of(path, a_.files());
        if (const auto* d = std::get_if<engine::Digest>(&digest)) return d->hex();
        const auto& fault = std::get<engine::FileFault>(digest);
        if (fault.code != "IO410") return path;
        engine::Diagnostic refusal;
        refusal.code = fault.code, refusal.message = fault.message, refusal.hint = fault.hint;
        throw engine::Failure(std::move(refusal));
    }

    // ---- what they say ----

    /// Prefixes all of whose nodes are called otherwise in the same way: one difference each.
    void renamed_prefixes() {
        std::map<std::pair<std::string, std::string>, std::size_t> renamed;
        std::map<std::string, std::size_t> below; // how many nodes are below each prefix of the first graph
        for (const std::string& name : a_.node_names()) {
            for (std::size_t dot = name.find('.'); dot != name.npos; dot = name.find('.', dot + 1))
                ++below[name.substr(0, dot)];
            const auto match = names_.find(name);
            if (match == names_.end() || match->second == name) continue;
            if (auto pair = prefixes(name, match->second); !pair.first.empty()) ++renamed[std::move(pair)];
        }
        for (const auto& [pair, count] : renamed)
            if (count == below[pair.first]) {
                add({Difference::Kind::prefix, pair.second, "", pair.first, pair.second, ""});
                prefixes_.insert(pair);
            }
    }

    void node(const std::string& from, const std::string& to) {
        const Node &a = *a_.find(from), &b = *b_.find(to);
        if (from != to && !prefixes_.contains(prefixes(from, to)))
            add({Difference::Kind::renamed, to, "", from, to, ""});
        if (a.type_name != b.type_name) add({Difference::Kind::type, to, "", a.type_name, b.type_name, ""});
        if (!a.type || !b.type) {
            if (a.type_name == b.type_name && !same_json(a.raw_json, b.raw_json))
                add({Difference::Kind::input, to, "", a.raw_json, b.raw_json, ""});
            return;
        }
        for (const AttributeInfo& info : a.type->inputs)
            if (const AttributeInfo* other = b.type->find_input(info.name)) input(to, a, b, info, *other);
        if (a.type == b.type) return;
        // What only one of two types has is different if somebody wrote it.
        for (const auto& [name, binding] : a.inputs)
            if (!b.type->find_input(name))
                add({Difference::Kind::input, to, name, engine::binding_json(*a.type->find_input(name), binding), "",
                     std::string(a.type->find_input(name)->unit)});
        for (const auto& [name, binding] : b.inputs)
            if (!a.type->find_input(name))
                add({Difference::Kind::input, to, name, "", engine::binding_json(*b.type->find_input(name), binding),
                     std::string(b.type->find_input(name)->unit)});
    }

    static bool same_json(const std::string& a, const std::string& b) {
        return nlohmann::json::parse(a, nullptr, false, true) == nlohmann::json::parse(b, nullptr, false, true);
    }

    static const Binding* bound(const Node& n, std::string_view name) {
        const auto it = n.inputs.find(name);
        return it == n.inputs.end() ? nullptr : &it->second;
    }

    void input(const std::string& name, const Node& a, const Node& b, const AttributeInfo& info,
               const AttributeInfo& other) {
        const Binding *x = bound(a, info.name), *y = bound(b, info.name);
        if (!x && !y) return; // defaults that follow the timing have been told
        const bool is_literal = info.kind == AttributeKind::literal;
        const Binding old = x ? *x : is_literal ? Binding(engine::default_value(info, a_.timing())) : Binding();
        const Binding now = y ? *y : is_literal ? Binding(engine::default_value(other, b_.timing())) : Binding();
        const bool nothing_before = !is_literal && (!x || is_empty_list(*x));
        const bool nothing_after = !is_literal && (!y || is_empty_list(*y));
        if (nothing_before && nothing_after) return;
        if (nothing_before == nothing_after && same(renamed(old, info), now)) return;
        add({Difference::Kind::input, name, std::string(info.name),
             nothing_before ? "" : engine::binding_json(info, old),
             nothing_after ? "" : engine::binding_json(other, now), std::string(info.unit)});
    }

    static bool is_empty_list(const Binding& b) {
        const auto* all = std::get_if<std::vector<Plug>>(&b);
        return all && all->empty();
    }

    /// With names as the second graph has them.
    Binding renamed(Binding b, const AttributeInfo& info) const {
        const auto follow = [&](Plug& p) {
            if (const auto it = names_.find(p.node); it != names_.end()) p.node = it->second;
        };
        if (Plug* p = std::get_if<Plug>(&b)) follow(*p);
        if (auto* all = std::get_if<std::vector<Plug>>(&b)) std::for_each(all->begin(), all->end(), follow);
        const Value* v = std::get_if<Value>(&b);
        if (v && v->is<std::string>() && !info.names_entry_of.empty())
            if (const auto it = names_.find(v->as<std::string>()); it != names_.end())
                return Value::of<std::string>(it->second);
        return b;
    }

    bool same(const Binding& a, const Binding& b) {
        if (a.index() != b.index()) return false;
        if (const Value* v = std::get_if<Value>(&a)) {
            const Value& w = std::get<Value>(b);
            if (v->is<engine::File>() && w.is<engine::File>())
                return v->as<engine::File>().path == w.as<engine::File>().path ||
                       content(v->as<engine::File>().path) == content(w.as<engine::File>().path);
            return v->type() == w.type() && v->digest() == w.digest();
        }
        if (const Curve* c = std::get_if<Curve>(&a)) return same_curve(*c, std::get<Curve>(b));
        if (const Plug* p = std::get_if<Plug>(&a)) return *p == std::get<Plug>(b);
        return std::get<std::vector<Plug>>(a) == std::get<std::vector<Plug>>(b);
    }

    const Graph &a_, &b_;
    Names names_;
    std::set<std::pair<std::string, std::string>> prefixes_; ///< that are told as such
    engine::FileDigests files_;
    std::vector<Difference> out_;
};

} // namespace

std::vector<Difference> differences(const Graph& a, const Graph& b) { return Comparison(a, b).run(); }

} // namespace sinew::cli
