// `sinew bench meshing`.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/meshing.h"
#include "tools/cli/bench_common.h"
#include "tools/cli/json_text.h"
#include "tools/cli/machine.h"

#include <nlohmann/json.hpp>
#include <ostream>
#include <tbb/task_arena.h>

namespace sinew::cli {

ExitCode bench_meshing(const Invocation& in) {
    const int threads = thread_count(in);
    const std::vector<std::string> paths = in.arguments.operands_from(1);
    if (paths.empty()) throw UsageError("meshing needs mesh files, or folders with mesh files in them.");
    const bool as_json = in.arguments.has("--json");
    const std::vector<double> parts = in.arguments.numbers("--parts", {20});
    for (const double p : parts)
        if (!(p > 0) || !(p <= 10000)) throw UsageError("--parts needs numbers above 0, up to 10000.");
    const int refine = in.arguments.whole_number("--refine", 0, 0);
    if (!as_json) in.out << bench::meshing_table_head();
    tbb::task_arena arena(threads);
    for (const std::string& file : bench::mesh_files_under(paths))
        for (const double p : parts)
            for (const solver::Fill fill : bench::all_fills) {
                bench::MeshingResult r;
                arena.execute([&] { r = bench::run_meshing(file, fill, p, refine, in.stop); });
                if (!as_json) {
                    in.out << bench::as_table_row(r) << std::flush;
                    continue;
                }
                nlohmann::ordered_json line = bench::as_json(r);
                line["threads"] = threads;
                line["machine"] = machine_name();
                line["version"] = SINEW_VERSION;
                in.out << json_text(line) << std::endl;
            }
    return done;
}

} // namespace sinew::cli
