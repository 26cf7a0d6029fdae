// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/doubts/doubting.h"

#include "engine/text.h"
#include "tools/embed/graph_walk.h"

#include <algorithm>

namespace sinew::doubts {

using engine::Diagnostic;
using engine::Plug;

Doubting::Doubting(std::shared_ptr<const engine::Graph> graph, engine::Evaluator& evaluator, Look look, double frame,
                   std::stop_token stop, std::shared_ptr<engine::Failures> failures)
    : graph_(std::move(graph))
    , evaluator_(evaluator)
    , look_(look)
    , frame_(frame)
    , stop_(std::move(stop))
    , failures_(std::move(failures)) {}

void Doubting::doubt(std::string_view code, const std::string& node, std::string_view attribute, std::string message,
                     std::string hint) {
    Diagnostic d;
    d.severity = engine::Severity::warning;
    d.code = code;
    d.node = node, d.attribute = attribute;
    d.spot = graph_->spot(node, attribute);
    if (!d.spot) d.spot = graph_->spot(node);
    d.message = std::move(message), d.hint = std::move(hint);
    out_.push_back(std::move(d));
}

bool Doubting::has_said(std::string_view code, const std::string& body) const {
    const std::vector<std::string> upstream = embed::upstream_of(*graph_, {body});
    return std::any_of(out_.begin(), out_.end(), [&](const Diagnostic& d) {
        return d.code == code && std::find(upstream.begin(), upstream.end(), d.node) != upstream.end();
    });
}

bool Doubting::once(std::string_view what, const std::string& node) {
    return asked_.emplace(std::string(what), node).second;
}

std::vector<Plug> Doubting::plugs(const std::string& node, std::string_view attribute) const {
    const auto& inputs = graph_->find(node)->inputs;
    const auto it = inputs.find(attribute);
    if (it == inputs.end()) return {};
    if (const auto* one = std::get_if<Plug>(&it->second)) return {*one};
    const auto* list = std::get_if<std::vector<Plug>>(&it->second);
    return list ? *list : std::vector<Plug>();
}

std::string Doubting::file_of(const std::string& body) const {
    std::vector<std::string> sources;
    for (const Plug& plug : plugs(body, "mesh")) sources.push_back(plug.node);
    for (const std::string& name : embed::upstream_of(*graph_, sources))
        for (const auto& [attribute, binding] : graph_->find(name)->inputs)
            if (const auto* v = std::get_if<engine::Value>(&binding); v && v->is<engine::File>()) {
                const std::string& path = v->as<engine::File>().path;
                if (!path.empty()) return engine::lower_case(path);
            }
    return {};
}

std::string rough(double value, int digits) { return engine::rough_text(value, digits); }

double extent(const solver::Points& points) { return solver::bounding_box(points).size().maxCoeff(); }

} // namespace sinew::doubts
