// `sinew bench graphs`.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/graph_scale.h"
#include "tools/cli/bench_common.h"

#include <nlohmann/json.hpp>

namespace sinew::cli {

ExitCode bench_graphs(const Invocation& in) {
    const bench::RunOptions options = run_options(in);
    const bench::GraphScale r = bench::run_graph_scale(options);
    if (r.rows.empty())
        throw UsageError("--only: graphs has no shape with '" + options.filter +
                         "' in its name; its shapes are chain, wide and included.");
    print_result(in, "graphs", bench::graph_scale_table(r), bench::graph_scale_json(r),
                 "goal: 10,000 nodes load in 1 s and plan in 50 ms; frame: every value is computed anew");
    return done;
}

} // namespace sinew::cli
