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

    void match() {
        std::set<std::string> removed, added;
        for (const std::string& name : a_.node_names())
            b_.find(name) ? void(names_.emplace(name, name)) : void(removed.insert(name));
        for (const std::string& name : b_.node_names())
            if (!a_.find(name)) added.insert(name);
        // From the sources on: a node is known by what it says, once those that it reads are known.
        for (bool is_more = true; is_more && !removed.empty() && !added.empty();) {
            std::map<std::string, std::pair<std::vector<std::string>, std::vector<std::string>>> alike;
            std::set<std::string> known;
            for (const auto& [from, to] : names_) known.insert(to);
            for (const std::string& name : removed)
                if (const std::string s = signature(a_, name,
                                                    [&](const std::string& n) {
                                                        const auto it = names_.find(n);
                                                        return it == names_.end() ? std::string() : it->second;
                                                    });
                    !s.empty())
                    alike[s].first.push_back(name);
            for (const std::string& name : added)
                if (const std::string s = signature(
                        b_, name, [&](const std::string& n) { return known.contains(n) ? n : std::string(); });
                    !s.empty())
                    alike[s].second.push_back(name);
            is_more = false;
            for (const auto& [s, both] : alike)
                for (const std::string& from : both.first)
                    if (const std::string to = only_match(from, both.first, both.second); !to.empty()) {
                        names_.emplace(from, to);
                        removed.erase(from);
                        added.erase(to);
                        is_more = true;
                    }
        }
    }

    /// Of several nodes that say the same, only one with the same name but for prefixes can be meant.
    static std::string only_match(const std::string& from, const std::vector<std::string>& removed,
                                  const std::vector<std::string>& added) {
        if (removed.size() == 1 && added.size() == 1) return added.front();
        const auto is_like = [&](const std::string& name) { return local_name(name) == local_name(from); };
        if (std::count_if(removed.begin(), removed.end(), is_like) != 1) return {};
        if (std::count_if(added.begin(), added.end(), is_like) != 1) return {};
        return *std::find_if(added.begin(), added.end(), is_like);
    }

    /// Equal for nodes that say the same, names of other nodes aside; empty if it reads a node that `name_of` does not
    /// know.
    template <class NameOf>
    std::string signature(const Graph& graph, const std::string& name, const NameOf& name_of) {
        const Node& n = *graph.find(name);
        if (!n.type) return {};
        std::string out = n.type_name;
        bool is_complete = true;
        const auto plug = [&](const Plug& p) {
            const std::string source = name_of(p.node);
            is_complete = is_complete && !source.empty();
            out += " " + source + "." + p.attribute;
        };
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
        return is_complete ? out : std::string();
    }

    std::string content(const std::string& path) {
        const auto digest = files_.of(path);
        const auto* d = std::get_if<engine::Digest>(&digest);
        return d ? d->hex() : path;
    }

    // ---- what they say ----

    void node(const std::string& from, const std::string& to) {
        const Node &a = *a_.find(from), &b = *b_.find(to);
        if (from != to) add({Difference::Kind::renamed, to, "", from, to, ""});
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
    engine::FileDigests files_;
    std::vector<Difference> out_;
};

} // namespace

std::vector<Difference> differences(const Graph& a, const Graph& b) { return Comparison(a, b).run(); }

} // namespace sinew::cli
