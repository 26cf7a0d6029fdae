// The benchmark page: a section a benchmark, each with its tables, its pictures, the machine and the day. A section
// can be measured anew while the others stay.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/elements.h"
#include "tools/bench/run_options.h"
#include "tools/bench/scene.h"

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::bench {

struct Picture {
    std::string file; ///< "bench_scaling.svg"
    std::string svg;
};

struct Section {
    std::string title; ///< "Hard cases"
    std::string text;  ///< Markdown without the title; pictures are in the folder images beside the page
    std::vector<Picture> pictures;
    nlohmann::ordered_json results; ///< members of the line that --json prints
};

/// Names of the sections, in the order of the page: accuracy, convergence, hard, work-precision, levers, cantilever,
/// scene, rigs, elements, scaling, idle-cost.
const std::vector<std::string>& section_names();
/// Where a section of this title stands among them.
std::size_t place_of(std::string_view title);
/// Measures one of those but scene, rigs and elements, which need graphs. Throws solver::Stopped.
Section measure_section(const std::string& name, const RunOptions& options);
Section scene_section(const SceneBench& scene);
Section rigs_section(const std::vector<SceneBench>& rigs);
Section elements_section(const ElementBench& curve);

/// When and where a section was measured.
struct Provenance {
    std::string date, machine, version;
    double load_before = 0, load_after = 0; ///< processes that ran or waited, means over a minute
    int threads = 1;
    bool quick = false;
};

/// The page with this section at its place, instead of what stood there under its title. An empty page gets its head.
std::string with_section(const std::string& page, const Section& section, const Provenance& measured);

} // namespace sinew::bench
