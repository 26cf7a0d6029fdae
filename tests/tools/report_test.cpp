// What the report and its summary say of known numbers.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/report.h"

#include "tools/cli/print.h"
#include "tools/embed/frame_json.h"

#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>

using namespace sinew;
using namespace sinew::cli;
using nlohmann::json;

namespace {

constexpr solver::Measure stretch{"spring", "stretch_m", "m", "largest stretch", solver::Combine::most},
    count{"touch", "points", "1", "points in touch", solver::Combine::sum},
    force{"touch", "force_N", "N", "last force", solver::Combine::last},
    each{"touch", "each_N", "N", "force of each part", solver::Combine::last};

FrameReport frame(int number, double wall_s, int newton, double residual) {
    FrameReport f;
    f.frame = number, f.wall_s = wall_s;
    solver::StepRecord s;
    s.substeps = 2, s.newton_iterations = newton, s.residual = residual;
    f.step = s;
    return f;
}

/// Four frames: one that was there before, one that has not converged, two with inverted tets.
RunReport report() {
    RunReport r;
    r.graph = "scene.json", r.threads = 2, r.frames_simulated = 3, r.wall_s = 6, r.setup_s = 1.25;
    r.memory_bytes = 4000, r.kept_bytes = 3000, r.made_again = 5;
    r.bodies = {"biceps", "humerus"}, r.attachments = {"origin", "insertion"};
    r.computed = {{"zTet", {5, 2.61}}, {"transform", {2, 0.2}}, {"weights", {1, 0.04}}, {"polyCube", {1, 0.055}}};
    r.frames = {frame(1, 0.5, 100, 9), frame(2, 1, 7, 0.25), frame(3, 0.5, 2, 0.5), frame(4, 2, 3, 0.125)};
    r.frames[0].reused = true;
    const double assembly[] = {5, 0.1, 0.2, 0.3}, factor[] = {5, 0.03, 0.03, 0.06}, other[] = {5, 0, 0, 0.3};
    const double stretches[] = {7, 0.002, 0.005, 0.001}, counts[] = {70, 1, 2, 3}, forces[] = {700, 4, 5, 1.5};
    const int inverted[] = {0, 3, 2, 1};
    for (std::size_t i = 0; i < 4; ++i) {
        solver::StepRecord& s = *r.frames[i].step;
        s.seconds_assembly = assembly[i], s.seconds_factor = factor[i], s.seconds_solve = 0.003;
        s.seconds_other = other[i];
        s.inverted = r.frames[i].inverted_here = inverted[i];
        s.measured = {{&stretch, stretches[i]}, {&count, counts[i]}, {&force, forces[i]}, {&each, 99, 0}};
    }
    r.frames[1].step->converged = false;
    r.frames[2].worst = {.body = 1, .tet = 11, .j = -0.5};
    r.frames[3].worst = {.body = 0, .tet = 22, .j = -0.75};
    nodes::SolveReport size;
    size.bodies = 2, size.tets = 100, size.triangles = 80, size.dofs = 600, size.attachments = 2;
    r.size = size;
    return r;
}

std::string line_of(const std::string& text, const std::string& part) {
    const std::size_t at = text.find(part);
    if (at == std::string::npos) return "";
    const std::size_t begin = text.rfind('\n', at) + 1;
    return text.substr(begin, text.find('\n', at) - begin);
}

} // namespace

TEST_CASE("the summary names the other solvers that have inverted tets", "[tools]") {
    RunReport r = report();
    const auto said = [&] { return line_of(summary(r), "INVERTED"); };
    r.inverted_elsewhere = {"muscles"};
    CHECK(said() == "  2 frames converged with INVERTED tets; the worst is frame 4, tet 22 of biceps; also in muscles");
    for (FrameReport& f : r.frames) f.inverted_here = 0;
    CHECK(said() == "  2 frames converged with INVERTED tets, in muscles");
    r.inverted_elsewhere = {"a", "b", "c", "d", "e"};
    CHECK(said() == "  2 frames converged with INVERTED tets, in a, b, c and 2 more");
}

TEST_CASE("the summary of known numbers", "[tools]") {
    CHECK(summary(report()) ==
          "4 frames in 6.0 s: set-up 1.25 s, then 1000 ms a frame; 3 simulated, 1 reused; 2 bodies, 100 "
          "tets, 600 unknowns\n"
          "  nodes: zTet 2.61 s (5 computed), transform 0.20 s (2 computed)\n"
          "  a frame, in ms: assembly 200.0, factor 40.0, solve 3.0, other 100.0\n"
          "  1 unconverged, worst residual 0.5, Newton 4.0 a frame (most 7), inverted tets at "
          "most 3, largest stretch 5 mm, points in touch 6, last force 1.5 N\n"
          "  2 frames converged with INVERTED tets; the worst is frame 4, tet 22 of biceps\n");
    RunReport short_run = report();
    short_run.wall_s = 5; // now a hundredth of it is 0.05 s
    CHECK(line_of(summary(short_run), "nodes:") ==
          "  nodes: zTet 2.61 s (5 computed), transform 0.20 s (2 computed), polyCube 0.06 s (1 computed)");
}

TEST_CASE("what --strict says of faults that frames converge with", "[tools]") {
    RunReport report;
    CHECK(faults_text(report) == "");
    const auto add = [&](bool converged, int inverted, bool is_deep) {
        FrameReport f;
        f.step.emplace();
        f.step->converged = converged, f.step->inverted = inverted, f.is_deep = is_deep;
        report.frames.push_back(f);
    };
    add(true, 0, false);
    CHECK(faults_text(report) == "");
    add(true, 2, false);
    CHECK(faults_text(report) == "1 frame converged with inverted tets");
    add(true, 0, true), add(true, 1, true);
    CHECK(faults_text(report) == "2 frames converged with inverted tets, 2 converged with bodies deep in each other");
    add(false, 5, true);
    CHECK(faults_text(report) == "1 frame has not converged, 2 converged with inverted tets, 2 converged with bodies "
                                 "deep in each other");
}

TEST_CASE("a residual that is no number is the worst one, whichever frame has it", "[tools]") {
    for (const std::size_t at : {std::size_t{1}, std::size_t{2}, std::size_t{3}}) {
        RunReport r = report();
        r.frames[at].step->residual = std::numeric_limits<double>::quiet_NaN();
        CHECK(line_of(summary(r), "worst residual").find("worst residual nan,") != std::string::npos);
    }
}

TEST_CASE("the report as JSON holds the numbers that it was given", "[tools]") {
    RunReport r = report();
    r.frames[2].worst = {.body = 1,
                         .tet = 11,
                         .j = -0.5,
                         .tet_place = {1, 2, 3},
                         .attachment = 1,
                         .source_body = 0,
                         .vertex = 8,
                         .stretch = 0.005,
                         .stretch_place = {4, 5, 6},
                         .residual_body = 1};
    const json all = json::parse(report_json(r));
    CHECK(all.at("graph") == "scene.json");
    CHECK(all.at("threads") == 2);
    json totals = all.at("totals");
    totals.erase("peak_bytes");
    CHECK(totals == json::parse(R"({"wall_s": 6.0, "setup_s": 1.25, "frames_simulated": 3, "frames_reused": 1,
        "memory_bytes": 4000, "kept_bytes": 3000, "made_again": 5})"));
    CHECK(all.at("computed").at("zTet") == json::parse(R"({"count": 5, "wall_s": 2.61})"));
    CHECK(all.at("size") == json::parse(R"({"bodies": 2, "tets": 100, "triangles": 80, "dofs": 600, "attachments": 2,
        "terms": []})"));
    const json& third = all.at("frames").at(2);
    CHECK((third.at("frame") == 3 && third.at("reused") == false && third.at("wall_s") == 0.5));
    CHECK(third.at("where") == json::parse(R"({"residual": {"body": "humerus"},
        "min_J": {"tissue": "humerus", "tet": 11, "at": [1.0, 2.0, 3.0]},
        "max_stretch_m": {"attachment": "insertion", "body": "biceps", "vertex": 8, "at": [4.0, 5.0, 6.0]}})"));
    CHECK(all.at("frames").at(0).at("reused") == true);
    CHECK((r.unconverged() == 1 && r.inverted() == 2));
}

TEST_CASE("a step is described field by field", "[tools]") {
    solver::StepRecord s;
    s.residual = 0.5, s.converged = false, s.newton_iterations = 7, s.substeps = 2, s.halvings = 3;
    s.linear_iterations = 11, s.factorizations = 13, s.energy = 0.25, s.min_j = -0.125, s.inverted = 17;
    s.seconds_assembly = 1, s.seconds_factor = 2, s.seconds_solve = 3, s.seconds_other = 4;
    s.measured = {{&stretch, 0.0625}, {&force, 4}, {&each, 5, 0}, {&each, 6, 1}};
    CHECK(json(sinew::embed::step_json(s)) ==
          json::parse(R"({"residual": 0.5, "converged": false, "newton": 7, "substeps": 2,
        "halvings": 3, "linear_iterations": 11, "factorizations": 13, "energy": 0.25, "min_J": -0.125, "inverted": 17,
        "phases": {"assembly": 1.0, "factor": 2.0, "solve": 3.0, "other": 4.0},
        "terms": {"spring": {"stretch_m": 0.0625}, "touch": {"force_N": 4.0, "each_N": [5.0, 6.0]}}})"));
}

TEST_CASE("times left are told as clocks do", "[tools]") {
    CHECK(clock_text(7) == "0:07");
    CHECK(clock_text(754.4) == "12:34");
    CHECK(clock_text(3599.6) == "1:00:00");
    CHECK(clock_text(2 * 3600 + 3 * 60 + 4) == "2:03:04");
    CHECK(clock_text(-3) == "0:00");
}
