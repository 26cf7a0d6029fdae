// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/graph.h"

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

std::optional<SourceSpot> Graph::spot(std::string_view node, std::string_view attribute) const {
    const Node* n = find(node);
    if (!n || !n->origin) return {};
    const NodeOrigin& o = *n->origin;
    SourceSpot out;
    std::size_t offset = o.at;
    out.file = o.source->file;
    out.pointer = "/nodes" + pointer_token(o.name);
    if (!attribute.empty()) {
        const auto it = o.inputs.find(attribute);
        if (it == o.inputs.end()) return {};
        offset = it->second;
        out.pointer += "/inputs" + pointer_token(attribute);
    }
    const TextPlace place = o.source->lines.at(offset);
    out.line = place.line, out.column = place.column;
    return out;
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
            for (const auto& [input, binding] : graph.find(names_[i])->inputs) {
                const auto wire = [&](const Plug& p) {
                    const auto source = index.find(p.node);
                    if (source != index.end())
                        wires_[static_cast<std::size_t>(source->second)].push_back(
                            {static_cast<int>(i), input, p.attribute});
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
