// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/doubts/doubting.h"

#include "engine/eval/program.h"
#include "engine/text.h"
#include "tools/embed/graph_walk.h"

#include <algorithm>
#include <limits>

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

namespace {

/// Whether the keys that matter from one frame to another have one value. Between them tangents that were given may
/// lead elsewhere; what `steps` does not see the next key before it is there.
bool is_constant(const engine::Curve& curve, bool steps, double first, double last) {
    const auto is_flat = [&](const std::vector<double>& tangent) {
        return steps || std::ranges::all_of(tangent, [](double slope) { return slope == 0; });
    };
    const std::vector<engine::Key>& keys = curve.keys;
    auto from = std::ranges::upper_bound(keys, first, {}, &engine::Key::frame);
    if (from != keys.begin()) --from;
    auto to = steps ? std::ranges::upper_bound(keys, last, {}, &engine::Key::frame)
                    : std::ranges::lower_bound(keys, last, {}, &engine::Key::frame);
    if (to != keys.end() && (!steps || to == from)) ++to;
    return std::all_of(from, to, [&](const engine::Key& key) {
        return key.value == from->value && is_flat(key.tangent_in) && is_flat(key.tangent_out);
    });
}

} // namespace

std::optional<engine::Value> Doubting::literal(const std::string& node, std::string_view attribute) const {
    const engine::Node& n = *graph_->find(node);
    const engine::AttributeInfo* info = n.type ? n.type->find_input(attribute) : nullptr;
    if (!info) return {};
    const auto it = n.inputs.find(attribute);
    if (it == n.inputs.end()) return engine::default_value(*info, graph_->timing());
    if (const auto* value = std::get_if<engine::Value>(&it->second)) return *value;
    const auto* curve = std::get_if<engine::Curve>(&it->second);
    if (!curve || curve->keys.empty()) return {};
    const bool steps = curve->interpolation == engine::Interpolation::step || info->is_stepped();
    // Of one frame alone is a graph that does not say for how long it is.
    const engine::Timing& timing = graph_->timing();
    const double last = timing.end > timing.start ? timing.end : std::numeric_limits<double>::infinity();
    if (!is_constant(*curve, steps, std::min<double>(frame_, timing.start), last)) return {};
    engine::Slot slot;
    slot.kind = engine::Slot::Kind::curve, slot.info = info, slot.curve = curve;
    return slot.sample(frame_);
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

std::vector<double> all_values(const Doubting& d, const std::string& node, std::string_view attribute) {
    std::vector<double> out;
    if (const engine::Curve* curve = d.keys(node, attribute))
        for (const engine::Key& key : curve->keys) out.insert(out.end(), key.value.begin(), key.value.end());
    else if (const auto v = d.number<double>(node, attribute))
        out.push_back(*v);
    return out;
}

std::string rough(double value, int digits) { return engine::rough_text(value, digits); }

double extent(const solver::Points& points) { return solver::bounding_box(points).size().maxCoeff(); }

} // namespace sinew::doubts
