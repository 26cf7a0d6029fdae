// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/units.h"

#include "tools/rig/graph_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace sinew::rig {

using engine::Severity;

namespace {

struct BoneLength {
    const char* word;
    double metres; ///< the longest side of its box's diagonal, as bones lie in any direction
};
/// Of grown people, to a few centimetres.
constexpr BoneLength bone_lengths[] = {
    {"femur", 0.45},   {"tibia", 0.38},   {"fibula", 0.37},   {"humerus", 0.32},  {"ulna", 0.26},
    {"radius", 0.24},  {"scapula", 0.18}, {"clavicle", 0.15}, {"hand", 0.19},     {"foot", 0.25},
    {"skull", 0.24},   {"cranium", 0.22}, {"mandible", 0.14}, {"pelvis", 0.32},   {"sacrum", 0.13},
    {"sternum", 0.18}, {"ribcage", 0.45}, {"spine", 0.6},     {"patella", 0.055}, {"calcaneus", 0.08},
};

constexpr std::array guessed_units = {"mm", "cm", "m"};
/// Which meshes are in, too, but so seldom that they are no guess.
constexpr std::array other_units = {"in", "ft", "dm"};

/// By such a factor a bone may differ from one of its name; where no name is known, the longest mesh from half a metre.
constexpr double most_known = 2.5, most_unknown = 4;
/// A unit fits about as well as the guessed one if it is off by at most so much more; where no name is known, by so
/// much less.
constexpr double as_well_known = 1.25, as_well_unknown = 1 / 1.5;

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

std::string in_metres(double metres) {
    return metres < 0.01 ? rough(1000 * metres) + " mm"
           : metres < 1  ? rough(100 * metres) + " cm"
                         : rough(metres) + " m";
}

std::string in_words(const std::string& unit) { return unit == "in" ? "inches" : unit == "ft" ? "feet" : unit; }

double size_of(const Part& part) { return part.box.size().norm(); }

solver::Box joined(const solver::Box& a, const solver::Box& b) {
    return {a.min.cwiseMin(b.min), a.max.cwiseMax(b.max)};
}

/// How far `inner` is outside of `outer`, by the larger of their diagonals; 0 if they touch.
double apart(const solver::Box& inner, const solver::Box& outer) {
    const solver::Vec3 gap = (outer.min - inner.max).cwiseMax(inner.min - outer.max).cwiseMax(0.0);
    return gap.norm() / std::max(inner.size().norm(), outer.size().norm());
}

solver::Box scaled(const solver::Box& box, double factor) { return {box.min * factor, box.max * factor}; }

/// The mean over all bones whose names tell something of log(their size / what it should be in metres), and the name
/// of the longest of them; nothing if there is none.
struct Known {
    double log_ratio = 0;
    std::string part;
    double size = 0;
};
std::optional<Known> by_names(const std::vector<Part>& parts) {
    Known out;
    int count = 0;
    for (const Part& part : parts) {
        if (part.kind != Kind::bone) continue;
        const std::string stem = lower(part.stem);
        const auto* const known = std::find_if(std::begin(bone_lengths), std::end(bone_lengths),
                                               [&](const BoneLength& b) { return stem.find(b.word) != stem.npos; });
        if (known == std::end(bone_lengths)) continue;
        out.log_ratio += std::log(size_of(part) / known->metres);
        ++count;
        if (size_of(part) > out.size) out.size = size_of(part), out.part = part.name;
    }
    if (count == 0) return {};
    out.log_ratio /= count;
    return out;
}

/// The same without names: the largest mesh counts as half a metre.
std::pair<double, std::string> by_sizes(const std::vector<Part>& parts, const std::optional<Known>& known) {
    if (known) return {known->log_ratio, known->part};
    const Part& longest = *std::max_element(parts.begin(), parts.end(),
                                            [](const Part& a, const Part& b) { return size_of(a) < size_of(b); });
    return {std::log(size_of(longest) / 0.5), longest.name};
}

/// By how much the parts are off in a unit: the log of a factor.
double off_by(double log_ratio, const char* unit) { return std::abs(log_ratio - std::log(unit_of(unit)->per_metre)); }

/// "in inches 37 cm" of the units in which they are off by less than this, joined by "or".
struct Fitting {
    std::string lengths, flags;
};
template <std::size_t n>
Fitting fitting(const std::array<const char*, n>& units, double log_ratio, double most, double size) {
    Fitting out;
    for (const char* name : units) {
        if (!(off_by(log_ratio, name) <= most)) continue;
        out.lengths +=
            (out.lengths.empty() ? "in " : ", in ") + in_words(name) + " " + in_metres(size / unit_of(name)->per_metre);
        out.flags += (out.flags.empty() ? "--unit " : " or --unit ") + std::string(name);
    }
    return out;
}

/// By the larger one's size: so far apart may boxes of one body be.
constexpr double is_near = 0.25;

/// By how much a mesh that lies apart would have to be scaled to lie among the others; 1: by nothing.
double missing_factor(const Part& part, const solver::Box& others) {
    const double ratio = size_of(part) / others.size().norm();
    const bool is_there = apart(part.box, others) < is_near;
    if (is_there && ratio < 4 && ratio > 2e-3) return 1;
    for (const double factor : {0.1, 0.01, 0.001, 10.0, 100.0, 1000.0}) {
        const solver::Box other = scaled(part.box, factor);
        if (apart(other, others) < 0.05 && factor * ratio < 3 && factor * ratio > 0.02) return factor;
    }
    return 1;
}

} // namespace

std::optional<Unit> unit_of(const std::string& word) {
    const std::string name = lower(word);
    constexpr std::pair<const char*, double> units[] = {{"mm", 1000}, {"cm", 100},        {"dm", 10},
                                                        {"m", 1},     {"in", 1 / 0.0254}, {"ft", 1 / 0.3048}};
    for (const auto& [known, per_metre] : units)
        if (name == known) return Unit{known, per_metre, "as --unit says"};
    return {};
}

Unit guess_unit(const std::vector<Part>& parts) {
    const auto known = by_names(parts);
    const auto [log_ratio, which] = by_sizes(parts, known);
    const double most = std::log(known ? most_known : most_unknown);
    const Part& part = *std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.name == which; });
    Unit best;
    double least = 1e300;
    for (const char* name : guessed_units) {
        Unit unit = unit_of(name).value();
        const double off = off_by(log_ratio, name);
        if (off < least) least = off, best = unit;
    }
    if (!(least <= most)) {
        const Fitting other = fitting(other_units, log_ratio, most, size_of(part));
        throw engine::Failure(say(Severity::error, "DG151", part.name,
                                  "the unit cannot be told: " + part.name + " is " + rough(size_of(part)) +
                                      " units long, which is neither in mm nor in cm nor in m the size of " +
                                      (known ? "such a bone" : "a part of a body") +
                                      (other.lengths.empty() ? "" : ", but is " + other.lengths),
                                  other.flags.empty() ? "Say it: --unit mm, cm, dm, m, in or ft."
                                                      : "Say it: " + other.flags + ", if that is meant."));
    }
    best.how_known = "guessed: " + part.name + " is " + rough(size_of(part)) + " units long, in " + best.name + " " +
                     in_metres(size_of(part) / best.per_metre) +
                     (known ? "" : "; no bone has a name that tells its size, so this is a weak guess");
    return best;
}

std::optional<engine::Diagnostic> doubt_of_guess(const std::vector<Part>& parts, const Unit& guessed) {
    const auto known = by_names(parts);
    const auto [log_ratio, which] = by_sizes(parts, known);
    const double most = off_by(log_ratio, guessed.name.c_str()) + std::log(known ? as_well_known : as_well_unknown);
    const Part& part = *std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.name == which; });
    const Fitting other = fitting(other_units, log_ratio, most, size_of(part));
    if (other.lengths.empty()) return {};
    return say(Severity::warning, "DG179", part.name,
               "the unit is not sure: it is " + rough(size_of(part)) + " units long, in " + guessed.name +
                   ", as was guessed, " + in_metres(size_of(part) / guessed.per_metre) + ", and " + other.lengths +
                   ", which fits " + (known ? "such bones" : "a part of a body") + " as well or better",
               "Say it: " + other.flags + ", or --unit " + guessed.name + " if the guess is right.");
}

std::optional<engine::Diagnostic> doubt_of_unit(const std::vector<Part>& parts, const Unit& unit) {
    const auto known = by_names(parts);
    const auto [log_ratio, which] = by_sizes(parts, known);
    // Children, small animals and giants are as they are; without names anything from a finger to an elephant.
    const double factor = std::exp(std::abs(log_ratio - std::log(unit.per_metre)));
    if (factor < (known ? 5 : 25)) return {};
    const Part& part = *std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.name == which; });
    std::string better;
    for (const char* name : guessed_units)
        if (std::abs(log_ratio - std::log(unit_of(name)->per_metre)) < std::log(2.5))
            better = "in " + std::string(name) + " it would be " + in_metres(size_of(part) / unit_of(name)->per_metre);
    return say(Severity::warning, "DG176", part.name,
               "it is " + rough(size_of(part)) + " units long, which in " + unit.name + ", as --unit says, is " +
                   in_metres(size_of(part) / unit.per_metre) + (better.empty() ? "" : "; " + better),
               "Give the unit that the meshes are in, or leave --unit away, which guesses it.");
}

std::vector<engine::Diagnostic> check_same_space(const std::vector<Part>& parts, bool is_unit_said) {
    std::vector<engine::Diagnostic> wrong;
    for (const Part& part : parts) {
        std::optional<solver::Box> others;
        for (const Part& other : parts)
            if (&other != &part) others = others ? joined(*others, other.box) : other.box;
        if (!others) return {};
        // One stray mesh must not make the others look like strays: it is judged by those of the other kind, too.
        std::optional<solver::Box> kind;
        for (const Part& other : parts)
            if (&other != &part && other.kind != part.kind) kind = kind ? joined(*kind, other.box) : other.box;
        const double factor = missing_factor(part, kind.value_or(*others));
        if (factor == 1 || missing_factor(part, *others) == 1) continue;
        const bool is_there = apart(part.box, *others) < is_near;
        const double ratio = size_of(part) / others->size().norm();
        wrong.push_back(
            say(is_unit_said ? Severity::warning : Severity::error, "DG152", part.name,
                "'" + part.file + "' " +
                    (is_there ? "is " + (ratio > 1 ? rough(ratio) + " times" : rough(100 * ratio) + " %") +
                                    (ratio > 1 ? " as large as the other meshes together" : " of the others' size") +
                                    ", among which it would be "
                              : "lies away from the other meshes, among which it would be ") +
                    (factor > 1 ? rough(factor) + " times larger" : rough(1 / factor) + " times smaller") +
                    (is_there ? ", too" : "") + ": it seems to be in another unit",
                is_unit_said ? "If it is in another unit than --unit says, save all meshes in one unit and one space."
                             : "Save all meshes in one unit and one space; or say which one they all are in: --unit."));
    }
    if (!wrong.empty() && !is_unit_said) throw engine::Failure(std::move(wrong));

    std::optional<solver::Box> bones, muscles;
    for (const Part& part : parts) {
        std::optional<solver::Box>& all = part.kind == Kind::bone ? bones : muscles;
        all = all ? joined(*all, part.box) : part.box;
    }
    if (!bones || !muscles || apart(*muscles, *bones) < is_near) return wrong;
    for (int axis = 0; axis < 3; ++axis) {
        solver::Box mirrored = *muscles;
        mirrored.min[axis] = -muscles->max[axis];
        mirrored.max[axis] = -muscles->min[axis];
        if (apart(mirrored, *bones) > 0) continue;
        throw engine::Failure(say(Severity::error, "DG157", "",
                                  std::string("the muscles are not where the bones are, but would be if they were "
                                              "mirrored along ") +
                                      "xyz"[axis] + ": one folder seems to be of the other side of the body",
                                  "Take bones and muscles of the same side."));
    }
    throw engine::Failure(say(Severity::error, "DG157", "",
                              "the muscles are not where the bones are: their boxes are " +
                                  rough(apart(*muscles, *bones)) + " times their size apart",
                              "Save all meshes in one unit and one space."));
}

std::optional<engine::Diagnostic> doubt_of_scale(const std::vector<Part>& parts) {
    std::optional<solver::Box> bones, muscles;
    const Part* first = nullptr;
    for (const Part& part : parts) {
        std::optional<solver::Box>& all = part.kind == Kind::bone ? bones : muscles;
        all = all ? joined(*all, part.box) : part.box;
        if (part.kind != Kind::bone && !first) first = &part;
    }
    if (!bones || !muscles) return {};
    constexpr double tiny = 0.12; // of the bones: a muscle goes from one to another
    const double ratio = muscles->size().norm() / bones->size().norm();
    if (!(ratio < tiny)) return {};
    for (const double factor : {10.0, 100.0, 1000.0})
        if (const double then = factor * ratio;
            then > 0.2 && then < 2 && apart(scaled(*muscles, factor), *bones) < 0.05)
            return say(Severity::warning, "DG152", first->name,
                       "the muscles are " + rough(100 * ratio) +
                           " % as large as the bones, among which they would be " + rough(factor) +
                           " times larger, too: they seem to be in another unit",
                       "Save all meshes in one unit and one space.");
    return {};
}

Up guess_up(const std::vector<Part>& parts) {
    solver::Box all = parts.front().box;
    for (const Part& part : parts) all = joined(all, part.box);
    const double size = all.size().maxCoeff();
    const auto is_above = [&](int axis) { return all.min[axis] > 0.2 * size; };
    if (is_above(2) && !is_above(1)) return {'z', "guessed: all meshes lie above 0 along z, but not along y"};
    return {'y', is_above(1) && !is_above(2) ? "guessed: all meshes lie above 0 along y, but not along z"
                                             : "assumed: the meshes do not tell"};
}

} // namespace sinew::rig
