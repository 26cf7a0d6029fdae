// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/faults.h"

#include "tools/viewer/recorder.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sinew::viewer {

namespace {

using Point = std::array<double, 3>;

/// Times as far as most frames reach.
constexpr double far_outside = 8;

bool is_drawable(float v) { return std::abs(static_cast<double>(v)) < most_drawable; } // false for NaN

/// Bodies and frames of one kind of fault, for a note a group.
using Found = std::map<std::string, std::vector<std::size_t>>; ///< body -> frame indices

/// Puts broken points where they were last. \returns how many are broken.
std::size_t mend(Coordinates& now, const Coordinates& before) {
    std::size_t count = 0;
    for (std::size_t i = 0; i + 2 < now.size(); i += 3) {
        if (is_drawable(now[i]) && is_drawable(now[i + 1]) && is_drawable(now[i + 2])) continue;
        for (std::size_t c = 0; c < 3; ++c)
            now[i + c] = i + c < before.size() && is_drawable(before[i + c]) ? before[i + c] : 0.0f;
        ++count;
    }
    return count;
}

void mend_frames(std::vector<Coordinates>& frames, Coordinates& rest, std::vector<std::size_t>& bad) {
    mend(rest, {});
    const Coordinates* before = &rest;
    for (std::size_t f = 0; f < frames.size(); ++f) {
        if (frames[f].size() != rest.size()) continue;
        if (mend(frames[f], *before) > 0) bad.push_back(f);
        before = &frames[f];
    }
}

struct Box {
    Point low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    void add(const Point& p) {
        for (std::size_t c = 0; c < 3; ++c) low[c] = std::min(low[c], p[c]), high[c] = std::max(high[c], p[c]);
    }
    bool is_empty() const { return !(low[0] <= high[0]); }
};

Box box_of(const ViewBody& body, std::size_t frame) {
    Box box;
    if (!body.is_there(frame)) return box;
    const Coordinates* points = nullptr;
    if (body.lattice && !body.lattice->surface.tet.empty())
        points = &body.lattice->frames[frame];
    else if (const auto* moving = std::get_if<DeformingMotion>(&body.motion))
        points = &moving->points[frame];
    if (points) {
        for (std::size_t i = 0; i + 2 < points->size(); i += 3)
            box.add({static_cast<double>((*points)[i]), static_cast<double>((*points)[i + 1]),
                     static_cast<double>((*points)[i + 2])});
        return box;
    }
    const std::size_t step = std::max<std::size_t>(1, body.vertex_count() / 200); // rigid: a few tell
    for (std::size_t v = 0; v < body.vertex_count(); v += step) {
        const auto p = vertex_position(body, frame, v);
        box.add({static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
    }
    return box;
}

/// The lower one of two middle values, so that one of two frames cannot be "most".
double lower_median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double reach(const Box& box, const Point& from) {
    double squared = 0;
    for (std::size_t c = 0; c < 3; ++c) squared += std::pow(std::max(from[c] - box.low[c], box.high[c] - from[c]), 2);
    return std::sqrt(squared);
}

/// How far frames usually reach: the median, or less if there is a wide gap above what a quarter of them
/// reach.
double usual_reach(std::vector<double> reaches) {
    const double median = lower_median(reaches);
    std::sort(reaches.begin(), reaches.end());
    for (std::size_t i = (reaches.size() + 3) / 4; i < reaches.size(); ++i)
        if (reaches[i] > far_outside * reaches[i - 1] && reaches[i - 1] > 0) return std::min(median, reaches[i - 1]);
    return median;
}

void find_far(const ViewScene& scene, Found& far, std::vector<double>& times) {
    const std::size_t count = scene.frames.size();
    std::vector<std::vector<Box>> boxes;
    std::vector<Box> whole(count);
    for (const ViewBody& body : scene.bodies) {
        auto& mine = boxes.emplace_back();
        for (std::size_t f = 0; f < count; ++f) {
            mine.push_back(box_of(body, f));
            if (!mine.back().is_empty()) whole[f].add(mine.back().low), whole[f].add(mine.back().high);
        }
    }
    std::array<std::vector<double>, 3> middles;
    for (const Box& box : whole)
        for (std::size_t c = 0; c < 3 && !box.is_empty(); ++c) middles[c].push_back((box.low[c] + box.high[c]) / 2);
    if (middles[0].size() < 2) return;
    Point centre{};
    // Of two frames neither is the middle one; the first is believed.
    for (std::size_t c = 0; c < 3; ++c)
        centre[c] = middles[c].size() == 2 ? middles[c].front() : lower_median(middles[c]);
    std::vector<double> reaches;
    for (const Box& box : whole)
        if (!box.is_empty()) reaches.push_back(reach(box, centre));
    const double usual = usual_reach(reaches);
    if (!(usual > 0)) return;
    for (std::size_t b = 0; b < boxes.size(); ++b)
        for (std::size_t f = 0; f < count; ++f)
            if (!boxes[b][f].is_empty() && reach(boxes[b][f], centre) > far_outside * usual) {
                far[scene.bodies[b].name].push_back(f);
                times[f] = std::max(times[f], reach(boxes[b][f], centre) / usual);
            }
}

std::string times_text(double times) {
    if (times >= 1e9) return "more than a billion";
    if (times >= 1e6) return std::to_string(std::lround(times / 1e6)) + " million";
    if (times >= 1e4) return std::to_string(std::lround(times / 1e3)) + ",000";
    return std::to_string(std::lround(times));
}

std::string joined(const std::vector<std::string>& names) {
    std::string out;
    constexpr std::size_t most = 4;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (i == most && names.size() > most + 1)
            return out + " and " + std::to_string(names.size() - most) + " other bodies";
        out += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
    }
    return out;
}

/// One note for all bodies that are wrong at the same frames.
template <class Say>
void note(ViewScene& scene, const Found& found, Say say) {
    std::map<std::vector<std::size_t>, std::vector<std::string>> groups;
    for (const auto& [name, frames] : found) groups[frames].push_back(name);
    for (const auto& [indices, names] : groups) {
        std::vector<int> frames;
        for (const std::size_t f : indices) frames.push_back(scene.frames[f].frame);
        scene.notes.push_back({true, "Frame" + std::string(frames.size() == 1 ? " " : "s ") + frame_list(frames) +
                                         ": " + say(indices, names)});
    }
}

/// Marks that cannot be drawn are left out; their frame says so.
void drop_broken_marks(ViewScene& scene) {
    const auto is_broken = [](const ViewMark& m) {
        const auto bad = [](float v) { return !is_drawable(v); };
        return std::any_of(m.from.begin(), m.from.end(), bad) || std::any_of(m.to.begin(), m.to.end(), bad) ||
               !std::isfinite(m.value);
    };
    Found broken;
    for (std::size_t f = 0; f < scene.frames.size(); ++f)
        for (ViewMarks& group : scene.frames[f].marks) {
            if (std::erase_if(group.marks, is_broken) == 0) continue;
            std::vector<std::size_t>& of_group = broken["marks of " + group.term + ", " + group.what];
            if (of_group.empty() || of_group.back() != f) of_group.push_back(f);
            scene.frames[f].faults.push_back("marks of " + group.term + " have numbers that are none");
        }
    note(scene, broken, [](const auto&, const auto& names) {
        return joined(names) + " have coordinates or values that are no numbers or beyond any; they are left out.";
    });
}

} // namespace

void find_faults(ViewScene& scene) {
    drop_broken_marks(scene);
    Found broken, far;
    for (ViewBody& body : scene.bodies) {
        std::vector<std::size_t> bad;
        if (body.lattice) mend_frames(body.lattice->frames, body.lattice->rest, bad);
        if (auto* moving = std::get_if<DeformingMotion>(&body.motion))
            mend_frames(moving->points, body.rest, bad);
        else
            mend(body.rest, {});
        std::sort(bad.begin(), bad.end());
        bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
        if (bad.empty()) continue;
        broken[body.name] = bad;
        for (const std::size_t f : bad)
            scene.frames[f].faults.push_back(body.name + " has coordinates that are no numbers");
    }
    std::vector<double> times(scene.frames.size(), 0);
    find_far(scene, far, times);
    for (const auto& [name, frames] : far)
        for (const std::size_t f : frames) scene.frames[f].faults.push_back(name + " flies far away");
    note(scene, broken, [](const auto&, const auto& names) {
        return joined(names) + (names.size() == 1 ? " has" : " have") +
               " coordinates that are no numbers or beyond any; those vertices are shown where they were "
               "before.";
    });
    note(scene, far, [&](const auto& indices, const auto& names) {
        double most = 0;
        for (const std::size_t f : indices) most = std::max(most, times[f]);
        return joined(names) + (names.size() == 1 ? " reaches " : " reach ") + times_text(most) +
               " times as far as the run usually does. The camera does not follow there.";
    });
}

} // namespace sinew::viewer
