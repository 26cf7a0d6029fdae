// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/convergence.h"

#include "tools/bench/accuracy.h"
#include "tools/bench/bar_release.h"
#include "tools/bench/oscillator.h"
#include "tools/bench/studies.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace sinew::bench {

namespace {

void fill_orders(ConvergenceRow& row) {
    for (std::size_t i = 0; i < row.levels.size(); ++i)
        row.levels[i].order =
            i ? observed_order(row.levels[i - 1].h, row.levels[i - 1].error, row.levels[i].h, row.levels[i].error)
              : std::numeric_limits<double>::quiet_NaN();
}

void mesh_rows(const RunOptions& options, std::vector<ConvergenceRow>& out) {
    for (const MeshStudy& study : mesh_studies()) {
        if (!options.wants(study.name)) continue;
        const std::vector<LevelValues> levels = run_study(study, options);
        for (std::size_t q = 0; q < study.quantities.size(); ++q) {
            const double reference = study.quantities[q].continuum;
            if (!std::isfinite(reference)) continue;
            ConvergenceRow row{false, study.name, study.setting, study.quantities[q].name, 2, {}};
            for (const LevelValues& l : levels)
                row.levels.push_back(
                    {l.level.name(), l.level.h, std::abs(l.values[q] / reference - 1), 0, l.work.seconds});
            fill_orders(row);
            out.push_back(std::move(row));
        }
    }
}

void oscillator_rows(const RunOptions& options, std::vector<ConvergenceRow>& out) {
    if (!options.wants("oscillator")) return;
    options.tell("oscillator");
    for (const IntegratorName& scheme : integrators) {
        ConvergenceRow row{true, "oscillator", std::string(scheme.word), "height at 0.25 s [m]", scheme.order, {}};
        for (int steps = 500; steps <= (options.quick ? 2000 : 8000); steps *= 2)
            row.levels.push_back({"1/" + std::to_string(4 * steps), 0.25 / steps,
                                  Oscillator::error_at(scheme.integrator, 0.25, steps), 0, 0});
        fill_orders(row);
        out.push_back(std::move(row));
    }
}

void bar_rows(const RunOptions& options, std::vector<ConvergenceRow>& out) {
    const double length = 0.4;
    if (!options.wants("released bar")) return;
    for (const LawName& law : laws) {
        if (!bar_is_known(law)) continue;
        options.tell("released bar, " + std::string(law.catalogue));
        for (const IntegratorName& scheme : integrators) {
            ConvergenceRow row{true,
                               "released bar",
                               std::string(law.catalogue) + ", " + std::string(scheme.word),
                               "tip over 1 s, rms [L]",
                               scheme.order,
                               {}};
            for (int substeps = 1; substeps <= (options.quick ? 4 : 32); substeps *= 2) {
                const BarTrajectory run = run_bar({law, scheme, 8, substeps}, options.stop);
                row.levels.push_back({"1/" + std::to_string(24 * substeps), 1.0 / (24 * substeps),
                                      rms_distance(run.tip, bar_on_mesh(law, 8)) / length, 0, run.work.seconds});
            }
            fill_orders(row);
            out.push_back(std::move(row));
        }
    }
}

} // namespace

std::vector<ConvergenceRow> run_convergence(const RunOptions& options) {
    std::vector<ConvergenceRow> out;
    mesh_rows(options, out);
    oscillator_rows(options, out);
    bar_rows(options, out);
    return out;
}

Table convergence_table(const std::vector<ConvergenceRow>& rows) {
    Table t;
    t.columns = {"refines", "case", "setting", "quantity", "levels", "errors", "orders", "ideal order"};
    for (const ConvergenceRow& row : rows) {
        std::string names, errors, orders;
        for (std::size_t i = 0; i < row.levels.size(); ++i) {
            names += (i ? ", " : "") + row.levels[i].name;
            errors += (i ? ", " : "") + number(row.levels[i].error, 2);
            if (i) orders += (i > 1 ? ", " : "") + number(row.levels[i].order, 3);
        }
        t.rows.push_back({row.in_time ? "time step" : "mesh", row.name, row.setting, row.quantity, names, errors,
                          orders, number(row.expected_order)});
    }
    return t;
}

nlohmann::ordered_json convergence_json(const std::vector<ConvergenceRow>& rows) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const ConvergenceRow& row : rows) {
        nlohmann::ordered_json levels = nlohmann::ordered_json::array();
        for (const ConvergenceLevel& l : row.levels)
            levels.push_back(
                {{"name", l.name}, {"h", l.h}, {"error", l.error}, {"order", l.order}, {"seconds", l.seconds}});
        out.push_back({{"refines", row.in_time ? "time step" : "mesh"},
                       {"case", row.name},
                       {"setting", row.setting},
                       {"quantity", row.quantity},
                       {"ideal_order", row.expected_order},
                       {"levels", levels}});
    }
    return out;
}

Plot convergence_plot(const std::vector<ConvergenceRow>& rows, bool in_time) {
    Plot plot;
    plot.title = in_time ? "Error in time against the time step" : "Error against the size of a cell";
    plot.x_axis = in_time ? "time step [s]" : "side of a cell [m]";
    plot.y_axis = in_time ? "rms error of the tip / length" : "relative error to the continuum";
    plot.slopes = in_time ? std::vector<double>{1, 2} : std::vector<double>{2};
    for (const ConvergenceRow& row : rows) {
        // A picture holds a few lines: one law, one quantity a problem.
        const bool shown = in_time
                               ? row.in_time && row.name == "released bar" && row.setting.starts_with("nh")
                               : !row.in_time && ((row.name == "gravity cantilever" && row.setting.starts_with("nh") &&
                                                   row.quantity.starts_with("tip uz")) ||
                                                  (row.name == "Cook's panel" && row.quantity.starts_with("uy") &&
                                                   !row.setting.starts_with("nh nu 0.49,")) ||
                                                  (row.name == "free vibration" && row.quantity.starts_with("f1")));
        if (!shown) continue;
        PlotSeries series{(in_time ? "" : row.name + ", ") + row.setting, {}, true};
        if (row.name == "gravity cantilever") series.name = "cantilever" + row.setting.substr(2);
        if (row.name == "Cook's panel") series.name = "Cook" + row.setting.substr(2);
        if (row.name == "free vibration") series.name = "f1" + row.setting.substr(row.setting.find(','));
        for (const ConvergenceLevel& l : row.levels) series.points.push_back({l.h, l.error, l.name});
        plot.series.push_back(std::move(series));
    }
    return plot;
}

} // namespace sinew::bench
