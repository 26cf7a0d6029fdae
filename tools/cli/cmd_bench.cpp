// `sinew bench`: measurements. What each one measures stands in tools/bench, what it prints in bench_NAME.cpp.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/evaluator.h"
#include "solver/error.h"
#include "tools/cli/bench_common.h"
#include "tools/cli/commands.h"

#include <algorithm>
#include <tbb/global_control.h>

namespace sinew::cli {

namespace {

struct Benchmark {
    const char* name;
    ExitCode (*run)(const Invocation&);
    std::string_view flags; ///< what it reads beside --json and --threads
    bool takes_files = false;
};

constexpr Benchmark benchmarks[] = {
    {"cantilever", bench_cantilever, "--quick --n --E --law --steps"},
    {"meshing", bench_meshing, "--parts --refine", true},
    {"accuracy", bench_accuracy, "--quick --only"},
    {"convergence", bench_convergence, "--quick --only --output"},
    {"work-precision", bench_work_precision, "--quick --only --output"},
    {"levers", bench_levers, "--quick --only"},
    {"scaling", bench_scaling, "--quick --only --output"},
    {"idle-cost", bench_idle_cost, "--quick --only"},
    {"graphs", bench_graphs, "--quick --only"},
    {"hard", bench_hard, "--quick --only"},
    {"scene", bench_scene, "--quick --steps --solvers --elements --sizes", true},
    {"contact", bench_contact, "--quick --steps --only", true},
    {"elements", bench_elements, "--quick --steps --only --sizes --output", true},
    {"report", bench_report, "--quick --steps --only --output", true},
};

/// A flag that the benchmark does not read would be a wish that nobody hears.
void refuse_other_flags(const Benchmark& b, const Arguments& arguments) {
    for (const Flag& f : bench_command().flags) {
        if (f.name == "--json" || f.name == "--threads" || !arguments.has(f.name)) continue;
        const std::vector<std::string> read = split(b.flags, ' ');
        if (std::find(read.begin(), read.end(), f.name) == read.end())
            throw UsageError("the benchmark " + std::string(b.name) + " has no " + std::string(f.name) + ".");
    }
}

ExitCode run_bench(const Invocation& in) {
    const std::string name = in.arguments.operand(0).value();
    std::vector<std::string> known;
    for (const Benchmark& b : benchmarks) {
        known.emplace_back(b.name);
        if (name != b.name) continue;
        if (const auto extra = in.arguments.operand(1); extra && !b.takes_files)
            throw UsageError("the benchmark " + name + " takes no files, but '" + *extra + "' is given.");
        refuse_other_flags(b, in.arguments);
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
    return {
        "bench",
        "measure the solver and the meshing: accuracy and speed",
        {{"NAME",
          "cantilever: a box of 1 x 0.25 x 0.25 m fixed at one end sags for 20 steps of 1/48 s; "
          "meshing: zTet's lattice of meshes in all fill modes; "
          "accuracy: every case with trusted values, its error and verdict, exit code 3 if one fails; convergence: "
          "orders in cell "
          "size and time step; work-precision: wall time against error as sub-steps, Newton tolerance, "
          "tet size, integrator, law, element and linear solver change, and of nearly incompressible bodies on finer "
          "and finer meshes; levers: what linear method, threads, exact Hessians and quadratic tets give, as ratios of "
          "times; "
          "scaling: time and memory from a thousand to half a million tets, and of contact to 200,000 points; "
          "idle-cost: what unused "
          "features cost; graphs: what a thousand to 40,000 nodes cost to load, to plan and to edit; hard: collapsed, "
          "scrambled, overstretched, torn about and spoilt bodies under every law, "
          "element and integrator, exit code 3 if an answer is wrong; scene: the frames of graphs under each linear "
          "solver and under the yardstick "
          "Plain, with their own tets or others; contact: graphs of bodies that touch, once each: times, iterations, "
          "deepest contact, drift and what fell through, exit code 3 if an answer is wrong, and beside the times of "
          "another engine where they are known; elements: linear and quadratic tets of several sizes, error "
          "against time, on the motion of a graph, or without one on bodies whose answer is known; "
          "report: all of them but meshing as a page with pictures"},
         {"FILES",
          "meshing: mesh files, or folders whose mesh files are taken; scene, contact: graph files, or folders "
          "whose graph files are taken; elements: a graph file or none; report: graph files, a scene each",
          false, true}},
        {{"--json", "", "JSON instead of the table: one line, of cantilever and meshing one a run"},
         {"--quick", "", "small sizes: seconds instead of minutes; all but meshing"},
         {"--only", "LETTERS",
          "accuracy, convergence, work-precision, levers, scaling, idle-cost, graphs, hard, contact: only what has "
          "these "
          "letters in "
          "its name; elements: the one tissue that takes part, without a graph as the others; report: the sections to "
          "measure anew, a list of accuracy, convergence, hard, work-precision, levers, cantilever, scene, rigs, "
          "elements, "
          "scaling, idle-cost"},
         {"--output", "PATH",
          "convergence, work-precision, scaling, elements: a folder to write plots to, of work-precision CSV and JSON "
          "too; "
          "report: the page to write",
          false, 'o'},
         {"--n", "LIST",
          "cantilever: cubes along the box, 6 tets each, multiples of 4 from 4 to 400; default: 24,40 (5,184 and "
          "24,000 tets)"},
         {"--E", "LIST", "cantilever: Young's moduli in Pa; default: 1e5,1e6"},
         {"--law", "LAW", "cantilever: an isotropic law of zTissue.material; default: NeoHookean"},
         {"--steps", "N",
          "cantilever: steps; default: 20; scene, contact, report: frames after the first; default: all; "
          "elements: default: 12"},
         {"--parts", "LIST", "meshing: cubes along a mesh's longest side; default: 20"},
         {"--refine", "N", "meshing: halve the cubes N times all over the surface; default: 0"},
         {"--solvers", "LIST", "scene: of Plain, Direct, Iterative, Auto, the yardstick first; default: all"},
         {"--elements", "LIST", "scene: linear, quadratic; default: as in the graph"},
         {"--sizes", "LIST",
          "scene, elements: factors of all tet sizes; default: 1; elements: default: 2,1.4,1,0.7,0.5,0.35, the "
          "smallest with quadratic tets the yardstick"},
         {"--threads", "N", "default: all cores", false, 'j'}},
        "sinew bench cantilever --n 24 --E 1e5 --threads 2             # time of a step, its parts, a digest of the "
        "result\n"
        "sinew bench meshing graphs/scenes/arm_ziva --parts 10,20      # a row for each mesh, fill mode and size\n"
        "sinew bench accuracy --quick                                  # value, reference, error and verdict of each "
        "case\n"
        "sinew bench convergence --only Cook -o out/bench              # errors on finer and finer meshes, and a plot\n"
        "sinew bench work-precision -o out/bench                       # tables, CSV, JSON and plots with Pareto "
        "lines\n"
        "sinew bench levers --only threads                             # one thread and two, in turns\n"
        "sinew bench scaling --quick                                   # limits of the machine, then time and memory\n"
        "sinew bench idle-cost --only bone                             # with a bone that nothing holds on to, and "
        "without\n"
        "sinew bench graphs --only chain                               # load, plan and edit graphs of many nodes\n"
        "sinew bench hard --only squeezed                              # recovered, stopped with a diagnostic, or "
        "wrong\n"
        "sinew bench scene graphs/scenes/arm.json --steps 20           # Plain, Direct, Iterative and Auto, same "
        "frames\n"
        "sinew bench scene graphs/scenes --steps 8 --solvers Direct,Iterative,Auto --sizes 1,0.5 --elements linear\n"
        "sinew bench contact graphs/bench --only tilt                 # tilted cubes that fall on a floor\n"
        "sinew bench elements graphs/scenes/arm.json --only biceps     # linear and quadratic tets of six sizes\n"
        "sinew bench elements --only cantilever                        # the same against a known answer\n"
        "sinew bench report graphs/scenes/arm.json -o docs/benchmarks.md   # more than two hours\n"
        "sinew bench report --only cantilever,levers -o docs/benchmarks.md  # two sections of it anew",
        run_bench};
}

} // namespace sinew::cli
