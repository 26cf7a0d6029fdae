// `sinew bench report`: runs everything and writes the page.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/report.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/bench_common.h"
#include "tools/cli/json_text.h"
#include "tools/cli/machine.h"
#include "tools/cli/writable_folder.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>

namespace sinew::cli {

ExitCode bench_report(const Invocation& in) {
    const auto output = in.arguments.value("--output");
    if (!output) throw UsageError("report needs --output PAGE.md.");
    const std::filesystem::path page = *output;
    if (page.extension() != ".md")
        throw UsageError("--output of report needs a file that ends in .md, not '" + *output + "'.");
    const std::filesystem::path images = page.parent_path() / "images";
    check_writable(images, "--output");
    const double load = load_average();
    bench::Report report = bench::run_all(run_options(in));
    for (const std::string& file : in.arguments.operands_from(1)) report.scenes.push_back(measure_scene(in, file));
    for (const std::string& file : in.arguments.operands_from(1))
        for (bench::SceneBench& rig : measure_rig(in, file)) report.rigs.push_back(std::move(rig));
    report.date = today(), report.machine = machine_name(), report.version = SINEW_VERSION;
    report.load_before = load, report.load_after = load_average(), report.threads = thread_count(in);
    for (const bench::Picture& p : bench::report_pictures(report)) write_file(images / p.file, p.svg);
    write_file(page, bench::report_page(report, "images"));
    if (in.arguments.has("--json")) {
        nlohmann::ordered_json line = provenance("report");
        line["accuracy"] = bench::accuracy_json(report.accuracy);
        line["convergence"] = bench::convergence_json(report.convergence);
        line["work_precision"] = bench::work_precision_json(report.work_precision);
        line["locking"] = bench::locking_json(report.locking);
        line["hard"] = bench::hard_json(report.hard);
        line["levers"] = bench::levers_json(report.levers);
        line["scaling"] = bench::scaling_json(report.scaling);
        line["idle_cost"] = bench::idle_cost_json(report.idle_cost);
        for (const bench::SceneBench& s : report.scenes) line["scenes"].push_back(bench::scene_json(s));
        for (const bench::SceneBench& s : report.rigs) line["rigs"].push_back(bench::scene_json(s));
        in.out << json_text(line) << std::endl;
    } else {
        in.out << "wrote " << page.string() << ": " << bench::accuracy_summary(report.accuracy) << std::endl;
    }
    return done;
}

} // namespace sinew::cli
