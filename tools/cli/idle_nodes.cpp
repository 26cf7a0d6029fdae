// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/idle_nodes.h"

#include "engine/text.h"
#include "nodes/values.h"
#include "tools/embed/graph_walk.h"

#include <algorithm>
#include <map>
#include <set>

namespace sinew::cli {

using engine::AttributeInfo;
using engine::AttributeKind;
using engine::Graph;
using engine::Node;
using engine::Plug;

namespace {

class Search {
  public:
    explicit Search(const Graph& graph)
        : graph_(graph)
        , names_(graph.node_names()) {
        for (const std::string& name : names_)
            for (const auto& [input, binding] : graph.find(name)->inputs)
                for (const Plug& source : embed::sources(binding)) readers_[source.node].push_back(name);
    }

    std::vector<engine::Diagnostic> run() {
        const std::vector<std::string> solvers = embed::simulations(graph_, names_);
        if (solvers.empty()) return {};
        std::vector<std::string> ends = downstream_of(solvers);
        for (const std::string& name : names_)
            if (gives_a_file(name)) ends.push_back(name);
        for (const std::string& name : embed::upstream_of(graph_, ends)) used_.insert(name);
        std::vector<std::string> idle;
        for (const std::string& name : names_)
            if (!used_.contains(name) && is_end(name)) idle.push_back(name);
        // Nobody reads more, and each takes a walk through the graph.
        constexpr std::size_t most_told = 20;
        std::vector<engine::Diagnostic> out;
        for (std::size_t i = 0; i < idle.size() && i < most_told; ++i) out.push_back(doubt(idle[i]));
        if (idle.size() > most_told)
            out.back().message += "; so it is with " + std::to_string(idle.size() - most_told) + " more nodes";
        return out;
    }

  private:
    bool is_end(const std::string& name) const {
        // What nobody knows is an error of its own, and who reads it may be what is idle.
        return graph_.find(name)->type && !readers_.contains(name) && !engine::is_included(name);
    }

    bool gives_a_file(const std::string& name) const {
        const Node& node = *graph_.find(name);
        return node.type && std::any_of(node.type->outputs.begin(), node.type->outputs.end(),
                                        [](const AttributeInfo& o) { return o.type == typeid(nodes::FileContent); });
    }

    /// `nodes` and all that read them, however far away.
    std::vector<std::string> downstream_of(std::vector<std::string> nodes) const {
        std::set<std::string> seen(nodes.begin(), nodes.end());
        for (std::size_t i = 0; i < nodes.size(); ++i)
            if (const auto it = readers_.find(nodes[i]); it != readers_.end())
                for (const std::string& reader : it->second)
                    if (seen.insert(reader).second) nodes.push_back(reader);
        return nodes;
    }

    /// Lists of what is used that take an output of the node. A single input that takes a mesh or a number tells
    /// nothing: most nodes have one.
    std::vector<std::string> takers(const std::string& name) const {
        constexpr std::size_t most = 3;
        std::vector<std::string> out;
        for (const AttributeInfo& output : graph_.find(name)->type->outputs)
            for (const std::string& other : names_) {
                const Node& node = *graph_.find(other);
                if (!node.type || !used_.contains(other) || engine::is_included(other)) continue;
                for (const AttributeInfo& input : node.type->inputs)
                    if (input.kind == AttributeKind::wire_list && input.type == output.type &&
                        may_take(node, input, name))
                        out.push_back(other + "." + std::string(input.name));
            }
        if (out.size() > most) out.clear();
        return out;
    }

    /// Bodies are one type on wires, but parts of a tissue are zSubtissues alone, which no solver takes by itself.
    bool may_take(const Node& node, const AttributeInfo& input, const std::string& given) const {
        return node.type->name != "zTissue" || input.name != "subtissues" ||
               graph_.find(given)->type->name == "zSubtissue";
    }

    engine::Diagnostic doubt(const std::string& name) const {
        engine::Diagnostic d;
        d.severity = engine::Severity::warning;
        d.code = "FE330";
        d.node = name;
        d.spot = graph_.spot(name);
        const std::vector<std::string> upstream = embed::upstream_of(graph_, {name});
        std::vector<std::string> along; // does nothing either
        for (const std::string& one : upstream)
            if (one != name && !used_.contains(one) && !engine::is_included(one)) along.push_back(one);
        d.message = upstream.size() > 1 ? "nothing reads it, so it does nothing"
                                        : "it is connected to nothing, so it does nothing";
        constexpr std::size_t most_named = 5;
        if (along.size() > most_named) {
            d.message += ", nor do " + std::to_string(along.size()) + " nodes that it reads";
        } else if (!along.empty()) {
            d.message += along.size() == 1 ? ", nor does " + along.front() : ", nor do " + all_of(along);
        }
        const std::vector<std::string> to = takers(name);
        d.hint = to.empty() ? "connect it to where it is to act, or take it out of the graph"
                            : "connect it to " + engine::listed(to) + ", or take it out of the graph";
        return d;
    }

    static std::string all_of(const std::vector<std::string>& names) {
        std::string out;
        for (std::size_t i = 0; i < names.size(); ++i)
            out += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
        return out;
    }

    const Graph& graph_;
    const std::vector<std::string> names_;
    std::map<std::string, std::vector<std::string>> readers_;
    std::set<std::string> used_;
};

} // namespace

std::vector<engine::Diagnostic> find_idle_nodes(const Graph& graph) { return Search(graph).run(); }

} // namespace sinew::cli
