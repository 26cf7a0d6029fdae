// Problems that are solved on finer and finer meshes: the accuracy benchmark compares each mesh with another code's
// value on the same mesh and the finest with the continuum; the convergence benchmark gives the orders.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/beams.h"
#include "tools/bench/run_options.h"

#include <map>
#include <string>
#include <vector>

namespace sinew::bench {

struct MeshLevel {
    int nx = 0, ny = 0, nz = 0; ///< cells
    double h = 0;               ///< side of a cell along the bar [m]
    bool quick = true;          ///< small enough for quick runs
    std::string name() const;   ///< "16x4x4"
};

struct Quantity {
    std::string name;                          ///< with its unit
    double continuum = 0, continuum_error = 0; ///< what refinement leads to and how well that is known; NaN = not known
    std::vector<double> same_mesh;             ///< per level; NaN where no other code gave it
};

struct MeshStudy {
    std::string section, name, setting;
    std::vector<Quantity> quantities;
    std::vector<MeshLevel> levels; ///< coarse to fine
    /// The quantities on one mesh.
    std::function<std::vector<double>(const MeshLevel&, const std::stop_token&, Work&)> run;
    bool may_lock = false; ///< see in_locking_range
};

struct LevelValues {
    MeshLevel level;
    std::vector<double> values;
    Work work;
};

/// Small-strain, gravity and twisted beams, Cook's panel, free vibration; every law that has reference values.
std::vector<MeshStudy> mesh_studies();
/// Cook's panel in the log neo-Hookean law at this Poisson's ratio: ux and uy of its upper corner.
MeshStudy cook_study(const std::string& poissons_ratio, solver::ElementKind element);
inline constexpr double cook_modulus = 1e5, gravity_modulus = 1e6; ///< Young's, of the catalogue [Pa]
/// How far the upper corner of Cook's panel moves under its load [m].
solver::Vec3 cook_corner(const MeshLevel& mesh, solver::ElasticLaw law, solver::ElementKind element,
                         solver::TissueInputs values, const std::stop_token& stop, Work& work);
/// How far the middle of the free end of the gravity cantilever (0.8 x 0.1 x 0.1 m, held at x = 0) moves [m].
solver::Vec3 gravity_tip(const MeshLevel& mesh, solver::ElasticLaw law, solver::ElementKind element,
                         const solver::TissueInputs& values, const std::stop_token& stop, Work& work);

/// What ran already, by name and setting.
struct StudyMemory {
    std::map<std::string, std::vector<LevelValues>> levels;
};

/// Runs the levels that the options ask for, or takes them from the options' memory.
std::vector<LevelValues> run_study(const MeshStudy& study, const RunOptions& options);

/// The lowest `count` natural frequencies [Hz] of a tissue at rest, from its own stiffness and mass.
std::vector<double> natural_frequencies(const solver::TissueRest& rest, const solver::TissueInputs& values, int count);

} // namespace sinew::bench
