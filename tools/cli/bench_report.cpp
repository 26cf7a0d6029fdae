// `sinew bench report`: runs everything, or what --only names, and writes the page.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/report.h"
#include "tools/bench/studies.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/bench_common.h"
#include "tools/cli/json_text.h"
#include "tools/cli/machine.h"
#include "tools/cli/writable_folder.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <sstream>
#include <utility>

namespace sinew::cli {

namespace {

/// The page as it is; empty if there is none.
std::string page_now(const std::filesystem::path& page) {
    std::ostringstream out;
    if (std::ifstream in(page, std::ios::binary); in) out << in.rdbuf();
    return out.str();
}

std::vector<bench::Section> measure(const Invocation& in, const std::string& name, const bench::RunOptions& options) {
    const std::vector<std::string> files = in.arguments.operands_from(1);
    std::vector<bench::Section> out;
    if (name == "scene") {
        for (const std::string& file : files) out.push_back(bench::scene_section(measure_scene(in, file)));
    } else if (name == "rigs") {
        std::vector<bench::SceneBench> rigs;
        for (const std::string& file : files)
            for (bench::SceneBench& rig : measure_rig(in, file)) rigs.push_back(std::move(rig));
        if (!rigs.empty()) out.push_back(bench::rigs_section(rigs));
    } else if (name == "elements") {
        for (const std::string& file : files) out.push_back(bench::elements_section(measure_curve(in, file)));
    } else {
        out.push_back(bench::measure_section(name, options));
    }
    return out;
}

} // namespace

ExitCode bench_report(const Invocation& in) {
    const auto output = in.arguments.value("--output");
    if (!output) throw UsageError("report needs --output PAGE.md.");
    const std::filesystem::path page = *output;
    if (page.extension() != ".md")
        throw UsageError("--output of report needs a file that ends in .md, not '" + *output + "'.");
    const std::vector<std::string> wanted = words(in, "--only", bench::section_names(), bench::section_names());
    const bool some = in.arguments.value("--only").has_value();
    for (const std::string& name : wanted)
        if (some && in.arguments.operands_from(1).empty() && (name == "scene" || name == "rigs" || name == "elements"))
            throw UsageError("report --only " + name + " needs graph files.");
    const std::filesystem::path images = page.parent_path() / "images";
    check_writable(images, "--output");
    bench::RunOptions options = run_options(in);
    options.filter.clear();
    options.memory = std::make_shared<bench::StudyMemory>();
    nlohmann::ordered_json line = provenance("report");
    // Written after each section: hours of measuring are not lost to an interrupt in the last of them.
    std::string text = some ? page_now(page) : "";
    for (const std::string& name : wanted) {
        const double load = load_average();
        for (const bench::Section& section : measure(in, name, options)) {
            for (const bench::Picture& p : section.pictures) write_file(images / p.file, p.svg);
            text = bench::with_section(
                text, section,
                {today(), machine_name(), SINEW_VERSION, load, load_average(), thread_count(in), options.quick});
            write_file(page, text);
            for (const auto& [member, rows] : section.results.items()) {
                if (member == "scene")
                    line["scenes"].push_back(rows);
                else
                    line[member] = rows;
            }
        }
    }
    if (in.arguments.has("--json"))
        in.out << json_text(line) << std::endl;
    else
        in.out << "wrote " << page.string() << std::endl;
    return done;
}

} // namespace sinew::cli
