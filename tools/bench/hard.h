// The hard cases under every law, element and integrator: what recovers, what stops and says so, what is wrong.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/hard_cases.h"
#include "tools/bench/run_options.h"
#include "tools/bench/table.h"

#include <nlohmann/json_fwd.hpp>

namespace sinew::bench {

struct HardResult {
    const HardCase* of = nullptr;
    HardSetting setting;
    Outcome outcome = Outcome::wrong;
    std::string why; ///< the code of what stopped it, or what is wrong; empty where it recovered
    int steps = 0, unconverged = 0, halvings = 0, newton = 0;
    double seconds = 0;
};

/// One case under one setting. Throws solver::Stopped.
HardResult run_case(const HardCase& c, const HardSetting& setting, const std::stop_token& stop);
/// Runs side by side on the threads that are allowed. Throws solver::Stopped.
std::vector<HardResult> run_hard(const RunOptions& options);

/// A row a case and variant, a count an outcome.
Table hard_overview(const std::vector<HardResult>& results);
/// A row a case, variant, element and law; a column an integrator.
Table hard_table(const std::vector<HardResult>& results);
/// What went wrong, and how.
Table hard_faults(const std::vector<HardResult>& results);
std::string hard_summary(const std::vector<HardResult>& results);
nlohmann::ordered_json hard_json(const std::vector<HardResult>& results);

} // namespace sinew::bench
