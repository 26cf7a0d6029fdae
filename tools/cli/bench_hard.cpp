// `sinew bench hard`.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/hard.h"
#include "tools/cli/bench_common.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

ExitCode bench_hard(const Invocation& in) {
    const bench::RunOptions options = run_options(in);
    const std::vector<bench::HardResult> results = bench::run_hard(options);
    if (results.empty()) throw UsageError("--only: no hard case has '" + options.filter + "' in its name.");
    const bench::Table faults = bench::hard_faults(results);
    if (!in.arguments.has("--json")) {
        in.out << bench::as_text(bench::hard_table(results)) << "\n";
        if (!faults.rows.empty()) in.out << bench::as_text(faults) << "\n";
    }
    print_result(in, "hard", bench::hard_overview(results), bench::hard_json(results), bench::hard_summary(results));
    return faults.rows.empty() ? done : solve_failed;
}

} // namespace sinew::cli
