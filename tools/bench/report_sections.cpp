// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/accuracy.h"
#include "tools/bench/cantilever.h"
#include "tools/bench/convergence.h"
#include "tools/bench/hard.h"
#include "tools/bench/idle_cost.h"
#include "tools/bench/levers.h"
#include "tools/bench/locking.h"
#include "tools/bench/report.h"
#include "tools/bench/scaling.h"
#include "tools/bench/work_precision.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
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

std::string shown(const std::string& name, const std::string& what) {
    return "\n![" + what + "](images/bench_" + name + ".svg)\n";
}

std::string folded(const std::string& summary, const Table& table) {
    return "\n<details><summary>" + summary + "</summary>\n\n" + as_markdown(table) + "\n</details>\n";
}

Section accuracy_section(const RunOptions& options) {
    const std::vector<CaseResult> results = run_accuracy(options);
    std::ostringstream out;
    out << "`sinew bench accuracy`: " << accuracy_summary(results)
        << ".\n\nThe references are closed formulas and values of other codes (dolfinx, CalculiX, a separate numpy "
           "code). *exact*: the engine's own discretisation has this value, only rounding may differ. *same mesh*: "
           "linear tets on one mesh have one solution, which another code computed. *order*: the finest mesh must be "
           "nearest to the continuum, at order 1 or more between the two finest meshes: clamped edges are singular, "
           "which keeps smooth elements below order 2, and an order below 1 is an element that locks. Orders in the "
           "time step must reach 0.85 (first order) or 1.8 (second).\n\n"
        << as_markdown(accuracy_overview(results));
    for (const auto& [status, title] :
         {std::pair{CaseStatus::fail, "What fails"},
          {CaseStatus::locks,
           "Where plain linear tets lock (Poisson's ratio of 0.49 and more): errors fall, but slowly; "
           "quadratic tets, or volumeConservation for the bulk, do not"}}) {
        const std::vector<CaseResult> these = of_status(results, status);
        if (!these.empty()) out << "\n" << title << ":\n\n" << as_markdown(without(accuracy_table(these), {"verdict"}));
    }
    out << "\nNot yet modelled, and never counted as passed:\n\n"
        << as_markdown(
               without(accuracy_table(of_status(results, CaseStatus::not_modelled)),
                       {"verdict", "setting", "quantity", "kind", "value", "reference", "error", "allowed", "order"}))
        << folded("All values of beams, panels, vibration and the released bar",
                  without(accuracy_table(shown_in_full(results)), {"note"}));
    return {"Accuracy", out.str(), {}, {{"accuracy", accuracy_json(results)}}};
}

Section convergence_section(const RunOptions& options) {
    const std::vector<ConvergenceRow> rows = run_convergence(options);
    return {"Convergence",
            "`sinew bench convergence`: errors on finer and finer meshes and time steps, and the orders between "
            "them.\n" +
                shown("convergence_mesh", "error against cell size") +
                shown("convergence_time", "error against time step") + folded("All orders", convergence_table(rows)),
            {{"bench_convergence_mesh.svg", draw(convergence_plot(rows, false))},
             {"bench_convergence_time.svg", draw(convergence_plot(rows, true))}},
            {{"convergence", convergence_json(rows)}}};
}

Section hard_section(const RunOptions& options) {
    const std::vector<HardResult> results = run_hard(options);
    std::string text =
        "`sinew bench hard`: " + hard_summary(results) +
        ".\n\nEach body is treated badly, under every law, element and integrator, and must end where it is known to "
        "end. *recovered*: it does, and every step that was called converged solves its equations, which a judge makes "
        "anew from the states before and after it. *elsewhere*: at rest in another stable equilibrium, of a body that "
        "has several. *stopped*: an error with a code, or the last frame or twelve in a row are called not converged "
        "(FE301). *wrong*: anything else. Newton has 100 iterations and 3 halvings; steps are frames of 1/24 s with "
        "damping, if the case does not say otherwise. QuasiStatic refuses free bodies (FE302), and LogNeoHookean knows "
        "no inverted tets: they stop.\n\n" +
        as_markdown(hard_overview(results));
    if (const Table faults = hard_faults(results); !faults.rows.empty())
        text += "\nWhat is wrong:\n\n" + as_markdown(faults);
    return {"Hard cases", text + folded("All runs", hard_table(results)), {}, {{"hard", hard_json(results)}}};
}

Section work_precision_section(const RunOptions& options) {
    const std::vector<WorkPoint> points = run_work_precision(options);
    const std::vector<LockingPoint> locking = run_locking(options);
    Section out{"Work and precision", {}, {}, {}};
    out.results = {{"work_precision", work_precision_json(points)}, {"locking", locking_json(locking)}};
    out.text =
        "`sinew bench work-precision`: a clamped bar of 0.4 x 0.1 x 0.1 m is let go in gravity and followed for a "
        "second. Error in time is against the run on the same mesh that is exact in time; total error is against the "
        "continuum. Both are other codes' for StVK, LogNeoHookean and Corotational; NeoHookean and Anisotropic (half "
        "as stiff across the bar as along it) are compared with runs of their own of many more sub-steps, as the "
        "column *against* says. Times are medians of as many runs as the table says, which take turns. The grey line "
        "joins the choices that no other one beats.\n";
    for (const NamedPlot& p : work_precision_plots(points)) {
        out.text += shown(p.name, p.plot.title);
        out.pictures.push_back({"bench_" + p.name + ".svg", draw(p.plot)});
    }
    out.text +=
        folded("All runs", work_precision_table(points)) +
        "\n### Nearly incompressible bodies\n\nAlso `sinew bench work-precision`: equilibria under the whole load, in "
        "the log neo-Hookean law. Cook's panel against another code's converged displacement of its upper corner; "
        "*linear + volumeConservation* has a Poisson's ratio of 0.3 and the rest of the bulk modulus as "
        "volumeConservation, which linear tets take over patches. The gravity cantilever, nu 0.4, with "
        "volumeConservation of 1000 E against the incompressible body of the same shear modulus (quadratic tets at nu "
        "0.4999 on two meshes, extrapolated; ± is how far the finer one is from that), and without it against another "
        "code; there linear tets bend too little even where nothing is incompressible. The meshes of at most " +
        std::to_string(modest_tets) + " tets:\n\n" +
        as_markdown(without(locking_table(modest_ones(locking)), {"runs", "spread [s]", "CG", "front"}));
    for (const NamedPlot& p : locking_plots(locking)) {
        out.text += shown(p.name, p.plot.title);
        out.pictures.push_back({"bench_" + p.name + ".svg", draw(p.plot)});
    }
    out.text += folded("All meshes", locking_table(locking));
    return out;
}

Section levers_section(const RunOptions& options) {
    const std::vector<Lever> levers = run_levers(options);
    return {"What each lever gives",
            "`sinew bench levers`: the same simulation without and with a choice, in turns; ratios are of neighbouring "
            "runs, their median over the turns. *linear method*, *threads*: a step of the cantilever below, E = 1e5 "
            "Pa. *Hessian*: Newton on one step of it with CHOLMOD, each element's eigenvalues clamped at every "
            "iteration, or only where the exact matrix is not positive definite, as the solver does. *element*: the "
            "finest linear mesh against a quadratic one that is nearer to the converged value. This program was built "
            "for " +
                vector_instructions() +
                ", a choice of the build (`SINEW_ARCH`) that one program cannot compare; element kernels take four "
                "tets at a time in any case. What linear methods give on a scene with attachments stands under "
                "Scene.\n\n" +
                as_markdown(levers_table(levers)),
            {},
            {{"levers", levers_json(levers)}}};
}

Section cantilever_section(const RunOptions& options) {
    std::vector<CantileverRun> runs;
    for (const int n : options.quick ? std::vector<int>{8} : std::vector<int>{24, 40, 60})
        for (const double e : {1e5, 1e6}) {
            CantileverOptions c;
            c.n = n, c.youngs_modulus = e, c.steps = options.quick ? 3 : 20;
            options.tell("cantilever, n " + std::to_string(n) + ", E " + number(e));
            CantileverResult result = run_cantilever(c, options.stop);
            runs.emplace_back(c, std::move(result));
        }
    return {"Cantilever",
            "`sinew bench cantilever`: a box of 1 x 0.25 x 0.25 m fixed at one end sags for 20 steps of 1/48 s, stable "
            "neo-Hookean, Poisson's ratio 0.45, converged to 1e-6 of the forces at work. Phases are per Newton "
            "iteration.\n\n" +
                as_markdown(cantilever_table(runs)),
            {},
            {}};
}

Section scaling_section(const RunOptions& options) {
    const ScalingResult result = run_scaling(options);
    return {
        "Scaling",
        "`sinew bench scaling`: the cantilever from a thousand to half a million tets. Memory is the growth of the "
        "resident set from before the scene is made to after its last step. The share of bandwidth is the bytes "
        "that conjugate gradients must move at least over their time, relative to the triad `a = b + s c` below; "
        "above 1 the matrix stays in the cache.\n\n" +
            as_markdown(limits_table(result)) + "\n" + as_markdown(scaling_table(result)) +
            shown("scaling", "time of a Newton iteration against tets") +
            "\nThe direct solver on the same matrices, one thread, medians of 5; its share is of the dgemm rate "
            "on one thread:\n\n" +
            as_markdown(factor_table(result)) +
            "\nWhat contact takes beside the rest of a step, of two bodies of few tets whose surfaces are cut finer "
            "and finer; one thread, medians of 8 steps. It grows no faster than n log n if the last column does "
            "not:\n\n" +
            as_markdown(contact_growth_table(result.contact)),
        {{"bench_scaling.svg", draw(scaling_plot(result))}},
        {{"scaling", scaling_json(result)}}};
}

Section idle_cost_section(const RunOptions& options) {
    const IdleCost cost = run_idle_cost(options);
    return {"Idle cost",
            "`sinew bench idle-cost`: the cantilever of " + std::to_string(cost.tets) +
                " tets with and without features that it does not use, in turns, medians of " +
                std::to_string(cost.rows.empty() ? 0 : cost.rows.front().turns) + ". Two runs without any differ by " +
                number(100 * cost.noise_level, 2) + " % on this machine; within that it is noise.\n\n" +
                as_markdown(idle_cost_table(cost)),
            {},
            {{"idle_cost", idle_cost_json(cost)}}};
}

struct NamedSection {
    const char* name;
    std::string_view title;                ///< how it begins
    Section (*measure)(const RunOptions&); ///< nothing for those that need graphs
};

constexpr NamedSection sections[] = {{"accuracy", "Accuracy", accuracy_section},
                                     {"convergence", "Convergence", convergence_section},
                                     {"hard", "Hard cases", hard_section},
                                     {"work-precision", "Work and precision", work_precision_section},
                                     {"levers", "What each lever gives", levers_section},
                                     {"cantilever", "Cantilever", cantilever_section},
                                     {"scene", "Scene: ", nullptr},
                                     {"rigs", "Rigs", nullptr},
                                     {"elements", "Error against time: ", nullptr},
                                     {"scaling", "Scaling", scaling_section},
                                     {"idle-cost", "Idle cost", idle_cost_section}};

} // namespace

const std::vector<std::string>& section_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> out;
        for (const NamedSection& s : sections) out.emplace_back(s.name);
        return out;
    }();
    return names;
}

std::size_t place_of(std::string_view title) {
    return static_cast<std::size_t>(std::find_if(std::begin(sections), std::end(sections),
                                                 [&](const NamedSection& s) { return title.starts_with(s.title); }) -
                                    std::begin(sections));
}

Section measure_section(const std::string& name, const RunOptions& options) {
    const auto* it = std::find_if(std::begin(sections), std::end(sections),
                                  [&](const NamedSection& s) { return s.measure && name == s.name; });
    if (it == std::end(sections)) throw std::invalid_argument("measure_section: '" + name + "'");
    return it->measure(options);
}

Section scene_section(const SceneBench& s) {
    return {"Scene: " + s.name,
            "`sinew bench scene`: the solver's time for frames " + std::to_string(s.first + 1) + " to " +
                std::to_string(s.last) + ", " + std::to_string(s.tets) + " tets, medians of " +
                std::to_string(s.turns) +
                " turns. Plain is one CHOLMOD factorisation of the whole matrix in every Newton iteration; Direct, one "
                "of each group of bodies that attachments join; Iterative, conjugate gradients with multigrid; Auto, "
                "the default, takes what it counts to be cheapest of those and of conjugate gradients on a factor in "
                "single precision that serves several iterations of Newton's. All end each frame at the same "
                "tolerance. Scene units: zSolver.scale of them make a metre.\n\n" +
                as_markdown(scene_table(s)),
            {},
            {{"scene", scene_json(s)}}};
}

Section rigs_section(const std::vector<SceneBench>& rigs) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const SceneBench& s : rigs)
        for (const auto& row : scene_json(s)) rows.push_back(row);
    return {
        "Rigs",
        "`sinew bench scene` with `--elements` and `--sizes`: the scenes' first nine frames, with all tet sizes "
        "scaled alike and with quadratic tets, one turn each. Linear iterations and factors are per frame; bytes per "
        "tet are the growth of the resident set over the frames. The cantilever is run before and after each scene; "
        "scaled by it, times of this hour can be compared with those of a quiet one.\n\n" +
            as_markdown(scenes_table(rigs)),
        {},
        {{"rigs", rows}}};
}

Section elements_section(const ElementBench& curve) {
    const std::string stem = std::filesystem::path(curve.name).stem().string();
    return {"Error against time: " + curve.name,
            "`sinew bench elements`: the scene with linear and quadratic tets of several sizes. CPU time of the whole "
            "process for frames " +
                std::to_string(curve.first + 1) + " to " + std::to_string(curve.last) +
                ", and how far the vertices of all tissues are at the last of them from the quadratic tets of the "
                "first row. That one is the finest, not the truth: this is how far one is from convergence in the "
                "size of the tets, not from a real arm. The size of the scene as it ships is 1.\n\n" +
                as_markdown(elements_table(curve)) + shown("elements_" + stem, "distance against CPU time a frame"),
            {{"bench_elements_" + stem + ".svg", draw(elements_plot(curve))}},
            {{"elements", elements_json(curve)}}};
}

} // namespace sinew::bench
