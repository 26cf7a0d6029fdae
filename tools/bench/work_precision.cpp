// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/work_precision.h"

#include "tools/bench/bar_release.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

namespace sinew::bench {

namespace {

using solver::Points;

constexpr double base_tolerance = 1e-6; // of the solver, which tolerance_factor multiplies
constexpr int fine_factor = 16;         // sub-steps of a law's own reference over the most that are measured

struct Plan {
    std::string sweep, setting;
    BarRelease bar;
};

int most_law_substeps(bool quick) { return quick ? 1 : 8; }

/// What is run, cheapest choices first within a sweep.
std::vector<Plan> plans(bool quick) {
    const LawName& law = *find_law("nh");
    const IntegratorName& best = integrators.back();
    std::vector<Plan> out;
    const auto add = [&](const std::string& sweep, const std::string& setting, BarRelease bar) {
        out.push_back({sweep, setting, bar});
    };
    const int most = quick ? 2 : 16;
    for (const IntegratorName& scheme : integrators)
        for (int substeps = 1; substeps <= most; substeps *= 2)
            add("sub-steps", std::to_string(substeps), {law, scheme, 8, substeps});
    for (const double factor : {1e4, 1e3, 1e2, 1e1, 1.0, 1e-2, 1e-4})
        if (!quick || factor >= 1)
            add("Newton tolerance", number(base_tolerance * factor, 1), {law, best, 8, 4, factor});
    for (const ElementName& element : elements)
        for (const int cells : {4, 8, 16, 32}) {
            if (quick && cells > 8) continue;
            if (element.kind == solver::ElementKind::quadratic && cells > 16)
                continue; // as many nodes as 32 linear cells
            BarRelease bar{law, best, cells, 2, 1};
            bar.element = element;
            add("tet size", number(400.0 / cells) + " mm " + std::string(element.word), bar);
        }
    for (const LawName& other : all_laws)
        for (int substeps = 1; substeps <= most_law_substeps(quick); substeps *= 2)
            add("law", std::string(other.word) + " x" + std::to_string(substeps), {other, best, 8, substeps, 1});
    for (const LinearMethodName& method : linear_methods)
        for (const int cells : {8, 16})
            if (!quick || cells == 8) {
                BarRelease bar{law, best, cells, 2, 1};
                bar.linear = method.method;
                add("linear solver", std::string(method.word) + ", " + std::to_string(cells) + " cells", bar);
            }
    return out;
}

std::string_view word_of(solver::LinearMethod method) {
    for (const LinearMethodName& m : linear_methods)
        if (m.method == method) return m.word;
    return "?";
}

/// What is exact in time on a mesh, and where it is from.
struct ExactInTime {
    Points tip;
    std::string source;
};

/// Other codes' trajectories where there are any. For the other laws, which only the law sweep has, on one mesh and
/// with one integrator of second order, a run of the law's own, once: so fine that its error is below a hundredth of
/// what it measures.
class TimeReferences {
  public:
    explicit TimeReferences(const RunOptions& options)
        : options_(options) {}
    ExactInTime operator()(const BarRelease& bar) {
        if (bar_is_known(bar.law))
            return bar.element.kind == solver::ElementKind::linear
                       ? ExactInTime{bar_on_mesh(bar.law, bar.cells), "other code"}
                       : ExactInTime{};
        auto& own = own_[std::string(bar.law.word)];
        if (own.tip.empty()) {
            const int substeps = fine_factor * most_law_substeps(options_.quick);
            options_.tell("work-precision, " + std::string(bar.law.word) + " with " + std::to_string(substeps) +
                          " sub-steps, the reference");
            own = {run_bar({bar.law, bar.integrator, bar.cells, substeps}, options_.stop).tip,
                   "own, " + std::to_string(substeps) + " sub-steps"};
        }
        return own;
    }

  private:
    const RunOptions& options_;
    std::map<std::string, ExactInTime> own_;
};

WorkPoint describe(const Plan& plan, const BarTrajectory& run, TimeReferences& references) {
    WorkPoint p;
    p.sweep = plan.sweep, p.setting = plan.setting;
    p.law = plan.bar.law.word, p.element = plan.bar.element.word, p.integrator = plan.bar.integrator.word;
    p.linear_solver = word_of(plan.bar.linear);
    p.cells = plan.bar.cells, p.substeps = plan.bar.substeps;
    p.tolerance = base_tolerance * plan.bar.tolerance_factor;
    p.newton = run.work.newton, p.unconverged = run.work.unconverged, p.linear_iterations = run.work.linear_iterations;
    if (const ExactInTime exact = references(plan.bar); !exact.tip.empty())
        p.error_time = rms_distance(run.tip, exact.tip), p.exact_in_time = exact.source;
    if (bar_is_known(plan.bar.law)) p.error_total = rms_distance(run.tip, bar_continuum(plan.bar.law));
    return p;
}

/// Marks the points that no other of the same law beats in time and total error.
void mark_front(std::vector<WorkPoint>& points) {
    std::map<std::string, std::vector<std::size_t>> by_law;
    for (std::size_t i = 0; i < points.size(); ++i) by_law[points[i].law].push_back(i);
    for (const auto& [law, members] : by_law) {
        std::vector<PlotPoint> plotted;
        for (const std::size_t i : members) plotted.push_back({points[i].timing.seconds, points[i].error_total, ""});
        for (const std::size_t k : pareto_front(plotted)) points[members[k]].on_front = true;
    }
}

} // namespace

std::vector<WorkPoint> run_work_precision(const RunOptions& options) {
    std::vector<Plan> wanted;
    for (Plan& plan : plans(options.quick))
        if (options.wants(plan.sweep)) wanted.push_back(std::move(plan));
    const int turns = options.quick ? 1 : 5;
    TimeReferences references(options);
    std::vector<WorkPoint> points;
    const auto seconds = in_turns(wanted.size(), turns, [&](std::size_t i, int turn) {
        const BarRelease& bar = wanted[i].bar;
        options.tell("work-precision, " + wanted[i].sweep + ", " + wanted[i].setting + ", " +
                     std::string(bar.integrator.word) + ", run " + std::to_string(turn + 1) + " of " +
                     std::to_string(turns));
        const BarTrajectory run = run_bar(bar, options.stop);
        if (turn == 0) points.push_back(describe(wanted[i], run, references));
        return run.work.seconds;
    });
    for (std::size_t i = 0; i < points.size(); ++i) points[i].timing = summary_of(seconds[i]);
    mark_front(points);
    return points;
}

Table work_precision_table(const std::vector<WorkPoint>& points) {
    Table t;
    t.columns = {"sweep",
                 "setting",
                 "law",
                 "element",
                 "integrator",
                 "cells",
                 "sub-steps",
                 "Newton tol.",
                 "linear solver",
                 "s per s (median)",
                 "runs",
                 "spread",
                 "Newton",
                 "CG",
                 "error in time [mm]",
                 "against",
                 "total error [mm]",
                 "front"};
    for (const WorkPoint& p : points)
        t.rows.push_back({p.sweep, p.setting, p.law, p.element, p.integrator, std::to_string(p.cells),
                          std::to_string(p.substeps), number(p.tolerance, 1), p.linear_solver,
                          number(p.timing.seconds, 3), std::to_string(p.timing.repeats), spread_of(p.timing),
                          std::to_string(p.newton), std::to_string(p.linear_iterations), number(1000 * p.error_time, 3),
                          p.exact_in_time, number(1000 * p.error_total, 3),
                          p.unconverged ? "not converged"
                          : p.on_front  ? "yes"
                                        : ""});
    return t;
}

nlohmann::ordered_json work_precision_json(const std::vector<WorkPoint>& points) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const WorkPoint& p : points)
        rows.push_back({{"sweep", p.sweep},
                        {"setting", p.setting},
                        {"law", p.law},
                        {"element", p.element},
                        {"integrator", p.integrator},
                        {"linear_solver", p.linear_solver},
                        {"cells", p.cells},
                        {"substeps", p.substeps},
                        {"newton_tolerance", p.tolerance},
                        {"seconds_median", p.timing.seconds},
                        {"seconds_least", p.timing.least},
                        {"seconds_most", p.timing.most},
                        {"repeats", p.timing.repeats},
                        {"newton", p.newton},
                        {"linear_iterations", p.linear_iterations},
                        {"unconverged", p.unconverged},
                        {"error_time_m", p.error_time},
                        {"exact_in_time", p.exact_in_time},
                        {"error_total_m", p.error_total},
                        {"on_front", p.on_front}});
    return rows;
}

std::vector<NamedPlot> work_precision_plots(const std::vector<WorkPoint>& points) {
    std::vector<NamedPlot> out;
    const auto plot = [&](const std::string& name, const std::string& title, bool in_time, const auto& series_of) {
        Plot p;
        p.title = title;
        p.x_axis = "wall time for one second of motion [s]";
        p.y_axis = in_time ? "rms error of the tip in time [m]" : "rms error of the tip to the continuum [m]";
        p.pareto = true;
        for (const WorkPoint& w : points) {
            const std::string series = series_of(w);
            if (series.empty()) continue;
            auto it =
                std::find_if(p.series.begin(), p.series.end(), [&](const PlotSeries& s) { return s.name == series; });
            if (it == p.series.end()) it = p.series.insert(p.series.end(), {series, {}, true});
            it->points.push_back({w.timing.seconds, in_time ? w.error_time : w.error_total,
                                  w.setting + ": " + number(w.timing.seconds, 3) + " s, " +
                                      number(1000 * (in_time ? w.error_time : w.error_total), 3) + " mm"});
        }
        if (!p.series.empty()) out.push_back({name, std::move(p)});
    };
    // The widest range of each sweep, for the titles.
    std::map<std::string, int> substeps;
    double tightest = 1, loosest = 0;
    for (const WorkPoint& w : points) {
        substeps[w.sweep] = std::max(substeps[w.sweep], w.substeps);
        if (w.sweep == "Newton tolerance")
            tightest = std::min(tightest, w.tolerance), loosest = std::max(loosest, w.tolerance);
    }
    const auto power = [](double v) { return "1e" + std::to_string(std::lround(std::log10(v))); };
    plot("work_precision_time",
         "Integrators: 1 to " + std::to_string(substeps["sub-steps"]) + " sub-steps a frame, same mesh", true,
         [](const WorkPoint& w) { return w.sweep == "sub-steps" ? w.integrator : std::string(); });
    plot("work_precision_newton",
         "Newton's tolerance: " + power(loosest) + " to " + power(tightest) + ", TR-BDF2, 4 sub-steps", true,
         [](const WorkPoint& w) { return w.sweep == "Newton tolerance" ? std::string("tolerance") : std::string(); });
    plot("work_precision_total", "All choices, log neo-Hookean bar", false, [](const WorkPoint& w) {
        if (w.law != "LogNeoHookean" || w.sweep == "law") return std::string();
        if (w.sweep == "sub-steps") return "sub-steps, " + w.integrator;
        if (w.sweep == "tet size") return "tet size, " + w.element;
        if (w.sweep == "linear solver") return "size, " + w.linear_solver;
        return w.sweep;
    });
    plot("work_precision_law", "Laws: 1 to " + std::to_string(substeps["law"]) + " sub-steps, TR-BDF2, same mesh", true,
         [](const WorkPoint& w) { return w.sweep == "law" ? w.law : std::string(); });
    return out;
}

} // namespace sinew::bench
