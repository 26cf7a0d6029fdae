// Graphs of bodies that touch, frame after frame: what a frame takes, how deep bodies get into each other, what drifts
// that should stay, and what falls through; beside times of another engine on the same scenes.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/graph.h"
#include "tools/bench/run_options.h"
#include "tools/bench/table.h"

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sinew::bench {

/// What runs: frames `first` + 1 to `last` of a zSolver.
struct ContactScene {
    std::shared_ptr<const engine::Graph> graph;
    std::string solver;
    int first = 0, last = 0;
    double units_per_metre = 1;
    char up = 'y';                   ///< 'y' or 'z'
    std::vector<std::string> bodies; ///< names of zSolver.bodies, in their order
    double longest_s = 180;          ///< no further frame after so long
};

struct ContactRow {
    std::string scene; ///< the graph file's name without folder and ending
    std::int64_t tets = 0, unknowns = 0;
    int frames = 0;                                                ///< that ran
    double median_s = 0, mean_s = 0, longest_s = 0;                ///< a frame, all of its evaluation [s]
    double assembly_s = 0, factor_s = 0, solve_s = 0, other_s = 0; ///< the solver's, means a frame [s]
    double newton = 0, linear = 0, factors = 0;                    ///< means a frame
    int newton_most = 0, unconverged = 0, halvings = 0;
    int contacts = 0;   ///< most at one frame
    double depth_m = 0; ///< deepest of all frames
    int inverted = 0;   ///< most at one frame
    double least_j = 1;
    /// Of scenes with cloth, else nothing: most edges that go through faces at one frame, of cloth with cloth, itself
    /// or bones, and its largest stretch of all frames [%].
    std::optional<int> crossings;
    std::optional<double> stretch_percent;
    /// Farthest way across of what should stay where it is [m]; nothing for other scenes. `drift_m`: of a body's centre
    /// of mass; of a body that stands on another, of its lowest vertices against what they stand on. `centre_m`: of the
    /// centre, against that of the one below if it stands on one; what leans without slipping moves it too.
    std::optional<double> drift_m, centre_m;
    std::vector<std::string> fallen; ///< tissues whose centre of mass ended below all bones
    std::string ended;               ///< empty: it ran to the end; else why it did not, with the code of an error
    /// Median of the other engine [s] as recorded, its Newton iterations, and ours over its time scaled to this
    /// machine.
    std::optional<double> peer_s, peer_newton, ratio;
    std::optional<double> cantilever_s; ///< a step of the yardstick, mean of before and after the scene
    /// Whether it ran to the end, converged, and nothing is inside out, fell through or crosses.
    bool is_sound() const {
        return ended.empty() && unconverged == 0 && inverted == 0 && fallen.empty() && crossings.value_or(0) == 0;
    }
};

/// Runs on the calling thread's TBB arena. Where the other engine's time is known, and not in a quick run, a cantilever
/// of 24,000 tets is measured before and after, to tell how fast the machine is just then. Errors of the graph and of
/// the solver end the row, they are not thrown. Throws engine::Cancelled.
ContactRow run_contact_scene(const ContactScene& scene, const RunOptions& options);

Table contact_table(const std::vector<ContactRow>& rows);
nlohmann::ordered_json contact_json(const std::vector<ContactRow>& rows);
/// What the columns need to be said beside them, and what is wrong with which scene.
std::string contact_summary(const std::vector<ContactRow>& rows);

} // namespace sinew::bench
