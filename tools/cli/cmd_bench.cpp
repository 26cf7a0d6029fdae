// `sinew bench`: measurements, one JSON line each.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/evaluator.h"
#include "solver/error.h"
#include "tools/bench/cantilever.h"
#include "tools/bench/meshing.h"
#include "tools/cli/arguments.h"
#include "tools/cli/commands.h"
#include "tools/cli/machine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <thread>

namespace sinew::cli {

namespace {

// The words of zTissue.material.
constexpr std::array<std::pair<std::string_view, solver::ElasticLaw>, 3> laws{
    {{"StVK", solver::ElasticLaw::stvk},
     {"NeoHookean", solver::ElasticLaw::neo_hookean},
     {"Corotational", solver::ElasticLaw::corotational}}};

solver::ElasticLaw law_of(const std::string& word) {
    std::vector<std::string> known;
    for (const auto& [name, law] : laws) {
        if (name == word) return law;
        known.emplace_back(name);
    }
    throw UsageError("--law needs StVK, NeoHookean or Corotational, not '" + word + "'." +
                     did_you_mean(word, known));
}

void measure_cantilever(const bench::CantileverOptions& options, const std::string& law, int threads,
                        const Invocation& in) {
    bench::CantileverResult r;
    tbb::task_arena arena(threads);
    arena.execute([&] { r = bench::run_cantilever(options, in.stop); });
    const nlohmann::ordered_json line = {{"bench", "cantilever"},
                                         {"n", options.n},
                                         {"tets", r.tets},
                                         {"E", options.youngs_modulus},
                                         {"threads", threads},
                                         {"law", law},
                                         {"steps", options.steps},
                                         {"tip_y", r.tip_y},
                                         {"s_per_step_median", r.seconds_per_step_median},
                                         {"newton_per_step", r.newton_per_step},
                                         {"assembly_ms", r.assembly_ms},
                                         {"factor_ms", r.factor_ms},
                                         {"solve_ms", r.solve_ms},
                                         {"residual_max", r.residual_max},
                                         {"unconverged", r.unconverged},
                                         {"digest", r.digest.hex()},
                                         {"peak_bytes", peak_bytes()},
                                         {"machine", machine_name()},
                                         {"version", SINEW_VERSION}};
    in.out << line.dump() << std::endl;
}

/// Solver errors as the diagnostics that main prints.
template <class Call>
void guarded(Call&& call) {
    try {
        call();
    } catch (const solver::Stopped&) {
        throw engine::Cancelled();
    } catch (const solver::Error& e) {
        engine::Diagnostic d;
        d.code = e.code, d.message = e.what(), d.hint = e.hint;
        throw engine::SolveFailure(d);
    }
}

void bench_cantilever(const Invocation& in, int threads) {
    const Arguments& arguments = in.arguments;
    if (const auto extra = arguments.operand(1))
        throw UsageError("the cantilever takes no files, but '" + *extra + "' is given.");
    const std::string law = arguments.value("--law").value_or("NeoHookean");
    bench::CantileverOptions options;
    options.law = law_of(law);
    options.steps = arguments.whole_number("--steps", 20, 1);
    for (const double n : arguments.numbers("--n", {24, 40})) {
        if (n < 4 || n > 400 || std::fmod(n, 4) != 0)
            throw UsageError("--n needs multiples of 4 between 4 and 400.");
        for (const double youngs_modulus : arguments.numbers("--E", {1e5, 1e6})) {
            if (!(youngs_modulus > 0)) throw UsageError("--E needs values above 0.");
            options.n = static_cast<int>(n);
            options.youngs_modulus = youngs_modulus;
            guarded([&] { measure_cantilever(options, law, threads, in); });
        }
    }
}

void bench_meshing(const Invocation& in, int threads) {
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
                guarded(
                    [&] { arena.execute([&] { r = bench::run_meshing(file, fill, p, refine, in.stop); }); });
                if (!as_json) {
                    in.out << bench::as_table_row(r) << std::flush;
                    continue;
                }
                nlohmann::ordered_json line = bench::as_json(r);
                line["threads"] = threads;
                line["machine"] = machine_name();
                line["version"] = SINEW_VERSION;
                in.out << line.dump() << std::endl;
            }
}

ExitCode run_bench(const Invocation& in) {
    const Arguments& arguments = in.arguments;
    const std::vector<std::string> known{"cantilever", "meshing"};
    const std::string name = arguments.operand(0).value();
    if (std::find(known.begin(), known.end(), name) == known.end())
        throw UsageError("there is no benchmark '" + name + "'." + did_you_mean(name, known));
    const int threads = arguments.whole_number(
        "--threads", static_cast<int>(std::max(1u, std::thread::hardware_concurrency())), 1);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    if (name == "meshing")
        bench_meshing(in, threads);
    else
        bench_cantilever(in, threads);
    return done;
}

} // namespace

Command bench_command() {
    return {"bench",
            "measure the solver and the meshing",
            {{"NAME", "cantilever: a box of 1 x 0.25 x 0.25 m fixed at one end sags for 20 steps of 1/48 s, "
                      "one JSON line a run; meshing: zTet's lattice of meshes in all fill modes, as a table"},
             {"FILES", "meshing: mesh files, or folders whose mesh files are taken", false, true}},
            {{"--n", "LIST", "cubes along the box, 6 tets each; default: 24,40 (5,184 and 24,000 tets)"},
             {"--E", "LIST", "Young's moduli in Pa; default: 1e5,1e6"},
             {"--law", "LAW", "StVK, NeoHookean (default) or Corotational"},
             {"--steps", "N", "default: 20"},
             {"--parts", "LIST", "meshing: cubes along a mesh's longest side; default: 20"},
             {"--refine", "N", "meshing: halve the cubes N times all over the surface; default: 0"},
             {"--json", "", "meshing: one JSON line a row instead of the table"},
             {"--threads", "N", "default: all cores", false, 'j'}},
            "sinew bench cantilever --n 24 --E 1e5 --threads 2\n"
            "sinew bench meshing graphs/scenes/arm_ziva --parts 10,20",
            run_bench};
}

} // namespace sinew::cli
