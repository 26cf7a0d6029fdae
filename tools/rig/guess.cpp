// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/guess.h"

#include "tools/rig/kinds.h"

#include "solver/error.h"
#include "solver/parallel.h"
#include "tools/rig/loose_pieces.h"
#include "tools/rig/reach.h"
#include "tools/rig/tet_limits.h"
#include "tools/rig/wrap.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

namespace sinew::rig {

using engine::Severity;

namespace {

constexpr double reach_share = 0.012; ///< of the muscles' median length
constexpr double tets_in_thickness = 0.7;
constexpr double least_touching = 0.01; ///< of a muscle's surface: below, two bodies do not count as touching

bool says_tendon(const Part& part) {
    std::string name = part.stem;
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    for (const char* word : {"tendon", "aponeuros", "ligament", "retinacul"})
        if (name.find(word) != name.npos) return true;
    return false;
}

/// Whether an end of a muscle holds on to this part.
bool holds(const Muscle& muscle, std::size_t part) {
    return std::any_of(muscle.ends.begin(), muscle.ends.end(), [&](const End& end) {
        return std::any_of(end.holds.begin(), end.holds.end(), [&](const Hold& h) { return h.target == part; });
    });
}

double round_to_2_digits(double value) {
    const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
    return std::round(value / unit) * unit;
}

/// The share of a muscle's surface that is within reach of another part.
double touching_share(const Muscle& muscle, const std::vector<double>& to) {
    double near = 0, all = 0;
    for (std::size_t v = 0; v < to.size(); ++v) {
        all += muscle.shape.areas[v];
        if (to[v] <= muscle.reach) near += muscle.shape.areas[v];
    }
    return near / all;
}

void find_touches(Rig& rig, const AllDistances& all, const std::string& usual) {
    const auto way = [&](const Muscle& m) { return m.options.overlaps.empty() ? usual : m.options.overlaps; };
    const auto volume = [&](const Muscle& m) {
        const Part& p = rig.parts[m.part];
        return std::abs(solver::enclosed_volume(p.points, p.triangles));
    };
    for (std::size_t m = 0; m < rig.muscles.size(); ++m)
        for (std::size_t p = 0; p < rig.parts.size(); ++p) {
            const Muscle& muscle = rig.muscles[m];
            if (p == muscle.part || holds(muscle, p) || way(muscle) == "none") continue;
            const Muscle* const other = rig.muscle_of(p);
            // Each pair of muscles once: the smaller one is painted.
            const auto size = [&](const Muscle& of) { return std::pair(volume(of), of.part); };
            if (other && (holds(*other, muscle.part) || way(*other) == "none" || size(*other) < size(muscle))) continue;
            const double share = touching_share(muscle, all[m][p]);
            if (share < least_touching) continue;
            const bool slides = way(muscle) == "slide" || (other && way(*other) == "slide");
            rig.touches.push_back({muscle.part, p, share, muscle.reach, 4 * muscle.reach, slides});
        }
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<long>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void set_sizes(Rig& rig, const GuessOptions& options) {
    std::vector<double> lengths, thicknesses;
    for (const Muscle& m : rig.muscles) {
        lengths.push_back(m.shape.length);
        thicknesses.push_back(m.shape.thickness);
    }
    const double usual_reach = reach_share * median(lengths), usual_thickness = median(thicknesses);
    for (Muscle& m : rig.muscles) {
        m.reach = m.options.reach.value_or(round_to_2_digits(usual_reach));
        // Half way between what suits the muscle and one size for all: thin ones would cost more than all others. At
        // least three cubes along the length, and no more than sixty.
        const double guess = std::clamp(tets_in_thickness * std::sqrt(m.shape.thickness * usual_thickness),
                                        m.shape.length / 60, m.shape.length / 3);
        m.tet_size = m.options.tet_size.value_or(round_to_2_digits(guess * options.tet_scale));
    }
}

void check_kinds(const Rig& rig) {
    const auto has = [&](Kind kind) {
        return std::any_of(rig.parts.begin(), rig.parts.end(), [&](const Part& p) { return p.kind == kind; });
    };
    if (!has(Kind::bone))
        throw engine::Failure(say(Severity::error, "DG156", "", "there is no bone, so nothing would hold the muscles",
                                  "Name a folder with meshes of bones first."));
    if (!has(Kind::muscle))
        throw engine::Failure(say(Severity::error, "DG156", "", "there is no muscle",
                                  "Name a folder with meshes of muscles after that of the bones."));
}

} // namespace

const Muscle* Rig::muscle_of(std::size_t part) const {
    for (const Muscle& m : muscles)
        if (m.part == part) return &m;
    return nullptr;
}

Surface::Surface(const Part& part)
    : tree(part.points, part.triangles)
    , box(part.box)
    , has_inside(solver::is_closed(part.triangles)) {}

std::vector<double> distances(const Part& from, const Surface& to, double most) {
    std::vector<double> out(from.points.size(), far_away);
    const solver::Vec3 gap = (to.box.min - from.box.max).cwiseMax(from.box.min - to.box.max).cwiseMax(0.0);
    if (gap.norm() > most) return out;
    solver::parallel_for(from.points.size(), 64, [&](std::size_t v) {
        const solver::Vec3& p = from.points[v];
        const solver::Vec3 off = (to.box.min - p).cwiseMax(p - to.box.max).cwiseMax(0.0);
        if (off.norm() > most) return;
        if (to.has_inside && off.isZero() && to.tree.inside(p)) {
            out[v] = 0;
            return;
        }
        const solver::ClosestPoint c = to.tree.closest(p, most);
        if (c.triangle >= 0) out[v] = c.distance;
    });
    return out;
}

namespace {

Unit unit_said(const GuessOptions& options) {
    if (const auto unit = unit_of(options.unit)) return *unit;
    throw std::invalid_argument("--unit " + options.unit + ": mm, cm, dm, m, in or ft is meant.");
}

} // namespace

void check_options(const GuessOptions& options) {
    if (!options.unit.empty()) unit_said(options);
    options_of(Part(), options.overrides);
}

void set_space(Rig& rig, const GuessOptions& options) {
    std::vector<engine::Diagnostic> strays = check_same_space(rig.parts, !options.unit.empty());
    if (auto doubt = doubt_of_scale(rig.parts); doubt && strays.empty()) strays.push_back(std::move(*doubt));
    for (engine::Diagnostic& stray : strays) rig.notes.push_back(std::move(stray));
    if (options.unit.empty()) {
        rig.unit = guess_unit(rig.parts);
        if (auto doubt = doubt_of_guess(rig.parts, rig.unit)) rig.notes.push_back(std::move(*doubt));
    } else {
        rig.unit = unit_said(options);
        if (auto doubt = doubt_of_unit(rig.parts, rig.unit)) rig.notes.push_back(std::move(*doubt));
    }
    rig.up = options.up.empty() ? guess_up(rig.parts) : Up{options.up[0], "as --up says"};
}

Rig guess_rig(const std::vector<std::string>& bones, const std::vector<std::string>& muscles,
              const GuessOptions& options) {
    Rig rig;
    const auto [bone_files, muscle_files] = mesh_files(options.files, bones, muscles, rig.notes);
    rig.parts = read_parts(options.files, bone_files, muscle_files, rig.notes);
    check_kinds(rig);
    auto doubt = doubt_of_kinds(rig.parts, options.is_one_muscle);
    // Two bones that are named for one muscle are meant both. What the ends reach of parts that are mixed up is nothing
    // to speak of.
    const bool has_two_bones = options.is_one_muscle && rig.parts.size() == 3;
    const OneBone one_bone = doubt ? OneBone::is_right : has_two_bones ? OneBone::is_odd : OneBone::is_odd_if_near;
    if (doubt) rig.notes.push_back(std::move(*doubt));
    if (const auto pattern = unmatched(options.overrides, rig.parts))
        throw std::invalid_argument("--set " + *pattern + ":…: no muscle has such a name.");
    set_space(rig, options);
    wrap_open(rig.parts, rig.notes, options.stop);

    for (std::size_t p = 0; p < rig.parts.size(); ++p) {
        if (rig.parts[p].kind != Kind::muscle) continue;
        Muscle m;
        m.part = p;
        m.options = options_of(rig.parts[p], options.overrides);
        m.is_tendon = m.options.preset.empty() ? says_tendon(rig.parts[p]) : m.options.preset == "tendon";
        m.shape = measure_muscle(rig.parts[p].points, rig.parts[p].triangles);
        rig.muscles.push_back(std::move(m));
        if (options.stop && options.stop()) throw solver::Stopped();
    }
    set_sizes(rig, options);
    check_tets(rig, options);
    std::vector<Surface> surfaces;
    for (const Part& part : rig.parts) surfaces.emplace_back(part);
    AllDistances all;
    for (const Muscle& m : rig.muscles) {
        all.emplace_back();
        for (std::size_t p = 0; p < rig.parts.size(); ++p) {
            const std::vector<double> none(rig.parts[m.part].points.size(), far_away);
            const bool is_near = m.options.attach_to.empty() && !has_two_bones;
            const double most = is_near ? 6 * m.reach : 1e300;
            all.back().push_back(p == m.part ? none : distances(rig.parts[m.part], surfaces[p], most));
        }
        if (options.stop && options.stop()) throw solver::Stopped();
    }
    find_reach(rig, all, surfaces, one_bone);
    if (std::none_of(rig.muscles.begin(), rig.muscles.end(), [](const Muscle& m) { return m.is_held(); }))
        throw engine::Failure(say(Severity::error, "DG158", "", "no muscle reaches any bone",
                                  "Bones and muscles must be modelled in one pose, unit and space; --set '*:reach=…' "
                                  "bridges gaps."));
    find_touches(rig, all, options.overlaps);
    for (const Muscle& m : rig.muscles)
        if (!m.is_held())
            rig.notes.push_back(
                say(Severity::warning, "DG158", rig.parts[m.part].name,
                    "nothing holds it, so it would fall; it is written with enable false",
                    "Say what it is attached to: --set '" + rig.parts[m.part].name + ":attachTo=BONE,BONE'."));
    doubt_loose_pieces(rig, all);
    return rig;
}

} // namespace sinew::rig
