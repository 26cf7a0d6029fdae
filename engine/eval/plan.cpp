// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/plan.h"

#include "engine/eval/arena.h"
#include "engine/eval/kept_entry.h"

#include <algorithm>
#include <chrono>
#include <tuple>

namespace sinew::engine {

namespace {
/// Another pull gave up work that we were waiting for.
struct GivenUp {};

bool is_failure(const std::exception_ptr& e) {
    try {
        std::rethrow_exception(e);
    } catch (const Failure&) {
        return true;
    } catch (...) {
        return false;
    }
}

bool is_stop(const std::exception_ptr& e) {
    try {
        std::rethrow_exception(e);
    } catch (const Cancelled&) {
        return true;
    } catch (const GivenUp&) {
        return true;
    } catch (...) {
        return false;
    }
}
} // namespace

int Plan::item_of(const Site& site, const std::function<EntryPtr(const Digest&, int)>& find) {
    Needs none;
    const Digest key = *session_.keys.of(site, none);
    const auto [known, is_new] = index_.try_emplace(key, static_cast<int>(items_.size()));
    if (!is_new) return known->second;
    Item item;
    item.site = site;
    item.key = key;
    item.result = find(key, site.node);
    const auto flight = session_.core.flights.find(key);
    if (item.result) {
        item.finished = true;
        session_.note_reuse(key, site, item.result);
    } else if (session_.program->place(site.node).is_simulation()) {
        frames_.push_back(site);
    } else if (flight != session_.core.flights.end()) {
        item.foreign = true;
        item.flight = flight->second;
    } else if (FlightPtr failed = session_.failed(key)) {
        item.foreign = true;
        item.flight = std::move(failed);
    } else {
        unexpanded_.push_back(known->second);
    }
    items_.push_back(std::move(item));
    return known->second;
}

void Plan::add(const Site& target, const std::function<EntryPtr(const Digest&, int)>& find) {
    item_of(target, find);
    while (!unexpanded_.empty()) {
        const int i = unexpanded_.back();
        unexpanded_.pop_back();
        const Site site = at(i).site;
        for (const Slot& s : session_.program->place(site.node).slots) {
            if (!s.read_by_compute()) continue;
            for (const Source& source : s.sources) {
                const int j = item_of(session_.program->site(source, site.frame), find);
                at(i).sources.push_back(j);
                if (at(j).finished) continue;
                at(j).dependents.push_back(i);
                ++at(i).waiting;
            }
        }
    }
}

void Plan::claim() {
    for (Item& i : items_)
        if (!i.finished && !i.foreign) i.flight = session_.core.claim(i.key, session_.program->graph().get());
}

// What an earlier process, or this one, kept on disk; nothing if there is none that can be used.
EntryPtr Plan::read_kept(const Item& item) {
    const Place& p = session_.program->place(item.site.node);
    const DiskStore& disk = *session_.core.disk;
    DiskStore::Found found = disk.read(item.key);
    std::vector<Diagnostic> warnings;
    EntryPtr entry;
    if (found.payload) {
        try {
            entry =
                std::make_shared<Entry>(decode_entry(session_.program->graph()->registry(), *p.type, *found.payload));
            warnings = entry->warnings;
        } catch (const BadBytes& bad) {
            found.fault = bad.what();
        }
    }
    if (!found.fault.empty()) {
        Diagnostic d = session_.program->about(p, p.type->kept_when, "IO406",
                                               "what was kept in '" + disk.file_of(item.key).string() +
                                                   "' cannot be used and is made anew: " + found.fault);
        d.severity = Severity::warning;
        warnings.push_back(std::move(d));
    }
    for (Diagnostic& d : warnings) {
        locate(d, *session_.program->graph(), p.name);
        session_.core.observe([&](Observer& o) { o.warning(d); });
    }
    if (entry) tell_reuse(item, nullptr);
    return entry;
}

// That a result was found, and what was warned about when it was made; without an entry the latter was told already.
void Plan::tell_reuse(const Item& item, const EntryPtr& entry) {
    const Place& p = session_.program->place(item.site.node);
    session_.core.observe([&](Observer& o) {
        o.reused(p.name, p.dynamic ? item.site.frame : session_.frame);
        for (Diagnostic d : entry ? entry->warnings : std::vector<Diagnostic>()) {
            if (p.dynamic && !d.frame) d.frame = item.site.frame;
            locate(d, *session_.program->graph(), p.name);
            o.warning(d);
        }
    });
}

void Plan::write_kept(const Item& item, const Entry& entry) {
    if (session_.core.disk_has_failed) return;
    const Place& p = session_.program->place(item.site.node);
    KeptInputs made_from{p.name, {}};
    {
        const std::lock_guard lock(session_.core.mutex);
        made_from.contents = session_.program->recipe(item.site.node, item.site.frame);
    }
    try {
        session_.core.disk->write(item.key,
                                  encode_entry(session_.program->graph()->registry(), *p.type, entry, made_from));
    } catch (const Failure& failure) {
        if (session_.core.disk_has_failed.exchange(true)) return;
        const FileFault why = why_not_kept(session_.core.disk->folder(), failure);
        Diagnostic d = session_.program->about(p, p.type->kept_when, why.code,
                                               "nothing is kept on disk: " + why.message, why.hint);
        d.severity = Severity::warning;
        session_.core.observe([&](Observer& o) { o.warning(d); });
    }
}

SlotValues Plan::inputs(const Item& item) {
    std::size_t next = 0;
    std::vector<Site> missing;
    return gather(
        *session_.program, session_.program->place(item.site.node), item.site.frame, Phase::compute,
        [&](const Site&) { return at(item.sources[next++]).result; }, missing);
}

// What was made of the same content before, at another frame or by other nodes. `waits`: another item of this plan is
// making it and will hand it over.
EntryPtr Plan::found_by_content(int i, const Digest& by_content, bool& waits) {
    {
        const std::lock_guard lock(session_.core.mutex);
        if (EntryPtr entry = session_.core.values.find(by_content)) return entry;
    }
    const std::lock_guard lock(mutex_);
    const auto [first, is_new] = by_content_.try_emplace(by_content, i);
    if (is_new || first->second == i) return nullptr;
    Item& maker = at(first->second);
    if (maker.finished) return maker.result;
    maker.twins.push_back(i);
    waits = true;
    return nullptr;
}

// After item i: those of equal content take its result. If it failed each fails by itself, so that the diagnostics name
// the right frames.
void Plan::finish_twins(int i, const Digest& by_content, std::vector<int>& ready) {
    std::vector<int> twins;
    EntryPtr result;
    {
        const std::lock_guard lock(mutex_);
        std::swap(twins, at(i).twins);
        result = at(i).result;
    }
    for (const int t : twins) {
        if (!result) {
            ready.push_back(t);
            continue;
        }
        const Item& twin = at(t);
        session_.core.land(twin.key, twin.flight, *session_.program->place(twin.site.node).type, result, nullptr,
                           by_content);
        tell_reuse(twin, result);
        for (int r : settle(t, result, nullptr, true)) ready.push_back(r);
    }
}

EntryPtr Plan::compute(const Item& item, SlotValues values) {
    const Place& p = session_.program->place(item.site.node);
    const bool kept = session_.core.disk && p.is_kept();
    if (kept)
        if (EntryPtr entry = read_kept(item)) return entry;
    const double frame = p.dynamic ? item.site.frame : session_.frame;
    CallContext context;
    context.core = &session_.core, context.program = session_.program.get(), context.place = &p;
    context.stop = session_.stop, context.frame = frame;
    NodeReads source(context, std::move(values), item.site.frame);
    Writes writes;
    const Core::AtWork at_work(session_.core, p.name, frame);
    const auto begin = std::chrono::steady_clock::now();
    tbb::this_task_arena::isolate([&] {
        const Reads reads(source);
        p.type->compute(reads, writes);
    });
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    const EntryPtr entry = make_entry(p, writes, std::move(context.warnings));
    session_.core.observe([&](Observer& o) { o.computed(p.name, frame, seconds.count()); });
    if (kept) write_kept(item, *entry);
    return entry;
}

void Plan::land(const Item& i) {
    const NodeType& type = *session_.program->place(i.site.node).type;
    session_.core.land(i.key, i.flight, type, i.result, i.error && !is_stop(i.error) ? i.error : nullptr);
}

// Marks an item as finished and hands its result, or its error, to those that wait for it.
std::vector<int> Plan::settle(int i, EntryPtr result, std::exception_ptr error, bool original) {
    std::vector<int> ready, spoiled, stack{i};
    {
        const std::lock_guard lock(mutex_);
        at(i).result = std::move(result), at(i).error = std::move(error);
        at(i).finished = true, at(i).original = original;
        while (!stack.empty()) {
            const Item& done = at(stack.back());
            stack.pop_back();
            for (int d : done.dependents) {
                if (at(d).finished) continue;
                if (!done.error) {
                    if (--at(d).waiting == 0) ready.push_back(d);
                    continue;
                }
                at(d).error = done.error;
                at(d).finished = true;
                spoiled.push_back(d);
                stack.push_back(d);
            }
        }
    }
    for (int d : spoiled) land(at(d));
    return ready;
}

void Plan::work(tbb::task_group& group, int i) {
    while (i >= 0) {
        EntryPtr result;
        std::exception_ptr error;
        Item* item;
        Digest by_content;
        {
            const std::lock_guard lock(mutex_); // what other threads wrote into the items is visible from here on
            item = &at(i);
        }
        const Place& p = session_.program->place(item->site.node);
        try {
            session_.check_stop();
            SlotValues values = inputs(*item);
            by_content = content_key(*session_.program, p, item->site.frame, values);
            bool waits = false;
            result = found_by_content(i, by_content, waits);
            if (waits) break;
            if (result)
                tell_reuse(*item, result);
            else
                result = compute(*item, std::move(values));
        } catch (...) {
            error = std::current_exception();
        }
        session_.core.land(item->key, item->flight, *p.type, result, error && !is_stop(error) ? error : nullptr,
                           by_content);
        session_.remember(item->key, item->flight);
        std::vector<int> ready = settle(i, std::move(result), std::move(error), true);
        finish_twins(i, by_content, ready);
        // One successor goes on here, so that a chain of nodes is a loop; the others become tasks.
        i = ready.empty() ? -1 : ready.back();
        if (!ready.empty()) ready.pop_back();
        for (int r : ready) spawn(group, r);
    }
    publish_to_threads(this);
}

void Plan::spawn(tbb::task_group& group, int i) {
    publish_to_threads(this);
    group.run([plan = this, of = &group, i] {
        Plan& self = *handed_over(plan);
        receive_from_threads(&self);
        self.work(*handed_over(of), handed_over(i));
    });
}

bool Plan::wait_for_others(std::vector<int>& ready) {
    std::vector<int> waited;
    for (std::size_t i = 0; i < items_.size(); ++i)
        if (items_[i].foreign && !items_[i].finished) waited.push_back(static_cast<int>(i));
    if (waited.empty()) return false;
    struct Landed {
        int item;
        EntryPtr entry;
        std::exception_ptr error;
    };
    std::vector<Landed> landed;
    {
        std::unique_lock lock(session_.core.mutex);
        const auto any = [&] {
            return std::any_of(waited.begin(), waited.end(), [&](int i) { return at(i).flight->done; });
        };
        if (!session_.core.landed.wait(lock, session_.stop, any))
            for (int i : waited) landed.push_back({i, nullptr, std::make_exception_ptr(Cancelled())});
        else
            for (int i : waited) {
                const Flight& f = *at(i).flight;
                if (!f.done) continue;
                const bool same = f.error && f.graph == session_.program->graph().get();
                const auto error = f.entry ? nullptr : same ? f.error : std::make_exception_ptr(GivenUp());
                landed.push_back({i, f.entry, error});
                again_ = again_ || (!f.entry && !same);
            }
    }
    for (Landed& l : landed)
        for (int r : settle(l.item, std::move(l.entry), std::move(l.error), true)) ready.push_back(r);
    return true;
}

bool Plan::run() {
    std::vector<int> ready;
    {
        const std::lock_guard lock(mutex_); // pairs with the lock in work(): the workers see all that was planned
        for (std::size_t i = 0; i < items_.size(); ++i)
            if (!items_[i].finished && !items_[i].foreign && items_[i].waiting == 0)
                ready.push_back(static_cast<int>(i));
    }
    do {
        if (!ready.empty())
            run_on(session_.core.arena, [&] {
                tbb::task_group group;
                for (int r : ready) spawn(group, r);
                group.wait();
                receive_from_threads(this);
            });
        ready.clear();
    } while (wait_for_others(ready));
    {
        const std::lock_guard lock(session_.core.mutex);
        for (const Item& i : items_) {
            if (!i.flight || i.foreign || !i.result) continue;
            session_.note_made(i.key);
            if (!i.result->warnings.empty()) session_.program->delivered.insert(i.key);
        }
    }
    throw_errors();
    return !again_;
}

void Plan::throw_errors() {
    std::vector<const Item*> failed;
    for (const Item& i : items_) {
        if (!i.error || !i.original) continue;
        if (is_failure(i.error))
            failed.push_back(&i);
        else if (!is_stop(i.error))
            std::rethrow_exception(i.error); // a bug, as it is
    }
    session_.check_stop();
    for (const Item& i : items_)
        if (i.error && i.original && is_stop(i.error) && !i.foreign) throw Cancelled();
    if (failed.empty()) return;
    // In the order of the graph, then of time; the same complaint at many frames is made once, at the first.
    std::sort(failed.begin(), failed.end(), [](const Item* a, const Item* b) {
        return std::tie(a->site.node, a->site.frame) < std::tie(b->site.node, b->site.frame);
    });
    std::vector<Diagnostic> all;
    bool solve = true;
    for (const Item* i : failed) {
        try {
            std::rethrow_exception(i->error);
        } catch (const Failure& f) {
            solve = solve && dynamic_cast<const SolveFailure*>(&f);
            for (const Diagnostic& d : f.diagnostics()) {
                const bool repeated = std::any_of(all.begin(), all.end(), [&](const Diagnostic& o) {
                    return std::tie(o.code, o.node, o.attribute, o.message) ==
                           std::tie(d.code, d.node, d.attribute, d.message);
                });
                if (!repeated) all.push_back(d);
            }
        }
    }
    if (solve) throw SolveFailure(std::move(all));
    throw Failure(std::move(all));
}

bool ValuesGoal::step() {
    Session& s = session_;
    Plan plan(s);
    {
        std::unique_lock lock(s.core.mutex);
        Needs needs;
        for (const Site& t : targets_) s.keys.of(t, needs);
        if (!needs.empty()) {
            s.push_chains(needs, this);
            return false;
        }
        for (const Site& t : targets_) plan.add(t, [&](const Digest& key, int node) { return find(key, node); });
        if (!plan.frames().empty()) {
            for (const Site& f : plan.frames())
                s.push(std::make_unique<FrameGoal>(s, this, f.node, static_cast<int>(f.frame)));
            return false;
        }
        plan.claim();
    }
    s.tell();
    const bool complete = plan.run();
    plan.each_result([&](const Digest& key, const EntryPtr& entry) { pins_[key] = entry; });
    if (!complete) return false;
    const std::lock_guard lock(s.core.mutex);
    Needs none;
    for (const Site& t : targets_) {
        const Digest key = *s.keys.of(t, none);
        parent_->pins_[key] = pins_.at(key);
    }
    return true;
}

} // namespace sinew::engine
