// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/session.h"

#include <stdexcept>

namespace sinew::engine {

EntryPtr Goal::find(const Digest& key, int node) {
    const auto it = pins_.find(key);
    EntryPtr entry = it != pins_.end() ? it->second : session_.core.values.find(key);
    return entry && session_.suffices(node, *entry) ? entry : nullptr;
}

Session::Session(Core& c, std::shared_ptr<Program> p, std::stop_token s, double f, std::shared_ptr<Failures> failures)
    : core(c)
    , program(std::move(p))
    , stop(std::move(s))
    , frame(f)
    , keys(*program,
           [this](const Digest& plug, const Digest& node, int output, DigestPart part) -> std::optional<Digest> {
               if (!stack_.empty()) { // the goal on top is the one that asks
                   const auto it = stack_.back()->pins_.find(node);
                   if (it != stack_.back()->pins_.end()) {
                       const Value& v = it->second->outputs[static_cast<std::size_t>(output)];
                       return part == DigestPart::aside ? v.aside_digest() : v.digest();
                   }
               }
               return core.contents.find(part == DigestPart::aside ? aside_key(plug) : plug);
           })
    , failures_(std::move(failures)) {}

FlightPtr Session::failed(const Digest& key) const {
    if (!failures_) return nullptr;
    const auto it = failures_->flights.find(key);
    // Diagnostics name places in a graph, so they serve the same graph only.
    const bool usable = it != failures_->flights.end() && it->second->graph == program->graph().get();
    return usable ? it->second : nullptr;
}

void Session::remember(const Digest& key, const FlightPtr& flight) {
    const std::lock_guard lock(core.mutex);
    if (failures_ && flight->error) failures_->flights.insert_or_assign(key, flight);
}

void Session::run(std::unique_ptr<Goal> goal) {
    push(std::move(goal));
    while (stack_.size() > 1) {
        check_stop();
        const std::size_t top = stack_.size() - 1;
        if (stack_[top]->step()) stack_.pop_back(); // a goal that is done has pushed nothing
    }
}

namespace {
// Stands at the bottom of the stack and receives the results.
class Root : public Goal {
  public:
    explicit Root(Session& s)
        : Goal(s, nullptr) {}
    bool step() override { return true; }
};
} // namespace

EntryPtr Session::entry(int node, int output) {
    target_ = node, target_output_ = output;
    push(std::make_unique<Root>(*this));
    Goal& root = *stack_.front();
    run(std::make_unique<ValuesGoal>(*this, &root, std::vector<Site>{program->site(node, frame)}));
    return root.pins_.begin()->second;
}

Value Session::state(int simulation) {
    target_ = simulation;
    push(std::make_unique<Root>(*this));
    const int at = static_cast<int>(program->site(simulation, frame).frame);
    // The goal leaves the stack when it is done, so the state is taken through a root that outlives it.
    class StateGoal : public FrameGoal {
      public:
        StateGoal(Session& s, Goal* parent, int simulation, int frame, Value& out)
            : FrameGoal(s, parent, simulation, frame, true)
            , out_(out) {}
        bool step() override {
            if (!FrameGoal::step()) return false;
            out_ = state();
            return true;
        }

      private:
        Value& out_;
    };
    Value out;
    run(std::make_unique<StateGoal>(*this, stack_.front().get(), simulation, at, out));
    return out;
}

Value Session::rehearse(int simulation, const Value& before) {
    target_ = simulation;
    push(std::make_unique<Root>(*this));
    Value out;
    run(rehearsal(*this, stack_.front().get(), simulation, before, out));
    return out;
}

Digest Session::frame_key(int simulation) {
    target_ = simulation;
    push(std::make_unique<Root>(*this));
    const int at = static_cast<int>(program->site(simulation, frame).frame);
    run(std::make_unique<ChainGoal>(*this, stack_.front().get(), simulation, at));
    const std::lock_guard lock(core.mutex);
    return keys.frame_key(simulation, at);
}

std::optional<KeptFrame> Session::read_frame(int simulation, const Digest& key, bool with_state) {
    const Place& p = program->place(simulation);
    FrameStore::Found found = core.frames->read(program->graph()->registry(), *p.type, key, with_state);
    if (!found.fault.empty()) tell_unusable(simulation, key, found.fault);
    // Whoever asks next whether this frame is there needs to know what its inputs hold.
    if (found.frame) keep_learned(program->place(simulation));
    return std::move(found.frame);
}

void Session::keep_learned(const Place& p) {
    if (core.disk_has_failed) return;
    std::vector<PlugContent> rows;
    {
        const std::lock_guard lock(core.mutex);
        rows.swap(core.learned);
    }
    try {
        core.frames->add_rows(rows);
    } catch (const Failure& failure) {
        tell_not_kept(p, failure);
    }
}

void Session::tell_not_kept(const Place& p, const Failure& failure) {
    if (core.disk_has_failed.exchange(true)) return;
    const FileFault why = why_not_kept(core.disk->folder(), failure);
    Diagnostic d = program->about(p, {}, why.code, "no frames are kept on disk: " + why.message, why.hint);
    d.severity = Severity::warning;
    core.observe([&](Observer& o) { o.warning(d); });
}

void Session::tell_unusable(int simulation, const Digest& key, const std::string& fault) {
    {
        const std::lock_guard lock(core.mutex);
        if (!core.told_unusable.emplace(program->place(simulation).name, fault).second) return;
    }
    Diagnostic d = program->about(program->place(simulation), {}, "IO406",
                                  "the frame kept in '" + core.frames->file_of(key).string() +
                                      "' cannot be used and is made anew: " + fault,
                                  "nothing to do: it is replaced, and so are others of which the same holds");
    d.severity = Severity::warning;
    core.observe([&](Observer& o) { o.warning(d); });
}

void Session::keep_frame(int simulation, int at, const Digest& key, const EntryPtr& entry, const StoredState& state) {
    if (core.disk_has_failed) return;
    const Place& p = program->place(simulation);
    KeptFrame kept;
    kept.frame = at;
    kept.entry = entry;
    kept.warnings_of_state = state.warnings;
    Digest start;
    {
        const std::lock_guard lock(core.mutex);
        kept.made_from = {p.name, program->recipe(simulation, at)};
        start = keys.frame_key(simulation, p.start_frame);
    }
    keep_learned(p);
    if (core.disk_has_failed) return;
    try {
        kept.state = p.type->simulation->save(state.state);
        core.frames->write(program->graph()->registry(), *p.type, key, start, kept);
    } catch (const Failure& failure) {
        tell_not_kept(p, failure);
    }
}

void Session::push_chains(const Needs& needs, Goal* parent) {
    for (const auto& [simulation, frame] : needs.chains)
        push(std::make_unique<ChainGoal>(*this, parent, simulation, frame));
}

void Session::push_values(std::vector<Site> sites, Goal* parent) {
    push(std::make_unique<ValuesGoal>(*this, parent, std::move(sites)));
}

void Session::note_reuse(const Digest& key, const Site& site, const EntryPtr& entry) {
    if (!reused_.insert(key).second) return;
    const Place& p = program->place(site.node);
    reuse_events_.emplace_back(p.name, p.dynamic ? site.frame : frame);
    if (entry->warnings.empty() || !program->delivered.insert(key).second) return;
    for (Diagnostic d : entry->warnings) { // with today's name and place: names are not part of keys
        if (p.dynamic && !d.frame) d.frame = site.frame;
        locate(d, *program->graph(), p.name);
        repeated_warnings_.push_back(std::move(d));
    }
}

void Session::tell() {
    for (const auto& event : reuse_events_) core.observe([&](Observer& o) { o.reused(event.first, event.second); });
    for (const Diagnostic& d : repeated_warnings_) core.observe([&](Observer& o) { o.warning(d); });
    reuse_events_.clear();
    repeated_warnings_.clear();
}

EntryPtr make_entry(const Place& p, const Writes& writes, std::vector<Diagnostic> warnings) {
    const auto bug = [&](std::string_view output, const char* what) {
        const std::string wrong = std::string(p.type->name) + " " + what + " output \"" + std::string(output) + "\"";
        if (p.type->revision.empty()) throw std::logic_error(wrong);
        Diagnostic d; // of a type that a host brings
        d.code = "DG127", d.node = p.name, d.message = wrong, d.hint = "this node type is the host's: repair it there";
        throw Failure(std::move(d));
    };
    auto out = std::make_shared<Entry>();
    out->warnings = std::move(warnings);
    for (const AttributeInfo& info : p.type->outputs) {
        const Value* found = nullptr;
        for (const auto& [name, value] : writes.values())
            if (name == info.name) found = &value;
        if (!found || !*found) bug(info.name, "did not write");
        if (found->type() != info.type) bug(info.name, "wrote another type to");
        out->outputs.push_back(*found);
    }
    for (const auto& [name, value] : writes.values())
        if (!p.type->find_output(name)) bug(name, "wrote the undeclared");
    return out;
}

bool ChainGoal::step() {
    Needs needs;
    {
        const std::lock_guard lock(session_.core.mutex);
        if (session_.keys.extend(simulation_, frame_, needs)) return true;
        if (session_.core.frames && !session_.core.recalled) { // what an earlier process knew of the inputs
            session_.core.recall();
            return false;
        }
    }
    pins_.clear(); // their content digests are in the chain or in the table now
    if (!needs.chains.empty())
        session_.push_chains(needs, this);
    else if (!needs.values.empty())
        session_.push_values(std::move(needs.values), this);
    return false;
}

} // namespace sinew::engine
