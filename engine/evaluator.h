// Pulls plugs. Keys are computed without computing values; what has been computed is found again by key; a
// simulation's frames form a hash chain, so an edit at frame 80 leaves frames 1…79 alone.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"

#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

namespace sinew::engine {

/// Where results are kept. The byte budgets of memory are hard limits, not hints, but for one thing: the newest state
/// of each simulation stays whatever its size, or no frame could follow it.
struct StorePolicy {
    std::size_t value_bytes = within(default_bytes()).value_bytes; ///< outputs of nodes
    std::size_t state_bytes = within(default_bytes()).state_bytes; ///< states of simulations
    std::size_t scratch_entries = 1024; ///< kept scratch objects: some per node (tracks, rest data), one solver each
    int state_every = 1;                ///< keep the state of each k-th frame, and the newest
    /// Outputs of nodes that ask for it (NodeType::kept_when) are kept in files here, and found again by later
    /// processes. Made when first written to. Empty: nothing is kept on disk. What cannot be read or written is warned
    /// about (IO406, IO407) and computed.
    std::string disk_folder = {};
    /// Frames of simulations, outputs and states, are kept there too, each as soon as it is done, so that a later
    /// process goes on where one ended or was killed.
    bool keeps_frames = false;
    /// Says which program makes them, so that another one, whose code may differ though its numerics do not, does not
    /// take them for its own: a digest of the executable, or nothing.
    std::string build = {};
    /// What they may take on disk together with the outputs. Those not used for longest go first.
    std::uintmax_t disk_bytes = std::uintmax_t{10} << 30;
    /// Where that folder and its files may lie; a folder elsewhere is a Failure IO410 when the evaluator is made.
    FileAccess files = {};

    /// What the two budgets are together unless they are set: a quarter of memory_limit() when it is first asked for.
    static std::size_t default_bytes();
    /// A third of `bytes` for values and the rest for states, which take longer to make again.
    static StorePolicy within(std::size_t bytes);
};

/// Events for hosts, progress bars and tests. Called from worker threads, one call at a time.
class Observer {
  public:
    virtual ~Observer() = default;
    /// A node computes, or a simulation steps, from here to `ends`; whether it succeeds or not.
    virtual void begins(const std::string& node, double frame) { (void)node, (void)frame; }
    virtual void ends(const std::string& node, double frame) { (void)node, (void)frame; }
    /// A node computed (never a look-up).
    virtual void computed(const std::string& node, double frame, double seconds) {
        (void)node, (void)frame, (void)seconds;
    }
    /// A simulation step ran, frame-1 -> frame (frame = start for the initial state).
    virtual void stepped(const std::string& node, double frame, double seconds) {
        (void)node, (void)frame, (void)seconds;
    }
    virtual void reused(const std::string& node, double frame) { (void)node, (void)frame; }
    virtual void warning(const Diagnostic& d) { (void)d; }
    virtual void progress(const std::string& node, double done, std::string_view what) {
        (void)node, (void)done, (void)what;
    }
};

/// What has failed in the pulls of one command, so that the later ones fail alike without computing it again. Not
/// kept longer than that: a mesher that ran out of time may do better the next time.
class Failures;
std::shared_ptr<Failures> remember_failures();

struct Request {
    std::shared_ptr<const Graph> graph;
    Plug plug;
    double frame = 1;
    std::stop_token stop = {};
    std::shared_ptr<Failures> failures = {}; ///< none: nothing is remembered
};

enum class Readiness { ready, would_run, undecided };

struct Verdict {
    Readiness readiness = Readiness::would_run;
    std::string because; ///< in words, for people
    /// Inputs whose content differs from what the value was made of when it was last computed here, or kept on disk.
    std::vector<std::string> changed_plugs;
    std::string first_plug;                 ///< the output that must be evaluated first, "node.output"; empty if none
    double first_frame = 0, last_frame = 0; ///< simulations: the frames that would be stepped
};

class Evaluator {
  public:
    /// threads = 0: all of the machine.
    explicit Evaluator(StorePolicy policy = {}, int threads = 0, Observer* observer = nullptr);
    ~Evaluator();
    Evaluator(const Evaluator&) = delete;
    /// Thread-safe; many pulls at once share work that is in flight. Throws Failure, SolveFailure or
    /// Cancelled.
    Value pull(const Request& request);
    /// "Why would this run?" Never computes a node.
    Verdict explain(const Request& request) const;
    /// Ranges of frames in [first, last] whose value is ready without computing. Never computes.
    std::vector<std::pair<int, int>> valid_frames(const Request& request, int first, int last) const;
    /// Has the simulation `request.plug.node` look at all that it would read in its steps to `frames` (rising), without
    /// any step: throws what the first step would throw because of that, which may also lie between the first of them
    /// that is refused and the one before. Other simulations that it reads
    /// are simulated, though. Does nothing at frames up to its start, and for simulations that cannot rehearse.
    void rehearse(const Request& request, std::span<const int> frames);
    /// Drops every scratch object; results must not change by a bit (a test does this each frame).
    void drop_scratch();
    /// Drops stored output values (not states); used by tests of the state chain.
    void drop_values();
    /// Saved bytes of the simulation state of `request.plug.node` at `request.frame`; runs what is missing.
    std::vector<std::byte> save_state(const Request& request);
    /// Puts a saved state into the store as the state of that node at that frame.
    void load_state(const Request& request, std::span<const std::byte> bytes);
    /// What the stores hold now, and the most that they have held at once.
    std::size_t stored_bytes() const;
    std::size_t most_stored_bytes() const;
    /// Results that were computed again because the budget had not had room for them.
    std::size_t made_again() const;
    int threads() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace sinew::engine
