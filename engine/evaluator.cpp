// The public face: finds the plug, opens a session, hands out the value.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/evaluator.h"

#include "engine/check.h"
#include "engine/eval/explain.h"
#include "engine/eval/session.h"
#include "engine/eval/state_file.h"
#include "engine/memory_limit.h"

#include <cmath>

namespace sinew::engine {

struct Evaluator::Impl {
    Core core;
    Impl(const StorePolicy& policy, int threads, Observer* observer)
        : core(policy, threads, observer) {}

    struct Target {
        std::shared_ptr<Program> program;
        int node = -1, output = -1;
    };

    static Failure wrong_plug(const Request& r, std::string message, std::string hint) {
        Diagnostic d;
        d.code = "DG102";
        d.node = r.plug.node, d.attribute = r.plug.attribute;
        d.message = std::move(message), d.hint = std::move(hint);
        return Failure(std::move(d));
    }

    Target find(const Request& r, bool needs_output = true) {
        if (!r.graph) throw std::logic_error("a request without a graph");
        if (!std::isfinite(r.frame) || std::abs(r.frame) > 1e9) {
            Diagnostic d;
            d.code = "DG104";
            d.node = r.plug.node, d.attribute = r.plug.attribute;
            d.message = "not a frame that can be evaluated";
            if (std::isfinite(r.frame)) d.frame = r.frame;
            throw Failure(std::move(d));
        }
        Target out;
        std::tie(out.program, out.node) = core.prepare(r.graph, r.plug.node);
        const NodeType& type = *out.program->place(out.node).type;
        for (std::size_t i = 0; i < type.outputs.size(); ++i)
            if (type.outputs[i].name == r.plug.attribute) out.output = static_cast<int>(i);
        if (needs_output && out.output < 0)
            throw wrong_plug(r, std::string(type.name) + " has no output \"" + r.plug.attribute + "\"",
                             name_hint(r.plug.attribute, output_names(type), "outputs"));
        return out;
    }

    Target find_simulation(const Request& r) {
        Target out = find(r, false);
        const Place& p = out.program->place(out.node);
        if (!p.is_simulation())
            throw wrong_plug(r, std::string(p.type->name) + " is not a simulation and has no state", {});
        return out;
    }
};

std::shared_ptr<Failures> remember_failures() { return std::make_shared<Failures>(); }

Evaluator::Evaluator(StorePolicy policy, int threads, Observer* observer)
    : impl_(std::make_unique<Impl>(policy, threads, observer)) {}
Evaluator::~Evaluator() = default;

Value Evaluator::pull(const Request& request) {
    if (request.stop.stop_requested()) throw Cancelled();
    const Impl::Target target = impl_->find(request);
    Session session(impl_->core, target.program, request.stop, request.frame, request.failures);
    const EntryPtr entry = session.entry(target.node, target.output);
    session.tell();
    const std::lock_guard lock(impl_->core.mutex);
    target.program->pulled = true;
    return entry->outputs[static_cast<std::size_t>(target.output)];
}

Verdict Evaluator::explain(const Request& request) const {
    const Impl::Target target = impl_->find(request);
    return Explainer(impl_->core, target.program).explain(target.node, request.frame);
}

std::vector<std::pair<int, int>> Evaluator::valid_frames(const Request& request, int first, int last) const {
    const Impl::Target target = impl_->find(request);
    Explainer explainer(impl_->core, target.program);
    std::vector<std::pair<int, int>> out;
    for (int f = first; f <= last; ++f) {
        if (explainer.readiness(target.node, f) != Readiness::ready) continue;
        if (!out.empty() && out.back().second == f - 1)
            out.back().second = f;
        else
            out.emplace_back(f, f);
    }
    return out;
}

void Evaluator::drop_scratch() {
    const std::lock_guard lock(impl_->core.mutex);
    impl_->core.scratch.clear();
}

void Evaluator::drop_values() {
    const std::lock_guard lock(impl_->core.mutex);
    impl_->core.values.clear();
}

void Evaluator::rehearse(const Request& request, std::span<const int> frames) {
    if (request.stop.stop_requested()) throw Cancelled();
    const Impl::Target target = impl_->find_simulation(request);
    const Place& p = target.program->place(target.node);
    if (!p.type->simulation->rehearse) return;
    const auto session = [&](int frame) {
        return std::make_unique<Session>(impl_->core, target.program, request.stop, frame, request.failures);
    };
    Value state;
    int last = p.start_frame;
    for (const int frame : frames) {
        if (frame <= last) continue;
        if (last == p.start_frame) state = session(last)->state(target.node);
        try {
            state = session(frame)->rehearse(target.node, state);
        } catch (const Failure&) {
            Value between = state;
            for (int f = last + 1; f < frame; ++f) between = session(f)->rehearse(target.node, between);
            throw;
        }
        last = frame;
    }
}

std::vector<std::byte> Evaluator::save_state(const Request& request) {
    const Impl::Target target = impl_->find_simulation(request);
    const NodeType& type = *target.program->place(target.node).type;
    Session session(impl_->core, target.program, request.stop, request.frame);
    const Value state = session.state(target.node);
    Session again(impl_->core, target.program, request.stop, request.frame);
    return wrap_state(type, again.frame_key(target.node), type.simulation->save(state));
}

void Evaluator::load_state(const Request& request, std::span<const std::byte> bytes) {
    const Impl::Target target = impl_->find_simulation(request);
    Program& program = *target.program;
    const Place& p = program.place(target.node);
    Session session(impl_->core, target.program, request.stop, request.frame);
    const Digest key = session.frame_key(target.node);
    const UnwrappedState found = unwrap_state(*p.type, key, bytes);
    if (!found.fault.empty()) {
        Diagnostic d = program.about(p, {}, "DG105", found.fault);
        d.frame = request.frame;
        throw Failure(std::move(d));
    }
    StoredState stored;
    stored.state = p.type->simulation->load(found.payload);
    const std::lock_guard lock(impl_->core.mutex);
    const int at = static_cast<int>(program.site(target.node, request.frame).frame);
    impl_->core.keep_state(program, target.node, at, key, {}, std::move(stored));
}

std::size_t StorePolicy::default_bytes() {
    static const std::size_t bytes = memory_limit() / 4;
    return bytes;
}

StorePolicy StorePolicy::within(std::size_t bytes) {
    return {.value_bytes = bytes / 3, .state_bytes = bytes - bytes / 3};
}

std::size_t Evaluator::stored_bytes() const {
    const std::lock_guard lock(impl_->core.mutex);
    return impl_->core.stored_bytes();
}

std::size_t Evaluator::most_stored_bytes() const {
    const std::lock_guard lock(impl_->core.mutex);
    return impl_->core.most_stored_bytes;
}

std::size_t Evaluator::made_again() const {
    const std::lock_guard lock(impl_->core.mutex);
    return impl_->core.made_again;
}

int Evaluator::threads() const { return impl_->core.arena.max_concurrency(); }

} // namespace sinew::engine
