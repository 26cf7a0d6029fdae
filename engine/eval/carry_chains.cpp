// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/carry_chains.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::engine {

namespace {

constexpr double always = std::numeric_limits<double>::infinity();

bool same_key(const Key& a, const Key& b) {
    return a.frame == b.frame && a.value == b.value && a.tangent_in == b.tangent_in && a.tangent_out == b.tangent_out;
}

/// Curves hold their last value, so a key that one has and the other has not counts from the key before it.
double same_until(const Curve& a, const Curve& b) {
    if (a.interpolation != b.interpolation) return -always;
    const std::size_t shared = std::min(a.keys.size(), b.keys.size());
    std::size_t same = 0;
    while (same < shared && same_key(a.keys[same], b.keys[same])) ++same;
    if (same == shared && a.keys.size() == b.keys.size()) return always;
    // The tangent at a smooth key looks at the next one, so the span before it changes too.
    const std::size_t spoiled = a.interpolation == Interpolation::smooth ? 1 : 0;
    return same > spoiled ? a.keys[same - 1 - spoiled].frame : -always;
}

double same_until(const Binding& a, const Binding& b) {
    if (a.index() != b.index()) return -always;
    if (const Curve* curve = std::get_if<Curve>(&a)) return same_until(*curve, std::get<Curve>(b));
    bool same = false;
    if (const Value* value = std::get_if<Value>(&a))
        same = value->type() == std::get<Value>(b).type() && value->digest() == std::get<Value>(b).digest();
    else if (const Plug* plug = std::get_if<Plug>(&a))
        same = *plug == std::get<Plug>(b);
    else
        same = std::get<std::vector<Plug>>(a) == std::get<std::vector<Plug>>(b);
    return same ? always : -always;
}

/// Of a switch that looks ahead: what it will be belongs to what it is at the first frame.
bool is_ever_on(const Binding& b) {
    if (const Value* value = std::get_if<Value>(&b)) return value->as<bool>();
    const Curve* curve = std::get_if<Curve>(&b);
    return !curve || is_ever_on(*curve);
}

bool look_ahead_alike(const Node& node, const std::string& input, const Binding& a, const Binding& b) {
    const AttributeInfo* info = node.type ? node.type->find_input(input) : nullptr;
    return !info || !info->looks_ahead || is_ever_on(a) == is_ever_on(b);
}

double same_until(const Node& a, const Node& b) {
    if (&a == &b) return always; // snapshots share what an edit did not touch
    if (a.type != b.type || a.type_name != b.type_name || a.inputs.size() != b.inputs.size()) return -always;
    double out = always;
    for (auto i = a.inputs.begin(), j = b.inputs.begin(); i != a.inputs.end() && out > -always; ++i, ++j)
        out = i->first == j->first && look_ahead_alike(a, i->first, i->second, j->second)
                  ? std::min(out, same_until(i->second, j->second))
                  : -always;
    return out;
}

/// Do both know the same contents of all files that the node needs?
bool same_files(Program& from, Program& to, int node) {
    for (const int at : to.cone(node)) {
        const Place &now = to.place(at), &before = from.place(at);
        for (std::size_t i = 0; i < now.slots.size(); ++i) {
            const Slot &s = now.slots[i], &t = before.slots[i];
            if (s.kind == Slot::Kind::constant && s.constant.is<File>() && s.constant.digest() != t.constant.digest())
                return false;
        }
    }
    return true;
}

} // namespace

double same_until(const Graph& a, const Graph& b) {
    if (a.timing().fps != b.timing().fps || a.timing().start != b.timing().start) return -always;
    const std::vector<std::string> names = a.node_names();
    if (names != b.node_names()) return -always;
    double out = always;
    for (std::size_t i = 0; i < names.size() && out > -always; ++i)
        out = std::min(out, same_until(*a.find(names[i]), *b.find(names[i])));
    return out;
}

void carry_chains(Program& from, Program& to, int node) {
    const std::vector<int>& cone = to.cone(node);
    const bool is_wanted = std::any_of(
        cone.begin(), cone.end(), [&](int at) { return to.place(at).is_simulation() && to.place(at).chain.empty(); });
    if (!is_wanted) return;
    const double until = same_until(*from.graph(), *to.graph());
    if (!(until > -always) || !same_files(from, to, node)) return;
    to.carry_reached(from);
    for (const int at : cone) {
        Place& p = to.place(at);
        const Place& before = from.place(at); // same names in the same order, so the same numbers
        if (!p.is_simulation() || !p.chain.empty() || p.start_frame != before.start_frame) continue;
        const double frames = std::floor(std::min(until, 1e9)) - p.start_frame + 1;
        const auto count = std::min(before.chain.size(), static_cast<std::size_t>(std::max(0.0, frames)));
        p.chain.assign(before.chain.begin(), before.chain.begin() + static_cast<std::ptrdiff_t>(count));
    }
}

} // namespace sinew::engine
