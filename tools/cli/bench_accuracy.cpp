// `sinew bench accuracy`.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/accuracy.h"
#include "tools/cli/bench_common.h"

#include <nlohmann/json.hpp>

namespace sinew::cli {

ExitCode bench_accuracy(const Invocation& in) {
    const bench::RunOptions options = run_options(in);
    const std::vector<bench::CaseResult> results = bench::run_accuracy(options);
    if (results.empty()) throw UsageError("--only: no accuracy case has '" + options.filter + "' in its name.");
    print_result(in, "accuracy", bench::accuracy_table(results), bench::accuracy_json(results),
                 bench::accuracy_summary(results));
    return done;
}

} // namespace sinew::cli
