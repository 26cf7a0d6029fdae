// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/tet_limits.h"

#include "solver/error.h"
#include "solver/meshing/lattice.h"

namespace sinew::rig {

using engine::Severity;

std::optional<engine::Diagnostic> refused_tets(const std::string& name, const solver::Points& points,
                                               const std::vector<solver::Triangle>& triangles, double tet_size,
                                               const std::string& option, const std::function<bool()>& stop) {
    solver::LatticeOptions lattice;
    lattice.tet_size = tet_size;
    const double along = solver::bounding_box(points).size().maxCoeff() / tet_size;
    // Too many are counted before they are made, and of those that are too large there are few.
    constexpr double few = 3;
    if (along > few && along <= lattice.max_resolution) return {};
    try {
        solver::make_lattice(points, triangles, lattice, {.stop = stop, .progress = {}});
    } catch (const solver::Error& e) {
        if (e.code == "FE210" || e.code == "FE222")
            return say(Severity::error, "FE210", name, e.what(),
                       along > few ? "Choose a larger one by " + option + ", or leave that away."
                                   : e.hint + ", by " + option + ", or leave that away");
    }
    return {};
}

void check_tets(const Rig& rig, const GuessOptions& options) {
    std::vector<engine::Diagnostic> wrong;
    for (const Muscle& m : rig.muscles) {
        if (!m.options.tet_size && options.tet_scale == 1) continue;
        const Part& part = rig.parts[m.part];
        const std::string option = m.options.tet_size ? "--set '" + part.name + ":tetSize=…'" : "--tet-scale";
        if (auto said = refused_tets(part.name, part.points, part.triangles, m.tet_size, option, options.stop))
            wrong.push_back(std::move(*said));
    }
    if (!wrong.empty()) throw engine::Failure(std::move(wrong));
}

} // namespace sinew::rig
