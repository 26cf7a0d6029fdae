// What a run shows while it goes: a bar that people watch, a line a frame for logs, JSON lines for programs,
// or nothing. Same content in all of them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"
#include "tools/cli/report.h"

#include <chrono>
#include <condition_variable>
#include <iosfwd>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace sinew::cli {

enum class ProgressStyle { bar, lines, json, quiet };

class Progress : public engine::Observer {
  public:
    /// \param out lines and JSON
    /// \param err the bar and warnings
    /// \param graph whose nodes are at work
    Progress(ProgressStyle style, std::shared_ptr<const engine::Graph> graph, int frame_count, std::ostream& out,
             std::ostream& err);
    ~Progress() override;

    void begin_frame(int frame);
    /// \param digest of what was pulled, so that programs can compare runs
    void end_frame(const FrameReport& report, const std::string& digest);
    /// Steps of simulations since the start, and whether one ended at this frame.
    int steps() const;
    bool was_stepped(int frame) const;
    /// What the nodes cost so far, by type.
    std::map<std::string, NodeCost> computed_by_type() const;
    /// Warnings of the graph so far, each once; not those of single frames, which their reports tell.
    std::vector<engine::Diagnostic> warnings() const;
    /// Takes the bar off the screen, so that other text can follow.
    void clear();

    void begins(const std::string& node, double frame) override;
    void ends(const std::string& node, double frame) override;
    void computed(const std::string& node, double frame, double seconds) override;
    void stepped(const std::string& node, double frame, double seconds) override;
    void progress(const std::string& node, double done, std::string_view what) override;
    void warning(const engine::Diagnostic& d) override;

  private:
    using Clock = std::chrono::steady_clock;
    /// A node at work.
    struct Working {
        std::string node, type;
        double frame;
        bool is_simulation; ///< its frames speak for themselves, but only once they are there
        Clock::time_point since, tell_at;
        double done = 0; ///< 0 to 1
    };
    void draw(const std::string& note, bool at_once);
    void watch(const std::stop_token& stop);
    void tell_working(Clock::time_point now);
    void tell(const Working& w);
    void tell_preroll(int frame);
    std::string rate() const;

    const ProgressStyle style_;
    const std::shared_ptr<const engine::Graph> graph_;
    const int frame_count_;
    std::ostream &out_, &err_;
    mutable std::mutex mutex_;
    int frames_done_ = 0, current_ = 0, steps_ = 0, unconverged_ = 0;
    std::set<double> stepped_frames_;
    std::set<std::string> told_; ///< warnings about meshes
    std::set<std::string> kept_; ///< what is in warnings_
    std::vector<engine::Diagnostic> warnings_;
    double seconds_done_ = 0;
    std::string last_step_;
    bool bar_is_shown_ = false;
    Clock::time_point last_drawn_{}, frame_begun_{}, preroll_told_{};
    int preroll_steps_ = 0; ///< since frame_begun_
    std::vector<Working> working_;
    std::map<std::string, NodeCost> computed_;
    std::condition_variable_any wake_;
    std::jthread watcher_; ///< last: it ends before what it reads
};

} // namespace sinew::cli
