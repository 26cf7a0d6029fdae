// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/graph.h"

#include "engine/check.h"
#include "engine/include.h"
#include "engine/origin.h"
#include "engine/text.h"

#include <algorithm>
#include <unordered_map>

namespace sinew::engine {

Value default_value(const AttributeInfo& input, const Timing& timing) {
    switch (input.from_timing) {
    case FromTiming::start:
        return Value::of<double>(timing.start);
    case FromTiming::fps:
        return Value::of<double>(timing.fps);
    case FromTiming::nothing:
        break;
    }
    return input.def;
}

Graph::Graph(std::shared_ptr<const Registry> registry)
    : registry_(std::move(registry)) {}

const Node* Graph::find(std::string_view name) const {
    const auto it = nodes_.find(name);
    return it == nodes_.end() ? nullptr : it->second.get();
}

std::vector<std::string> Graph::node_names() const { return order_; }

IncludedName included_name(std::string_view node) {
    const std::size_t dot = node.find('.');
    if (dot == std::string_view::npos) return {{}, node};
    return {node.substr(0, dot), node.substr(dot + 1)};
}

const Include* Graph::find_include(std::string_view prefix) const {
    for (const auto& [name, include] : includes_)
        if (name == prefix) return include.get();
    return nullptr;
}

std::optional<Binding> Graph::included_binding(std::string_view node, std::string_view attribute) const {
    const IncludedName name = included_name(node);
    const Include* include = name.prefix.empty() ? nullptr : find_include(name.prefix);
    const Node* n = include ? include->graph->find(name.name) : nullptr;
    if (!n || !n->inputs.contains(attribute)) return {};
    return prefixed_binding(*include->graph, *n, attribute, name.prefix);
}

Binding prefixed_binding(const Graph& graph, const Node& n, std::string_view attribute, std::string_view prefix) {
    Binding out = n.inputs.find(attribute)->second;
    const auto follow = [&](Plug& p) { p.node.insert(0, std::string(prefix) + "."); };
    if (Plug* p = std::get_if<Plug>(&out)) follow(*p);
    if (auto* all = std::get_if<std::vector<Plug>>(&out)) std::for_each(all->begin(), all->end(), follow);
    const auto* text = std::get_if<Value>(&out);
    const AttributeInfo* info = n.type ? n.type->find_input(attribute) : nullptr;
    if (!text || !text->is<std::string>() || !info || info->names_entry_of.empty()) return out;
    const std::vector<std::string> names = entry_names(graph, n, *info);
    if (std::find(names.begin(), names.end(), text->as<std::string>()) == names.end()) return out;
    return Value::of<std::string>(std::string(prefix) + "." + text->as<std::string>());
}

namespace {

SourceSpot spot_in(const SourceText& source, std::size_t offset, std::string pointer) {
    const TextPlace place = source.lines.at(offset);
    return {source.file, std::move(pointer), place.line, place.column};
}

} // namespace

SourceSpot include_spot(const Include& include, std::string_view prefix) {
    return spot_in(*include.source, include.at, "/includes" + pointer_token(prefix));
}

std::optional<SourceSpot> Graph::spot(std::string_view node, std::string_view attribute) const {
    const Node* n = find(node);
    if (!n) return {};
    const IncludedName name = included_name(node);
    if (const Include* include = name.prefix.empty() ? nullptr : find_include(name.prefix)) {
        const auto own = n->overrides.find(attribute);
        if (own == n->overrides.end()) {
            auto out = include->graph->spot(name.name, attribute);
            if (out) out->included_by.push_back(include_spot(*include, name.prefix));
            return out;
        }
        if (own->second == std::string_view::npos) return {};
        const std::string plug = std::string(name.name) + "." + std::string(attribute);
        return spot_in(*include->source, own->second,
                       "/includes" + pointer_token(name.prefix) + "/overrides" + pointer_token(plug));
    }
    if (!n->origin) return {};
    const NodeOrigin& o = *n->origin;
    std::size_t offset = o.at;
    std::string pointer = "/nodes" + pointer_token(o.name);
    if (!attribute.empty()) {
        const auto it = o.inputs.find(attribute);
        if (it == o.inputs.end()) return {};
        offset = it->second;
        pointer += "/inputs" + pointer_token(attribute);
    }
    return spot_in(*o.source, offset, std::move(pointer));
}

namespace {

struct Wiring {
    int target;
    std::string_view input, output;
};

// Depth-first search with an explicit stack: graphs may be deeper than the C stack.
class CycleSearch {
  public:
    explicit CycleSearch(const Graph& graph)
        : names_(graph.node_names()) {
        std::unordered_map<std::string_view, int> index;
        for (const std::string& n : names_) index.emplace(n, static_cast<int>(index.size()));
        wires_.resize(names_.size());
        for (std::size_t i = 0; i < names_.size(); ++i)
            for (const auto& named : graph.find(names_[i])->inputs) {
                const Binding& binding = named.second;
                const auto wire = [&](const Plug& p) {
                    const auto source = index.find(p.node);
                    if (source != index.end())
                        wires_[static_cast<std::size_t>(source->second)].push_back(
                            {static_cast<int>(i), named.first, p.attribute});
                };
                if (const Plug* p = std::get_if<Plug>(&binding)) wire(*p);
                if (const auto* all = std::get_if<std::vector<Plug>>(&binding))
                    std::for_each(all->begin(), all->end(), wire);
            }
    }

    std::string path() {
        enum : char { fresh, open, closed };
        std::vector<char> state(names_.size(), fresh);
        struct Level {
            std::size_t node, next;
        };
        std::vector<Level> stack;
        for (std::size_t root = 0; root < names_.size(); ++root) {
            if (state[root] != fresh) continue;
            stack.push_back({root, 0});
            state[root] = open;
            while (!stack.empty()) {
                Level& top = stack.back();
                if (top.next == wires_[top.node].size()) {
                    state[top.node] = closed;
                    stack.pop_back();
                    continue;
                }
                const auto target = static_cast<std::size_t>(wires_[top.node][top.next++].target);
                if (state[target] == fresh) {
                    state[target] = open;
                    stack.push_back({target, 0});
                } else if (state[target] == open) {
                    std::size_t first = 0;
                    while (stack[first].node != target) ++first;
                    std::string out;
                    for (std::size_t i = first; i < stack.size(); ++i) {
                        const Wiring& w = wires_[stack[i].node][stack[i].next - 1];
                        out += names_[stack[i].node] + "." + std::string(w.output) + " -> " +
                               names_[static_cast<std::size_t>(w.target)] + "." + std::string(w.input) + " -> ";
                    }
                    return out + names_[target];
                }
            }
        }
        return {};
    }

  private:
    std::vector<std::string> names_;
    std::vector<std::vector<Wiring>> wires_;
};

} // namespace

std::string find_cycle(const Graph& graph) { return CycleSearch(graph).path(); }

} // namespace sinew::engine
