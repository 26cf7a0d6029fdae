// `sinew bench`: measurements. What each one measures stands in tools/bench, what it prints in bench_NAME.cpp.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/evaluator.h"
#include "solver/error.h"
#include "tools/cli/bench_common.h"
#include "tools/cli/commands.h"

#include <tbb/global_control.h>

namespace sinew::cli {

namespace {

struct Benchmark {
    const char* name;
    ExitCode (*run)(const Invocation&);
    bool takes_files = false;
};

constexpr Benchmark benchmarks[] = {
    {"cantilever", bench_cantilever},
    {"meshing", bench_meshing, true},
    {"accuracy", bench_accuracy},
    {"convergence", bench_convergence},
    {"work-precision", bench_work_precision},
    {"scaling", bench_scaling},
    {"idle-cost", bench_idle_cost},
    {"scene", bench_scene, true},
    {"report", bench_report, true},
};

ExitCode run_bench(const Invocation& in) {
    const std::string name = in.arguments.operand(0).value();
    std::vector<std::string> known;
    for (const Benchmark& b : benchmarks) {
        known.emplace_back(b.name);
        if (name != b.name) continue;
        if (const auto extra = in.arguments.operand(1); extra && !b.takes_files)
            throw UsageError("the benchmark " + name + " takes no files, but '" + *extra + "' is given.");
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(thread_count(in)));
        try {
            return b.run(in);
        } catch (const solver::Stopped&) {
            throw engine::Cancelled();
        } catch (const solver::Error& e) {
            engine::Diagnostic d;
            d.code = e.code, d.message = e.what(), d.hint = e.hint;
            throw engine::SolveFailure(d);
        }
    }
    throw UsageError("there is no benchmark '" + name + "'." + did_you_mean(name, known));
}

} // namespace

Command bench_command() {
    return {"bench",
            "measure the solver and the meshing: accuracy and speed",
            {{"NAME", "cantilever: a box of 1 x 0.25 x 0.25 m fixed at one end sags for 20 steps of 1/48 s, "
                      "one JSON line a run; meshing: zTet's lattice of meshes in all fill modes, as a table; "
                      "accuracy: every case with trusted values, its error and verdict, exit code 3 if one fails; convergence: orders in cell "
                      "size and time step; work-precision: wall time against error as sub-steps, Newton tolerance, "
                      "tet size, integrator, law, element and linear solver change; scaling: time and memory from a "
                      "thousand to half a million tets; idle-cost: what unused features cost; scene: the frames of "
                      "a graph under each linear solver and under the yardstick Plain; report: all of them as a page with pictures"},
             {"FILES", "meshing: mesh files, or folders whose mesh files are taken; scene, report: graph files", false, true}},
            {{"--json", "", "one line of JSON instead of the table; meshing: one a row"},
             {"--quick", "", "small sizes: seconds instead of minutes"},
             {"--only", "LETTERS", "only cases or sweeps with these letters in their name"},
             {"--output", "PATH", "convergence, work-precision, scaling: write plots and CSV there too; report: the page to write", false, 'o'},
             {"--n", "LIST", "cantilever: cubes along the box, 6 tets each; default: 24,40 (5,184 and 24,000 tets)"},
             {"--E", "LIST", "cantilever: Young's moduli in Pa; default: 1e5,1e6"},
             {"--law", "LAW", "cantilever: StVK, NeoHookean (default), LogNeoHookean or Corotational"},
             {"--steps", "N", "cantilever: steps; default: 20; scene: frames after the first; default: all"},
             {"--parts", "LIST", "meshing: cubes along a mesh's longest side; default: 20"},
             {"--refine", "N", "meshing: halve the cubes N times all over the surface; default: 0"},
             {"--threads", "N", "default: all cores", false, 'j'}},
            "sinew bench cantilever --n 24 --E 1e5 --threads 2\n"
            "sinew bench accuracy --quick\n"
            "sinew bench work-precision -o out/bench\n"
            "sinew bench scene graphs/scenes/arm.json\n"
            "sinew bench report graphs/scenes/arm.json -o docs/benchmarks.md\n"
            "sinew bench meshing graphs/scenes/arm_ziva --parts 10,20",
            run_bench};
}

} // namespace sinew::cli
