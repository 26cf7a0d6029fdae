// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/report.h"

#include "engine/text.h"
#include "solver/linear/blas_kernel.h"
#include "tools/cli/json_text.h"
#include "tools/cli/machine.h"
#include "tools/cli/print.h"
#include "tools/embed/frame_json.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace sinew::cli {

using Json = nlohmann::ordered_json;
using embed::line_json;
using embed::name_at;
using embed::step_json;
using embed::where_json;

namespace {

template <class... Values>
std::string text(const char* format, Values... values) {
    char buffer[512];
    std::snprintf(buffer, sizeof buffer, format, values...);
    return buffer;
}

Json frame_json(const FrameReport& f, const RunReport& r) {
    Json out = {{"frame", f.frame}, {"reused", f.reused}, {"wall_s", f.wall_s}};
    if (f.step) {
        out.update(step_json(*f.step));
        out["where"] = where_json(f.worst, r.bodies, r.attachments);
        for (const nodes::LineReport& line : f.lines) {
            Json& entry = out["lines_of_action"].emplace_back(line_json(line));
            entry["body"] = name_at(r.bodies, line.body);
        }
    }
    return out;
}

std::string phases_text(const std::vector<solver::StepRecord>& steps) {
    double assembly = 0, factor = 0, solve = 0, other = 0;
    for (const auto& s : steps)
        assembly += s.seconds_assembly, factor += s.seconds_factor, solve += s.seconds_solve, other += s.seconds_other;
    const double scale = 1000.0 / static_cast<double>(steps.size());
    return text("  a frame, in ms: assembly %.1f, factor %.1f, solve %.1f, other %.1f\n", assembly * scale,
                factor * scale, solve * scale, other * scale);
}

/// ", largest attachment stretch 1.2 mm": what the terms measured, over all steps; of each part is in the report.
std::string terms_text(const std::vector<solver::StepRecord>& steps) {
    // Terms may be switched on and off: each measure is found by what it is.
    std::vector<solver::Measured> all;
    for (const solver::StepRecord& step : steps)
        for (const solver::Measured& m : step.measured) {
            const auto same = [&](const solver::Measured& a) { return a.what == m.what && a.part == m.part; };
            const auto found = std::find_if(all.begin(), all.end(), same);
            if (found == all.end()) {
                all.push_back(m);
                continue;
            }
            switch (found->what->combine) {
            case solver::Combine::sum:
                found->value += m.value;
                break;
            case solver::Combine::most:
                found->value = std::max(found->value, m.value);
                break;
            case solver::Combine::last:
                found->value = m.value;
                break;
            }
        }
    std::string out;
    for (const solver::Measured& m : all) {
        if (m.part >= 0) continue;
        // What is added up are events: none of them is nothing to tell.
        if (m.what->combine == solver::Combine::sum && m.value == 0) continue;
        if (m.what->unit == "1") { // a count
            out += text(", %s %.0f", std::string(m.what->title).c_str(), m.value);
            continue;
        }
        const bool is_length = m.what->unit == "m";
        out += text(", %s %s %s", std::string(m.what->title).c_str(),
                    engine::rough_text(is_length ? 1000 * m.value : m.value, 2).c_str(),
                    is_length ? "mm" : std::string(m.what->unit).c_str());
    }
    return out;
}

std::string health_text(const std::vector<solver::StepRecord>& steps) {
    int unconverged = 0, inverted = 0, most_newton = 0;
    double residual = 0, newton = 0;
    for (const auto& s : steps) {
        unconverged += !s.converged;
        inverted = std::max(inverted, s.inverted);
        most_newton = std::max(most_newton, s.newton_iterations);
        newton += s.newton_iterations;
        // NaN must not hide behind a comparison.
        residual = std::isnan(s.residual) ? s.residual : std::max(residual, s.residual);
    }
    return text("  %d unconverged, worst residual %.2g, Newton %.1f a frame (most %d), inverted tets at most %d%s\n",
                unconverged, residual, newton / static_cast<double>(steps.size()), most_newton, inverted,
                terms_text(steps).c_str());
}

/// "  nodes: zTet 2.61 s in 5, …": what took a noticeable share of the time beside the steps.
std::string nodes_text(const RunReport& r) {
    std::vector<std::pair<std::string, NodeCost>> all(r.computed.begin(), r.computed.end());
    std::erase_if(all, [&](const auto& c) { return c.second.seconds < std::max(0.05, 0.01 * r.wall_s); });
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.second.seconds > b.second.seconds; });
    std::string out;
    for (const auto& [type, cost] : all)
        out +=
            text("%s%s %.2f s (%d computed)", out.empty() ? "  nodes: " : ", ", type.c_str(), cost.seconds, cost.count);
    return out.empty() ? out : out + "\n";
}

/// The other solvers in which a thing has been: it has no place in the lists of the first one. `too`: in that, too.
std::string elsewhere(const std::set<std::string>& solvers, bool too) {
    constexpr std::size_t most_named = 3;
    std::string out;
    std::size_t named = 0;
    for (const std::string& solver : solvers) {
        if (named == most_named) break;
        out += (named++ == 0 ? " in " : ", ") + solver;
    }
    if (named < solvers.size()) out += " and " + std::to_string(solvers.size() - named) + " more";
    return out.empty() ? out : (too ? "; also" : ",") + out;
}

} // namespace

int RunReport::unconverged() const {
    return static_cast<int>(
        std::count_if(frames.begin(), frames.end(), [](const FrameReport& f) { return f.step && !f.step->converged; }));
}

int RunReport::inverted() const {
    return static_cast<int>(std::count_if(frames.begin(), frames.end(), [](const FrameReport& f) {
        return f.step && f.step->converged && f.step->inverted > 0;
    }));
}

int RunReport::deep() const {
    return static_cast<int>(std::count_if(
        frames.begin(), frames.end(), [](const FrameReport& f) { return f.step && f.step->converged && f.is_deep; }));
}

std::string faults_text(const RunReport& r) {
    std::string out;
    const auto add = [&](int count, const char* how) {
        if (count == 0) return;
        const char* frames = count == 1 ? " frame" : " frames";
        out += (out.empty() ? "" : ", ") + std::to_string(count) + (out.empty() ? frames : "") + how;
    };
    add(r.unconverged(), r.unconverged() == 1 ? " has not converged" : " have not converged");
    add(r.inverted(), " converged with inverted tets");
    add(r.deep(), " converged with bodies deep in each other");
    return out;
}

int RunReport::reused() const {
    return static_cast<int>(std::count_if(frames.begin(), frames.end(), [](const FrameReport& f) { return f.reused; }));
}

std::string report_json(const RunReport& r) {
    Json out = {{"version", SINEW_VERSION},      {"machine", machine_name()},
                {"blas", solver::blas_kernel()}, {"numerics", solver::machine_numerics()},
                {"threads", r.threads},          {"graph", r.graph}};
    out["totals"] = {
        {"wall_s", r.wall_s},          {"setup_s", r.setup_s},           {"frames_simulated", r.frames_simulated},
        {"frames_reused", r.reused()}, {"memory_bytes", r.memory_bytes}, {"kept_bytes", r.kept_bytes},
        {"made_again", r.made_again},  {"peak_bytes", peak_bytes()}};
    out["computed"] = Json::object();
    for (const auto& [type, cost] : r.computed)
        out["computed"][type] = {{"count", cost.count}, {"wall_s", cost.seconds}};
    out["warnings"] = Json::array();
    for (const engine::Diagnostic& d : r.warnings) out["warnings"].push_back(Json::parse(engine::to_json(d)));
    out["frames"] = Json::array();
    for (const FrameReport& f : r.frames) out["frames"].push_back(frame_json(f, r));
    if (r.error) {
        out["error"] = {{"frame", r.error->frame}, {"message", r.error->message}};
        if (!r.error->code.empty()) out["error"]["code"] = r.error->code;
        if (!r.error->node.empty()) out["error"]["node"] = r.error->node;
    }
    out["size"] = Json::object();
    if (r.size) out["size"] = embed::size_json(*r.size);
    return json_text(out, 1) + "\n";
}

std::string summary(const RunReport& r) {
    std::vector<solver::StepRecord> steps;
    for (const FrameReport& f : r.frames)
        if (f.step && f.step->substeps > 0 && !f.reused) steps.push_back(*f.step);
    const std::size_t count = r.frames.size();
    std::string out = text("%zu frame%s in %.1f s", count, count == 1 ? "" : "s", r.wall_s);
    double in_frames = 0;
    for (const FrameReport& f : r.frames) in_frames += f.wall_s;
    if (count)
        out += text(": set-up %.2f s, then %.0f ms a frame", r.setup_s, 1000 * in_frames / static_cast<double>(count));
    if (r.frames_simulated) out += text("; %d simulated", r.frames_simulated);
    if (const auto reused = r.reused()) out += text("%s%d reused", r.frames_simulated ? ", " : "; ", reused);
    if (r.size)
        out += text("; %lld %s, %lld tets, %lld unknowns", static_cast<long long>(r.size->bodies),
                    r.size->bodies == 1 ? "body" : "bodies", static_cast<long long>(r.size->tets),
                    static_cast<long long>(r.size->dofs));
    out += "\n";
    out += nodes_text(r);
    if (!steps.empty()) out += phases_text(steps) + health_text(steps);
    if (const int frames = r.inverted()) {
        const FrameReport* worst = nullptr;
        for (const FrameReport& f : r.frames)
            if (f.step && f.step->converged && f.inverted_here > 0 && (!worst || f.worst.j < worst->worst.j))
                worst = &f;
        out += text("  %d frame%s converged with INVERTED tets", frames, frames == 1 ? "" : "s");
        if (worst)
            out += text("; the worst is frame %d, tet %d of %s", worst->frame, worst->worst.tet,
                        name_at(r.bodies, worst->worst.body).c_str());
        out += elsewhere(r.inverted_elsewhere, worst != nullptr) + "\n";
    }
    if (const int frames = r.deep()) {
        const FrameReport* worst = nullptr;
        for (const FrameReport& f : r.frames)
            if (f.step && f.step->converged && f.worst.deep_body >= 0 &&
                (!worst || f.worst.deep_share > worst->worst.deep_share))
                worst = &f;
        out += text("  %d frame%s converged with bodies DEEP in each other", frames, frames == 1 ? "" : "s");
        if (worst)
            out += text("; the worst is frame %d, %s in %s, %s mm", worst->frame,
                        name_at(r.bodies, worst->worst.deep_body).c_str(),
                        worst->worst.deep_body == worst->worst.deep_target
                            ? "itself"
                            : name_at(r.bodies, worst->worst.deep_target).c_str(),
                        engine::rough_text(1000 * worst->worst.deep, 2).c_str());
        out += elsewhere(r.deep_elsewhere, worst != nullptr) + "\n";
    }
    return out;
}

std::string clock_text(double seconds) {
    const long long s = std::llround(std::clamp(seconds, 0.0, 1e9));
    return s < 3600 ? text("%lld:%02lld", s / 60, s % 60) : text("%lld:%02lld:%02lld", s / 3600, s / 60 % 60, s % 60);
}

} // namespace sinew::cli
