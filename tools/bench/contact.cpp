// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/contact.h"

#include "engine/evaluator.h"
#include "nodes/values.h"
#include "solver/term/measure.h"
#include "tools/bench/beams.h"
#include "tools/bench/cantilever.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

namespace sinew::bench {

namespace {

/// What should stay where it is, seen from above: nothing pushes sideways in these scenes.
enum class Stays { nothing, body, upper_on_lower };

/// Times of stark 0.1.0 with 2 threads on this kind of machine: median of the steps [s], mean Newton iterations. It
/// stops at a change of velocity below 1e-3 m/s.
struct Peer {
    std::string_view scene;
    Stays stays = Stays::nothing;
    double seconds = 0, newton = 0; ///< 0: none were recorded
};
constexpr Peer peers[] = {
    {"a_tilt_6k", Stays::body, .016, 1.7},
    {"a_tilt_24k", Stays::body, .068, 1.8},
    {"b_stack_12k", Stays::upper_on_lower, .044, 1.4},
    {"b_stack_49k", Stays::upper_on_lower, .128, 1.5},
    {"c_balls_10", Stays::nothing, .067, 4.9},
    {"c_balls_20", Stays::nothing, .107, 7.7},
    {"c_cubes_10", Stays::nothing, .054, 5.1},
    {"c_cubes_20", Stays::nothing, .52, 16},
    {"d_squeeze_6k", Stays::nothing, .047, 4.1},
    {"d_squeeze_24k", Stays::nothing, .24, 5.3},
    {"f_drag_6k", Stays::nothing, .049, 5.1},
    {"f_drag_30k", Stays::nothing, .20, 5.7},
    {"g_fast_6k", Stays::body},
    {"g_thin_5.1", Stays::body},
};
/// Of this program's yardstick, in the hour in which those times were taken [s].
constexpr double recorded_cantilever_s = .021;

const Peer* peer_of(const std::string& scene) {
    const auto* it = std::find_if(std::begin(peers), std::end(peers), [&](const Peer& p) { return p.scene == scene; });
    return it == std::end(peers) ? nullptr : it;
}

/// Of every body: tissues their centre of mass, by the volumes of their tets at rest; bones their lowest point.
struct Places {
    std::vector<solver::Vec3> centres; ///< of tissues, in their order
    std::vector<int> tissues;          ///< places in zSolver.bodies
    double floor = std::numeric_limits<double>::infinity();
};

solver::Vec3 centre_of_mass(const solver::TetMesh& rest, const solver::Points& now) {
    solver::Vec3 sum = solver::Vec3::Zero();
    double total = 0;
    for (std::size_t t = 0; t < rest.tets.size(); ++t) {
        const auto at = [&](const solver::Points& p, int corner) -> const solver::Vec3& {
            return p[static_cast<std::size_t>(rest.tets[t][static_cast<std::size_t>(corner)])];
        };
        const double share = rest.coverage.empty() ? 1 : rest.coverage[t];
        const double volume = share * solver::tet_volume(at(rest.vertices, 0), at(rest.vertices, 1),
                                                         at(rest.vertices, 2), at(rest.vertices, 3));
        sum += volume / 4 * (at(now, 0) + at(now, 1) + at(now, 2) + at(now, 3));
        total += volume;
    }
    return sum / total;
}

Places places_of(const nodes::Solved& solved, int up) {
    Places out;
    for (std::size_t b = 0; b < solved.rests.size(); ++b) {
        const auto* tissue = std::get_if<std::shared_ptr<const solver::TissueRest>>(&solved.rests[b]->data);
        if (tissue) {
            out.centres.push_back(centre_of_mass((*tissue)->tets, solved.positions[b]));
            out.tissues.push_back(static_cast<int>(b));
        } else {
            for (const solver::Vec3& p : solved.positions[b]) out.floor = std::min(out.floor, p[up]);
        }
    }
    return out;
}

/// Way across since the start of what should stay, in scene units.
double way_across(Stays stays, const Places& start, const Places& now, int up) {
    solver::Vec3 way = now.centres.back() - start.centres.back();
    if (stays == Stays::upper_on_lower) way -= now.centres.front() - start.centres.front();
    way[up] = 0;
    return way.norm();
}

/// Frame after frame into the row; stops where an error does.
void run_frames(const ContactScene& scene, const RunOptions& options, Stays stays, ContactRow& row,
                std::vector<double>& seconds) {
    using Clock = std::chrono::steady_clock;
    engine::Evaluator evaluator;
    const int up = scene.up == 'z' ? 2 : 1;
    const auto pull = [&](const char* output, int frame) {
        return evaluator.pull({scene.graph, {scene.solver, output}, static_cast<double>(frame), options.stop});
    };
    const Places start = places_of(pull("outSolved", scene.first).as<nodes::Solved>(), up);
    const auto begin = Clock::now();
    Places now = start;
    for (int frame = scene.first + 1; frame <= scene.last; ++frame) {
        const auto before = Clock::now();
        const engine::Value report = pull("outReport", frame);
        seconds.push_back(std::chrono::duration<double>(Clock::now() - before).count());
        const auto& solved = report.as<nodes::SolveReport>();
        const solver::StepRecord& r = solved.record;
        row.tets = solved.tets, row.unknowns = solved.dofs, ++row.frames;
        row.assembly_s += r.seconds_assembly, row.factor_s += r.seconds_factor;
        row.solve_s += r.seconds_solve, row.other_s += r.seconds_other;
        row.newton += r.newton_iterations, row.linear += r.linear_iterations, row.factors += r.factorizations;
        row.newton_most = std::max(row.newton_most, r.newton_iterations);
        row.unconverged += !r.converged, row.halvings += r.halvings;
        row.inverted = std::max(row.inverted, r.inverted), row.least_j = std::min(row.least_j, r.min_j);
        row.contacts = std::max(row.contacts, static_cast<int>(solver::value_of(r.measured, "contact", "contacts")));
        row.depth_m = std::max(row.depth_m, solver::value_of(r.measured, "contact", "max_depth_m"));
        now = places_of(pull("outSolved", frame).as<nodes::Solved>(), up);
        if (stays != Stays::nothing && !start.centres.empty())
            row.drift_m = std::max(row.drift_m.value_or(0), way_across(stays, start, now, up) / scene.units_per_metre);
        if (std::chrono::duration<double>(Clock::now() - begin).count() > scene.longest_s && frame < scene.last) {
            row.ended = "stopped after frame " + std::to_string(frame) + " of " + std::to_string(scene.last) +
                        ": more than " + number(scene.longest_s) + " s";
            break;
        }
    }
    for (std::size_t k = 0; k < now.centres.size(); ++k)
        if (now.centres[k][up] < now.floor)
            row.fallen.push_back(scene.bodies[static_cast<std::size_t>(now.tissues[k])]);
}

} // namespace

bool has_peer(const std::string& scene) {
    const Peer* peer = peer_of(scene);
    return peer && peer->seconds > 0;
}

double contact_yardstick(const RunOptions& options) {
    options.tell("cantilever, n 40, E 1e5");
    return run_cantilever({.n = 40, .youngs_modulus = 1e5}, options.stop).seconds_per_step_median;
}

ContactRow run_contact_scene(const ContactScene& scene, const RunOptions& options, std::optional<double> cantilever_s) {
    ContactRow row;
    row.scene = std::filesystem::path(scene.graph->file()).stem().string();
    options.tell(row.scene);
    const Peer* peer = peer_of(row.scene);
    std::vector<double> seconds;
    try {
        run_frames(scene, options, peer ? peer->stays : Stays::nothing, row, seconds);
    } catch (const engine::Failure& e) {
        const engine::Diagnostic& d = e.diagnostics().front();
        row.ended = d.code + " at frame " + std::to_string(scene.first + 1 + row.frames) + ": " + d.message;
    }
    if (!seconds.empty()) {
        for (double* sum :
             {&row.assembly_s, &row.factor_s, &row.solve_s, &row.other_s, &row.newton, &row.linear, &row.factors})
            *sum /= row.frames;
        for (const double s : seconds) row.mean_s += s / static_cast<double>(seconds.size());
        row.median_s = median(seconds);
        row.longest_s = *std::max_element(seconds.begin(), seconds.end());
    }
    if (has_peer(row.scene)) {
        row.peer_s = peer->seconds, row.peer_newton = peer->newton;
        if (cantilever_s && row.frames > 0)
            row.ratio = row.median_s / (peer->seconds * *cantilever_s / recorded_cantilever_s);
    }
    return row;
}

namespace {

std::string number_or_dash(const std::optional<double>& value, double scale, int digits) {
    return value ? number(scale * *value, digits) : "-";
}

std::string list_of(const std::vector<std::string>& words) {
    std::string out;
    for (const std::string& w : words) out += (out.empty() ? "" : ", ") + w;
    return out;
}

} // namespace

Table contact_table(const ContactBench& result) {
    Table t{{"scene",
             "tets",
             "unknowns",
             "frames",
             "ms per frame: median",
             "mean",
             "longest",
             "other engine's median",
             "ratio",
             "Newton per frame",
             "most",
             "other engine's",
             "linear iterations",
             "factors",
             "contacts",
             "deepest [mm]",
             "inverted",
             "unconverged",
             "drift [mm]",
             "fell through"},
            {}};
    for (const ContactRow& r : result.rows)
        t.rows.push_back({r.scene,
                          std::to_string(r.tets),
                          std::to_string(r.unknowns),
                          std::to_string(r.frames),
                          number(1e3 * r.median_s, 3),
                          number(1e3 * r.mean_s, 3),
                          number(1e3 * r.longest_s, 3),
                          number_or_dash(r.peer_s, 1e3, 3),
                          number_or_dash(r.ratio, 1, 2),
                          number(r.newton, 2),
                          std::to_string(r.newton_most),
                          number_or_dash(r.peer_newton, 1, 2),
                          number(r.linear, 3),
                          number(r.factors, 2),
                          std::to_string(r.contacts),
                          number(1e3 * r.depth_m, 3),
                          std::to_string(r.inverted),
                          std::to_string(r.unconverged),
                          number_or_dash(r.drift_m, 1e3, 2),
                          r.fallen.empty() ? "none" : list_of(r.fallen)});
    return t;
}

nlohmann::ordered_json contact_json(const ContactBench& result) {
    const auto or_null = [](const std::optional<double>& value) {
        return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
    };
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const ContactRow& r : result.rows)
        out.push_back({{"scene", r.scene},
                       {"tets", r.tets},
                       {"unknowns", r.unknowns},
                       {"frames", r.frames},
                       {"s_per_frame_median", r.median_s},
                       {"s_per_frame_mean", r.mean_s},
                       {"s_per_frame_longest", r.longest_s},
                       {"peer_s_median", or_null(r.peer_s)},
                       {"ratio", or_null(r.ratio)},
                       {"assembly_s", r.assembly_s},
                       {"factor_s", r.factor_s},
                       {"solve_s", r.solve_s},
                       {"other_s", r.other_s},
                       {"newton_per_frame", r.newton},
                       {"newton_most", r.newton_most},
                       {"peer_newton", or_null(r.peer_newton)},
                       {"linear_per_frame", r.linear},
                       {"factors_per_frame", r.factors},
                       {"halvings", r.halvings},
                       {"unconverged", r.unconverged},
                       {"contacts", r.contacts},
                       {"max_depth_m", r.depth_m},
                       {"inverted", r.inverted},
                       {"min_J", r.least_j},
                       {"drift_m", or_null(r.drift_m)},
                       {"fallen", r.fallen},
                       {"ended", r.ended}});
    return out;
}

std::string contact_summary(const ContactBench& result) {
    std::string out = "a frame is all of its evaluation; drift: way across of what should stay";
    if (result.cantilever_s)
        out += "; ratio: median over that of stark 0.1.0 (2 threads), scaled by the cantilever, " +
               number(1e3 * *result.cantilever_s, 3) + " ms now and " + number(1e3 * recorded_cantilever_s, 3) +
               " ms when that was recorded";
    for (const ContactRow& r : result.rows) {
        if (r.is_sound()) continue;
        out += "\n" + r.scene + ":";
        if (!r.ended.empty()) out += " " + r.ended + ";";
        if (r.unconverged) out += " " + std::to_string(r.unconverged) + " frames not converged;";
        if (r.inverted) out += " " + std::to_string(r.inverted) + " tets inside out;";
        if (!r.fallen.empty()) out += " fell through: " + list_of(r.fallen) + ";";
        out.pop_back();
    }
    return out;
}

} // namespace sinew::bench
