// `sinew bench scaling`, `sinew bench levers` and `sinew bench idle-cost`.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/idle_cost.h"
#include "tools/bench/levers.h"
#include "tools/bench/scaling.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/bench_common.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

ExitCode bench_scaling(const Invocation& in) {
    const bench::RunOptions options = run_options(in);
    const auto folder = output_folder(in);
    const bench::ScalingResult r = bench::run_scaling(options);
    if (r.limits.empty() && r.contact.empty())
        throw UsageError("--only: scaling has no part with '" + options.filter +
                         "' in its name; its parts are cantilever, factor and contact.");
    if (!in.arguments.has("--json")) {
        if (!r.limits.empty()) in.out << bench::as_text(bench::limits_table(r)) << "\n";
        if (!r.contact.empty()) in.out << bench::as_text(bench::contact_growth_table(r.contact)) << "\n";
        if (!r.factors.empty()) in.out << bench::as_text(bench::factor_table(r)) << "\n";
    }
    print_result(in, "scaling", bench::scaling_table(r), bench::scaling_json(r),
                 r.rows.empty() ? "medians of 5"
                                : "memory per tet is the growth of the resident set while the scene is simulated");
    if (folder) write_file(*folder / "scaling.svg", bench::draw(bench::scaling_plot(r)));
    return done;
}

ExitCode bench_levers(const Invocation& in) {
    const bench::RunOptions options = run_options(in);
    const auto levers = bench::run_levers(options);
    if (levers.empty()) throw UsageError("--only: there is no lever with '" + options.filter + "' in its name.");
    print_result(in, "levers", bench::levers_table(levers), bench::levers_json(levers),
                 std::to_string(levers.size()) + " levers; built for " + bench::vector_instructions());
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
