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
    std::string name; ///< with its unit
    double continuum = 0, continuum_error = 0; ///< what refinement leads to and how well that is known; NaN = not known
    std::vector<double> same_mesh;             ///< per level; NaN where no other code gave it
};

struct MeshStudy {
    std::string section, name, setting;
    std::vector<Quantity> quantities;
    std::vector<MeshLevel> levels; ///< coarse to fine
    /// The quantities on one mesh.
    std::function<std::vector<double>(const MeshLevel&, const std::stop_token&, Work&)> run;
};

struct LevelValues {
    MeshLevel level;
    std::vector<double> values;
    Work work;
};

/// Small-strain, gravity and twisted beams, Cook's panel, free vibration; every law that has reference values.
std::vector<MeshStudy> mesh_studies();
/// What ran already, by name and setting.
struct StudyMemory {
    std::map<std::string, std::vector<LevelValues>> levels;
};

/// Runs the levels that the options ask for, or takes them from the options' memory.
std::vector<LevelValues> run_study(const MeshStudy& study, const RunOptions& options);

/// The lowest `count` natural frequencies [Hz] of a tissue at rest, from its own stiffness and mass.
std::vector<double> natural_frequencies(const solver::TissueRest& rest, const solver::TissueInputs& values, int count);

} // namespace sinew::bench
