// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/read_report.h"

#include "solver/terms/all_terms.h"
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace sinew::viewer {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
}

bool is_report(const json& j) { return j.is_object() && j.contains("frames") && j["frames"].is_array(); }

/// Reads fields whatever the file holds there, and counts what cannot be right.
class Fields {
  public:
    int odd = 0;

    double real(const json& j, const char* key, double otherwise, double least = -INFINITY) {
        const auto it = j.find(key);
        if (it == j.end() || it->is_null()) return otherwise; // null stands for NaN
        if (it->is_number())
            if (const double v = it->get<double>(); std::isfinite(v) && v >= least) return v;
        ++odd;
        return otherwise;
    }
    int whole(const json& j, const char* key, int otherwise) {
        const double v = real(j, key, otherwise);
        if (std::abs(v) < 2e9) return static_cast<int>(v);
        ++odd;
        return otherwise;
    }
    bool flag(const json& j, const char* key, bool otherwise) {
        const auto it = j.find(key);
        if (it == j.end()) return otherwise;
        if (it->is_boolean()) return it->get<bool>();
        ++odd;
        return otherwise;
    }
    static std::string text(const json& j, const char* key) {
        const auto it = j.find(key);
        return it != j.end() && it->is_string() ? it->get<std::string>() : std::string();
    }
};

ViewFrame frame_of(Fields& in, const json& j) {
    ViewFrame f;
    f.frame = in.whole(j, "frame", 0);
    f.reused = in.flag(j, "reused", false);
    f.wall_s = in.real(j, "wall_s", 0, 0);
    const auto phases = j.find("phases");
    if (phases == j.end() || !phases->is_object()) return f;
    solver::StepRecord s;
    s.seconds_assembly = in.real(*phases, "assembly", 0, 0), s.seconds_factor = in.real(*phases, "factor", 0, 0);
    s.seconds_solve = in.real(*phases, "solve", 0, 0), s.seconds_other = in.real(*phases, "other", 0, 0);
    s.substeps = in.whole(j, "substeps", 0), s.newton_iterations = in.whole(j, "newton", 0);
    s.residual = in.real(j, "residual", NAN), s.converged = in.flag(j, "converged", true);
    s.energy = in.real(j, "energy", NAN), s.min_j = in.real(j, "min_J", NAN), s.inverted = in.whole(j, "inverted", 0);
    const auto terms = j.find("terms");
    for (const solver::TermType* type : solver::all_terms())
        for (const solver::Measure& m : type->measures) {
            if (terms == j.end() || !terms->is_object() || !terms->contains(m.term)) continue;
            const json& of_term = (*terms)[std::string(m.term)];
            if (!of_term.is_object() || !of_term.contains(m.name)) continue;
            if (const json& parts = of_term[std::string(m.name)]; parts.is_array())
                for (std::size_t k = 0; k < parts.size(); ++k)
                    s.measured.push_back({&m, in.real(json{{"value", parts[k]}}, "value", NAN), static_cast<int>(k)});
            else
                s.measured.push_back({&m, in.real(of_term, std::string(m.name).c_str(), NAN)});
        }
    f.step = s;
    return f;
}

FoundReport report_of(const fs::path& file, const json& j, std::vector<ViewNote>& notes) {
    FoundReport out;
    out.file = file;
    out.graph = Fields::text(j, "graph");
    Fields in;
    for (const json& frame : j["frames"]) {
        if (!frame.is_object() || !frame.contains("frame") || !frame["frame"].is_number()) {
            ++in.odd;
            continue;
        }
        ViewFrame f = frame_of(in, frame);
        out.frames[f.frame] = std::move(f);
    }
    if (const auto it = j.find("error"); it != j.end() && it->is_object())
        out.error = {in.whole(*it, "frame", 0), Fields::text(*it, "code"), Fields::text(*it, "node"),
                     Fields::text(*it, "message")};
    if (in.odd > 0)
        notes.push_back({true, file.filename().string() + ": " + std::to_string(in.odd) +
                                   (in.odd == 1 ? " value cannot be right and is" : " values cannot be right and are") +
                                   " left out."});
    return out;
}

} // namespace

std::vector<FoundReport> find_reports(const fs::path& folder, std::vector<ViewNote>& notes) {
    std::vector<FoundReport> out;
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (entry.path().extension() == ".json" && entry.is_regular_file(error)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
        const bool is_named_so = file.filename() == "report.json";
        json j;
        try {
            j = json::parse(text_of(file));
        } catch (const json::exception&) {
            if (is_named_so)
                notes.push_back({true, "report.json is damaged and cannot be read: there are no times and no word on "
                                       "convergence."});
            continue;
        }
        if (!is_report(j)) {
            if (is_named_so) notes.push_back({true, "report.json lists no frames and is no report of a run."});
            continue;
        }
        out.push_back(report_of(file, j, notes));
        out.back().written = fs::last_write_time(file, error);
    }
    std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.written > b.written; });
    return out;
}

std::string ended_early(const cli::RunError& e) {
    return "The run ended before frame " + std::to_string(e.frame) + ": " + e.message +
           (e.code.empty() ? "" : " (" + e.code + ")");
}

} // namespace sinew::viewer
