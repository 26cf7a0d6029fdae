// One pull, from request to value. A session works through a stack of goals: a goal either finishes, or
// pushes the goals that it needs first and is tried again later. Nothing recurses, however deep the graph is.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/eval/core.h"
#include "engine/eval/keys.h"
#include "engine/eval/node_reads.h"

#include <functional>
#include <memory>
#include <set>
#include <span>
#include <stop_token>

namespace sinew::engine {

class Session;

/// What a step of a simulation reads, gathered.
struct GatheredStep {
    std::vector<SubstepTimes> times;
    std::vector<std::pair<double, SlotValues>> inputs; ///< at the stages of each sub-step, then at its end
};

class Goal {
  public:
    Goal(Session& session, Goal* parent)
        : session_(session)
        , parent_(parent) {}
    virtual ~Goal() = default;
    /// True: done. False: try again, after the goals that it pushed.
    virtual bool step() = 0;

  protected:
    /// Needs the core's mutex. What this goal holds on to, else what the store has, of that node; nothing if it lacks
    /// an output that this session reads.
    EntryPtr find(const Digest& key, int node);
    /// Needs the core's mutex, and the keys of what is read. The entry of a site, which is pinned, or nothing.
    EntryPtr pinned(const Site& site);
    /// Needs the core's mutex, and the keys of what is read. What a step to `frame` reads; sites that have no entry yet
    /// are appended to `missing`.
    GatheredStep gather_step(int simulation, int frame, Phase phase, std::vector<Site>& missing);
    Session& session_;
    Goal* parent_;
    /// Results of child goals, safe from eviction until they have been used.
    std::unordered_map<Digest, EntryPtr, DigestHash> pins_;
    friend class ValuesGoal;
    friend class FrameGoal;
    friend class Session;
};

class Session {
  public:
    Session(Core& core, std::shared_ptr<Program> program, std::stop_token stop, double frame,
            std::shared_ptr<Failures> failures = {});
    /// The entry of a node at the session's frame, with that output at least.
    EntryPtr entry(int node, int output);
    /// The state of a simulation at the session's frame.
    Value state(int simulation);
    /// Has a simulation look at what it would read on its way to the session's frame, without a step; `before` as
    /// SimulationType::rehearse takes it.
    Value rehearse(int simulation, const Value& before);
    /// Makes the chain of a simulation reach the session's frame, without a step.
    Digest frame_key(int simulation);

    Core& core;
    const std::shared_ptr<Program> program;
    const std::stop_token stop;
    const double frame;
    Keys keys;

    void push(std::unique_ptr<Goal> goal) { stack_.push_back(std::move(goal)); }
    void push_chains(const Needs& needs, Goal* parent);
    void push_values(std::vector<Site> sites, Goal* parent);
    void check_stop() const {
        if (stop.stop_requested()) throw Cancelled();
    }
    /// Needs the core's mutex. Whether the entry of a simulation has all that this session reads of it.
    bool suffices(int simulation, const Entry& entry) const {
        return program->suffices(target_, target_output_, simulation, entry);
    }
    /// Without the mutex. A frame of a simulation that is kept on disk; none, with a warning where there is one that
    /// cannot be used.
    std::optional<KeptFrame> read_frame(int simulation, const Digest& key, bool with_state);
    /// Without the mutex. Warns that what is kept of a frame is of no use; once for a node and a fault.
    void tell_unusable(int simulation, const Digest& key, const std::string& fault);
    /// Without the mutex. Keeps a frame on disk; where that fails, it is told once.
    void keep_frame(int simulation, int frame, const Digest& key, const EntryPtr& entry, const StoredState& state);

    /// Without the mutex. Keeps what plugs are known to hold on disk; where that fails, it is told once.
    void keep_learned(const Place& p);
    void tell_not_kept(const Place& p, const Failure& failure);

    /// Needs the core's mutex. Notes that a stored result was used; told to the observer by `tell`.
    void note_reuse(const Digest& key, const Site& site, const EntryPtr& entry);
    /// This session computed the key itself: finding it again is no reuse.
    void note_made(const Digest& key) { reused_.insert(key); }
    /// Needs the core's mutex. Work on this graph that failed earlier in this command, or nothing.
    FlightPtr failed(const Digest& key) const;
    /// Takes the core's mutex. Keeps a flight that ended in an error.
    void remember(const Digest& key, const FlightPtr& flight);
    /// Without the mutex: passes on what was noted.
    void tell();

  private:
    void run(std::unique_ptr<Goal> goal);
    int target_ = -1, target_output_ = -1;
    std::shared_ptr<Failures> failures_;
    std::vector<std::unique_ptr<Goal>> stack_;
    std::set<Digest> reused_;
    std::vector<std::pair<std::string, double>> reuse_events_;
    std::vector<Diagnostic> repeated_warnings_;
};

/// Evaluates nodes side by side, and whatever they need and nobody has yet.
class ValuesGoal : public Goal {
  public:
    ValuesGoal(Session& s, Goal* parent, std::vector<Site> targets)
        : Goal(s, parent)
        , targets_(std::move(targets)) {}
    bool step() override;

  private:
    std::vector<Site> targets_;
};

/// Extends the chain of a simulation up to a frame.
class ChainGoal : public Goal {
  public:
    ChainGoal(Session& s, Goal* parent, int simulation, int frame)
        : Goal(s, parent)
        , simulation_(simulation)
        , frame_(frame) {}
    bool step() override;

  private:
    int simulation_, frame_;
};

/// Brings a simulation to a frame: finds the frame, or the nearest state before it, and steps on from there.
class FrameGoal : public Goal {
  public:
    FrameGoal(Session& s, Goal* parent, int simulation, int frame, bool state_only = false)
        : Goal(s, parent)
        , simulation_(simulation)
        , frame_(frame)
        , state_only_(state_only) {}
    bool step() override;
    const Value& state() const { return state_.state; }

  private:
    const Place& place() const { return session_.program->place(simulation_); }
    void find_nearest_state();
    bool take_from_disk(std::unique_lock<std::mutex>& lock, const Digest& key);
    bool load_nearest(std::unique_lock<std::mutex>& lock);
    void take(const StoredState& state, int frame);
    bool finish(const Digest& key, EntryPtr entry);
    bool make(std::unique_lock<std::mutex>& lock, int next);
    StoredState advanced(GatheredStep step, CallContext& context, int next);
    EntryPtr published(SlotValues values, const StoredState& state, int next);

    int simulation_, frame_;
    bool state_only_;
    bool searched_ = false, stepped_ = false;
    bool looked_on_disk_ = false; ///< for the frame itself
    std::optional<int> on_disk_;  ///< the nearest frame whose state is kept there, where none as near is in memory
    std::set<int> not_on_disk_;   ///< frames whose files are there and cannot be used
    int have_ = 0;                ///< frame of state_; below the start frame: none
    StoredState state_;
};

/// Has a simulation rehearse the step to the session's frame (SimulationType::rehearse). `before` and `out` must
/// outlive the goal.
std::unique_ptr<Goal> rehearsal(Session& session, Goal* parent, int simulation, const Value& before, Value& out);

/// Gathers the values of all slots of a node at a time. `entry_of` gives the entry of a source or nothing; sites
/// without one are appended to `missing`.
template <class EntryOf>
SlotValues gather(const Program& program, const Place& p, double time, Phase phase, EntryOf entry_of,
                  std::vector<Site>& missing) {
    SlotValues out(p.slots.size());
    for (std::size_t i = 0; i < p.slots.size(); ++i) {
        const Slot& s = p.slots[i];
        if (!s.read_by_compute()) continue;
        const bool later = phase == Phase::advance || phase == Phase::publish;
        if (s.info->affects == Affects::initial_state && later) continue;
        if (s.kind == Slot::Kind::constant || s.kind == Slot::Kind::curve) out[i].push_back(s.sample(time));
        for (const Source& source : s.sources) {
            const Site site = program.site(source, time);
            const EntryPtr entry = entry_of(site);
            if (entry)
                out[i].push_back(entry->outputs[static_cast<std::size_t>(source.output)]);
            else
                missing.push_back(site);
        }
    }
    return out;
}

/// Runs a call of a node where its own parallel loops keep to our threads; isolated, so that a loop that waits does not
/// pick up another node in between.
void on_arena(Core& core, const std::function<void()>& call);

/// Calls `use` with what the simulation of `context` reads in a step, on the arena.
void with_reads(GatheredStep step, CallContext& context, const std::function<void(std::span<const SubstepReads>)>& use);

/// What a node wrote, checked against its declaration. Throws std::logic_error if it does not fit.
EntryPtr make_entry(const Place& p, const Writes& writes, std::vector<Diagnostic> warnings);

} // namespace sinew::engine
