// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/reach.h"

#include "tools/rig/graph_text.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace sinew::rig {

using engine::Severity;

namespace {

constexpr double end_part = 0.35;     ///< of the length: where an end looks for what it may reach
constexpr double sharpness = 0.05;    ///< of the length: what is so much nearer to the tip counts e times as much
constexpr double tip_part = 0.15;     ///< where it is looked for over a gap
constexpr double most_gaps = 5;       ///< reaches
constexpr double as_near = 0.6;       ///< of the best score: worth a word
constexpr double hardly_missed = 2;   ///< reaches
constexpr std::size_t fewest = 3;     ///< vertices that hold an end
constexpr double longest_reach = 0.5; ///< of the length: what spans more is no muscle that hardly misses its bone

/// From 0 at the tip of this end to 1 at the other.
double from_tip(const Muscle& muscle, std::size_t end, std::size_t vertex) {
    const double along = muscle.shape.along[vertex];
    return end == 0 ? along : 1 - along;
}

/// 1 up to `inner`, 0 from `outer` on, as the weights nodes have it.
double fall(double distance, double inner, double outer) {
    if (distance <= inner) return 1;
    if (!(distance < outer)) return 0;
    const double t = (distance - inner) / (outer - inner);
    return 1 - t * t * (3 - 2 * t);
}

struct Candidate {
    std::size_t part = 0;
    double score = 0;          ///< 0: does not touch
    double gap = far_away;     ///< smallest distance near the tip
    double nearest = far_away; ///< in the whole end part
};

/// Every other part as seen from one end.
std::vector<Candidate> candidates(const Muscle& muscle, std::size_t end,
                                  const std::vector<std::vector<double>>& distances) {
    std::vector<Candidate> out;
    for (std::size_t part = 0; part < distances.size(); ++part) {
        Candidate c{part};
        const std::vector<double>& to = distances[part];
        double all = 0;
        for (std::size_t v = 0; v < to.size(); ++v) {
            const double s = from_tip(muscle, end, v),
                         touching = muscle.shape.areas[v] * fall(to[v], muscle.reach / 2, muscle.reach);
            all += touching;
            if (s > end_part) continue;
            c.score += touching * std::exp(-s / sharpness);
            c.nearest = std::min(c.nearest, to[v]);
            if (s <= tip_part) c.gap = std::min(c.gap, to[v]);
        }
        // What a muscle lies along touches it at its end, too; what it is attached to, there alone.
        if (c.score > 0) c.score *= c.score / all;
        out.push_back(c);
    }
    return out;
}

double best_score(const std::vector<Candidate>& all, const std::vector<Part>& parts, Kind kind) {
    double out = 0;
    for (const Candidate& c : all)
        if (parts[c.part].kind == kind) out = std::max(out, c.score);
    return out;
}

using Choice = std::optional<std::size_t>;
using Chosen = std::array<Choice, 2>;
using BothEnds = std::array<std::vector<Candidate>, 2>;

/// The pair of bones with the best sum of scores, each by the best at its end; two ends at one bone only if there is no
/// other.
Chosen best_bones(const BothEnds& ends, const std::vector<Part>& parts) {
    Chosen best;
    double most = 0;
    std::array<std::vector<std::pair<std::optional<std::size_t>, double>>, 2> shares;
    for (std::size_t e = 0; e < 2; ++e) {
        const double top = best_score(ends[e], parts, Kind::bone);
        shares[e].push_back({std::nullopt, 0});
        for (const Candidate& c : ends[e])
            if (parts[c.part].kind == Kind::bone && c.score > 0) shares[e].push_back({c.part, c.score / top});
    }
    for (const auto& [a, score_a] : shares[0])
        for (const auto& [b, score_b] : shares[1]) {
            const double sum = score_a + score_b - (a && a == b ? 0.99 : 0);
            if (sum > most) most = sum, best = {a, b};
        }
    return best;
}

/// A tendon if one is touched, else the muscle with the best score.
Choice best_muscle(const std::vector<Candidate>& all, const Rig& rig) {
    Choice best;
    double score = 0;
    bool is_tendon = false;
    for (const Candidate& c : all) {
        const Muscle* const other = rig.muscle_of(c.part);
        if (!other || !(c.score > 0) || (is_tendon && !other->is_tendon)) continue;
        if (c.score > score || other->is_tendon > is_tendon) best = c.part, score = c.score;
        is_tendon = other->is_tendon;
    }
    return best;
}

Choice nearest_bone(const std::vector<Candidate>& all, const Rig& rig, double most) {
    Choice best;
    for (const Candidate& c : all)
        if (rig.parts[c.part].kind == Kind::bone && c.gap < most) best = c.part, most = c.gap;
    return best;
}

/// How far the nearest vertex of those faces of a muscle's end is that a bone touches; far_away if it touches none. By
/// the bone's vertices: what lies flat on a wide face has some there.
double gap_of_touched_faces(const Muscle& muscle, std::size_t end, const Part& own, const Surface& surface,
                            const Part& bone, const std::vector<double>& to) {
    double out = far_away;
    for (const solver::Vec3& p : bone.points) {
        const solver::Vec3 off = (surface.box.min - p).cwiseMax(p - surface.box.max).cwiseMax(0.0);
        if (off.norm() > muscle.reach) continue;
        const solver::ClosestPoint c = surface.tree.closest(p, muscle.reach);
        if (c.triangle < 0) continue;
        for (const int v : own.triangles[static_cast<std::size_t>(c.triangle)])
            if (const auto vertex = static_cast<std::size_t>(v); from_tip(muscle, end, vertex) <= end_part)
                out = std::min(out, to[vertex]);
    }
    return out;
}

/// The bone that touches an end between its vertices.
std::optional<Hold> held_by_faces(const Rig& rig, const Muscle& muscle, std::size_t end,
                                  std::vector<std::vector<double>>& distances, const std::vector<Surface>& surfaces) {
    std::optional<Hold> best;
    const Part& own = rig.parts[muscle.part];
    for (std::size_t p = 0; p < rig.parts.size(); ++p) {
        if (rig.parts[p].kind != Kind::bone) continue;
        const solver::Vec3 apart =
            (surfaces[p].box.min - own.box.max).cwiseMax(own.box.min - surfaces[p].box.max).cwiseMax(0.0);
        if (apart.norm() > muscle.reach) continue;
        std::vector<double> to = rig::distances(own, surfaces[p], 1e300);
        const double gap = gap_of_touched_faces(muscle, end, own, surfaces[muscle.part], rig.parts[p], to);
        if (!(gap < (best ? best->gap : far_away))) continue;
        best = Hold{.target = p,
                    .gap = gap,
                    .inner = gap + muscle.reach * 2 / 3,
                    .outer = gap + muscle.reach * 4 / 3,
                    .by_faces = true};
        distances[p] = std::move(to);
    }
    return best;
}

std::size_t part_named(const Rig& rig, const std::string& name, const Muscle& muscle) {
    for (std::size_t p = 0; p < rig.parts.size(); ++p)
        if (p != muscle.part && (matches(name, rig.parts[p].name) || matches(name, rig.parts[p].stem))) return p;
    throw std::invalid_argument("attachTo of " + rig.parts[muscle.part].name + ": there is no bone or other muscle '" +
                                name + "'.");
}

/// What the user wants, each at the end that is better for it.
Chosen wanted(const Rig& rig, const Muscle& muscle, const BothEnds& ends) {
    const auto rank = [&](std::size_t end, std::size_t part) {
        const Candidate& c = ends[end][part];
        return c.score > 0 ? c.score : -c.nearest;
    };
    const std::vector<std::string>& names = muscle.options.attach_to;
    const std::size_t first = part_named(rig, names[0], muscle);
    if (names.size() == 1)
        return rank(0, first) >= rank(1, first) ? Chosen{Choice(first), Choice()} : Chosen{Choice(), Choice(first)};
    const std::size_t second = part_named(rig, names[1], muscle);
    // As far away as both may be, one of the two ways is the better one.
    const auto distance = [&](std::size_t end, std::size_t part) { return std::min(ends[end][part].nearest, 1e300); };
    const double straight = distance(0, first) + distance(1, second),
                 crossed = distance(1, first) + distance(0, second);
    if (straight < crossed) return {Choice(first), Choice(second)};
    if (crossed < straight) return {Choice(second), Choice(first)};
    return rank(0, first) + rank(1, second) >= rank(1, first) + rank(0, second) ? Chosen{Choice(first), Choice(second)}
                                                                                : Chosen{Choice(second), Choice(first)};
}

Hold hold_on(const Muscle& muscle, const Candidate& c, const std::vector<double>& to) {
    Hold out;
    out.target = c.part;
    out.gap = c.score > 0 ? *std::min_element(to.begin(), to.end()) : std::min(c.gap, c.nearest);
    // The rim of the paint is half way of its fall-off: 1 reach beyond the gap, if there is one.
    const double beyond = out.gap > muscle.reach ? out.gap : 0;
    out.inner = beyond + muscle.reach * 2 / 3;
    out.outer = beyond + muscle.reach * 4 / 3;
    return out;
}

void settle_masks(Muscle& muscle, const Part& part, const std::vector<std::vector<double>>& distances) {
    for (std::size_t e = 0; e < 2; ++e)
        for (Hold& hold : muscle.ends[e].holds) {
            const std::vector<double>& to = distances[hold.target];
            for (std::size_t v = 0; v < to.size(); ++v)
                if (to[v] < hold.outer && from_tip(muscle, e, v) > 2.0 / 3) hold.mask = Mask::far_third;
        }
    const auto all_painted = [&] {
        for (std::size_t e = 0; e < 2; ++e) {
            for (Hold& hold : muscle.ends[e].holds)
                hold.points = painted(muscle, e, hold, part, distances[hold.target]).size();
            muscle.ends[e].fibre_start.clear();
            if (!muscle.ends[e].holds.empty()) {
                const Hold& hold = muscle.ends[e].holds.front();
                muscle.ends[e].fibre_start = painted(muscle, e, hold, part, distances[hold.target]);
            }
        }
    };
    all_painted();
    const auto meet = [&] {
        std::vector<std::size_t> both;
        const auto &a = muscle.ends[0].fibre_start, &b = muscle.ends[1].fibre_start;
        std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
        return !both.empty();
    };
    if (meet()) {
        for (End& end : muscle.ends)
            for (Hold& hold : end.holds) hold.mask = Mask::far_half;
        all_painted();
    }
    // Fibres need vertices to start at, where nothing or too little is painted, too.
    for (std::size_t e = 0; e < 2; ++e) {
        End& end = muscle.ends[e];
        if (end.fibre_start.size() >= fewest) continue;
        end.fibres_by_tip = true;
        end.fibre_start.clear();
        for (std::size_t v = 0; v < part.points.size(); ++v)
            if ((part.points[v] - end.tip).norm() <= tip_radius(muscle)) end.fibre_start.push_back(v);
    }
    if (meet())
        for (End& end : muscle.ends) end.fibres_by_tip = true;
}

std::string place_of(const End& end) {
    return "the end near (" + rough(end.tip.x()) + ", " + rough(end.tip.y()) + ", " + rough(end.tip.z()) + ")";
}

/// Both ends at one bone, and the other one nearest to an end, if it is no farther than `most`.
void tell_one_bone(Rig& rig, const Muscle& muscle, const Chosen& chosen, const BothEnds& ends, double most) {
    if (!chosen[0] || chosen[0] != chosen[1] || rig.parts[*chosen[0]].kind != Kind::bone) return;
    const Candidate* missed = nullptr;
    std::size_t at = 0;
    for (std::size_t e = 0; e < 2; ++e)
        for (const Candidate& c : ends[e])
            if (rig.parts[c.part].kind == Kind::bone && c.part != *chosen[0] && c.gap < far_away &&
                (!missed || c.gap < missed->gap))
                missed = &c, at = e;
    if (!missed || missed->gap > most) return;
    const std::string &name = rig.parts[muscle.part].name, &held = rig.parts[*chosen[0]].name,
                      &other = rig.parts[missed->part].name;
    rig.notes.push_back(say(Severity::warning, "DG155", name,
                            "both ends are attached to " + held + ", none to " + other + ": " +
                                place_of(muscle.ends[at]) + " is " + rough(missed->gap) + " from it",
                            "If it shall hold one: --set '" + name + ":attachTo=" + held + "," + other + "'."));
}

/// A bone as an end of a muscle sees it.
struct Away {
    std::size_t bone = 0;
    double gap = far_away;    ///< of the nearest vertex
    double enough = far_away; ///< of the last one that is needed for a hold
};

/// The vertices of a muscle's end.
Part part_of_end(const Rig& rig, const Muscle& muscle, std::size_t end) {
    const Part& own = rig.parts[muscle.part];
    Part out;
    for (std::size_t v = 0; v < own.points.size(); ++v)
        if (from_tip(muscle, end, v) <= end_part) out.points.push_back(own.points[v]);
    out.box = own.box;
    return out;
}

/// Looks no farther than `most`.
Away away_from(const Part& end, std::size_t bone, const Surface& surface, double most) {
    std::vector<double> to = distances(end, surface, most);
    std::sort(to.begin(), to.end());
    return {bone, to.empty() ? far_away : to.front(), to.size() < fewest ? far_away : to[fewest - 1]};
}

/// The bone that an end would take if it reached farther.
std::optional<Away> nearest_but(const Rig& rig, const Muscle& muscle, std::size_t end,
                                const std::vector<Surface>& surfaces, const Choice& other) {
    const Part here = part_of_end(rig, muscle, end);
    std::optional<Away> best;
    for (std::size_t p = 0; p < rig.parts.size(); ++p) {
        if (rig.parts[p].kind != Kind::bone || p == other) continue;
        const Away c = away_from(here, p, surfaces[p], best ? std::min(best->enough, 1e300) : 1e300);
        if (!best ? c.gap < far_away : c.enough < best->enough) best = c;
    }
    return best;
}

/// A reach that is a bit more than the distance, with two digits; NaN where there is none.
double reach_for(double distance) {
    const double more = 1.2 * distance, unit = std::pow(10, std::floor(std::log10(more)) - 1);
    return std::ceil(more / unit - 1e-6) * unit;
}

std::string setting(const Rig& rig, const Muscle& muscle, const std::string& value) {
    return "--set '" + rig.parts[muscle.part].name + ":" + value + "'";
}

/// Says of each end that holds nothing which bone is the nearest and what would help: a reach that is enough for both
/// ends, where it is in proportion to the muscle.
void tell_loose_ends(Rig& rig, const Muscle& muscle, const std::vector<Surface>& surfaces) {
    std::array<Choice, 2> bones, others;
    std::array<std::optional<Away>, 2> nearest;
    const double most = longest_reach * muscle.shape.length;
    const auto is_near = [&](const std::optional<Away>& bone) { return bone && reach_for(bone->enough) <= most; };
    for (std::size_t e = 0; e < 2; ++e)
        if (const End& end = muscle.ends[e]; !end.holds.empty()) bones[e] = end.holds.front().target;
    double reach = 0;
    for (std::size_t e = 0; e < 2; ++e) {
        if (!muscle.ends[e].holds.empty()) continue;
        // Not the bone of the other end, unless that is the only one in reach.
        others[e] = bones[1 - e];
        nearest[e] = nearest_but(rig, muscle, e, surfaces, others[e]);
        if (others[e] && !is_near(nearest[e]))
            if (const auto any = nearest_but(rig, muscle, e, surfaces, std::nullopt); is_near(any) || !nearest[e])
                nearest[e] = any, others[e] = std::nullopt;
        if (!nearest[e]) continue;
        bones[e] = nearest[e]->bone;
        if (is_near(nearest[e])) reach = std::max(reach, reach_for(nearest[e]->enough));
    }
    const bool are_two = bones[0] && bones[1] && bones[0] != bones[1];
    const std::string attach =
        setting(rig, muscle,
                "attachTo=" + (are_two ? rig.parts[*bones[0]].name + "," + rig.parts[*bones[1]].name : "BONE,BONE"));
    for (std::size_t e = 0; e < 2; ++e) {
        if (!muscle.ends[e].holds.empty()) continue;
        const bool is_told = !muscle.options.attach_to.empty(); // what it touches else was not asked for
        std::string message =
            place_of(muscle.ends[e]) + (is_told ? " is attached to nothing" : " reaches no bone and no muscle");
        if (nearest[e] && !is_told)
            message += ": " + rig.parts[nearest[e]->bone].name +
                       (others[e] ? ", the nearest other one that could hold it, is "
                                  : ", the nearest that could hold it, is ") +
                       rough(nearest[e]->gap) + " away";
        // Where attachTo says what is held, no reach adds to it.
        const std::string hint =
            is_told ? "If it shall, name a bone for each end: " + attach + "."
            : is_near(nearest[e])
                ? "If it shall: " + setting(rig, muscle, "reach=" + rough(reach)) + ", or " + attach + "."
                : "Is it in the bones' pose, unit and place? If it shall hold on over such a gap: " + attach + ".";
        rig.notes.push_back(say(Severity::warning, "DG155", rig.parts[muscle.part].name, message, hint));
    }
}

/// What helps an end with too few vertices within reach of what it holds on to.
std::string hint_of_few(const Rig& rig, const Muscle& muscle, std::size_t end, const std::vector<Surface>& surfaces) {
    const Hold& hold = muscle.ends[end].holds.front();
    const double enough = away_from(part_of_end(rig, muscle, end), hold.target, surfaces[hold.target], 1e300).enough;
    // Over a gap, paint ends a reach beyond it, as long as the gap is wider than the reach.
    const double beyond = reach_for(std::max(enough - hold.gap, 0.0));
    const bool is_beyond = hold.inner > muscle.reach && beyond < hold.gap;
    const double reach = is_beyond ? beyond : reach_for(enough);
    if (!(reach > muscle.reach && reach <= longest_reach * muscle.shape.length))
        return "Give the muscle's mesh more vertices there, or move it to where it touches.";
    const std::string larger = "a larger reach: " + setting(rig, muscle, "reach=" + rough(reach));
    return muscle.options.attach_to.empty()
               ? "If it shall hold it, " + larger + "; if another, " + setting(rig, muscle, "attachTo=BONE,BONE") + "."
               : "What helps is " + larger + ".";
}

void tell(Rig& rig, const Muscle& muscle, const std::vector<Surface>& surfaces) {
    const std::string& name = rig.parts[muscle.part].name;
    if (!muscle.is_tendon) tell_loose_ends(rig, muscle, surfaces); // muscles hold on to a tendon's loose end
    for (std::size_t e = 0; e < 2; ++e) {
        const End& end = muscle.ends[e];
        const std::string where = place_of(end);
        if (end.holds.empty()) continue;
        const Hold& hold = end.holds.front();
        if (hold.by_faces)
            rig.notes.push_back(say(Severity::warning, "DG155", name,
                                    where + " touches " + rig.parts[hold.target].name +
                                        " between its vertices, of which the nearest are " + rough(hold.gap) +
                                        " away; those are attached to it",
                                    "Give the muscle's mesh vertices where it is attached, which then hold it alone."));
        else if (hold.gap > muscle.reach)
            rig.notes.push_back(say(Severity::warning, "DG155", name,
                                    where + " does not touch anything; it is attached to " +
                                        rig.parts[hold.target].name + " over a gap of " + rough(hold.gap),
                                    "Look at it, and move the mesh if it should touch."));
        if (hold.points < fewest)
            rig.notes.push_back(say(Severity::warning, "DG155", name,
                                    where + " has only " + std::to_string(hold.points) +
                                        (hold.points == 1 ? " vertex" : " vertices") + " within reach of " +
                                        rig.parts[hold.target].name,
                                    hint_of_few(rig, muscle, e, surfaces)));
    }
}

} // namespace

double tip_radius(const Muscle& muscle) { return 0.1 * muscle.shape.length; }

MaskSphere sphere_of(Mask mask, std::size_t end, const Muscle& muscle) {
    const double apart = (muscle.ends[0].tip - muscle.ends[1].tip).norm();
    // A point with weights above 0.5 of both far_half masks would be nearer to both tips than half of their distance.
    if (mask == Mask::far_half) return {end, 0.4 * apart, 0.15 * apart, false};
    return {1 - end, 0.25 * apart, 0.15 * apart, true};
}

std::vector<std::size_t> painted(const Muscle& muscle, std::size_t end, const Hold& hold, const Part& part,
                                 const std::vector<double>& to_target) {
    std::vector<std::size_t> out;
    for (std::size_t v = 0; v < to_target.size(); ++v) {
        double weight = fall(to_target[v], hold.inner, hold.outer);
        if (hold.mask != Mask::none) {
            const MaskSphere s = sphere_of(hold.mask, end, muscle);
            const double in_sphere =
                fall((part.points[v] - muscle.ends[s.tip].tip).norm(), s.radius, s.radius + s.falloff);
            weight *= s.is_inverted ? 1 - in_sphere : in_sphere;
        }
        if (weight > 0.5) out.push_back(v);
    }
    return out;
}

void find_reach(Rig& rig, AllDistances& all, const std::vector<Surface>& surfaces, OneBone one_bone) {
    std::vector<BothEnds> seen;
    for (std::size_t m = 0; m < rig.muscles.size(); ++m) {
        Muscle& muscle = rig.muscles[m];
        for (std::size_t e = 0; e < 2; ++e)
            muscle.ends[e].tip = rig.parts[muscle.part].points[static_cast<std::size_t>(muscle.shape.tips[e])];
        seen.push_back({candidates(muscle, 0, all[m]), candidates(muscle, 1, all[m])});
    }
    for (std::size_t m = 0; m < rig.muscles.size(); ++m) {
        Muscle& muscle = rig.muscles[m];
        const bool is_said = !muscle.options.attach_to.empty();
        Chosen chosen = is_said ? wanted(rig, muscle, seen[m]) : best_bones(seen[m], rig.parts);
        for (std::size_t e = 0; e < 2; ++e) {
            const std::vector<Candidate>& here = seen[m][e];
            // Muscles hold on to tendons, not tendons to muscles.
            if (!chosen[e] && !is_said && !muscle.is_tendon) chosen[e] = best_muscle(here, rig);
            End& end = muscle.ends[e];
            if (!chosen[e] && !is_said && !muscle.is_tendon)
                if (const auto hold = held_by_faces(rig, muscle, e, all[m], surfaces))
                    chosen[e] = hold->target, end.holds.push_back(*hold);
            if (!chosen[e] && !is_said && !muscle.is_tendon) {
                const auto bone = nearest_bone(here, rig, most_gaps * muscle.reach);
                if (bone && bone != chosen[1 - e]) chosen[e] = bone;
            }
            if (chosen[e] && end.holds.empty())
                end.holds.push_back(hold_on(muscle, here[*chosen[e]], all[m][*chosen[e]]));
            const double top = best_score(here, rig.parts, Kind::bone);
            for (const Candidate& c : here) {
                const bool is_taken = c.part == chosen[0] || c.part == chosen[1];
                if (is_taken || !(c.score > 0)) continue;
                if (rig.parts[c.part].kind == Kind::bone && c.score > as_near * top) end.also_near.push_back(c.part);
                const Muscle* const other = rig.muscle_of(c.part);
                if (other && other->is_tendon && !muscle.is_tendon && !is_said)
                    end.holds.push_back(hold_on(muscle, c, all[m][c.part]));
            }
        }
        settle_masks(muscle, rig.parts[muscle.part], all[m]);
        tell(rig, muscle, surfaces);
        if (one_bone != OneBone::is_right && !is_said)
            tell_one_bone(rig, muscle, chosen, seen[m],
                          one_bone == OneBone::is_odd ? far_away : hardly_missed * muscle.reach);
    }
}

} // namespace sinew::rig
