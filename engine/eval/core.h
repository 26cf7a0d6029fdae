// What all pulls of one evaluator share: stores, work in flight, threads, the observer.
// One mutex guards everything but the observer; nobody holds it while a node computes.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/eval/disk_store.h"
#include "engine/eval/frame_store.h"
#include "engine/eval/program.h"
#include "engine/eval/store.h"
#include "engine/evaluator.h"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <unordered_map>
#include <utility>

namespace sinew::engine {

/// Work that one pull has claimed and that others may wait for. Guarded by Core::mutex.
struct Flight {
    bool done = false;
    EntryPtr entry;           ///< set if the work succeeded
    std::exception_ptr error; ///< set if it failed; neither: given up, whoever needs it claims it again
    const Graph* graph = nullptr;
};
using FlightPtr = std::shared_ptr<Flight>;

/// Flights that ended in an error, by key. Guarded by Core::mutex.
class Failures {
  public:
    std::unordered_map<Digest, FlightPtr, DigestHash> flights;
};

struct Core {
    Core(const StorePolicy& policy, int threads, Observer* watcher);

    std::mutex mutex;
    std::condition_variable_any landed; ///< some flight is done
    ValueStore values;
    StateStore states;
    DigestTable contents;
    DigestTable made; ///< keys of what was computed here
    ScratchPool scratch;
    std::size_t most_stored_bytes = 0, made_again = 0;           ///< see Evaluator
    const std::optional<DiskStore> disk;                         ///< has no need of the mutex
    const std::unique_ptr<FrameStore> frames;                    ///< of simulations, on disk; null: not kept
    std::vector<PlugContent> learned;                            ///< rows of `contents` that are not on disk yet
    bool recalled = false;                                       ///< those that are have been read
    std::set<std::pair<std::string, std::string>> told_unusable; ///< nodes and faults of kept frames
    std::atomic<bool> disk_has_failed = false;                   ///< cannot be written to: told once, then only read
    std::unordered_map<Digest, FlightPtr, DigestHash> flights;
    std::vector<std::shared_ptr<Program>> programs; ///< most recently used last
    FileDigests files;
    /// Where more threads are asked for than there are cores; TBB gives no more of its own accord, and warns.
    const std::unique_ptr<tbb::global_control> more_threads;
    tbb::task_arena arena;

    /// The program of a snapshot with the cone of `node` ready: files digested, connections sound. Gives the
    /// node's number too. Throws Failure.
    std::pair<std::shared_ptr<Program>, int> prepare(const std::shared_ptr<const Graph>& graph,
                                                     const std::string& node);
    /// Needs the mutex. Notes what a plug holds.
    void learn(const Digest& plug, const Digest& content);
    /// Needs the mutex. Takes over what earlier processes learned, once.
    void recall();
    /// Needs the mutex. Stores the entry under the key, and under the key by content if there is one, and a row for
    /// each output.
    void keep(const Digest& key, const std::optional<Digest>& by_content, const NodeType& type, const EntryPtr& entry);
    /// Needs the mutex. The state of a simulation of `program` at `frame`, under its key; `key_before` is that of the
    /// frame before. The states that the program's simulations were last brought to stay, whatever the budget.
    void keep_state(Program& program, int simulation, int frame, const Digest& key,
                    const std::optional<Digest>& key_before, StoredState state);
    /// Needs the mutex.
    std::size_t stored_bytes() const { return values.bytes() + states.bytes(); }
    /// Needs the mutex.
    FlightPtr claim(const Digest& key, const Graph* graph);
    /// Takes the mutex. Ends a flight; an entry is kept.
    void land(const Digest& key, const FlightPtr& flight, const NodeType& type, EntryPtr entry,
              std::exception_ptr error, const std::optional<Digest>& by_content = {});

    /// Calls the observer, one call at a time.
    template <class F>
    void observe(F&& call) {
        if (!observer_) return;
        const std::lock_guard lock(observer_mutex_);
        call(*observer_);
    }

    /// Tells the observer that a node is at work, while it lives.
    class AtWork {
      public:
        AtWork(Core& core, const std::string& node, double frame)
            : core_(core)
            , node_(node)
            , frame_(frame) {
            core_.observe([&](Observer& o) { o.begins(node_, frame_); });
        }
        ~AtWork() {
            core_.observe([&](Observer& o) { o.ends(node_, frame_); });
        }
        AtWork(const AtWork&) = delete;

      private:
        Core& core_;
        const std::string& node_;
        double frame_;
    };

  private:
    std::shared_ptr<Program> program_of(const std::shared_ptr<const Graph>& graph);
    Observer* observer_;
    std::mutex observer_mutex_;
};

} // namespace sinew::engine
