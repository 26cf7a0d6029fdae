// Has a simulation look at what it would read at a frame, without stepping there: how a graph is checked ahead.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/session.h"

namespace sinew::engine {

namespace {

class RehearsalGoal : public Goal {
  public:
    RehearsalGoal(Session& s, Goal* parent, int simulation, const Value& before, Value& out)
        : Goal(s, parent)
        , simulation_(simulation)
        , before_(before)
        , out_(out) {}

    bool step() override {
        Session& s = session_;
        const Place& p = s.program->place(simulation_);
        const int frame = static_cast<int>(s.frame);
        std::unique_lock lock(s.core.mutex);
        Needs needs;
        for (const SubstepTimes& t : s.keys.read_times(simulation_, frame)) {
            for (const double within : t.within) know_sources(p, within, needs);
            know_sources(p, t.end, needs);
        }
        if (!needs.empty()) {
            lock.unlock();
            s.push_chains(needs, this);
            return false;
        }
        std::vector<Site> missing;
        GatheredStep gathered = gather_step(simulation_, frame, Phase::advance, missing);
        lock.unlock();
        if (!missing.empty()) {
            s.push_values(std::move(missing), this);
            return false;
        }
        CallContext context;
        context.core = &s.core, context.program = s.program.get(), context.place = &p;
        context.stop = s.stop, context.frame = frame, context.phase = Phase::advance;
        with_reads(std::move(gathered), context,
                   [&](std::span<const SubstepReads> reads) { out_ = p.type->simulation->rehearse(before_, reads); });
        return true;
    }

  private:
    /// Needs the core's mutex. The keys of all that a step reads at a time.
    void know_sources(const Place& p, double time, Needs& needs) {
        for (const Slot& slot : p.slots)
            if (slot.read_by_compute() && slot.info->affects != Affects::initial_state)
                for (const Source& source : slot.sources) session_.keys.of(source, time, needs);
    }

    int simulation_;
    const Value& before_;
    Value& out_;
};

} // namespace

std::unique_ptr<Goal> rehearsal(Session& session, Goal* parent, int simulation, const Value& before, Value& out) {
    return std::make_unique<RehearsalGoal>(session, parent, simulation, before, out);
}

} // namespace sinew::engine
