// The benchmark page: every benchmark's tables and pictures with the machine and the day they were made on.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/accuracy.h"
#include "tools/bench/cantilever.h"
#include "tools/bench/convergence.h"
#include "tools/bench/hard.h"
#include "tools/bench/idle_cost.h"
#include "tools/bench/levers.h"
#include "tools/bench/locking.h"
#include "tools/bench/scaling.h"
#include "tools/bench/scene.h"
#include "tools/bench/work_precision.h"

namespace sinew::bench {

struct Report {
    std::string date, machine, version;
    double load_before = 0, load_after = 0; ///< processes that ran or waited, means over a minute
    int threads = 1;
    bool quick = false;
    std::vector<CaseResult> accuracy;
    std::vector<ConvergenceRow> convergence;
    std::vector<WorkPoint> work_precision;
    std::vector<LockingPoint> locking;
    std::vector<CantileverRun> cantilever;
    std::vector<Lever> levers;
    ScalingResult scaling;
    IdleCost idle_cost;
    std::vector<HardResult> hard;
    std::vector<SceneBench> scenes, rigs; ///< as they are; with other tets
};

struct Picture {
    std::string file; ///< "bench_scaling.svg"
    std::string svg;
};

/// Runs every benchmark but scenes and rigs; those, date, machine, version and loads are the caller's to fill in.
Report run_all(const RunOptions& options);
std::vector<Picture> report_pictures(const Report& report);
/// Markdown; `images` is the folder of the pictures as seen from the page.
std::string report_page(const Report& report, const std::string& images);

} // namespace sinew::bench
