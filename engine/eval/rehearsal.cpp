// Has a simulation look at what it would read at a frame, without stepping there: how a graph is checked ahead.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/session.h"

namespace sinew::engine {

namespace {

class RehearsalGoal : public Goal {
  public:
    RehearsalGoal(Session& s, Goal* parent, int simulation, int frame, const Value& at_start)
        : Goal(s, parent)
        , simulation_(simulation)
        , frame_(frame)
        , at_start_(at_start) {}

    bool step() override {
        Session& s = session_;
        std::unique_lock lock(s.core.mutex);
        Needs needs;
        const Place& p = s.program->place(simulation_);
        const auto know = [&](double time) {
            for (const Slot& slot : p.slots) {
                if (!slot.read_by_compute()) continue;
                for (const Source& source : slot.sources) s.keys.of(source, time, needs);
            }
        };
        for (const SubstepTimes& t : s.keys.read_times(simulation_, frame_)) {
            for (const double within : t.within) know(within);
            know(t.end);
        }
        if (!needs.empty()) {
            lock.unlock();
            s.push_chains(needs, this);
            return false;
        }
        std::vector<Site> missing;
        GatheredStep step = gather_step(simulation_, frame_, Phase::advance, missing);
        lock.unlock();
        if (!missing.empty()) {
            s.push_values(std::move(missing), this);
            return false;
        }
        CallContext context;
        context.core = &s.core, context.program = s.program.get(), context.place = &p;
        context.stop = s.stop, context.frame = frame_, context.phase = Phase::advance;
        with_reads(std::move(step), context,
                   [&](std::span<const SubstepReads> reads) { p.type->simulation->rehearse(at_start_, reads); });
        return true;
    }

  private:
    int simulation_, frame_;
    const Value& at_start_;
};

} // namespace

void Session::rehearse(int simulation) {
    const Place& p = program->place(simulation);
    if (!p.type->simulation->rehearse || !(frame > p.start_frame)) return;
    const Value at_start = state_at(simulation, p.start_frame);
    run(std::make_unique<RehearsalGoal>(*this, stack_.front().get(), simulation, static_cast<int>(frame), at_start));
}

} // namespace sinew::engine
