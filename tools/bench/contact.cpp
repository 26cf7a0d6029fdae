// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/contact.h"

#include "engine/evaluator.h"
#include "nodes/values.h"
#include "solver/mesh/crossings.h"
#include "solver/term/measure.h"
#include "tools/bench/beams.h"
#include "tools/bench/cantilever.h"

#include <algorithm>
#include <array>
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
    {"e_cloth_50", Stays::nothing, .34, 16},
    {"e_cloth_100", Stays::nothing, 1.75, 22},
    {"g_fast_6k", Stays::body},
    {"g_thin_5.1", Stays::body},
};

const Peer* peer_of(const std::string& scene) {
    const auto* it = std::find_if(std::begin(peers), std::end(peers), [&](const Peer& p) { return p.scene == scene; });
    return it == std::end(peers) ? nullptr : it;
}

const solver::TetMesh* tets_of(const nodes::Solved& solved, std::size_t body) {
    const auto* tissue = std::get_if<std::shared_ptr<const solver::TissueRest>>(&solved.rests[body]->data);
    return tissue ? &(*tissue)->tets : nullptr;
}

const solver::Vec3& corner(const solver::TetMesh& tets, const solver::Points& points, std::size_t tet, std::size_t c) {
    return points[static_cast<std::size_t>(tets.tets[tet][c])];
}

/// By the volumes of the tets at rest.
solver::Vec3 centre_of_mass(const solver::TetMesh& rest, const solver::Points& now) {
    solver::Vec3 sum = solver::Vec3::Zero();
    double total = 0;
    for (std::size_t t = 0; t < rest.tets.size(); ++t) {
        const auto at = [&](std::size_t c) -> const solver::Vec3& { return corner(rest, rest.vertices, t, c); };
        const double share = rest.coverage.empty() ? 1 : rest.coverage[t];
        const double volume = share * solver::tet_volume(at(0), at(1), at(2), at(3));
        for (std::size_t c = 0; c < 4; ++c) sum += volume / 4 * corner(rest, now, t, c);
        total += volume;
    }
    return sum / total;
}

/// How far bodies have moved that should stay: the last tissue, or the last on the first.
class Watch {
  public:
    Watch(Stays stays, const nodes::Solved& start, int up);
    /// Ways across since the start, in scene units: of what `ContactRow::drift_m` and `centre_m` say.
    std::array<double, 2> ways(const nodes::Solved& now) const;

  private:
    /// A lowest vertex of the upper body and what of the lower one lies under it.
    struct Stand {
        std::size_t vertex, tet;
        std::array<double, 4> shares;
    };
    solver::Vec3 centre(const nodes::Solved& at) const;
    solver::Vec3 stand(const nodes::Solved& at) const;
    double across(solver::Vec3 way) const {
        way[up_] = 0;
        return way.norm();
    }
    Stays stays_;
    int up_;
    std::size_t upper_ = 0, lower_ = 0; ///< places among the bodies
    std::vector<Stand> stands_;
    solver::Vec3 centre_, stand_;
};

double extreme(const solver::Points& points, int axis, bool highest) {
    double out = points.front()[axis];
    for (const solver::Vec3& p : points) out = highest ? std::max(out, p[axis]) : std::min(out, p[axis]);
    return out;
}

Watch::Watch(Stays stays, const nodes::Solved& start, int up)
    : stays_(stays)
    , up_(up) {
    for (std::size_t b = start.rests.size(); b-- > 0;)
        if (tets_of(start, b)) lower_ = b, upper_ = std::max(upper_, b);
    if (stays_ == Stays::upper_on_lower) {
        const solver::Points& upper = start.positions[upper_];
        const solver::Points& lower = start.positions[lower_];
        const solver::TetMesh& tets = *tets_of(start, lower_);
        const double bottom = extreme(upper, up_, false), top = extreme(lower, up_, true);
        const double size = top - extreme(lower, up_, false);
        for (std::size_t v = 0; v < upper.size(); ++v) {
            if (upper[v][up_] > bottom + 1e-6 * size) continue;
            solver::Vec3 under = upper[v];
            under[up_] = top - 1e-6 * size;
            for (std::size_t t = 0; t < tets.tets.size(); ++t) {
                const auto at = [&](std::size_t c) -> const solver::Vec3& { return corner(tets, lower, t, c); };
                const double whole = solver::tet_volume(at(0), at(1), at(2), at(3));
                const std::array shares{solver::tet_volume(under, at(1), at(2), at(3)) / whole,
                                        solver::tet_volume(at(0), under, at(2), at(3)) / whole,
                                        solver::tet_volume(at(0), at(1), under, at(3)) / whole,
                                        solver::tet_volume(at(0), at(1), at(2), under) / whole};
                if (*std::min_element(shares.begin(), shares.end()) < 0) continue;
                stands_.push_back({v, t, shares});
                break;
            }
        }
    }
    centre_ = centre(start), stand_ = stand(start);
}

solver::Vec3 Watch::centre(const nodes::Solved& at) const {
    const solver::Vec3 upper = centre_of_mass(*tets_of(at, upper_), at.positions[upper_]);
    if (stays_ == Stays::body) return upper;
    return upper - centre_of_mass(*tets_of(at, lower_), at.positions[lower_]);
}

solver::Vec3 Watch::stand(const nodes::Solved& at) const {
    solver::Vec3 sum = solver::Vec3::Zero();
    for (const Stand& s : stands_) {
        sum += at.positions[upper_][s.vertex];
        for (std::size_t c = 0; c < 4; ++c)
            sum -= s.shares[c] * corner(*tets_of(at, lower_), at.positions[lower_], s.tet, c);
    }
    return stands_.empty() ? sum : solver::Vec3(sum / static_cast<double>(stands_.size()));
}

std::array<double, 2> Watch::ways(const nodes::Solved& now) const {
    const double centre_way = across(centre(now) - centre_);
    return {stays_ == Stays::body ? centre_way : across(stand(now) - stand_), centre_way};
}

/// Places among the bodies of tissues whose centre is below all bones.
std::vector<std::size_t> below_all_bones(const nodes::Solved& now, int up) {
    double floor = std::numeric_limits<double>::infinity();
    std::vector<std::size_t> out;
    for (std::size_t b = 0; b < now.rests.size(); ++b)
        if (!tets_of(now, b)) floor = std::min(floor, extreme(now.positions[b], up, false));
    for (std::size_t b = 0; b < now.rests.size(); ++b)
        if (const solver::TetMesh* tets = tets_of(now, b); tets && floor < std::numeric_limits<double>::infinity())
            if (centre_of_mass(*tets, now.positions[b])[up] < floor) out.push_back(b);
    return out;
}

bool is_cloth(const nodes::Solved& solved, std::size_t body) {
    return std::holds_alternative<std::shared_ptr<const solver::ClothRest>>(solved.rests[body]->data);
}

/// Edges that go through faces, of cloth with itself, other cloth and bones; nothing where there is no cloth.
std::optional<int> crossings_of_cloth(const nodes::Solved& now) {
    std::optional<int> out;
    const auto faces = [&](std::size_t b) -> const std::vector<solver::Triangle>& {
        return now.rests[b]->mesh.topology->triangles;
    };
    for (std::size_t a = 0; a < now.rests.size(); ++a) {
        if (!is_cloth(now, a)) continue;
        std::size_t count = solver::own_crossings(now.positions[a], faces(a)).size();
        for (std::size_t b = 0; b < now.rests.size(); ++b) {
            if (a == b || tets_of(now, b) || (is_cloth(now, b) && b < a)) continue;
            count += solver::crossings(now.positions[a], faces(a), now.positions[b], faces(b)).size() +
                     solver::crossings(now.positions[b], faces(b), now.positions[a], faces(a)).size();
        }
        out = out.value_or(0) + static_cast<int>(count);
    }
    return out;
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
    const engine::Value start = pull("outSolved", scene.first);
    engine::Value last = start;
    std::optional<Watch> watch;
    if (stays != Stays::nothing) watch.emplace(stays, start.as<nodes::Solved>(), up);
    const auto begin = Clock::now();
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
        last = pull("outSolved", frame);
        if (const auto crossings = crossings_of_cloth(last.as<nodes::Solved>())) {
            row.crossings = std::max(row.crossings.value_or(0), *crossings);
            row.stretch_percent =
                std::max(row.stretch_percent.value_or(0), solver::value_of(r.measured, "cloth", "max_stretch_percent"));
        }
        if (watch) {
            const auto [drift, centre] = watch->ways(last.as<nodes::Solved>());
            row.drift_m = std::max(row.drift_m.value_or(0), drift / scene.units_per_metre);
            row.centre_m = std::max(row.centre_m.value_or(0), centre / scene.units_per_metre);
        }
        if (std::chrono::duration<double>(Clock::now() - begin).count() > scene.longest_s && frame < scene.last) {
            row.ended = "stopped after frame " + std::to_string(frame) + " of " + std::to_string(scene.last) +
                        ": more than " + number(scene.longest_s) + " s";
            break;
        }
    }
    std::vector<std::string> names; // of the bodies that take part
    for (const std::string& body : scene.bodies)
        if (evaluator.pull({scene.graph, {body, "outBody"}, static_cast<double>(scene.first), options.stop})
                .as<nodes::Body>()
                .enable)
            names.push_back(body);
    for (const std::size_t b : below_all_bones(last.as<nodes::Solved>(), up)) row.fallen.push_back(names.at(b));
}

} // namespace

ContactRow run_contact_scene(const ContactScene& scene, const RunOptions& options) {
    ContactRow row;
    row.scene = std::filesystem::path(scene.graph->file()).stem().string();
    const Peer* peer = peer_of(row.scene);
    const bool with_peer = peer && peer->seconds > 0, scaled = with_peer && !options.quick;
    if (scaled) row.cantilever_s = yardstick_seconds(options) / 2;
    options.tell(row.scene);
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
    if (with_peer) row.peer_s = peer->seconds, row.peer_newton = peer->newton;
    if (scaled) *row.cantilever_s += yardstick_seconds(options) / 2;
    if (scaled && row.frames > 0) row.ratio = row.median_s / (peer->seconds * *row.cantilever_s / recorded_yardstick_s);
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

Table contact_table(const std::vector<ContactRow>& rows) {
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
             "crossings",
             "stretch [%]",
             "unconverged",
             "drift [mm]",
             "centre [mm]",
             "fell through"},
            {}};
    for (const ContactRow& r : rows)
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
                          r.crossings ? std::to_string(*r.crossings) : "-",
                          number_or_dash(r.stretch_percent, 1, 2),
                          std::to_string(r.unconverged),
                          number_or_dash(r.drift_m, 1e3, 2),
                          number_or_dash(r.centre_m, 1e3, 2),
                          r.fallen.empty() ? "none" : list_of(r.fallen)});
    return t;
}

nlohmann::ordered_json contact_json(const std::vector<ContactRow>& rows) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const ContactRow& r : rows)
        out.push_back({{"scene", r.scene},
                       {"tets", r.tets},
                       {"unknowns", r.unknowns},
                       {"frames", r.frames},
                       {"s_per_frame_median", r.median_s},
                       {"s_per_frame_mean", r.mean_s},
                       {"s_per_frame_longest", r.longest_s},
                       {"peer_s_median", or_null(r.peer_s)},
                       {"ratio", or_null(r.ratio)},
                       {"cantilever_s", or_null(r.cantilever_s)},
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
                       {"crossings", r.crossings ? nlohmann::ordered_json(*r.crossings) : nlohmann::ordered_json()},
                       {"max_stretch_percent", or_null(r.stretch_percent)},
                       {"drift_m", or_null(r.drift_m)},
                       {"centre_m", or_null(r.centre_m)},
                       {"fallen", r.fallen},
                       {"ended", r.ended}});
    return out;
}

std::string contact_summary(const std::vector<ContactRow>& rows) {
    std::string out =
        "a frame is all of its evaluation; drift: farthest way across of what should stay, of what stands on "
        "another where it stands";
    std::vector<double> steps;
    for (const ContactRow& r : rows)
        if (r.cantilever_s) steps.push_back(*r.cantilever_s);
    if (!steps.empty())
        out += "; ratio: median over that of stark 0.1.0 (2 threads), scaled by the cantilever beside each, " +
               number(1e3 * *std::min_element(steps.begin(), steps.end()), 3) + " to " +
               number(1e3 * *std::max_element(steps.begin(), steps.end()), 3) + " ms now and " +
               number(1e3 * recorded_yardstick_s, 3) + " ms when that was recorded";
    for (const ContactRow& r : rows) {
        if (r.is_sound()) continue;
        out += "\n" + r.scene + ":";
        if (!r.ended.empty()) out += " " + r.ended + ";";
        if (r.unconverged) out += " " + std::to_string(r.unconverged) + " frames not converged;";
        if (r.inverted) out += " " + std::to_string(r.inverted) + " tets inside out;";
        if (r.crossings.value_or(0) > 0) out += " up to " + std::to_string(*r.crossings) + " edges through faces;";
        if (!r.fallen.empty()) out += " fell through: " + list_of(r.fallen) + ";";
        out.pop_back();
    }
    return out;
}

} // namespace sinew::bench
