// Node types by name, and the checks that a declaration must pass before any graph can use it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"

#include "engine/limits.h"
#include "engine/units.h"

#include <algorithm>
#include <set>
#include <stdexcept>

namespace sinew::engine {

namespace {

[[noreturn]] void contradiction(const NodeType& t, std::string_view attribute, const std::string& what) {
    std::string where = "node type " + std::string(t.name);
    if (!attribute.empty()) where += ", attribute " + std::string(attribute);
    throw std::logic_error(where + ": " + what);
}

void check_literal(const NodeType& t, const AttributeInfo& a) {
    const bool numeric = !a.def.is<std::string>() && !a.def.is<File>() && !a.def.is<bool>();
    if (!(a.limits.min <= a.limits.max)) contradiction(t, a.name, "the limits are empty");
    if (numeric)
        if (const auto wrong = outside(a.limits, a.def)) contradiction(t, a.name, "the default is outside the limits");
    if (!a.options.empty()) {
        if (!a.def.is<std::string>()) contradiction(t, a.name, "only text can have options");
        if (std::find(a.options.begin(), a.options.end(), a.def.as<std::string>()) == a.options.end())
            contradiction(t, a.name, "the default is not among the options");
    }
    if (!a.presets.empty() && !a.def.is<double>()) contradiction(t, a.name, "only a number can have presets");
    if (a.from_timing != FromTiming::nothing && !a.def.is<double>())
        contradiction(t, a.name, "only a number can come from the timing");
    for (const Preset& p : a.presets)
        if (!inside(a.limits, p.value))
            contradiction(t, a.name, "preset \"" + std::string(p.name) + "\" is outside the limits");
    if (a.required && a.def.is<File>() && !a.def.as<File>().path.empty())
        contradiction(t, a.name, "a required file cannot have a default");
}

void check_attribute(const NodeType& t, const AttributeInfo& a, std::set<std::string_view>& seen) {
    if (a.name.empty() || a.name.find('.') != std::string_view::npos)
        contradiction(t, a.name, "an attribute needs a name without a dot");
    if (!seen.insert(a.name).second) contradiction(t, a.name, "declared twice");
    if (a.doc.empty()) contradiction(t, a.name, "has no doc");
    if (!a.unit.empty() && !parse_unit(a.unit)) contradiction(t, a.name, "\"" + std::string(a.unit) + "\" is no unit");
    if (a.affects == Affects::initial_state && !t.simulation)
        contradiction(t, a.name, "only a simulation has an initial state");
    for (const std::string_view name : {a.when, a.aside_when}) {
        if (name.empty()) continue;
        const AttributeInfo* s = t.find_input(name);
        if (!s || s->kind != AttributeKind::literal || !s->def.is<bool>() || s->affects != Affects::result ||
            !s->when.empty())
            contradiction(t, a.name,
                          "what switches it is an Input<bool> of the same node that affects the result and that "
                          "nothing else switches");
    }
    if (a.kind == AttributeKind::literal) check_literal(t, a);
}

// The engine itself reads the start frame, the sub-steps and what decides on stages, before anything runs.
void check_time_inputs(const NodeType& t) {
    const SimulationFunctions& f = *t.simulation;
    if (const AttributeInfo* a = t.find_input(f.start_frame_input))
        if (a->kind != AttributeKind::literal || !a->def.is<double>() || a->keyable)
            contradiction(t, a->name, "the start frame is an Input<double> that is not keyable");
    if (const AttributeInfo* a = t.find_input(f.substeps_input))
        if (a->kind != AttributeKind::literal || !a->def.is<std::int64_t>() || a->def.as<std::int64_t>() < 1)
            contradiction(t, a->name, "the sub-steps are an Input<std::int64_t>, at least 1");
    if (f.stages_input.empty() != !f.stages)
        contradiction(t, f.stages_input, "stage times need both the input that decides them and a function of it");
    if (f.stages_input.empty()) return;
    const AttributeInfo* a = t.find_input(f.stages_input);
    if (!a || a->kind != AttributeKind::literal || a->affects != Affects::result)
        contradiction(t, f.stages_input, "what decides on stage times is an Input that affects the result");
}

// So is the switch that keeps outputs on disk; it must not enter their key.
void check_kept(const NodeType& t, const std::map<std::type_index, Codec>& codecs) {
    const AttributeInfo* a = t.find_input(t.kept_when);
    if (!a || a->kind != AttributeKind::literal || !a->def.is<bool>() || a->keyable || a->affects != Affects::nothing)
        contradiction(t, t.kept_when,
                      "what keeps outputs on disk is an Input<bool> that is not keyable and affects nothing");
    if (t.simulation) contradiction(t, t.kept_when, "frames of simulations are not kept on disk");
    for (const AttributeInfo& o : t.outputs)
        if (!codecs.contains(o.type)) contradiction(t, o.name, "is to be kept on disk and its type has no codec");
}

} // namespace

void Registry::add(Codec codec) {
    const std::string name(codec.type_name);
    if (!codecs_.emplace(codec.type, std::move(codec)).second)
        throw std::logic_error("a second codec for values of type " + name);
}

const Codec* Registry::find_codec(std::type_index type) const {
    const auto it = codecs_.find(type);
    return it == codecs_.end() ? nullptr : &it->second;
}

void Registry::add(NodeType type) {
    if (type.name.empty()) throw std::logic_error("a node type needs a name");
    if (types_.contains(type.name)) contradiction(type, {}, "registered twice");
    if (type.doc.empty()) contradiction(type, {}, "has no doc");
    if (type.version < 1 || type.numerics < 1) contradiction(type, {}, "version and numerics start at 1");
    if (type.outputs.empty()) contradiction(type, {}, "has no output");
    if (static_cast<bool>(type.compute) == static_cast<bool>(type.simulation))
        contradiction(type, {}, "needs either compute or a simulation");
    std::set<std::string_view> inputs, outputs;
    for (const AttributeInfo& a : type.inputs) {
        if (a.kind == AttributeKind::output) contradiction(type, a.name, "an output stands among the inputs");
        check_attribute(type, a, inputs);
    }
    for (const AttributeInfo& a : type.outputs) {
        if (a.kind != AttributeKind::output) contradiction(type, a.name, "an input stands among the outputs");
        check_attribute(type, a, outputs);
    }
    if (!type.time_input.empty() && (!type.uses_time || !type.find_input(type.time_input)))
        contradiction(type, type.time_input, "brings time in where none is used, or is no input");
    if (type.simulation) check_time_inputs(type);
    if (!type.kept_when.empty()) check_kept(type, codecs_);
    std::string name(type.name);
    types_.emplace(std::move(name), std::move(type));
}

const NodeType* Registry::find(std::string_view name) const {
    const auto it = types_.find(name);
    return it == types_.end() ? nullptr : &it->second;
}

std::vector<std::string> Registry::names() const {
    std::vector<std::string> out;
    for (const auto& [name, type] : types_) out.push_back(name);
    return out;
}

} // namespace sinew::engine
