// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/levers.h"

#include "tools/bench/cantilever.h"
#include "tools/bench/hessian_choice.h"
#include "tools/bench/reference.h"
#include "tools/bench/studies.h"
#include "tools/bench/turns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tbb/task_arena.h>

namespace sinew::bench {

using namespace solver;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Something that is measured; several levers may share it.
struct Choice {
    std::string name;
    std::function<LeverEnd(const std::stop_token&)> run;
};

/// A lever between two choices, by their numbers.
struct Plan {
    std::string name, subject, of;
    std::size_t without, with;
};

struct Plans {
    std::vector<Choice> choices;
    std::vector<Plan> levers;
    std::size_t add(Choice choice) {
        choices.push_back(std::move(choice));
        return choices.size() - 1;
    }
};

/// The cantilever of `sinew bench cantilever`, its first steps.
Choice cantilever(const std::string& name, int n, LinearMethod method, int threads) {
    return {name + ", " + std::to_string(n) + " cells", [=](const std::stop_token& stop) {
                CantileverOptions c;
                c.n = n, c.linear = method, c.steps = 6;
                CantileverResult r;
                const auto run = [&] { r = run_cantilever(c, stop); };
                threads > 0 ? tbb::task_arena(threads).execute(run) : run();
                return LeverEnd{name, r.seconds_per_step_median, r.newton_per_step, r.tip_y,
                                nan,  r.unconverged == 0,        r.digest.hex()};
            }};
}

void linear_methods_and_threads(Plans& plans, int n) {
    const std::string subject = "cantilever, " + std::to_string(3 * n * n * n / 8) + " tets";
    const std::size_t plain = plans.add(cantilever("Plain", n, LinearMethod::plain, 0)),
                      direct = plans.add(cantilever("Direct", n, LinearMethod::direct, 0)),
                      iterative = plans.add(cantilever("Iterative", n, LinearMethod::iterative, 0)),
                      automatic = plans.add(cantilever("Auto", n, LinearMethod::automatic, 0)),
                      one = plans.add(cantilever("1 thread", n, LinearMethod::automatic, 1)),
                      two = plans.add(cantilever("2 threads", n, LinearMethod::automatic, 2));
    for (const auto& [a, b] : {std::pair{plain, direct}, {direct, iterative}, {plain, automatic}})
        plans.levers.push_back({"linear method", subject, "a step", a, b});
    plans.levers.push_back({"threads", subject, "a step", one, two});
}

/// The step after `steps_before`, with Hessians projected always and only where they must be.
void hessian(Plans& plans, const std::string& subject, const TissueRest& rest, const StepInputs& inputs,
             int steps_before, const Vec3& tip) {
    const auto shared = std::make_shared<const TissueRest>(rest);
    std::size_t ends[2];
    for (const bool always : {true, false}) {
        const std::string name = always ? "always projected" : "exact where definite";
        ends[!always] =
            plans.add({name + ", " + subject, [=](const std::stop_token& stop) {
                           Simulation sim({{shared}, {}}, inputs, stop);
                           for (int i = 0; i < steps_before; ++i) sim.step();
                           const HessianRun r = solve_step(sim.scene(), sim.state, inputs, always, stop);
                           const double moved = (position(r.x, vertex_at(shared->tets.vertices, tip)) - tip).norm();
                           return LeverEnd{name, r.seconds, static_cast<double>(r.newton), moved, nan, r.converged, ""};
                       }});
    }
    plans.levers.push_back({"Hessian", subject, "a step", ends[0], ends[1]});
}

void hessians(Plans& plans, bool quick) {
    StepInputs in = tight_inputs();
    in.tolerance_factor = 1;
    in.step_size = 1.0 / 48, in.gravity = Vec3(0, -9.81, 0);
    in.bodies = {material(1e5, 0.45)};
    const int n = quick ? 8 : 24;
    hessian(plans, "cantilever, " + std::to_string(3 * n * n * n / 8) + " tets, step 11",
            cantilever_rest(n, ElasticLaw::neo_hookean), in, 10, Vec3(1, 0.125, 0.125));
    in.integrator = Integrator::quasi_static;
    hessian(plans, "cantilever, " + std::to_string(3 * n * n * n / 8) + " tets, from rest to equilibrium",
            cantilever_rest(n, ElasticLaw::neo_hookean), in, 0, Vec3(1, 0.125, 0.125));
}

/// The gravity cantilever at equal error: the coarsest quadratic mesh is still nearer than the finest linear one.
void element(Plans& plans, bool quick) {
    const double converged = reference_values()["cantilever_gravity"]["continuum"]["nh"]["tip_uz"]["value"];
    const auto choice = [&](ElementKind kind, const MeshLevel& mesh) {
        const std::string name = (kind == ElementKind::linear ? "linear, " : "quadratic, ") +
                                 std::to_string(6 * mesh.nx * mesh.ny * mesh.nz) + " tets";
        return plans.add({name, [=](const std::stop_token& stop) {
                              Work work;
                              const Vec3 u = gravity_tip(mesh, ElasticLaw::log_neo_hookean, kind,
                                                         material(gravity_modulus, 0.4), stop, work);
                              return LeverEnd{name,
                                              work.seconds,
                                              static_cast<double>(work.newton) / work.steps,
                                              u.z(),
                                              std::abs(u.z() / converged - 1),
                                              work.unconverged == 0,
                                              ""};
                          }});
    };
    const MeshLevel fine = quick ? MeshLevel{16, 2, 2} : MeshLevel{64, 8, 8};
    const std::size_t linear = choice(ElementKind::linear, fine), quadratic = choice(ElementKind::quadratic, {8, 1, 1});
    plans.levers.push_back({"element", "gravity cantilever, no worse error", "the solution", linear, quadratic});
}

} // namespace

std::vector<Lever> run_levers(const RunOptions& options) {
    Plans plans;
    for (const int n : options.quick ? std::vector<int>{8} : std::vector<int>{24, 40})
        linear_methods_and_threads(plans, n);
    hessians(plans, options.quick);
    element(plans, options.quick);
    std::erase_if(plans.levers, [&](const Plan& p) { return !options.wants(p.name); });
    std::vector<std::size_t> needed;
    for (std::size_t i = 0; i < plans.choices.size(); ++i)
        if (std::any_of(plans.levers.begin(), plans.levers.end(),
                        [i](const Plan& p) { return p.without == i || p.with == i; }))
            needed.push_back(i);

    std::vector<LeverEnd> ends(plans.choices.size());
    const auto measured = in_turns(needed.size(), options.quick ? 1 : 5, [&](std::size_t k, int turn) {
        options.tell("levers, " + plans.choices[needed[k]].name + ", run " + std::to_string(turn + 1));
        ends[needed[k]] = plans.choices[needed[k]].run(options.stop);
        return ends[needed[k]].seconds;
    });
    std::vector<std::vector<double>> seconds(plans.choices.size());
    for (std::size_t k = 0; k < needed.size(); ++k) {
        seconds[needed[k]] = measured[k];
        ends[needed[k]].seconds = median(measured[k]);
    }
    std::vector<Lever> out;
    for (const Plan& p : plans.levers) {
        Lever l{p.name, p.subject, p.of, ends[p.without], ends[p.with]};
        std::vector<double> ratios;
        for (std::size_t turn = 0; turn < std::min(seconds[p.without].size(), seconds[p.with].size()); ++turn)
            ratios.push_back(seconds[p.without][turn] / seconds[p.with][turn]);
        const Timing range = summary_of(ratios);
        l.ratio = range.seconds, l.least = range.least, l.most = range.most, l.turns = range.repeats;
        out.push_back(std::move(l));
    }
    return out;
}

Table levers_table(const std::vector<Lever>& levers) {
    Table t{{"lever", "measured on", "time of", "without", "with", "without [ms]", "with [ms]", "ratio (median)",
             "range", "turns", "Newton a step", "result [m]", "note"},
            {}};
    const auto both = [](const std::string& a, const std::string& b) { return a == b ? a : a + " → " + b; };
    for (const Lever& l : levers) {
        std::string note;
        if (!l.without.converged || !l.with.converged)
            note = "not converged";
        else if (std::isfinite(l.with.error))
            note = "error " + number(100 * l.without.error, 3) + " % → " + number(100 * l.with.error, 3) + " %";
        else if (!l.with.digest.empty() && l.without.digest == l.with.digest)
            note = "same bits";
        t.rows.push_back({l.name, l.subject, l.of, l.without.choice, l.with.choice, number(1000 * l.without.seconds, 3),
                          number(1000 * l.with.seconds, 3), number(l.ratio, 3),
                          number(l.least, 3) + "…" + number(l.most, 3), std::to_string(l.turns),
                          both(number(l.without.newton, 3), number(l.with.newton, 3)),
                          both(number(l.without.value, 6), number(l.with.value, 6)), note});
    }
    return t;
}

nlohmann::ordered_json levers_json(const std::vector<Lever>& levers) {
    const auto end = [](const LeverEnd& e) {
        return nlohmann::ordered_json{{"choice", e.choice}, {"seconds", e.seconds}, {"newton", e.newton},
                                      {"value_m", e.value}, {"error", e.error},     {"converged", e.converged},
                                      {"digest", e.digest}};
    };
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const Lever& l : levers)
        rows.push_back({{"lever", l.name},
                        {"subject", l.subject},
                        {"of", l.of},
                        {"without", end(l.without)},
                        {"with", end(l.with)},
                        {"ratio", l.ratio},
                        {"ratio_least", l.least},
                        {"ratio_most", l.most},
                        {"turns", l.turns}});
    return rows;
}

std::string vector_instructions() {
#if defined(__AVX512F__)
    return "AVX-512";
#elif defined(__AVX2__)
    return "AVX2";
#else
    return "the least of its processor family";
#endif
}

} // namespace sinew::bench
