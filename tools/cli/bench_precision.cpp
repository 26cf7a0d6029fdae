// `sinew bench convergence` and `sinew bench work-precision`.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/convergence.h"
#include "tools/bench/work_precision.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/bench_common.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

ExitCode bench_convergence(const Invocation& in) {
    const bench::RunOptions options = run_options(in);
    const auto rows = bench::run_convergence(options);
    if (rows.empty()) throw UsageError("--only: no convergence case has '" + options.filter + "' in its name.");
    print_result(in, "convergence", bench::convergence_table(rows), bench::convergence_json(rows),
                 std::to_string(rows.size()) + " orders");
    if (const auto folder = in.arguments.value("--output"))
        for (const bool in_time : {false, true})
            write_file(std::filesystem::path(*folder) / (in_time ? "convergence_time.svg" : "convergence_mesh.svg"),
                       bench::draw(bench::convergence_plot(rows, in_time)));
    return done;
}

ExitCode bench_work_precision(const Invocation& in) {
    const bench::RunOptions options = run_options(in);
    const auto points = bench::run_work_precision(options);
    if (points.empty())
        throw UsageError("--only: there is no sweep with '" + options.filter + "' in its name.");
    print_result(in, "work-precision", bench::work_precision_table(points), bench::work_precision_json(points),
                 std::to_string(points.size()) + " runs");
    if (const auto folder = in.arguments.value("--output")) {
        const std::filesystem::path path = *folder;
        write_file(path / "work_precision.csv", bench::work_precision_csv(points));
        write_file(path / "work_precision.json", bench::work_precision_json(points).dump(1) + "\n");
        for (const bench::NamedPlot& p : bench::work_precision_plots(points)) write_file(path / (p.name + ".svg"), bench::draw(p.plot));
    }
    return done;
}

} // namespace sinew::cli
