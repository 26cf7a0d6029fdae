// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/locking.h"

#include "tools/bench/reference.h"
#include "tools/bench/studies.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sinew::bench {

using namespace solver;

namespace {

constexpr ElasticLaw law = ElasticLaw::log_neo_hookean; // Cook's panel has reference values for it
constexpr double gravity_ratio = 0.4;                   // Poisson's, of the catalogue's cantilever

/// One way of modelling a problem, and the meshes it is run on. (Linear tets of Cook's panel need an even number of
/// layers to have a vertex where the displacement is asked for.)
struct Variant {
    std::string element;
    ElementKind kind;
    TissueInputs values;
    std::vector<MeshLevel> meshes;
};

struct Problem {
    std::string name, file;
    std::function<Quantity(const RunOptions&)> converged;
    std::function<double(const MeshLevel&, const Variant&, const std::stop_token&, Work&)> displacement;
    std::vector<Variant> variants;
};

double shear_modulus(double youngs_modulus, double poissons_ratio) {
    return youngs_modulus / (2 * (1 + poissons_ratio));
}

/// The same stiffness at small strain, but the part of the bulk modulus that exceeds a Poisson's ratio of 0.3 is
/// volumeConservation, which linear tets take over patches of several.
TissueInputs bulk_in_patches(double youngs_modulus, double poissons_ratio) {
    const double base = 0.3, mu = shear_modulus(youngs_modulus, poissons_ratio);
    const auto lambda = [mu](double nu) { return 2 * mu * nu / (1 - 2 * nu); };
    TissueInputs out = material(2 * mu * (1 + base), base);
    out.layers[0].volume_conservation = lambda(poissons_ratio) - lambda(base);
    return out;
}

Problem cook(const std::string& nu) {
    Problem p;
    p.name = "Cook's panel, nu " + nu, p.file = "cook_" + nu.substr(2);
    p.converged = [nu](const RunOptions&) { return cook_study(nu, ElementKind::linear).quantities[1]; };
    p.displacement = [](const MeshLevel& m, const Variant& v, const std::stop_token& stop, Work& work) {
        return cook_corner(m, law, v.kind, v.values, stop, work).y();
    };
    const double ratio = std::stod(nu);
    const std::vector<MeshLevel> linear{
        {4, 4, 2}, {8, 8, 2}, {16, 16, 2, 0, false}, {20, 20, 2, 0, false}, {32, 32, 4, 0, false}};
    p.variants = {{"linear", ElementKind::linear, material(cook_modulus, ratio), linear},
                  {"linear + volumeConservation", ElementKind::linear, bulk_in_patches(cook_modulus, ratio), linear},
                  {"quadratic",
                   ElementKind::quadratic,
                   material(cook_modulus, ratio),
                   {{4, 4, 1}, {8, 8, 2, 0, false}, {12, 12, 2, 0, false}, {20, 20, 2, 0, false}}}};
    return p;
}

/// What refinement of an incompressible body of the same shear modulus leads to: quadratic tets at a Poisson's ratio of
/// 0.4999 on two meshes, one of half the cells, extrapolated at first order. The edges of the clamped face are
/// singular, and that is the order that meshes are seen to converge at. It is as well known as the finer mesh is far
/// from it.
Quantity incompressible_tip(const RunOptions& options) {
    const double nu = 0.4999;
    const TissueInputs values = material(2 * (1 + nu) * shear_modulus(gravity_modulus, gravity_ratio), nu);
    double coarse = 0, fine = 0;
    Work ignored;
    for (const int across : options.quick ? std::vector<int>{1, 2} : std::vector<int>{2, 4}) {
        options.tell("the incompressible cantilever, " + std::to_string(across) + " cells across");
        coarse = std::exchange(
            fine,
            gravity_tip({8 * across, across, across}, law, ElementKind::quadratic, values, options.stop, ignored).z());
    }
    return {"tip uz [m]", 2 * fine - coarse, std::abs(fine - coarse), {}};
}

/// The catalogue's, with volumeConservation of so many times Young's modulus.
Problem cantilever(double conservation) {
    Problem p;
    p.name = conservation > 0 ? "cantilever, volumeConservation " + number(conservation) + " E"
                              : "cantilever, no volumeConservation";
    p.file = conservation > 0 ? "cantilever_volume" : "cantilever";
    p.converged = [conservation](const RunOptions& options) {
        if (conservation > 0) return incompressible_tip(options);
        const nlohmann::json& known = reference_values()["cantilever_gravity"]["continuum"]["nh"]["tip_uz"];
        return Quantity{"tip uz [m]", known["value"], known["errbar"], {}};
    };
    p.displacement = [](const MeshLevel& m, const Variant& v, const std::stop_token& stop, Work& work) {
        return gravity_tip(m, law, v.kind, v.values, stop, work).z();
    };
    TissueInputs values = material(gravity_modulus, gravity_ratio);
    values.layers[0].volume_conservation = conservation * gravity_modulus;
    p.variants = {{"linear",
                   ElementKind::linear,
                   values,
                   {{16, 2, 2}, {32, 4, 4, 0, false}, {48, 4, 4, 0, false}, {64, 8, 8, 0, false}}},
                  {"quadratic",
                   ElementKind::quadratic,
                   values,
                   {{8, 1, 1}, {16, 2, 2}, {24, 3, 3, 0, false}, {32, 4, 4, 0, false}}}};
    return p;
}

std::vector<Problem> problems() { return {cook("0.49"), cook("0.499"), cantilever(1e3), cantilever(0)}; }

/// Marks the points that no other of the same problem beats in time and error.
void mark_front(std::vector<LockingPoint>& points) {
    for (const Problem& problem : problems()) {
        std::vector<std::size_t> members;
        std::vector<PlotPoint> plotted;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (points[i].problem == problem.name)
                members.push_back(i), plotted.push_back({points[i].timing.seconds, points[i].error, ""});
        for (const std::size_t k : pareto_front(plotted)) points[members[k]].on_front = true;
    }
}

} // namespace

std::vector<LockingPoint> run_locking(const RunOptions& options) {
    const std::vector<Problem> all = problems();
    struct Plan {
        const Problem* problem;
        const Variant* variant;
        const MeshLevel* mesh;
    };
    std::vector<Plan> plans;
    std::vector<LockingPoint> points;
    for (const Problem& problem : all) {
        if (!options.wants(problem.name)) continue;
        const Quantity converged = problem.converged(options);
        for (const Variant& variant : problem.variants)
            for (const MeshLevel& mesh : variant.meshes) {
                if (options.quick && !mesh.quick) continue;
                plans.push_back({&problem, &variant, &mesh});
                LockingPoint p;
                p.problem = problem.name, p.element = variant.element, p.mesh = mesh.name();
                p.tets = 6 * mesh.nx * mesh.ny * mesh.nz;
                p.converged = converged.continuum, p.converged_error = converged.continuum_error;
                points.push_back(std::move(p));
            }
    }
    const auto seconds = in_turns(plans.size(), options.quick ? 1 : 5, [&](std::size_t i, int turn) {
        LockingPoint& p = points[i];
        options.tell(p.problem + ", " + p.element + ", " + p.mesh + ", run " + std::to_string(turn + 1));
        Work work;
        p.value = plans[i].problem->displacement(*plans[i].mesh, *plans[i].variant, options.stop, work);
        p.error = std::abs(p.value / p.converged - 1);
        p.newton = work.newton, p.unconverged = work.unconverged, p.linear_iterations = work.linear_iterations;
        return work.seconds;
    });
    for (std::size_t i = 0; i < points.size(); ++i) points[i].timing = summary_of(seconds[i]);
    mark_front(points);
    return points;
}

std::vector<LockingPoint> modest_ones(std::vector<LockingPoint> points) {
    std::erase_if(points, [](const LockingPoint& p) { return p.tets > modest_tets; });
    return points;
}

Table locking_table(const std::vector<LockingPoint>& points) {
    Table t{{"problem", "element", "mesh", "tets", "displacement [m]", "converged [m]", "error [%]", "within 10 %",
             "time [s] (median)", "runs", "spread [s]", "Newton", "CG", "front"},
            {}};
    for (const LockingPoint& p : points)
        t.rows.push_back({p.problem, p.element, p.mesh, std::to_string(p.tets), number(p.value, 6),
                          number(p.converged, 6) + " ± " + number(p.converged_error, 1), number(100 * p.error, 3),
                          p.error <= promised_error ? "yes" : "no", number(p.timing.seconds, 3),
                          std::to_string(p.timing.repeats), spread_of(p.timing), std::to_string(p.newton),
                          std::to_string(p.linear_iterations),
                          p.unconverged ? "not converged"
                          : p.on_front  ? "yes"
                                        : ""});
    return t;
}

nlohmann::ordered_json locking_json(const std::vector<LockingPoint>& points) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const LockingPoint& p : points)
        rows.push_back({{"problem", p.problem},
                        {"element", p.element},
                        {"mesh", p.mesh},
                        {"tets", p.tets},
                        {"displacement_m", p.value},
                        {"converged_m", p.converged},
                        {"converged_error_m", p.converged_error},
                        {"error", p.error},
                        {"seconds_median", p.timing.seconds},
                        {"seconds_least", p.timing.least},
                        {"seconds_most", p.timing.most},
                        {"repeats", p.timing.repeats},
                        {"newton", p.newton},
                        {"linear_iterations", p.linear_iterations},
                        {"unconverged", p.unconverged},
                        {"on_front", p.on_front}});
    return rows;
}

std::vector<NamedPlot> locking_plots(const std::vector<LockingPoint>& points) {
    std::vector<NamedPlot> out;
    for (const Problem& problem : problems()) {
        Plot plot;
        plot.title = problem.name + ": numbers are tets";
        plot.x_axis = "wall time [s]", plot.y_axis = "relative error of the displacement";
        plot.pareto = true;
        plot.levels = {{promised_error, "10 % off"}};
        for (const Variant& variant : problem.variants) {
            PlotSeries series{variant.element, {}, true};
            for (const LockingPoint& p : points)
                if (p.problem == problem.name && p.element == variant.element)
                    series.points.push_back(
                        {p.timing.seconds, p.error,
                         p.mesh + ": " + number(p.timing.seconds, 3) + " s, " + number(100 * p.error, 3) + " %",
                         std::to_string(p.tets)});
            if (!series.points.empty()) plot.series.push_back(std::move(series));
        }
        if (!plot.series.empty()) out.push_back({"work_precision_" + problem.file, std::move(plot)});
    }
    return out;
}

} // namespace sinew::bench
