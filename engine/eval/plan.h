// The nodes that one goal must evaluate, as a graph of items; runs them side by side on the arena. Work that
// another pull has in flight is waited for, outside the arena, so that waiting never blocks a thread that
// others need.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/eval/session.h"

#include <tbb/task_group.h>

namespace sinew::engine {

class Plan {
  public:
    explicit Plan(Session& session)
        : session_(session) {}
    /// Needs the core's mutex; all keys must be known. Adds a site and what it needs. `find` gives entries
    /// that exist, by key and node.
    void add(const Site& target, const std::function<EntryPtr(const Digest&, int)>& find);
    /// Simulation frames that must be there first; then the plan cannot run yet.
    const std::vector<Site>& frames() const { return frames_; }
    /// Needs the core's mutex. From here on others wait for our items.
    void claim();
    /// Without the mutex. False: another pull gave up something that we waited for; plan again. Throws what
    /// the nodes threw: a bug before a cancel before failures, of which all are reported together.
    bool run();
    /// What has been evaluated or found, by key.
    template <class F>
    void each_result(F&& f) const {
        for (const Item& i : items_)
            if (i.result) f(i.key, i.result);
    }

  private:
    struct Item {
        Site site;
        Digest key;
        EntryPtr result;
        std::exception_ptr error;
        bool foreign = false, finished = false, original = false; ///< original: the error arose here
        FlightPtr flight;
        std::vector<int> sources; ///< in the order in which slots are gathered
        std::vector<int> dependents;
        int waiting = 0;
        std::vector<int> twins; ///< of equal content; they take this one's result
    };
    int item_of(const Site& site, const std::function<EntryPtr(const Digest&, int)>& find);
    void work(tbb::task_group& group, int i);
    void spawn(tbb::task_group& group, int i);
    SlotValues inputs(const Item& item);
    EntryPtr compute(const Item& item, SlotValues values);
    EntryPtr found_by_content(int i, const Digest& by_content, bool& waits);
    void finish_twins(int i, const Digest& by_content, std::vector<int>& ready);
    void tell_reuse(const Item& item, const EntryPtr& entry);
    EntryPtr read_kept(const Item& item);
    void write_kept(const Item& item, const Entry& entry);
    std::vector<int> settle(int i, EntryPtr result, std::exception_ptr error, bool original);
    void land(const Item& item);
    bool wait_for_others(std::vector<int>& ready);
    void throw_errors();
    Item& at(int i) { return items_[static_cast<std::size_t>(i)]; }

    Session& session_;
    std::mutex mutex_; ///< guards the items while they run
    std::vector<Item> items_;
    std::unordered_map<Digest, int, DigestHash> index_;
    std::unordered_map<Digest, int, DigestHash> by_content_; ///< who computes it; guarded by mutex_
    std::vector<int> unexpanded_;
    std::vector<Site> frames_;
    bool again_ = false;
};

} // namespace sinew::engine
