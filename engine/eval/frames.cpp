// Stepping a simulation: the nearest kept state, then frame by frame.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/arena.h"
#include "engine/eval/session.h"

#include <chrono>
#include <utility>

namespace sinew::engine {

namespace {

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Ends a claim, whatever happens: with an entry, with an error, or given up.
class Claim {
  public:
    Claim(Core& core, const Digest& key, const NodeType& type, const Graph* graph)
        : core_(core)
        , key_(key)
        , type_(type)
        , flight_(core.claim(key, graph)) {}
    ~Claim() {
        if (flight_) core_.land(key_, flight_, type_, nullptr, nullptr);
    }
    Claim(const Claim&) = delete;
    FlightPtr land(EntryPtr entry, std::exception_ptr error) {
        FlightPtr flight = std::exchange(flight_, nullptr);
        core_.land(key_, flight, type_, std::move(entry), std::move(error));
        return flight;
    }

  private:
    Core& core_;
    Digest key_;
    const NodeType& type_;
    FlightPtr flight_;
};

} // namespace

void on_arena(Core& core, const std::function<void()>& call) {
    std::exception_ptr error;
    run_on(core.arena, [&] {
        tbb::this_task_arena::isolate([&] {
            try {
                call();
            } catch (...) {
                error = std::current_exception();
            }
        });
    });
    if (error) std::rethrow_exception(error);
}

void with_reads(GatheredStep step, CallContext& context,
                const std::function<void(std::span<const SubstepReads>)>& use) {
    std::vector<std::unique_ptr<NodeReads>> sources;
    for (auto& [t, values] : step.inputs) sources.push_back(std::make_unique<NodeReads>(context, std::move(values), t));
    on_arena(*context.core, [&] {
        std::vector<SubstepReads> reads;
        auto source = sources.begin();
        for (const SubstepTimes& t : step.times) {
            std::vector<Reads> within;
            for (std::size_t i = 0; i < t.within.size(); ++i) within.emplace_back(**source++);
            reads.push_back({Reads(**source++), std::move(within)});
        }
        use(reads);
    });
}

EntryPtr Goal::pinned(const Site& site) {
    Needs none;
    const Digest key = *session_.keys.of(site, none);
    const EntryPtr entry = find(key, site.node);
    if (entry) pins_[key] = entry;
    return entry;
}

GatheredStep Goal::gather_step(int simulation, int frame, Phase phase, std::vector<Site>& missing) {
    const Place& p = session_.program->place(simulation);
    GatheredStep out;
    out.times = session_.keys.read_times(simulation, frame);
    const auto take = [&](double t) {
        out.inputs.emplace_back(
            t, gather(
                   *session_.program, p, t, phase, [&](const Site& site) { return pinned(site); }, missing));
    };
    for (const SubstepTimes& t : out.times) {
        for (const double within : t.within) take(within);
        take(t.end);
    }
    return out;
}

void FrameGoal::find_nearest_state() {
    searched_ = true;
    on_disk_.reset();
    for (have_ = frame_; have_ >= place().start_frame; --have_) { // each asks the disk, and there may be a million
        session_.check_stop();
        const Digest& key = session_.keys.frame_key(simulation_, have_);
        if (const StoredState* s = session_.core.states.find(key)) return take(*s, have_);
        if (!on_disk_ && session_.core.frames && !not_on_disk_.contains(have_) && session_.core.frames->contains(key))
            on_disk_ = have_;
        if (on_disk_) return;
    }
}

// The state of that frame, from disk. False: it could not be used.
bool FrameGoal::load_nearest(std::unique_lock<std::mutex>& lock) {
    Session& s = session_;
    const int frame = *on_disk_;
    on_disk_.reset();
    const Digest key = s.keys.frame_key(simulation_, frame);
    lock.unlock();
    std::optional<KeptFrame> kept = s.read_frame(simulation_, key, true);
    StoredState stored;
    if (kept) {
        try {
            stored = {place().type->simulation->load(kept->state), std::move(kept->warnings_of_state)};
        } catch (const Cancelled&) {
            throw;
        } catch (const std::exception& fault) { // bytes that were whole and are no state: made by other code
            const auto* failure = dynamic_cast<const Failure*>(&fault);
            if (not_on_disk_.empty()) // those before it will be none either
                s.tell_unusable(simulation_, key, failure ? failure->diagnostics().front().message : fault.what());
            kept.reset();
        }
    }
    lock.lock();
    if (!kept) {
        not_on_disk_.insert(frame);
        searched_ = false;
        return false;
    }
    s.core.keep_state(*s.program, simulation_, frame, key, {}, stored);
    state_ = std::move(stored);
    have_ = frame;
    return true;
}

// Puts the outputs that are kept of this frame into memory. False: there are none, or not those that are needed.
bool FrameGoal::take_from_disk(std::unique_lock<std::mutex>& lock, const Digest& key) {
    Session& s = session_;
    looked_on_disk_ = true;
    if (!s.core.frames || !s.core.frames->contains(key)) return false;
    lock.unlock();
    std::optional<KeptFrame> kept = s.read_frame(simulation_, key, false);
    lock.lock();
    if (!kept) {
        not_on_disk_.insert(frame_);
        return false;
    }
    s.core.keep(key, {}, *place().type, kept->entry);
    if (!s.suffices(simulation_, *kept->entry)) return false;
    pins_[key] = kept->entry;
    return true;
}

void FrameGoal::take(const StoredState& state, int frame) {
    state_ = state;
    have_ = frame;
    session_.program->place(simulation_).reached = session_.keys.frame_key(simulation_, frame);
}

bool FrameGoal::finish(const Digest& key, EntryPtr entry) {
    parent_->pins_[key] = std::move(entry);
    return true;
}

bool FrameGoal::step() {
    Session& s = session_;
    std::unique_lock lock(s.core.mutex);
    Needs needs;
    if (!s.keys.extend(simulation_, frame_, needs)) {
        lock.unlock();
        s.push(std::make_unique<ChainGoal>(s, this, simulation_, frame_));
        return false;
    }
    const Digest key = s.keys.frame_key(simulation_, frame_);
    if (!state_only_)
        if (EntryPtr entry = find(key, simulation_)) {
            if (!stepped_) s.note_reuse(key, {simulation_, static_cast<double>(frame_)}, entry);
            lock.unlock();
            s.tell();
            return finish(key, std::move(entry));
        }
    if (!state_only_ && !looked_on_disk_ && take_from_disk(lock, key)) return false;
    if (!searched_) find_nearest_state();
    if (on_disk_) {
        load_nearest(lock);
        return false;
    }
    if (state_only_ && have_ == frame_) return true;
    const int next = have_ == frame_ ? frame_ : have_ + 1;
    if (next > have_) // another pull may have come by
        if (const StoredState* there = s.core.states.find(s.keys.frame_key(simulation_, next))) {
            take(*there, next);
            return false;
        }
    return make(lock, next);
}

// Steps to `next` unless its state is here already, and publishes its outputs.
bool FrameGoal::make(std::unique_lock<std::mutex>& lock, int next) {
    Session& s = session_;
    const Place& p = place();
    const bool steps = next > have_, first = next == p.start_frame;
    const Phase phase = first ? Phase::initial : Phase::advance;
    std::vector<Site> missing;
    GatheredStep inputs;
    if (steps) inputs = gather_step(simulation_, next, phase, missing);
    SlotValues at_frame = gather(
        *s.program, p, next, Phase::publish, [&](const Site& site) { return pinned(site); }, missing);
    if (!missing.empty()) {
        lock.unlock();
        s.push_values(std::move(missing), this);
        return false;
    }
    const Digest key = s.keys.frame_key(simulation_, next);
    if (const auto flight = s.core.flights.find(key); flight != s.core.flights.end()) {
        const FlightPtr theirs = flight->second; // one thread steps; the others wait, holding nothing
        if (!s.core.landed.wait(lock, s.stop, [&] { return theirs->done; })) throw Cancelled();
        if (theirs->error && theirs->graph == s.program->graph().get()) std::rethrow_exception(theirs->error);
        return false;
    }
    if (const FlightPtr failed = s.failed(key)) std::rethrow_exception(failed->error);
    Claim claim(s.core, key, *p.type, s.program->graph().get());
    const EntryPtr there = s.core.values.find(key);
    const bool publishes = !there || (next == frame_ && !s.suffices(simulation_, *there));
    lock.unlock();
    stepped_ = true;
    s.note_made(key);
    try {
        if (steps) {
            CallContext context;
            context.core = &s.core, context.program = s.program.get(), context.place = &p;
            context.stop = s.stop, context.frame = next, context.phase = phase;
            StoredState made = advanced(std::move(inputs), context, next);
            const std::lock_guard again(s.core.mutex);
            s.core.keep_state(*s.program, simulation_, next, key,
                              first ? std::nullopt : std::optional(s.keys.frame_key(simulation_, next - 1)), made);
            state_ = std::move(made);
            have_ = next;
        }
        EntryPtr entry;
        if (publishes) entry = published(std::move(at_frame), state_, next);
        if (entry && next == frame_) pins_.insert_or_assign(key, entry);
        if (entry && steps && s.core.frames) s.keep_frame(simulation_, next, key, entry, state_);
        claim.land(std::move(entry), nullptr);
    } catch (const Cancelled&) {
        throw;
    } catch (...) {
        s.remember(key, claim.land(nullptr, std::current_exception()));
        throw;
    }
    if (next != frame_) pins_.clear(); // the inputs of this frame are not needed again
    return false;
}

StoredState FrameGoal::advanced(GatheredStep step, CallContext& context, int next) {
    const SimulationFunctions& f = *place().type->simulation;
    const Core::AtWork at_work(session_.core, place().name, next);
    const auto begin = std::chrono::steady_clock::now();
    StoredState out;
    with_reads(std::move(step), context, [&](std::span<const SubstepReads> reads) {
        out.state = context.phase == Phase::initial ? f.initial(reads.front().end) : f.advance(state_.state, reads);
    });
    out.warnings = std::move(context.warnings);
    const double seconds = seconds_since(begin);
    session_.core.observe([&](Observer& o) { o.stepped(place().name, next, seconds); });
    return out;
}

EntryPtr FrameGoal::published(SlotValues values, const StoredState& state, int next) {
    const Place& p = place();
    CallContext context;
    context.core = &session_.core, context.program = session_.program.get(), context.place = &p;
    context.stop = session_.stop, context.frame = next, context.phase = Phase::publish;
    NodeReads source(context, std::move(values), next);
    Writes writes;
    const auto begin = std::chrono::steady_clock::now();
    on_arena(session_.core, [&] {
        const Reads reads(source);
        p.type->simulation->publish(state.state, reads, writes);
    });
    std::vector<Diagnostic> warnings = state.warnings;
    warnings.insert(warnings.end(), context.warnings.begin(), context.warnings.end());
    EntryPtr entry = make_entry(p, writes, std::move(warnings));
    {
        const std::lock_guard lock(session_.core.mutex);
        if (!entry->warnings.empty()) session_.program->delivered.insert(session_.keys.frame_key(simulation_, next));
    }
    session_.core.observe([&](Observer& o) { o.computed(p.name, next, seconds_since(begin)); });
    return entry;
}

} // namespace sinew::engine
