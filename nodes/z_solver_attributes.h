// The attributes of zSolver, in the order artists see them; read by z_solver.cpp and solver_setup.cpp.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/attribute.h"
#include "nodes/limits.h"
#include "nodes/options.h"
#include "nodes/values.h"

namespace sinew::nodes::z_solver {

using namespace engine;

inline const WireList<Body> bodies{
    .name = "bodies",
    .doc = "The bones, tissues and cloths of the simulation; outMeshes follows this order.",
    .min_count = 1,
    .aside_when = "collisionDetection",
};
inline const WireList<Attachment> attachments{
    .name = "attachments",
    .doc = "The attachments between them.",
};
inline const WireList<Force> forces{
    .name = "forces",
    .doc = "Further forces: fields, holds and whatever else acts on bodies.",
};
inline const Input<bool> enable{
    .name = "enable",
    .def = true,
    .doc = "Off simulates nothing: tissues stay as modelled.",
    .keyable = false,
};
inline const Input<double> start_frame{
    .name = "startFrame",
    .def = 1,
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "The frame at which everything is as modelled and at rest; attachments take their places there. An earlier "
           "one than the graph's first frame lets the tissues settle before it.",
    .keyable = false,
    .from_timing = FromTiming::start,
};
inline const Input<Vec3> translate{
    .name = "translate",
    .limits = within_reach,
    .doc = "Moves the space that the simulation runs in, in scene units. Only how it moves from the start frame on "
           "counts: what bones do together with it is felt by nothing, as on a train at full speed. Gravity and fields "
           "are given in this space and turn along with it; results come out where the scene is.",
};
inline const Input<Vec3> rotate{
    .name = "rotate",
    .unit = "deg",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Turns that space about x, then y, then z; see translate.",
};
inline const Input<double> scale{
    .name = "scale",
    .def = 100,
    .limits = {.min = 1e-12, .max = 1e12},
    .doc = "Scene units per metre: 100 reads the scene as centimetres, 1 as metres. Keyed, it scales the space that "
           "the simulation runs in, as translate moves it.",
    .presets = {{"m", 1},
                {"dm", 10},
                {"cm", 100},
                {"mm", 1000},
                {"in", 1 / 0.0254},
                {"inch", 1 / 0.0254},
                {"ft", 1 / 0.3048},
                {"foot", 1 / 0.3048}},
};
inline const Input<Matrix4> matrix{
    .name = "matrix",
    .def = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
    .limits = {.min = -1e60, .max = 1e60},
    .doc = "Moves that space too, after translate, rotate and scale: connect the transform.outMatrix that carries "
           "the bones. Translations, turns and even scales only.",
};
inline const Input<double> runup_weight{
    .name = "runupWeight",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1e6},
    .doc = "Multiplies the channels whose affect switch is on. Keyed from 0 to 1 over some frames before the shot, it "
           "lets them set in slowly.",
};
inline const Input<bool> affect_gravity{
    .name = "affectSolverGravity",
    .def = true,
    .doc = "Whether runupWeight multiplies gravity.",
};
inline const Input<bool> affect_inertial_damping{
    .name = "affectInertialDamping",
    .def = false,
    .doc = "Whether runupWeight multiplies inertialDamping of tissues and cloths. Off lets it calm the run-up itself.",
};
inline const Input<bool> affect_pressure{
    .name = "affectPressureEnvelope",
    .def = true,
    .doc = "Whether runupWeight multiplies pressureEnvelope of all bodies.",
};
inline const Input<bool> affect_surface_tension{
    .name = "affectSurfaceTensionEnvelope",
    .def = true,
    .doc = "Whether runupWeight multiplies surfaceTensionEnvelope of all bodies.",
};
inline const Input<bool> affect_rest_scale{
    .name = "affectRestScaleEnvelope",
    .def = true,
    .doc = "Whether runupWeight multiplies restScaleEnvelope of all bodies.",
};
inline const Input<bool> affect_excitation{
    .name = "affectFiberExcitation",
    .def = true,
    .doc = "Whether runupWeight multiplies the excitation of all fibres.",
};
inline const Input<std::string> integrator{
    .name = "integrator",
    .def = std::string(word_of(solver::Integrator::backward_euler)),
    .doc = "How time is stepped. BackwardEuler is the most robust and damps the most; BDF2 and, more so, TR-BDF2 keep "
           "swings alive and are accurate to second order, TR-BDF2 at twice the cost a step. QuasiStatic has no "
           "momentum: it finds the shape at rest for each frame, so every tissue must be tied to a bone or "
           "held by zHold. May be keyed.",
    .options = words(options_of<solver::Integrator>),
};
inline const Input<std::string> linear_solver{
    .name = "solver",
    .def = std::string(word_of(solver::LinearMethod::automatic)),
    .doc = "How the linear systems are solved. Direct factorises each; Iterative takes conjugate gradients with "
           "multigrid; Auto "
           "iterates and goes to the factorisation for a while where counted cost says that it is cheaper. Plain "
           "factorises all "
           "bodies together, as the library comes: the yardstick of `sinew bench scene`, never the faster choice.",
    .options = words(options_of<solver::LinearMethod>),
};
inline const Input<double> frames_per_second{
    .name = "framesPerSecond",
    .def = 24,
    .unit = "1/s",
    .limits = {.min = 0.001, .max = 1e6},
    .doc = "How many frames make a second of simulation.",
    .from_timing = FromTiming::fps,
};
inline const Input<std::int64_t> substeps{
    .name = "substeps",
    .def = 1,
    .limits = {.min = 1, .max = 10000},
    .doc = "Steps per frame; bones and keyed values are read at the end of each, by TR-BDF2 also in between. More for "
           "fast motion.",
};
inline const Input<std::int64_t> max_newton_iterations{
    .name = "maxNewtonIterations",
    .def = 10,
    .limits = {.min = 1, .max = 100000},
    .doc = "Upper bound of Newton iterations per solve; a step stops earlier when it has converged, and one that has "
           "not is "
           "reported. A step is one solve, two with TR-BDF2, and one more for each tenfold tightening where "
           "volumeConservation "
           "holds it up.",
};
inline const Input<std::int64_t> step_halvings{
    .name = "stepHalvings",
    .def = 3,
    .limits = {.min = 0, .max = 10},
    .doc = "How often a step that has not converged is taken again as two steps of half the size, and those again. "
           "The report counts it.",
};
inline const Input<double> tolerance_factor{
    .name = "solverToleranceFactor",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1e5, .open_min = true},
    .doc = "Multiplies the tolerance of 1e-6 on the residual relative to the forces at work; below 1 is stricter.",
};
inline const Input<double> stiffness_damping{
    .name = "stiffnessDamping",
    .def = 0.001,
    .unit = "s",
    .limits = {.min = 0, .max = 1e6},
    .doc = "Damps fast wobble: a viscosity of this times the stiffness, on the rate of strain. Turning is not braked.",
};
inline const Input<double> mass_damping{
    .name = "massDamping",
    .def = 0,
    .unit = "1/s",
    .limits = {.min = 0, .max = 1e9},
    .doc = "Damps all motion, as under water (Rayleigh); normally 0.",
};
inline const Input<Vec3> gravity{
    .name = "gravity",
    .def = {0, -9.8, 0},
    .unit = "m/s^2",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Gravity; always in metres, whatever the scale.",
};

inline const Input<bool> collision_detection{
    .name = "collisionDetection",
    .def = false,
    .doc = "The master switch: on, bodies whose surfaces meet push each other apart, see their collisions, "
           "collisionVolume, contactSliding, contactStiffness, contactFriction and collisionSets. What is inside of "
           "another body at the start frame, or where it is switched on, is pushed out through the nearest place. May "
           "be keyed: a frame at which it is off costs nothing of it, and attributes of contact then change nothing.",
};
inline const Input<bool> collision_subdivision{
    .name = "collisionSubdivision",
    .def = false,
    .doc = "On tests points between vertices too, so that edges do not pass each other.",
    .keyable = false,
    .when = "collisionDetection",
};
inline const Input<double> collision_point_spacing{
    .name = "collisionPointSpacing",
    .def = 0.1,
    .unit = "m",
    .limits = {.min = 0, .max = 1e60, .open_min = true},
    .doc = "With collisionSubdivision, the largest distance between points that are tested along an edge; in metres, "
           "whatever the scale.",
    .keyable = false,
    .when = "collisionDetection",
};
inline const Input<double> max_contact_length{
    .name = "maxContactLength",
    .def = 0,
    .unit = "m",
    .limits = {.min = 0, .max = 1e60},
    .doc = "A contact that is deeper as a step begins is dropped, and what it held falls through if nothing else holds "
           "it; "
           "within a step points may press in deeper. 0 keeps all. In metres, whatever the scale.",
    .when = "collisionDetection",
};
inline const Input<double> contact_damping{
    .name = "contactDamping",
    .def = 0,
    .unit = "N*s/m^3",
    .limits = {.min = 0, .max = 1e13},
    .doc = "Brakes how fast contacts open and close, as pressure per speed; in fixed contacts all relative motion.",
    .when = "collisionDetection",
};

} // namespace sinew::nodes::z_solver
