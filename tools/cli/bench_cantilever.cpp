// `sinew bench cantilever`: a table, or one JSON line a run.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/cantilever.h"
#include "tools/bench/models.h"
#include "tools/cli/bench_common.h"
#include "tools/cli/json_text.h"
#include "tools/cli/machine.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>
#include <tbb/task_arena.h>

namespace sinew::cli {

namespace {

solver::ElasticLaw law_of(const std::string& word) {
    std::vector<std::string> known;
    std::string listed;
    for (const bench::LawName& l : bench::laws) {
        if (l.word == word) return l.law;
        known.emplace_back(l.word);
        listed += (listed.empty() ? "" : ", ") + known.back();
    }
    throw UsageError("--law needs one of " + listed + ", not '" + word + "'." + did_you_mean(word, known));
}

nlohmann::ordered_json json_of(const bench::CantileverOptions& options, const bench::CantileverResult& r,
                               const std::string& law, int threads) {
    return {{"bench", "cantilever"},
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
}

} // namespace

ExitCode bench_cantilever(const Invocation& in) {
    const Arguments& arguments = in.arguments;
    const bool quick = arguments.has("--quick"), as_json = arguments.has("--json");
    const std::string law = arguments.value("--law").value_or("NeoHookean");
    const int threads = thread_count(in);
    bench::CantileverOptions options;
    options.law = law_of(law);
    options.steps = arguments.whole_number("--steps", quick ? 3 : 20, 1);
    const std::vector<double> sizes =
        arguments.numbers("--n", quick ? std::vector<double>{8} : std::vector<double>{24, 40});
    const std::vector<double> moduli = arguments.numbers("--E", {1e5, 1e6});
    for (const double n : sizes)
        if (n < 4 || n > 400 || std::fmod(n, 4) != 0) throw UsageError("--n needs multiples of 4 from 4 to 400.");
    for (const double e : moduli)
        if (!(e > 0)) throw UsageError("--E needs values above 0.");
    const bench::RunOptions told = run_options(in);
    std::vector<bench::CantileverRun> runs;
    for (const double n : sizes)
        for (const double e : moduli) {
            options.n = static_cast<int>(n), options.youngs_modulus = e;
            told.tell("cantilever, n " + std::to_string(options.n) + ", E " + bench::number(e));
            bench::CantileverResult r;
            tbb::task_arena(threads).execute([&] { r = bench::run_cantilever(options, in.stop); });
            if (as_json) in.out << json_text(json_of(options, r, law, threads)) << std::endl;
            runs.emplace_back(options, std::move(r));
        }
    if (!as_json)
        in.out << bench::as_text(bench::cantilever_table(runs)) << law << ", " << options.steps << " steps, " << threads
               << (threads == 1 ? " thread" : " threads") << "; phases are per Newton iteration" << std::endl;
    return done;
}

} // namespace sinew::cli
