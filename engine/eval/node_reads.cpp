// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/node_reads.h"

#include "engine/check.h"
#include "engine/limits.h"
#include "engine/text.h"

#include <algorithm>
#include <stdexcept>

namespace sinew::engine {

std::size_t NodeReads::slot(std::string_view attribute) const {
    const Place& p = *context_.place;
    const auto refuse = [&](const char* why) {
        throw std::logic_error(std::string(p.type->name) + " read \"" + std::string(attribute) + "\", which " + why);
    };
    for (std::size_t i = 0; i < p.slots.size(); ++i) {
        const AttributeInfo& info = *p.slots[i].info;
        if (info.name != attribute) continue;
        if (info.affects == Affects::nothing) refuse("affects nothing and so must not be read");
        const bool later = context_.phase == Phase::advance || context_.phase == Phase::publish;
        if (info.affects == Affects::initial_state && later) refuse("belongs to the initial state only");
        for (std::size_t k = 0; !info.when.empty() && k < p.slots.size(); ++k)
            if (p.slots[k].info->name == info.when && !values_[k].empty() && !values_[k].front().as<bool>())
                refuse("is switched off");
        return i;
    }
    refuse("it did not declare");
    return 0;
}

Value NodeReads::get(std::string_view attribute) {
    const std::size_t i = slot(attribute);
    if (context_.place->slots[i].info->kind == AttributeKind::wire_list)
        throw std::logic_error(std::string(attribute) + " is a list and was read as a single value");
    if (values_[i].empty()) return {};
    const Value& v = values_[i].front();
    refuse_outside(context_.place->slots[i], v);
    return v;
}

// Literals are checked when the graph is read. What a connection brings, or a curve with steep tangents passes through
// between its keys, is known only now.
void NodeReads::refuse_outside(const Slot& s, const Value& v) {
    if (s.kind != Slot::Kind::wire && s.kind != Slot::Kind::curve) return;
    if (s.info->kind != AttributeKind::literal) return;
    const auto wrong = outside(s.info->limits, v);
    if (!wrong) return;
    Diagnostic d;
    d.code = "DG013";
    d.attribute = s.info->name;
    const std::string from = s.kind == Slot::Kind::wire && !s.sources.empty()
                                 ? " (from " + context_.program->place(s.sources.front().node).name + ")"
                                 : " (between keys)";
    d.message = number_text(wrong->value) + from + " is outside " + limits_text(s.info->limits, s.info->unit);
    d.hint = meaning_of(*s.info);
    fail(std::move(d));
}

std::vector<Value> NodeReads::get_list(std::string_view attribute) {
    const std::size_t i = slot(attribute);
    if (context_.place->slots[i].info->kind != AttributeKind::wire_list)
        throw std::logic_error(std::string(attribute) + " is a single value and was read as a list");
    if (!context_.place->slots[i].info->with_start) return values_[i];
    return {values_[i].begin(), values_[i].begin() + static_cast<std::ptrdiff_t>(values_[i].size() / 2)};
}

std::pair<Value, Value> NodeReads::around(std::string_view attribute) {
    const std::size_t i = slot(attribute);
    if (!context_.place->slots[i].info->whole_frames)
        throw std::logic_error(std::string(attribute) + " is not read at whole frames");
    if (values_[i].empty()) return {};
    return {values_[i].front(), values_[i].back()};
}

std::vector<Value> NodeReads::list_at_start(std::string_view attribute) {
    const std::size_t i = slot(attribute);
    if (!context_.place->slots[i].info->with_start)
        throw std::logic_error(std::string(attribute) + " is not read at the start");
    return {values_[i].begin() + static_cast<std::ptrdiff_t>(values_[i].size() / 2), values_[i].end()};
}

std::vector<std::string> NodeReads::entry_names(std::string_view attribute) {
    const Place& p = *context_.place;
    return engine::entry_names(*context_.program->graph(), *p.node, *p.slots[slot(attribute)].info);
}

bool NodeReads::is_ever_on(std::string_view attribute) {
    const Slot& s = context_.place->slots[slot(attribute)];
    if (!s.info->looks_ahead) throw std::logic_error(std::string(attribute) + " does not look ahead");
    return s.is_ever_on();
}

Digest NodeReads::digest(std::string_view attribute) {
    const std::size_t i = slot(attribute);
    if (context_.place->slots[i].info->kind != AttributeKind::wire_list) return get(attribute).digest();
    Hasher h;
    h.add(std::uint64_t{values_[i].size()});
    for (const Value& v : values_[i]) h.add(v.digest());
    return h.finish();
}

void NodeReads::needs_time(std::string_view what) const {
    const NodeType& t = *context_.place->type;
    if (!context_.place->uses_frame && !t.simulation)
        throw std::logic_error(std::string(t.name) + " asked for the " + std::string(what) +
                               " without declaring uses_time" +
                               (t.uses_time ? ", or where its time_input is not set" : ""));
}

double NodeReads::frame() {
    needs_time("frame");
    return time_;
}

double NodeReads::fps() {
    needs_time("frame rate");
    return context_.program->graph()->timing().fps;
}

void NodeReads::checkpoint() {
    if (stop_requested()) throw Cancelled();
}

void NodeReads::progress(double done, std::string_view what) {
    context_.core->observe([&](Observer& o) { o.progress(context_.place->name, done, what); });
}

void NodeReads::place(Diagnostic& d) const {
    if (!d.frame && context_.place->dynamic) d.frame = context_.frame;
    locate(d, *context_.program->graph(), context_.place->name);
}

void NodeReads::report(Diagnostic d) {
    {
        const std::lock_guard lock(context_.mutex);
        context_.warnings.push_back(d);
    }
    place(d);
    context_.core->observe([&](Observer& o) { o.warning(d); });
}

void NodeReads::fail(Diagnostic d) {
    place(d);
    if (d.code.rfind("FE3", 0) == 0) throw SolveFailure(std::move(d));
    throw Failure(std::move(d));
}

// Two types may build different things under one key; the type's name keeps them apart.
Digest NodeReads::scratch_key(const Digest& key) const {
    return Hasher().add(context_.place->type->name).add(key).finish();
}

std::shared_ptr<void> NodeReads::take_scratch(const Digest& key) {
    const std::lock_guard lock(context_.core->mutex);
    return context_.core->scratch.take(scratch_key(key));
}

void NodeReads::give_scratch(const Digest& key, std::shared_ptr<void> scratch) {
    const std::lock_guard lock(context_.core->mutex);
    context_.core->scratch.give(scratch_key(key), std::move(scratch));
}

std::string NodeReads::source_name(std::string_view attribute, std::size_t index) {
    const Slot& s = context_.place->slots[slot(attribute)];
    if (index >= s.sources.size()) return {};
    return context_.program->place(s.sources[index].node).name;
}

std::string NodeReads::source_behind(std::string_view attribute, std::size_t index, std::string_view input,
                                     std::size_t entry) {
    const Slot& s = context_.place->slots[slot(attribute)];
    if (index >= s.sources.size()) return {};
    for (const Slot& of_source : context_.program->place(s.sources[index].node).slots)
        if (of_source.info->name == input && entry < of_source.sources.size())
            return context_.program->place(of_source.sources[entry].node).name;
    return {};
}

} // namespace sinew::engine
