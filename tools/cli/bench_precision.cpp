// `sinew bench convergence` and `sinew bench work-precision`.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/convergence.h"
#include "tools/bench/locking.h"
#include "tools/bench/work_precision.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/bench_common.h"
#include "tools/cli/json_text.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

ExitCode bench_convergence(const Invocation& in) {
    const bench::RunOptions options = run_options(in);
    const auto folder = output_folder(in);
    const auto rows = bench::run_convergence(options);
    if (rows.empty()) throw UsageError("--only: no convergence case has '" + options.filter + "' in its name.");
    print_result(in, "convergence", bench::convergence_table(rows), bench::convergence_json(rows),
                 std::to_string(rows.size()) + " orders");
    if (folder)
        for (const bool in_time : {false, true})
            write_file(*folder / (in_time ? "convergence_time.svg" : "convergence_mesh.svg"),
                       bench::draw(bench::convergence_plot(rows, in_time)));
    return done;
}

ExitCode bench_work_precision(const Invocation& in) {
    const bench::RunOptions options = run_options(in);
    const auto folder = output_folder(in);
    const auto points = bench::run_work_precision(options);
    const auto locking = bench::run_locking(options);
    if (points.empty() && locking.empty())
        throw UsageError("--only: there is no sweep and no problem with '" + options.filter + "' in its name.");
    if (!in.arguments.has("--json") && !locking.empty())
        in.out << bench::as_text(bench::locking_table(locking)) << "\n";
    const nlohmann::ordered_json extra = {{"locking", bench::locking_json(locking)}};
    print_result(in, "work-precision", bench::work_precision_table(points), bench::work_precision_json(points),
                 std::to_string(points.size()) + " runs of the released bar, " + std::to_string(locking.size()) +
                     " of nearly incompressible bodies",
                 &extra);
    if (folder) {
        const auto write = [&](const std::string& name, const nlohmann::ordered_json& rows,
                               const std::vector<bench::NamedPlot>& plots) {
            if (rows.empty()) return;
            write_file(*folder / (name + ".csv"), bench::as_csv(rows));
            write_file(*folder / (name + ".json"), json_text(rows, 1) + "\n");
            for (const bench::NamedPlot& p : plots) write_file(*folder / (p.name + ".svg"), bench::draw(p.plot));
        };
        write("work_precision", bench::work_precision_json(points), bench::work_precision_plots(points));
        write("work_precision_locking", bench::locking_json(locking), bench::locking_plots(locking));
    }
    return done;
}

} // namespace sinew::cli
