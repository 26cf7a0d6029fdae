// What each choice that makes the solver fast gives: the same simulation without it and with it, in turns of one run,
// as a ratio of times. Choices that change the result say by how much.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/run_options.h"
#include "tools/bench/table.h"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace sinew::bench {

/// One end of a lever.
struct LeverEnd {
    std::string choice; ///< "Plain", "1 thread"
    double seconds = 0; ///< median over the turns
    double newton = 0;  ///< iterations a step
    double value = 0;   ///< displacement of the free end [m]
    double error = 0;   ///< of it, relative to the continuum; NaN where another mesh is no part of the lever
    bool converged = true;
    std::string digest; ///< of the last positions; empty where they are not asked for
};

struct Lever {
    std::string name;    ///< "linear method"
    std::string subject; ///< "cantilever, 24000 tets"
    std::string of;      ///< what the seconds are of: "a step", "the solution"
    LeverEnd without, with;
    double ratio = 1;           ///< time without / time with, median over the turns
    double least = 1, most = 1; ///< range of the ratio
    int turns = 0;
};

/// The options' filter picks levers by name. Throws solver::Error and solver::Stopped.
std::vector<Lever> run_levers(const RunOptions& options);

Table levers_table(const std::vector<Lever>& levers);
nlohmann::ordered_json levers_json(const std::vector<Lever>& levers);
/// The vector instructions that this program was built for: "AVX2".
std::string vector_instructions();

} // namespace sinew::bench
