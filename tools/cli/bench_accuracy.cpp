// `sinew bench accuracy`.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/accuracy.h"
#include "tools/cli/bench_common.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace sinew::cli {

ExitCode bench_accuracy(const Invocation& in) {
    const bench::RunOptions options = run_options(in);
    const std::vector<bench::CaseResult> results = bench::run_accuracy(options);
    if (results.empty()) throw UsageError("--only: no accuracy case has '" + options.filter + "' in its name.");
    print_result(in, "accuracy", bench::accuracy_table(results), bench::accuracy_json(results),
                 bench::accuracy_summary(results));
    const bool failed =
        std::any_of(results.begin(), results.end(), [](const auto& r) { return r.status == bench::CaseStatus::fail; });
    return failed ? solve_failed : done;
}

} // namespace sinew::cli
