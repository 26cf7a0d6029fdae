// A rig guessed from meshes: what holds on to what, how fine, of what. Everything that the graph's text is written
// from.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/closest_point.h"
#include "tools/rig/muscle_shape.h"
#include "tools/rig/overrides.h"
#include "tools/rig/parts.h"
#include "tools/rig/units.h"

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <vector>

namespace sinew::rig {

constexpr double far_away = std::numeric_limits<double>::infinity();

/// Which part of a muscle an attachment leaves out, so that its two ends stay apart.
enum class Mask {
    none,
    far_third, ///< what is near the other tip
    far_half,  ///< all that is not near this tip
};

/// Where an end holds on: paint by nearness to `target`.
struct Hold {
    std::size_t target = 0; ///< of Rig::parts
    double gap = 0;         ///< smallest distance to it
    double inner = 0, outer = 0;
    Mask mask = Mask::none;
    std::size_t points = 0; ///< vertices of the muscle with a weight above 0.5
    bool by_faces = false;  ///< it touches between the muscle's vertices, the nearest of which are `gap` away
};

struct End {
    solver::Vec3 tip = solver::Vec3::Zero();
    std::vector<Hold> holds;              ///< the first is what the end reaches, the others are tendons that it touches
    std::vector<std::size_t> also_near;   ///< bones that it touches, too, but does not hold on to
    std::vector<std::size_t> fibre_start; ///< vertices at which the fibres start or end
    bool fibres_by_tip = false;           ///< those are around the tip, else those of the first hold
};

struct Muscle {
    std::size_t part = 0;
    MuscleOptions options;
    MuscleShape shape;
    std::array<End, 2> ends;
    bool is_tendon = false; ///< no fibres; muscles hold on to it
    double reach = 0;       ///< what counts as touching, in scene units
    double tet_size = 0;
    bool is_held() const { return !ends[0].holds.empty() || !ends[1].holds.empty(); }
};

/// Two bodies that touch, neither holding on to the other.
struct Touch {
    std::size_t source = 0, target = 0; ///< of Rig::parts; the source is a muscle
    double share = 0;                   ///< of the source's surface
    double inner = 0, outer = 0;
    bool slides = false;
};

struct GuessOptions {
    std::string unit; ///< empty: guessed
    std::string up;   ///< "y", "z" or empty
    double tet_scale = 1;
    std::string overlaps = "tie";
    std::vector<Override> overrides;
    bool is_one_muscle = false; ///< of `new muscle`
    engine::FileAccess files;   ///< what may be read
    std::function<bool()> stop;
};

struct Rig {
    std::vector<Part> parts;
    std::vector<Muscle> muscles;
    std::vector<Touch> touches;
    Unit unit;
    Up up;
    std::vector<engine::Diagnostic> notes;
    const Muscle* muscle_of(std::size_t part) const;
};

/// Says what is wrong with them before any mesh is read: std::invalid_argument.
void check_options(const GuessOptions& options);
/// Sets the unit and the way up, as they are given or guessed. Notes: DG152, DG176, DG179. Throws engine::Failure
/// DG151, DG152, DG157; std::invalid_argument for options.
void set_space(Rig& rig, const GuessOptions& options);

/// A part that distances are measured to.
struct Surface {
    explicit Surface(const Part& part);
    solver::SurfaceTree tree;
    solver::Box box;
    bool has_inside = false;
};
/// Of each vertex of `from`: to the surface of `to`, 0 inside of it where it is closed; far_away beyond `most`.
std::vector<double> distances(const Part& from, const Surface& to, double most);

/// Vertices with weights above 0.5, by the same rules as the nodes of the graph have.
std::vector<std::size_t> painted(const Muscle& muscle, std::size_t end, const Hold& hold, const Part& part,
                                 const std::vector<double>& to_target);
/// The weights of a mask are those of a sphere around a tip with this radius and falloff, by the tips' distance.
struct MaskSphere {
    std::size_t tip = 0;
    double radius = 0, falloff = 0;
    bool is_inverted = false;
};
MaskSphere sphere_of(Mask mask, std::size_t end, const Muscle& muscle);
/// Of the sphere around a tip at which fibres start that nothing holds.
double tip_radius(const Muscle& muscle);

/// The whole of it. Throws engine::Failure: what read_parts does, DG151, DG152, DG156 for no muscles or no bones,
/// DG157, DG158 for muscles of which none reaches a bone, FE210 for tet sizes that zTet refuses; std::invalid_argument
/// for options; solver::Stopped.
Rig guess_rig(const std::vector<std::string>& bones, const std::vector<std::string>& muscles,
              const GuessOptions& options);

} // namespace sinew::rig
