// A graph that is simulated again whenever it, a file that it reads, or an attribute in the page changes. What has not
// changed is not computed again: one evaluator serves all the time. Knows no network; server.h asks it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"
#include "tools/live/changes.h"
#include "tools/live/watched_files.h"
#include "tools/viewer/flesh.h"

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace sinew::live {

struct Options {
    std::string file;
    engine::FileAccess files; ///< what may be read and written, the graph file itself too
    /// Reads the file anew, with the command line's settings. Throws Failure. Called by several threads at once: by the
    /// one that simulates, and by whoever changes an attribute.
    std::function<std::shared_ptr<const engine::Graph>(std::vector<engine::Diagnostic>& notes)> open;
    std::vector<int> frames; ///< rising; empty: all of the graph's timing
    bool with_lattices = true;
    engine::StorePolicy store;
    int threads = 0;
};

/// Thread-safe: every function may be called by any thread at any time. Changes, discards and saves wait for each other
/// (each reads the graph's file, which takes as long as that takes); everything else waits for nothing but a few
/// assignments. Graphs are immutable and reading one shares nothing with other threads, so a run goes on meanwhile.
class Session {
  public:
    explicit Session(Options options);
    ~Session();
    Session(const Session&) = delete;

    /// JSON of what is going on (docs/live.md), and its number, which grows with each change. Waits until there is a
    /// newer one than `seen`, for a quarter of a second at most.
    std::pair<std::uint64_t, std::string> wait_status(std::uint64_t seen) const;
    /// The newest page that could be made; null: none yet.
    std::shared_ptr<const std::string> page() const;
    /// JSON: where the bodies are in the first frame of the run that is new; empty: there is none yet.
    std::shared_ptr<const std::string> preview() const;
    /// JSON: each node's type and inputs as they are now, with what the reference says of them.
    std::string nodes() const;
    /// Throws Failure, with nothing changed, for what a graph file could not hold there, and where an earlier change no
    /// longer fits (DG175).
    void change(const Change& change);
    void discard_changes();
    /// Writes them into the graph file, each in its place; all else of the file stays byte for byte. Without changes
    /// nothing is written. Throws Failure, with nothing written: a file that cannot be read or written (IO405), or that
    /// has changed so that they do not fit (DG175).
    void save_changes();

  private:
    struct Watcher;
    void work(const std::stop_token& stop);
    /// \param notes what the reader said; kept whatever comes after
    void run(const std::stop_token& stop, std::vector<engine::Diagnostic>& notes);
    void look_at_files(const std::stop_token& stop);
    void start_anew();
    /// Any file may be what is mended next, also one that no graph that could be read includes.
    void watch_what_is_named();
    std::shared_ptr<const engine::Graph> changed(std::shared_ptr<const engine::Graph> graph) const;
    template <class Action>
    void tell(const Action& action);

    const Options options_;
    std::mutex changing_;      ///< held by change, discard and save from end to end; taken before mutex_
    mutable std::mutex mutex_; ///< guards all that follows, up to watcher_, which has its own and is never held with it
    mutable std::condition_variable_any news_;
    bool is_due_ = true;       ///< a run must begin
    std::stop_source current_; ///< of the run that goes on
    struct Status;
    std::unique_ptr<Status> status_;
    std::shared_ptr<const std::string> page_, preview_;
    std::shared_ptr<const engine::Graph> graph_; ///< the newest that could be read
    std::vector<Change> changes_;
    WatchedFiles files_;
    std::unique_ptr<Watcher> watcher_;
    std::unique_ptr<engine::Evaluator> evaluator_;
    std::shared_ptr<viewer::FleshMemory> memory_ = std::make_shared<viewer::FleshMemory>(); ///< of all runs
    std::jthread worker_, looker_; ///< last: they end before what they use
};

} // namespace sinew::live
