// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/progress.h"

#include "tools/cli/json_text.h"
#include "tools/cli/print.h"
#include "tools/embed/frame_json.h"

#include "engine/text.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

namespace {

constexpr int bar_width = 24;
constexpr auto redraw_interval = std::chrono::milliseconds(100);
constexpr auto told_after = std::chrono::seconds(1);  // what is quicker needs no word
constexpr auto told_again = std::chrono::seconds(10); // how far a step is

std::string step_text(const FrameReport& f) {
    if (!f.step) return {};
    char text[160];
    std::snprintf(text, sizeof text, "residual %.1e  Newton %d%s", f.step->residual, f.step->newton_iterations,
                  f.step->converged ? "" : "  NOT CONVERGED");
    return text;
}

} // namespace

Progress::Progress(ProgressStyle style, std::shared_ptr<const engine::Graph> graph, int frame_count, std::ostream& out,
                   std::ostream& err)
    : style_(style)
    , graph_(std::move(graph))
    , frame_count_(frame_count)
    , out_(out)
    , err_(err) {
    if (style_ != ProgressStyle::quiet) watcher_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

Progress::~Progress() {
    watcher_ = {}; // joined before the line goes
    clear();
}

void Progress::clear() {
    const std::lock_guard lock(mutex_);
    if (!bar_is_shown_) return;
    err_ << "\r\x1b[K" << std::flush;
    bar_is_shown_ = false;
}

void Progress::begin_frame(int frame) {
    const std::lock_guard lock(mutex_);
    current_ = frame;
    frame_begun_ = preroll_told_ = Clock::now();
    preroll_steps_ = 0;
    draw("", true);
}

void Progress::end_frame(const FrameReport& f, const std::string& digest) {
    const std::lock_guard lock(mutex_);
    ++frames_done_;
    seconds_done_ += f.wall_s;
    if (f.step && !f.step->converged) ++unconverged_;
    last_step_ = step_text(f);
    if (style_ == ProgressStyle::json) {
        nlohmann::ordered_json line = {
            {"event", "frame"}, {"frame", f.frame}, {"reused", f.reused}, {"wall_s", f.wall_s}};
        if (f.step) line.update(embed::step_json(*f.step));
        line["digest"] = digest;
        out_ << json_text(line) << "\n" << std::flush;
    } else if (style_ == ProgressStyle::lines) {
        char text[64];
        std::snprintf(text, sizeof text, "frame %4d  %7.0f ms  ", f.frame, 1000 * f.wall_s);
        out_ << text << last_step_ << (f.reused ? "  reused" : "") << "\n" << std::flush;
    }
    draw("", true);
}

int Progress::steps() const {
    const std::lock_guard lock(mutex_);
    return steps_;
}

bool Progress::was_stepped(int frame) const {
    const std::lock_guard lock(mutex_);
    return stepped_frames_.contains(frame);
}

void Progress::stepped(const std::string&, double frame, double) {
    const std::lock_guard lock(mutex_);
    ++steps_;
    stepped_frames_.insert(frame);
    if (frame_begun_ != Clock::time_point{} && frame < current_) tell_preroll(static_cast<int>(frame));
}

// A run that starts in the middle simulates what comes before first: which frame it is at, and how long it will take.
void Progress::tell_preroll(int frame) {
    ++preroll_steps_;
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - frame_begun_).count();
    const double left = seconds / preroll_steps_ * (current_ - frame);
    const std::string text = "pre-roll: frame " + std::to_string(frame) + " on the way to " + std::to_string(current_) +
                             ", " + clock_text(left) + " left";
    if (style_ == ProgressStyle::bar) return draw(text, false);
    if (style_ == ProgressStyle::quiet || now - preroll_told_ < told_after) return;
    preroll_told_ = now;
    if (style_ == ProgressStyle::json) {
        const nlohmann::ordered_json line = {
            {"event", "preroll"}, {"frame", frame}, {"to", current_}, {"left_s", left}};
        out_ << json_text(line) << "\n" << std::flush;
    } else {
        err_ << text << "\n" << std::flush;
    }
}

void Progress::begins(const std::string& node, double frame) {
    const std::lock_guard lock(mutex_);
    const engine::Node* n = graph_->find(node);
    if (!n || !n->type) return;
    const auto now = Clock::now();
    working_.push_back({node, n->type_name, frame, n->type->simulation != nullptr, now, now + told_after});
    if (working_.size() == 1) wake_.notify_all();
}

void Progress::ends(const std::string& node, double frame) {
    const std::lock_guard lock(mutex_);
    const auto at = std::find_if(working_.begin(), working_.end(),
                                 [&](const Working& w) { return w.node == node && w.frame == frame; });
    if (at != working_.end()) working_.erase(at);
}

void Progress::computed(const std::string& node, double, double seconds) {
    const std::lock_guard lock(mutex_);
    const engine::Node* n = graph_->find(node);
    NodeCost& cost = computed_[n ? n->type_name : node];
    ++cost.count;
    cost.seconds += seconds;
}

std::map<std::string, NodeCost> Progress::computed_by_type() const {
    const std::lock_guard lock(mutex_);
    return computed_;
}

// Runs beside the work, because a node that takes long says nothing by itself.
void Progress::watch(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (wake_.wait(lock, stop, [this] { return !working_.empty(); })) {
        tell_working(Clock::now());
        wake_.wait_for(lock, stop, redraw_interval, [] { return false; });
    }
}

void Progress::tell_working(Clock::time_point now) {
    for (Working& w : working_) {
        if (now < w.tell_at) continue;
        if (style_ == ProgressStyle::bar) {
            const double seconds = std::chrono::duration<double>(now - w.since).count();
            if (now - last_drawn_ >= told_after)
                draw("computing " + w.node + " (" + w.type + "), " + clock_text(seconds), true);
            return;
        }
        w.tell_at = w.is_simulation ? now + told_again : Clock::time_point::max();
        tell(w);
    }
}

void Progress::tell(const Working& w) {
    if (style_ == ProgressStyle::json) {
        nlohmann::ordered_json line = {{"event", "computing"}, {"node", w.node}, {"type", w.type}, {"frame", w.frame}};
        if (w.is_simulation) line["done"] = w.done;
        out_ << json_text(line) << "\n" << std::flush;
        return;
    }
    err_ << "computing " << w.node << " (" << w.type << ")";
    if (w.is_simulation) {
        char percent[16];
        std::snprintf(percent, sizeof percent, "%.0f %%", 100 * w.done);
        err_ << ", frame " << engine::number_text(w.frame) << ": " << percent;
    }
    err_ << "\n" << std::flush;
}

void Progress::progress(const std::string& node, double done, std::string_view what) {
    const std::lock_guard lock(mutex_);
    for (Working& w : working_)
        if (w.node == node) w.done = done;
    char percent[16];
    std::snprintf(percent, sizeof percent, " %.0f %%", 100 * done);
    draw(node + (what.empty() ? "" : ": ") + std::string(what) + percent, false);
}

void Progress::warning(const engine::Diagnostic& d) {
    const std::lock_guard lock(mutex_);
    if (d.code != "FE301" && d.code != "FE306") // which are of single frames; of FE307 the first is kept
        if (kept_.insert(d.code + "\n" + d.node + "\n" + d.attribute + "\n" + (d.code == "FE307" ? "" : d.message))
                .second)
            warnings_.push_back(d);
    // A frame that has not converged is counted and marked in its own line.
    if (style_ == ProgressStyle::bar && d.code == "FE301") return;
    // So is one with inverted tets, which the bar tells of once; the summary counts them. It counts frames that leave
    // bodies deep in each other, too, and says which is the worst.
    const bool once = style_ == ProgressStyle::bar ? d.code == "FE306" || d.code == "FE307"
                                                   : style_ != ProgressStyle::json && d.code == "FE307";
    if (once && !told_.insert(d.code).second) return;
    // What is wrong with a mesh is said again by every frame that evaluates its node.
    if (d.code.starts_with("FE2") &&
        !told_.insert(d.code + "\n" + d.node + "\n" + d.attribute + "\n" + d.message).second)
        return;
    if (bar_is_shown_) err_ << "\r\x1b[K";
    bar_is_shown_ = false;
    print_diagnostics({&d, 1}, style_ == ProgressStyle::json, out_, err_);
}

std::vector<engine::Diagnostic> Progress::warnings() const {
    const std::lock_guard lock(mutex_);
    return warnings_;
}

std::string Progress::rate() const {
    if (frames_done_ == 0) return {};
    const double mean = seconds_done_ / frames_done_;
    char text[64];
    std::snprintf(text, sizeof text, "  %.0f ms a frame  %s left", 1000 * mean,
                  clock_text(mean * (frame_count_ - frames_done_)).c_str());
    return text;
}

void Progress::draw(const std::string& note, bool at_once) {
    if (style_ != ProgressStyle::bar) return;
    const auto now = std::chrono::steady_clock::now();
    if (!at_once && now - last_drawn_ < redraw_interval) return;
    last_drawn_ = now;
    const int full = frame_count_ ? bar_width * frames_done_ / frame_count_ : 0;
    err_ << "\r" << std::string(static_cast<std::size_t>(full), '#')
         << std::string(static_cast<std::size_t>(bar_width - full), '.') << " frame " << current_ << " ("
         << frames_done_ << "/" << frame_count_ << ")" << rate();
    if (!last_step_.empty()) err_ << "  " << last_step_ << "  unconverged " << unconverged_;
    if (!note.empty()) err_ << "  " << note;
    err_ << "\x1b[K" << std::flush;
    bar_is_shown_ = true;
}

} // namespace sinew::cli
