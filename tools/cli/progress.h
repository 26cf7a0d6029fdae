// What a run shows while it goes: a bar that people watch, a line a frame for logs, JSON lines for programs,
// or nothing. Same content in all of them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"
#include "tools/cli/report.h"

#include <chrono>
#include <iosfwd>
#include <map>
#include <mutex>
#include <set>
#include <string>

namespace sinew::cli {

enum class ProgressStyle { bar, lines, json, quiet };

class Progress : public engine::Observer {
  public:
    /// \param out lines and JSON
    /// \param err the bar and warnings
    Progress(ProgressStyle style, int frame_count, std::ostream& out, std::ostream& err);
    ~Progress() override;

    void begin_frame(int frame);
    /// \param digest of what was pulled, so that programs can compare runs
    void end_frame(const FrameReport& report, const std::string& digest);
    /// Steps of simulations since the start, and whether one ended at this frame.
    int steps() const;
    bool was_stepped(int frame) const;
    /// Takes the bar off the screen, so that other text can follow.
    void clear();

    void stepped(const std::string& node, double frame, double seconds) override;
    void progress(const std::string& node, double done, std::string_view what) override;
    void warning(const engine::Diagnostic& d) override;

  private:
    void draw(const std::string& note, bool at_once);
    std::string rate() const;

    const ProgressStyle style_;
    const int frame_count_;
    std::ostream &out_, &err_;
    mutable std::mutex mutex_;
    int frames_done_ = 0, current_ = 0, steps_ = 0, unconverged_ = 0;
    std::set<double> stepped_frames_;
    std::set<std::string> told_; ///< warnings about meshes
    double seconds_done_ = 0;
    std::string last_step_;
    bool bar_is_shown_ = false;
    std::chrono::steady_clock::time_point last_drawn_{};
};

} // namespace sinew::cli
