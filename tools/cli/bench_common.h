// What the subcommands of `sinew bench` share.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/elements.h"
#include "tools/bench/run_options.h"
#include "tools/bench/scene.h"
#include "tools/bench/table.h"
#include "tools/cli/arguments.h"

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sinew::cli {

/// --quick, --only and the request to stop; what is being measured goes to `err`.
bench::RunOptions run_options(const Invocation& in);
/// --sizes, factors of all tet sizes. Throws UsageError for one outside of 0.01 to 100.
std::vector<double> tet_scales(const Invocation& in, const std::vector<double>& usual);
/// The words of the list that a flag gives, each one of `known`; `otherwise` without the flag. Throws UsageError.
std::vector<std::string> words(const Invocation& in, std::string_view flag, const std::vector<std::string>& known,
                               std::vector<std::string> otherwise);
/// The files, and the graph files of folders by name. Throws UsageError for a folder without any.
std::vector<std::string> graph_files(const std::vector<std::string>& paths);
/// The folder that --output names, if given: made, and found to be writable, before anything is measured. Throws
/// Failure IO405.
std::optional<std::filesystem::path> output_folder(const Invocation& in);
/// --threads, or all cores.
int thread_count(const Invocation& in);
/// {"bench": name, "date", "machine", "load", "version"}: how a result says where it comes from.
nlohmann::ordered_json provenance(const std::string& name);
/// A graph file under each linear solver; --steps frames of it.
bench::SceneBench measure_scene(const Invocation& in, const std::string& file);
/// Its first frames with smaller tets and with quadratic ones, under Direct, Iterative and Auto.
std::vector<bench::SceneBench> measure_rig(const Invocation& in, const std::string& file);
/// Its motion's error against time, over tet sizes and both elements.
bench::ElementBench measure_curve(const Invocation& in, const std::string& file);
/// With --json one line that holds provenance, the summary, the rows and the members of `extra`; else the table, if it
/// has rows, and the summary.
void print_result(const Invocation& in, const std::string& name, const bench::Table& table,
                  const nlohmann::ordered_json& rows, const std::string& summary,
                  const nlohmann::ordered_json* extra = nullptr);

// One function a subcommand.
ExitCode bench_cantilever(const Invocation& in);
ExitCode bench_meshing(const Invocation& in);
ExitCode bench_accuracy(const Invocation& in);
ExitCode bench_convergence(const Invocation& in);
ExitCode bench_work_precision(const Invocation& in);
ExitCode bench_scaling(const Invocation& in);
ExitCode bench_levers(const Invocation& in);
ExitCode bench_idle_cost(const Invocation& in);
ExitCode bench_graphs(const Invocation& in);
ExitCode bench_hard(const Invocation& in);
ExitCode bench_scene(const Invocation& in);
ExitCode bench_contact(const Invocation& in);
ExitCode bench_elements(const Invocation& in);
ExitCode bench_report(const Invocation& in);

} // namespace sinew::cli
