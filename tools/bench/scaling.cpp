// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/scaling.h"

#include "solver/linear/blas_speed.h"
#include "solver/linear/cholesky.h"
#include "tools/bench/beams.h"
#include "tools/bench/cantilever.h"
#include "tools/bench/resident.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace sinew::bench {

using namespace solver;
using Clock = std::chrono::steady_clock;

namespace {

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double triad_rate(int threads, std::size_t entries, int repeats) {
    std::vector<double> a(entries), b(entries, 1.5), c(entries, 0.5), rates;
    tbb::task_arena arena(threads);
    arena.execute([&] {
        for (int i = 0; i <= repeats; ++i) {
            const auto start = Clock::now();
            tbb::parallel_for(
                tbb::blocked_range<std::size_t>(0, entries, entries / static_cast<std::size_t>(threads)),
                [&](const auto& range) {
                    for (std::size_t k = range.begin(); k < range.end(); ++k) a[k] = b[k] + 3.0 * c[k];
                },
                tbb::static_partitioner());
            if (i > 0) rates.push_back(24.0 * static_cast<double>(entries) / seconds_since(start));
        }
    });
    return median(rates);
}

/// What an iteration of conjugate gradients on the diagonal blocks reads and writes at least [bytes]: each block of
/// both triangles once (12 floats and a column number), and a row's part of the vectors at each pass over them.
double bytes_of_iteration(const TissueRest& rest) {
    std::vector<char> held(rest.tets.vertices.size(), 0);
    for (const int v : rest.fixed_vertices) held[static_cast<std::size_t>(v)] = 1;
    double edges = 0, rows = 0;
    for (const char h : held) rows += !h;
    for (const auto& [a, b] : edges_of(rest.tets.tets))
        edges += !held[static_cast<std::size_t>(a)] && !held[static_cast<std::size_t>(b)];
    constexpr double block = 48 + 4, vectors = 504;
    return (2 * edges + rows) * block + rows * vectors;
}

/// On 1 and 2 threads.
std::vector<MachineLimits> measure_limits(const RunOptions& options) {
    std::vector<MachineLimits> out;
    for (const int threads : {1, 2}) {
        options.tell("dgemm and triad on " + std::to_string(threads) + " threads");
        MachineLimits m;
        m.threads = threads;
        m.dgemm = dgemm_rate(options.quick ? 256 : 2048, threads, 5);
        m.triad = triad_rate(threads, options.quick ? 1 << 20 : 1 << 24, 9);
        out.push_back(m);
    }
    return out;
}

ScalingRow measure_cantilever(int n, const MachineLimits& limit, const RunOptions& options) {
    CantileverOptions c;
    c.n = n;
    c.steps = n <= 40 ? 6 : 4; // the first is not counted; each is several Newton iterations
    ScalingRow row;
    row.n = n, row.threads = limit.threads, row.steps = c.steps;
    options.tell("cantilever of " + std::to_string(3 * n * n * n / 8) + " tets, " + std::to_string(limit.threads) +
                 " threads");
    const double bytes = bytes_of_iteration(cantilever_rest(n, ElasticLaw::neo_hookean));
    const double before = resident_bytes();
    double after = 0;
    c.at_end = [&after] { after = resident_bytes(); };
    CantileverResult r;
    tbb::task_arena(limit.threads).execute([&] { r = run_cantilever(c, options.stop); });
    row.tets = r.tets, row.vertices = r.vertices, row.unconverged = r.unconverged;
    row.newton_ms = r.newton_ms_median, row.assembly_ms = r.assembly_ms, row.factor_ms = r.factor_ms;
    row.solve_ms = r.solve_ms, row.other_ms = r.other_ms, row.linear_iterations = r.linear_iterations;
    row.bytes_per_tet = std::max(0.0, after - before) / r.tets;
    row.bandwidth_share = r.factor_ms > 0 || !(r.solve_ms > 0)
                              ? std::numeric_limits<double>::quiet_NaN()
                              : bytes * r.linear_iterations / (1e-3 * r.solve_ms) / limit.triad;
    return row;
}

FactorRow measure_factor(int n, double dgemm) {
    const auto rest = cantilever_rest(n, ElasticLaw::neo_hookean);
    const Scene scene({{std::make_shared<const TissueRest>(rest)}, {}});
    StepInputs in = tight_inputs();
    in.step_size = 1.0 / 48;
    in.bodies = {material(1e5, 0.45)};
    const State state = initial_state(scene, in);
    Potential potential(scene);
    ImplicitForm form;
    potential.take(state, in);
    potential.begin_step(state, in);
    backward_euler_form(state, in.step_size, form);
    potential.begin_stage(state, form, state.bones);
    BlockMatrix a(potential.pattern());
    potential.assemble(state.x, false, a);

    FactorRow row;
    row.n = n, row.tets = static_cast<int>(rest.tets.tets.size());
    auto start = Clock::now();
    Cholesky factor(potential.pattern());
    row.analyse_ms = 1000 * seconds_since(start);
    std::vector<double> factoring, solving, b(3 * potential.unknown_count(), 1.0), x(b.size());
    for (int i = 0; i < 5; ++i) {
        start = Clock::now();
        factor.factorize(a);
        factoring.push_back(1000 * seconds_since(start));
        start = Clock::now();
        factor.solve(b.data(), x.data());
        solving.push_back(1000 * seconds_since(start));
    }
    row.factor_ms = median(factoring), row.solve_ms = median(solving);
    row.operations = factor.factor_operations();
    row.dgemm_share = row.operations / (1e-3 * row.factor_ms) / dgemm;
    return row;
}

} // namespace

ScalingResult run_scaling(const RunOptions& options) {
    ScalingResult out;
    const bool whole = options.wants("cantilever"), factors = options.wants("factor");
    if (options.wants("contact")) out.contact = run_contact_growth(options);
    if (!whole && !factors) return out;
    out.limits = measure_limits(options);
    if (whole)
        for (const int n : options.quick ? std::vector<int>{8, 12} : std::vector<int>{16, 24, 40, 60, 80, 112})
            for (const MachineLimits& limit : out.limits) out.rows.push_back(measure_cantilever(n, limit, options));
    if (factors)
        for (const int n : options.quick ? std::vector<int>{8, 12} : std::vector<int>{16, 24, 40, 60}) {
            options.tell("factor of " + std::to_string(3 * n * n * n / 8) + " tets");
            out.factors.push_back(measure_factor(n, out.limits.front().dgemm));
        }
    return out;
}

Table limits_table(const ScalingResult& result) {
    Table t{{"threads", "dgemm [GFLOP/s]", "triad [GB/s]"}, {}};
    for (const MachineLimits& m : result.limits)
        t.rows.push_back({std::to_string(m.threads), number(1e-9 * m.dgemm, 3), number(1e-9 * m.triad, 3)});
    return t;
}

Table scaling_table(const ScalingResult& result) {
    Table t{{"tets", "vertices", "threads", "Newton iteration [ms]", "assembly", "factor", "solve", "other", "CG its",
             "us per tet", "bytes per tet", "share of bandwidth", "note"},
            {}};
    for (const ScalingRow& r : result.rows)
        t.rows.push_back({std::to_string(r.tets), std::to_string(r.vertices), std::to_string(r.threads),
                          number(r.newton_ms, 3), number(r.assembly_ms, 3), number(r.factor_ms, 3),
                          number(r.solve_ms, 3), number(r.other_ms, 3), number(r.linear_iterations, 3),
                          number(1000 * r.newton_ms / r.tets, 3), number(r.bytes_per_tet, 3),
                          number(r.bandwidth_share, 2),
                          r.unconverged ? std::to_string(r.unconverged) + " steps did not converge" : ""});
    return t;
}

Table factor_table(const ScalingResult& result) {
    Table t{{"tets", "analyse [ms]", "factor [ms]", "solve [ms]", "GFLOP", "GFLOP/s", "share of dgemm"}, {}};
    for (const FactorRow& r : result.factors)
        t.rows.push_back({std::to_string(r.tets), number(r.analyse_ms, 3), number(r.factor_ms, 3),
                          number(r.solve_ms, 3), number(1e-9 * r.operations, 3),
                          number(1e-6 * r.operations / r.factor_ms, 3), number(r.dgemm_share, 2)});
    return t;
}

nlohmann::ordered_json scaling_json(const ScalingResult& result) {
    nlohmann::ordered_json limits = nlohmann::ordered_json::array(), rows = limits, factors = limits;
    for (const MachineLimits& m : result.limits)
        limits.push_back({{"threads", m.threads}, {"dgemm_flops", m.dgemm}, {"triad_bytes_per_s", m.triad}});
    for (const ScalingRow& r : result.rows)
        rows.push_back({{"n", r.n},
                        {"tets", r.tets},
                        {"vertices", r.vertices},
                        {"threads", r.threads},
                        {"steps", r.steps},
                        {"newton_ms", r.newton_ms},
                        {"assembly_ms", r.assembly_ms},
                        {"factor_ms", r.factor_ms},
                        {"solve_ms", r.solve_ms},
                        {"other_ms", r.other_ms},
                        {"linear_iterations", r.linear_iterations},
                        {"bytes_per_tet", r.bytes_per_tet},
                        {"bandwidth_share", r.bandwidth_share},
                        {"unconverged", r.unconverged}});
    for (const FactorRow& r : result.factors)
        factors.push_back({{"n", r.n},
                           {"tets", r.tets},
                           {"analyse_ms", r.analyse_ms},
                           {"factor_ms", r.factor_ms},
                           {"solve_ms", r.solve_ms},
                           {"operations", r.operations},
                           {"dgemm_share", r.dgemm_share}});
    return {{"limits", limits},
            {"cantilever", rows},
            {"factor", factors},
            {"contact", contact_growth_json(result.contact)}};
}

Plot scaling_plot(const ScalingResult& result) {
    Plot plot;
    plot.title = "One Newton iteration of the cantilever";
    plot.x_axis = "tets", plot.y_axis = "time [ms]";
    plot.slopes = {1};
    for (const MachineLimits& m : result.limits) {
        const std::string threads = m.threads == 1 ? ", 1 thread" : ", " + std::to_string(m.threads) + " threads";
        PlotSeries whole{"iteration" + threads, {}, true}, assembly{"assembly" + threads, {}, true};
        for (const ScalingRow& r : result.rows)
            if (r.threads == m.threads) {
                const double tets = r.tets;
                whole.points.push_back({tets, r.newton_ms, number(r.newton_ms, 3) + " ms"});
                assembly.points.push_back({tets, r.assembly_ms, number(r.assembly_ms, 3) + " ms"});
            }
        plot.series.push_back(whole), plot.series.push_back(assembly);
    }
    PlotSeries factor{"factor, direct", {}, true};
    for (const FactorRow& r : result.factors)
        factor.points.push_back({static_cast<double>(r.tets), r.factor_ms, number(r.factor_ms, 3) + " ms"});
    plot.series.push_back(factor);
    return plot;
}

} // namespace sinew::bench
