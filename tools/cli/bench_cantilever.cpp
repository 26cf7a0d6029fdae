// `sinew bench cantilever`: one JSON line a run.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/cantilever.h"
#include "tools/bench/models.h"
#include "tools/cli/bench_common.h"
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

} // namespace

ExitCode bench_cantilever(const Invocation& in) {
    const Arguments& arguments = in.arguments;
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
            measure_cantilever(options, law, thread_count(in), in);
        }
    }
    return done;
}

} // namespace sinew::cli
