// `sinew bench`: measurements, one JSON line each.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/evaluator.h"
#include "solver/error.h"
#include "tools/bench/cantilever.h"
#include "tools/cli/arguments.h"
#include "tools/cli/commands.h"
#include "tools/cli/machine.h"

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

ExitCode run_bench(const Invocation& in) {
    const Arguments& arguments = in.arguments;
    const std::vector<std::string> known{"cantilever"};
    const std::string name = arguments.operand(0).value();
    if (name != known.front())
        throw UsageError("there is no benchmark '" + name + "'." + did_you_mean(name, known));
    const int threads = arguments.whole_number(
        "--threads", static_cast<int>(std::max(1u, std::thread::hardware_concurrency())), 1);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
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
            try {
                measure_cantilever(options, law, threads, in);
            } catch (const solver::Stopped&) {
                throw engine::Cancelled();
            } catch (const solver::Error& e) {
                engine::Diagnostic d;
                d.code = e.code, d.message = e.what(), d.hint = e.hint;
                throw engine::SolveFailure(d);
            }
        }
    }
    return done;
}

} // namespace

Command bench_command() {
    return {"bench",
            "measure the solver; one JSON line a run",
            {{"NAME", "cantilever: a box of 1 x 0.25 x 0.25 m fixed at one end sags for 20 steps of 1/48 s"}},
            {{"--n", "LIST", "cubes along the box, 6 tets each; default: 24,40 (5,184 and 24,000 tets)"},
             {"--E", "LIST", "Young's moduli in Pa; default: 1e5,1e6"},
             {"--law", "LAW", "StVK, NeoHookean (default) or Corotational"},
             {"--steps", "N", "default: 20"},
             {"--threads", "N", "default: all cores", false, 'j'}},
            "sinew bench cantilever --n 24 --E 1e5 --threads 2",
            run_bench};
}

} // namespace sinew::cli
