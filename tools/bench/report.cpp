// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/report.h"

#include "tools/bench/studies.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace sinew::bench {

namespace {

/// One row a case: how many of its results passed, the worst of the exact and same-mesh errors.
Table accuracy_overview(const std::vector<CaseResult>& results) {
    struct Line {
        std::string section, name, kind;
        int passed = 0, failed = 0, lock = 0;
        double worst = 0, allowed = 0, least_order = 1e9;
    };
    std::vector<Line> lines;
    for (const CaseResult& r : results) {
        if (r.status == CaseStatus::not_modelled) continue;
        const std::string kind = std::isfinite(r.order) ? (r.kind == CaseKind::continuum ? "order in h" : "order in dt")
                                                        : std::string(name_of(r.kind));
        auto it =
            std::find_if(lines.begin(), lines.end(), [&](const Line& l) { return l.name == r.name && l.kind == kind; });
        if (it == lines.end()) it = lines.insert(lines.end(), {r.section, r.name, kind});
        (r.status == CaseStatus::pass ? it->passed : r.status == CaseStatus::locks ? it->lock : it->failed) += 1;
        it->worst = std::max(it->worst, r.error), it->allowed = std::max(it->allowed, r.tolerance);
        if (std::isfinite(r.order)) it->least_order = std::min(it->least_order, r.order);
    }
    Table t{{"section", "case", "judged by", "passed", "failed", "lock", "worst"}, {}};
    for (const Line& l : lines)
        t.rows.push_back({l.section, l.name, l.kind, std::to_string(l.passed), std::to_string(l.failed),
                          std::to_string(l.lock),
                          l.least_order < 1e9 ? "order " + number(l.least_order, 3)
                                              : number(l.worst, 2) + " of " + number(l.allowed, 2)});
    return t;
}

std::vector<CaseResult> of_status(const std::vector<CaseResult>& results, CaseStatus status) {
    std::vector<CaseResult> out;
    std::copy_if(results.begin(), results.end(), std::back_inserter(out),
                 [&](const CaseResult& r) { return r.status == status; });
    return out;
}

/// Results judged by a value on a mesh or in the limit, in full: the exact ones are hundreds and all alike.
std::vector<CaseResult> shown_in_full(const std::vector<CaseResult>& results) {
    std::vector<CaseResult> out;
    for (const CaseResult& r : results)
        if (r.status != CaseStatus::not_modelled && (r.kind != CaseKind::exact || r.section == "13")) out.push_back(r);
    return out;
}

/// Table without some of its columns.
Table without(Table t, std::initializer_list<const char*> names) {
    for (const char* name : names) {
        const auto at = std::find(t.columns.begin(), t.columns.end(), name) - t.columns.begin();
        if (at == static_cast<std::ptrdiff_t>(t.columns.size())) continue;
        t.columns.erase(t.columns.begin() + at);
        for (auto& row : t.rows) row.erase(row.begin() + at);
    }
    return t;
}

} // namespace

Report run_all(const RunOptions& told) {
    RunOptions options = told;
    options.memory = std::make_shared<StudyMemory>();
    Report r;
    r.quick = options.quick;
    r.accuracy = run_accuracy(options);
    r.convergence = run_convergence(options);
    r.work_precision = run_work_precision(options);
    r.locking = run_locking(options);
    for (const int n : options.quick ? std::vector<int>{8} : std::vector<int>{24, 40, 60})
        for (const double e : {1e5, 1e6}) {
            CantileverOptions c;
            c.n = n, c.youngs_modulus = e, c.steps = options.quick ? 3 : 20;
            options.tell("cantilever, n " + std::to_string(n) + ", E " + number(e));
            CantileverResult result = run_cantilever(c, options.stop);
            r.cantilever.emplace_back(c, std::move(result));
        }
    r.hard = run_hard(options);
    r.levers = run_levers(options);
    r.scaling = run_scaling(options);
    r.idle_cost = run_idle_cost(options);
    return r;
}

std::vector<Picture> report_pictures(const Report& report) {
    std::vector<Picture> out;
    for (const auto& plots : {work_precision_plots(report.work_precision), locking_plots(report.locking)})
        for (const NamedPlot& p : plots) out.push_back({"bench_" + p.name + ".svg", draw(p.plot)});
    out.push_back({"bench_convergence_mesh.svg", draw(convergence_plot(report.convergence, false))});
    out.push_back({"bench_convergence_time.svg", draw(convergence_plot(report.convergence, true))});
    out.push_back({"bench_scaling.svg", draw(scaling_plot(report.scaling))});
    return out;
}

std::string report_page(const Report& report, const std::string& images) {
    std::ostringstream out;
    const auto picture = [&](const std::string& name, const std::string& what) {
        out << "\n![" << what << "](" << images << "/bench_" << name << ".svg)\n";
    };
    out << "# Benchmarks\n\nMade by `sinew bench report " << (report.scenes.empty() ? "" : "GRAPH ")
        << "-o docs/benchmarks.md" << (report.quick ? " --quick" : "") << "` on " << report.date << ", Sinew "
        << report.version << ".\n\nMachine: " << report.machine << ", " << report.threads
        << " threads unless a table says otherwise. Load average " << number(report.load_before, 2) << " before and "
        << number(report.load_after, 2)
        << " after; what is above the threads used is other work on the machine, and times then "
           "vary by a quarter and more. Compare only times of one table.\n";

    out << "\n## Accuracy\n\n`sinew bench accuracy`: " << accuracy_summary(report.accuracy)
        << ".\n\nThe references are closed formulas and values of other codes (dolfinx, CalculiX, a separate numpy "
           "code). *exact*: the "
           "engine's own discretisation has this value, only rounding may differ. *same mesh*: linear tets on one mesh "
           "have one "
           "solution, which another code computed. *order*: the finest mesh must be nearest to the continuum, at order "
           "1 "
           "or more between the two finest meshes: clamped edges are singular, which keeps smooth elements below order "
           "2, and an order "
           "below 1 is an element that locks. Orders in the time step must reach 0.85 (first order) or 1.8 "
           "(second).\n\n"
        << as_markdown(accuracy_overview(report.accuracy));
    for (const auto& [status, title] :
         {std::pair{CaseStatus::fail, "What fails"},
          {CaseStatus::locks,
           "Where plain linear tets lock (Poisson's ratio of 0.49 and more): errors fall, but slowly; "
           "quadratic tets, or volumeConservation for the bulk, do not"}}) {
        const std::vector<CaseResult> these = of_status(report.accuracy, status);
        if (!these.empty()) out << "\n" << title << ":\n\n" << as_markdown(without(accuracy_table(these), {"verdict"}));
    }
    out << "\nNot yet modelled, and never counted as passed:\n\n"
        << as_markdown(
               without(accuracy_table(of_status(report.accuracy, CaseStatus::not_modelled)),
                       {"verdict", "setting", "quantity", "kind", "value", "reference", "error", "allowed", "order"}))
        << "\n<details><summary>All values of beams, panels, vibration and the released bar</summary>\n\n"
        << as_markdown(without(accuracy_table(shown_in_full(report.accuracy)), {"note"})) << "\n</details>\n";

    out << "\n## Convergence\n\n`sinew bench convergence`: errors on finer and finer meshes and time steps, and the "
           "orders between them.\n";
    picture("convergence_mesh", "error against cell size");
    picture("convergence_time", "error against time step");
    out << "\n<details><summary>All orders</summary>\n\n"
        << as_markdown(convergence_table(report.convergence)) << "\n</details>\n";

    out << "\n## Hard cases\n\n`sinew bench hard`: " << hard_summary(report.hard)
        << ".\n\nEach body is treated badly, under every law, element and integrator, and must end where it is known "
           "to "
           "end. *recovered*: it does, and every step that was called converged solves its equations, which a judge "
           "makes anew from the states before and after it. *elsewhere*: at rest in another stable equilibrium, of a "
           "body that has several. *stopped*: an error with a code, or the last frame or twelve in a row are called "
           "not converged (FE301). "
           "*wrong*: anything else. Newton has 100 iterations and 3 halvings; steps are frames of 1/24 s with damping, "
           "if the case does not say otherwise. QuasiStatic refuses free bodies (FE302), and LogNeoHookean knows no "
           "inverted tets: they stop.\n\n"
        << as_markdown(hard_overview(report.hard));
    if (const Table faults = hard_faults(report.hard); !faults.rows.empty())
        out << "\nWhat is wrong:\n\n" << as_markdown(faults);
    out << "\n<details><summary>All runs</summary>\n\n" << as_markdown(hard_table(report.hard)) << "\n</details>\n";

    out << "\n## Work and precision\n\n`sinew bench work-precision`: a clamped bar of 0.4 x 0.1 x 0.1 m is let go in "
           "gravity and "
           "followed for a second. Error in time is against the run on the same mesh that is exact in time; total "
           "error is against the "
           "continuum. Both are other codes' for StVK, LogNeoHookean and Corotational; NeoHookean and Anisotropic "
           "(half as stiff across "
           "the bar as along it) are compared with runs of their own of many more sub-steps, as the column *against* "
           "says. Times are "
           "medians of as many runs as the table says, which take turns. The grey line joins the choices that no other "
           "one beats.\n";
    for (const NamedPlot& p : work_precision_plots(report.work_precision)) picture(p.name, p.plot.title);
    out << "\n<details><summary>All runs</summary>\n\n"
        << as_markdown(work_precision_table(report.work_precision)) << "\n</details>\n";

    out << "\n### Nearly incompressible bodies\n\nAlso `sinew bench work-precision`: equilibria under the whole load, "
           "in the log neo-Hookean law. "
           "Cook's panel against another code's converged displacement of its upper corner; *linear + "
           "volumeConservation* has a Poisson's "
           "ratio of 0.3 and the rest of the bulk modulus as volumeConservation, which linear tets take over patches. "
           "The gravity "
           "cantilever, nu 0.4, with volumeConservation of 1000 E against the incompressible body of the same shear "
           "modulus (quadratic tets "
           "at nu 0.4999 on two meshes, extrapolated; ± is how far the finer one is from that), and without it against "
           "another code; there "
           "linear tets bend too little even where nothing is incompressible. The meshes of at most "
        << modest_tets << " tets:\n\n"
        << as_markdown(without(locking_table(modest_ones(report.locking)), {"runs", "spread [s]", "CG", "front"}));
    for (const NamedPlot& p : locking_plots(report.locking)) picture(p.name, p.plot.title);
    out << "\n<details><summary>All meshes</summary>\n\n"
        << as_markdown(locking_table(report.locking)) << "\n</details>\n";

    out << "\n## What each lever gives\n\n`sinew bench levers`: the same simulation without and with a choice, in "
           "turns; ratios are of "
           "neighbouring runs, their median over the turns. *linear method*, *threads*: a step of the cantilever "
           "below, E = 1e5 Pa. *Hessian*: Newton on "
           "one step of it with CHOLMOD, each element's eigenvalues clamped at every iteration, or only where the "
           "exact matrix is "
           "not positive definite, as the solver does. *element*: the finest linear mesh against a quadratic one that "
           "is nearer to the "
           "converged value. This program was built for "
        << vector_instructions()
        << ", a choice of the build (`SINEW_ARCH`) that one "
           "program cannot compare; element kernels take four tets at a time in any case. What linear methods give on "
           "a scene with "
           "attachments stands under Scene.\n\n"
        << as_markdown(levers_table(report.levers));

    out << "\n## Cantilever\n\n`sinew bench cantilever`: a box of 1 x 0.25 x 0.25 m fixed at one end sags for 20 steps "
           "of 1/48 s, stable "
           "neo-Hookean, Poisson's ratio 0.45, converged to 1e-6 of the forces at work. Phases are per Newton "
           "iteration.\n\n"
        << as_markdown(cantilever_table(report.cantilever));

    for (const SceneBench& s : report.scenes)
        out << "\n## Scene: " << s.name << "\n\n`sinew bench scene`: the solver's time for frames " << s.first + 1
            << " to " << s.last << ", " << s.tets << " tets, medians of " << s.turns
            << " turns. Plain is one CHOLMOD factorisation of the whole matrix in every Newton iteration; Direct, one "
               "of each "
               "group of bodies that attachments join; Iterative, conjugate gradients with multigrid; Auto, the "
               "default, takes what it counts to be cheapest of those and of conjugate gradients on a factor in "
               "single precision that serves several iterations of Newton's. All end each frame at the same tolerance. "
               "Scene units: zSolver.scale of them make a "
               "metre.\n\n"
            << as_markdown(scene_table(s));

    if (!report.rigs.empty())
        out << "\n## Rigs\n\n`sinew bench scene` with `--elements` and `--sizes`: the scenes' first nine frames, with "
               "all "
               "tet sizes scaled alike and with quadratic tets, one turn each. Linear iterations and factors are per "
               "frame.\n\n"
            << as_markdown(scenes_table(report.rigs));

    out << "\n## Scaling\n\n`sinew bench scaling`: the cantilever from a thousand to half a million tets. Memory is "
           "the growth of the "
           "resident set from before the scene is made to after its last step. The share of bandwidth is the bytes "
           "that conjugate gradients "
           "must move at least over their time, relative to the triad `a = b + s c` below; above 1 the matrix stays in "
           "the cache.\n\n"
        << as_markdown(limits_table(report.scaling)) << "\n"
        << as_markdown(scaling_table(report.scaling));
    picture("scaling", "time of a Newton iteration against tets");
    out << "\nThe direct solver on the same matrices, one thread, medians of 5; its share is of the dgemm rate on one "
           "thread:\n\n"
        << as_markdown(factor_table(report.scaling));

    out << "\n## Idle cost\n\n`sinew bench idle-cost`: the cantilever of " << report.idle_cost.tets
        << " tets with and without features that it does not use, in turns, medians of "
        << (report.idle_cost.rows.empty() ? 0 : report.idle_cost.rows.front().turns)
        << ". Two runs without any differ by " << number(100 * report.idle_cost.noise_level, 2)
        << " % on this machine; within that it is noise.\n\n"
        << as_markdown(idle_cost_table(report.idle_cost));
    return out.str();
}

} // namespace sinew::bench
