// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/motion_range.h"

#include "engine/diagnostics.h"
#include "engine/text.h"
#include "nodes/motion_track.h"
#include "solver/error.h"
#include "tools/viewer/recorder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

namespace sinew::cli {

using engine::Curve;
using engine::Diagnostic;
using engine::Graph;
using engine::Key;
using engine::Node;

namespace {

/// Frames of the graph.
struct Reach {
    double first, last;
};

/// How far a motion gets, where it does not reach over the run.
struct Gap {
    bool begins_late, ends_early;
    explicit operator bool() const { return begins_late || ends_early; }
};

/// The literal at an input or its default; empty if it is keyed or connected.
template <class T>
std::optional<T> literal(const Graph& graph, const Node& node, std::string_view attribute) {
    const auto it = node.inputs.find(attribute);
    engine::Value v;
    if (it == node.inputs.end())
        v = engine::default_value(*node.type->find_input(attribute), graph.timing());
    else if (const auto* value = std::get_if<engine::Value>(&it->second))
        v = *value;
    if (v.is<T>()) return v.as<T>();
    return {};
}

class Search {
  public:
    Search(const Graph& graph, const std::vector<std::string>& nodes, int first, int last)
        : graph_(graph)
        , first_(first)
        , last_(last)
        , first_simulated_(graph.timing().start) {
        for (const std::string& name : nodes)
            if (const Node* node = graph.find(name); node && node->type)
                for (const engine::AttributeInfo& a : node->type->inputs)
                    if (a.from_timing == engine::FromTiming::start)
                        first_simulated_ = std::min(first_simulated_,
                                                    literal<double>(graph, *node, a.name).value_or(first_simulated_));
        // To stand still in a run-up is what it is for.
        if (first_simulated_ < graph.timing().start) first_ = std::max<double>(first, graph.timing().start);
    }

    void keys(const std::string& name, const std::string& attribute, const engine::AttributeInfo& info,
              const Curve& curve) {
        const std::vector<Key>& keys = curve.keys;
        const auto same = [](const Key& a, const Key& b) { return a.value == b.value; };
        if (keys.size() < 2) return;
        if (std::all_of(keys.begin(), keys.end(), [&](const Key& k) { return same(k, keys.front()); })) return;
        const Reach reach{keys.front().frame, keys.back().frame};
        const engine::Timing& timing = graph_.timing();
        const bool moves =
            info.def.is<engine::Vec3>() || info.def.is<engine::Matrix4>() || info.def.is<engine::NumberList>();
        const bool steps = curve.interpolation == engine::Interpolation::step || info.is_stepped();
        // Of one frame alone is a graph that does not say for how long it is.
        const bool is_bounded = !steps || timing.end > timing.start;
        if (is_bounded && (reach.first > std::max<double>(timing.end, last_) || reach.last < first_simulated_)) {
            const bool before = reach.last < first_simulated_;
            Diagnostic d = warning("FE266", name, attribute);
            d.message = std::string(moves ? "the keyed motion" : "the keyed value") + " lasts from frame " +
                        frame_text(reach.first) + " to " + frame_text(reach.last) + ", the graph's timing from " +
                        frame_text(timing.start) + " to " + frame_text(timing.end) +
                        (first_simulated_ < timing.start ? ", its run-up from " + frame_text(first_simulated_) : "") +
                        ": it stays as it is at its " + (before ? "last" : "first") + " key throughout";
            d.hint = "move the keys to the frames of the timing, or set timing.start and timing.end to theirs";
            found_.push_back(std::move(d));
            return;
        }
        if (steps) return; // holds by itself
        if (!moves && (missing(reach.first - timing.start) || missing(timing.end - reach.last))) return;
        Gap gap = gap_of(reach);
        gap.begins_late = gap.begins_late && !same(keys[0], keys[1]);
        gap.ends_early = gap.ends_early && !same(keys[keys.size() - 2], keys.back());
        if (!gap) return;
        warn(name, attribute, moves ? "the keyed motion" : "the keyed value", reach, gap,
             "key what it does up to frame " + frame_text(gap.ends_early ? last_ : first_) +
                 ", the same value again where it is to hold, or run other frames");
    }

    /// One warning for all nodes that read a file in the same way.
    void track(const std::string& name, const std::string& attribute, const std::string& path, Reach reach) {
        const Gap gap = gap_of(reach);
        if (!gap) return;
        const auto [it, is_new] = tracks_.emplace(std::tuple(path, reach.first, reach.last), found_.size());
        if (!is_new) {
            ++followers_[it->second];
            return;
        }
        warn(name, attribute, "the recorded motion", reach, gap,
             "run the frames that it has, record more, or follow another motion");
    }

    /// Of a node that follows a file and does not say how fast: where the file was recorded at another rate. Told once
    /// a file.
    void pace(const std::string& name, const std::string& attribute, std::string_view rate, const std::string& path,
              double recorded) {
        constexpr double ntsc = 0.01; // 23.976 for 24, and the like
        const double fps = graph_.timing().fps, right = recorded / fps;
        if (!std::isfinite(right) || std::abs(right - 1) < ntsc || !paced_.insert(path).second) return;
        Diagnostic d = warning("FE334", name, attribute);
        d.message = "the motion was recorded at " + engine::number_text(recorded) +
                    " frames a second, the graph runs at " + engine::number_text(fps) + ": it goes " +
                    (right > 1 ? engine::rough_text(right, 3) + " times too slow"
                               : engine::rough_text(1 / right, 3) + " times too fast");
        d.hint = "write \"" + std::string(rate) + "\": " + engine::rough_text(right, 6) +
                 ", or 1 if one of its frames is to be one of the graph's";
        found_.push_back(std::move(d));
    }

    std::vector<Diagnostic> finish() {
        for (const auto& [at, count] : followers_)
            found_[at].message +=
                ", as " + std::to_string(count) + " more that follow" + (count == 1 ? "s" : "") + " this file";
        return std::move(found_);
    }

  private:
    /// Less than a frame is nothing that shows.
    static bool missing(double frames) { return frames > 1 - 1e-6; }
    Gap gap_of(const Reach& reach) const {
        const double start = graph_.timing().start;
        const bool brings_to_start = first_simulated_ < start && reach.last <= start; // all of it in the run-up
        return {missing(reach.first - first_), missing(last_ - reach.last) && !brings_to_start};
    }
    static std::string frame_text(double frame) { return engine::number_text(std::round(10 * frame) / 10); }

    Diagnostic warning(std::string_view code, const std::string& name, const std::string& attribute) const {
        Diagnostic d;
        d.severity = engine::Severity::warning;
        d.code = code;
        d.node = name, d.attribute = attribute;
        d.spot = graph_.spot(name, attribute);
        if (!d.spot) d.spot = graph_.spot(name);
        return d;
    }
    void warn(const std::string& name, const std::string& attribute, const std::string& what, const Reach& reach,
              const Gap& gap, std::string hint) {
        Diagnostic d = warning("FE266", name, attribute);
        const std::string a = frame_text(reach.first), b = frame_text(reach.last), first = frame_text(first_),
                          last = frame_text(last_);
        if (gap.begins_late && gap.ends_early)
            d.message = what + " lasts from frame " + a + " to " + b + ", the run from " + first + " to " + last +
                        "; before and after it stands still";
        else if (gap.ends_early)
            d.message = what + " ends at frame " + b + ", the run at frame " + last + "; in between it stands still";
        else
            d.message = what + " begins at frame " + a + ", the run at frame " + first + "; in between it stands still";
        d.hint = std::move(hint);
        found_.push_back(std::move(d));
    }

    const Graph& graph_;
    double first_; ///< from which on motion is looked for
    const double last_;
    double first_simulated_; ///< of the timing, or of a solver's run-up to it
    std::vector<Diagnostic> found_;
    std::map<std::tuple<std::string, double, double>, std::size_t> tracks_; ///< -> in found_
    std::map<std::size_t, int> followers_;
    std::set<std::string> paced_; ///< files
};

/// A node that follows a file: its inputs.
struct Follower {
    std::string_view type, file, name, offset, rate;
};
constexpr Follower followers[] = {{"transform", "track", "trackName", "trackOffset", "trackRate"},
                                  {"trackChannel", "file", "channel", "offset", "rate"}};

/// Where samples lie on the graph's frames; nothing where they are all alike.
template <class Track, class Values>
std::optional<Reach> reach_of(const Track& track, const Values& values, double offset, double rate) {
    if (std::all_of(values.begin(), values.end(), [&](const auto& v) { return v == values.front(); })) return {};
    // The inverse of track_frame.
    const double a = (track.frames.front() - 1 - offset) / rate + 1, b = (track.frames.back() - 1 - offset) / rate + 1;
    return Reach{std::min(a, b), std::max(a, b)};
}

void look_at_track(const Graph& graph, const std::string& name, const Node& node, const Follower& f, Search& search) {
    const auto file = literal<engine::File>(graph, node, f.file);
    const auto track = literal<std::string>(graph, node, f.name);
    const auto offset = literal<double>(graph, node, f.offset), rate = literal<double>(graph, node, f.rate);
    // A keyed offset places the motion by hand, and without a rate it stands still.
    if (!file || file->path.empty() || !track || !offset || !rate || *rate == 0) return;
    try {
        std::optional<Reach> reach;
        std::optional<double> fps;
        if (f.type == "transform") {
            const nodes::MatrixTrack t = nodes::read_matrix_track(graph.files(), file->path, *track);
            reach = reach_of(t, t.matrices, *offset, *rate), fps = t.fps;
        } else {
            const nodes::NumberTrack t = nodes::read_number_track(graph.files(), file->path, *track);
            reach = reach_of(t, t.values, *offset, *rate), fps = t.fps;
        }
        if (!reach) return; // it never moves
        search.track(name, std::string(f.file), file->path, *reach);
        if (fps && !node.inputs.contains(f.rate)) search.pace(name, std::string(f.file), f.rate, file->path, *fps);
    } catch (const solver::Error&) {
    } catch (const engine::Failure&) {
    }
}

} // namespace

std::vector<Diagnostic> find_motion_doubts(const Graph& graph, const std::vector<std::string>& nodes, int first,
                                           int last) {
    Search search(graph, nodes, first, last);
    for (const std::string& name : nodes) {
        const Node* node = graph.find(name);
        if (!node || !node->type) continue;
        for (const auto& [attribute, binding] : node->inputs) {
            const engine::AttributeInfo* info = node->type->find_input(attribute);
            if (const auto* curve = std::get_if<Curve>(&binding); curve && info)
                search.keys(name, attribute, *info, *curve);
        }
        for (const Follower& f : followers)
            if (node->type->name == f.type) look_at_track(graph, name, *node, f, search);
    }
    return search.finish();
}

std::vector<int> frames_outside(const engine::Timing& timing, const std::vector<int>& frames) {
    std::vector<int> out;
    for (const int f : frames)
        if (f < timing.start || f > timing.end) out.push_back(f);
    return out;
}

std::optional<Diagnostic> find_timing_doubt(const engine::Timing& timing, const std::vector<int>& frames,
                                            const std::string& command) {
    const std::vector<int> outside = frames_outside(timing, frames);
    if (outside.empty() || timing.start == timing.end) return {};
    Diagnostic d;
    d.severity = engine::Severity::warning;
    d.code = "FE333";
    const bool one = outside.size() == 1;
    const std::string range = std::to_string(timing.start) + " to " + std::to_string(timing.end);
    d.message = std::string(one ? "frame " : "frames ") + viewer::frame_list(outside) + (one ? " lies" : " lie") +
                " outside of the graph's timing, " + range + ": what is keyed and recorded may not be meant for " +
                (one ? "it" : "them");
    d.hint = command + " --frames " + std::to_string(timing.start) + "-" + std::to_string(timing.end) +
             ", or change timing.start and timing.end in the graph";
    return d;
}

} // namespace sinew::cli
