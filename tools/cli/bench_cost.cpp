// `sinew bench scaling` and `sinew bench idle-cost`.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/idle_cost.h"
#include "tools/bench/scaling.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/bench_common.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

ExitCode bench_scaling(const Invocation& in) {
    const bench::ScalingResult r = bench::run_scaling(run_options(in));
    if (!in.arguments.has("--json"))
        in.out << bench::as_text(bench::limits_table(r)) << "\n" << bench::as_text(bench::factor_table(r)) << "\n";
    print_result(in, "scaling", bench::scaling_table(r), bench::scaling_json(r),
                 "memory per tet is the growth of the resident set while the scene is simulated");
    if (const auto folder = in.arguments.value("--output"))
        write_file(std::filesystem::path(*folder) / "scaling.svg", bench::draw(bench::scaling_plot(r)));
    return done;
}

ExitCode bench_idle_cost(const Invocation& in) {
    const bench::RunOptions options = run_options(in);
    const bench::IdleCost r = bench::run_idle_cost(options);
    if (r.rows.empty()) throw UsageError("--only: there is no feature with '" + options.filter + "' in its name.");
    print_result(in, "idle-cost", bench::idle_cost_table(r), bench::idle_cost_json(r),
                 "two runs without any feature differ by " + bench::number(100 * r.noise_level, 2) + " %");
    return done;
}

} // namespace sinew::cli
