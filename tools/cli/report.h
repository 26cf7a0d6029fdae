// The machine-readable report of a run (--report) and its summary for people.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/diagnostics.h"
#include "nodes/values.h"

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace sinew::cli {

struct FrameReport {
    int frame = 0;
    bool reused = false; ///< nothing was simulated for it
    double wall_s = 0;
    std::optional<solver::StepRecord> step;    ///< none where no solver is involved
    nodes::WorstPlaces worst = {};             ///< in the first of the solvers; `step` is of all
    int inverted_here = 0;                     ///< tets of that solver
    bool is_deep = false;                      ///< a solver left bodies deep in each other
    std::vector<nodes::LineReport> lines = {}; ///< of action
};

/// Why a run ended before its last frame.
struct RunError {
    int frame = 0; ///< the one that could not be had
    std::string code, node, message;
};

/// What nodes of one type cost in a run: each compute counts, look-ups do not. Of simulations what makes the outputs of
/// a frame, not the steps.
struct NodeCost {
    int count = 0;
    double seconds = 0;
};

struct RunReport {
    std::string graph;
    int threads = 0, frames_simulated = 0;
    double wall_s = 0;
    double setup_s = 0; ///< of wall_s: meshes, tets and everything else before the first frame
    std::size_t memory_bytes = 0, kept_bytes = 0; ///< the budget for results, and the most that it held at once
    std::size_t made_again = 0;                   ///< results that it had no room for
    std::vector<FrameReport> frames;
    std::map<std::string, NodeCost> computed; ///< by node type
    std::vector<engine::Diagnostic> warnings; ///< of the graph, each once; of single frames the frames tell
    std::optional<RunError> error;
    std::optional<nodes::SolveReport> size;                   ///< of the last frame
    std::vector<std::string> bodies, attachments;             ///< nodes in the order of the solver's lists
    std::set<std::string> inverted_elsewhere, deep_elsewhere; ///< other solvers whose converged frames have such
    int unconverged() const;
    int inverted() const; ///< frames that have converged with inverted tets
    int deep() const;     ///< frames that have converged with bodies deep in each other
    int reused() const;   ///< frames that were there already, in memory or on disk
};

/// JSON.
std::string report_json(const RunReport& report);
/// "128 frames in 41.2 s, 322 ms a frame: …", several lines.
std::string summary(const RunReport& report);
/// "3 frames have not converged, 1 converged with inverted tets": what makes a run useless to who looks at no picture.
/// Empty if nothing does.
std::string faults_text(const RunReport& report);
/// "0:07", "12:34", "1:02:03".
std::string clock_text(double seconds);

} // namespace sinew::cli
