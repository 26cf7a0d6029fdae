// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "solver/error.h"
#include "solver/mesh/mesh_files.h"
#include "tools/cli/body_files.h"
#include "tools/viewer/collect.h"
#include "tools/viewer/recorder.h"

#include <algorithm>
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

/// "# sinew: bone, y up, 100 units a metre"
std::optional<double> units_of(const fs::path& obj) {
    std::ifstream in(obj);
    std::string line;
    if (!std::getline(in, line) || !line.starts_with("# sinew:")) return {};
    const std::size_t comma = line.rfind(", ");
    if (comma == std::string::npos) return {};
    return cli::to_number(line.substr(comma + 2, line.find(' ', comma + 2) - comma - 2));
}

bool is_report(const json& j) { return j.is_object() && j.contains("frames") && j["frames"].is_array(); }

/// report.json, or else the first JSON file beside the meshes that looks like one.
json find_report(const fs::path& folder) {
    std::vector<fs::path> files{folder / "report.json"};
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (entry.path().extension() == ".json") files.push_back(entry.path());
    std::sort(files.begin() + 1, files.end());
    for (const fs::path& file : files)
        if (fs::is_regular_file(file))
            if (json j = json::parse(text_of(file), nullptr, false); is_report(j)) return j;
    return {};
}

/// A number at `key`, whatever the file holds there.
template <class T>
T number(const json& j, const char* key, T otherwise) {
    const auto it = j.find(key);
    if (it == j.end()) return otherwise;
    if constexpr (std::is_same_v<T, bool>)
        return it->is_boolean() ? it->template get<bool>() : otherwise;
    else
        return it->is_number() ? it->template get<T>() : otherwise;
}

ViewFrame frame_of(const json& j) {
    ViewFrame f;
    f.frame = number(j, "frame", 0);
    f.reused = number(j, "reused", false);
    f.wall_s = number(j, "wall_s", 0.0);
    f.contact_count = number(j, "contacts", 0);
    const auto phases = j.find("phases");
    if (phases == j.end() || !phases->is_object()) return f;
    solver::StepRecord s;
    s.seconds_assembly = number(*phases, "assembly", 0.0), s.seconds_factor = number(*phases, "factor", 0.0);
    s.seconds_solve = number(*phases, "solve", 0.0), s.seconds_other = number(*phases, "other", 0.0);
    f.seconds_contact = number(*phases, "contact", 0.0);
    s.substeps = number(j, "substeps", 0), s.newton_iterations = number(j, "newton", 0);
    s.residual = number(j, "residual", 0.0), s.converged = number(j, "converged", true);
    s.energy = number(j, "energy", 0.0), s.min_j = number(j, "min_J", 1.0),
    s.inverted = number(j, "inverted", 0);
    s.max_stretch = number(j, "max_stretch_m", 0.0);
    f.step = s;
    return f;
}

std::shared_ptr<const engine::Graph> find_graph(const fs::path& folder, const json& report,
                                                ViewScene& scene) {
    std::vector<fs::path> places{folder / "graph.json"};
    if (report.is_object() && report.contains("graph") && report["graph"].is_string()) {
        const fs::path named = report["graph"].get<std::string>();
        places.push_back(named);
        places.push_back(folder / named.filename());
    }
    for (const fs::path& place : places) {
        if (!fs::is_regular_file(place)) continue;
        try {
            return engine::load_graph(nodes::make_registry(), place.string()).graph;
        } catch (const engine::Failure&) {
            scene.notes.push_back(
                {true, "The graph " + place.string() + " cannot be read; its nodes are not shown."});
            return nullptr;
        }
    }
    return nullptr;
}

std::vector<int> chosen(const std::set<int>& there, const std::vector<int>& wanted, ViewScene& scene) {
    std::vector<int> out, absent;
    for (const int f : there)
        if (wanted.empty() || std::find(wanted.begin(), wanted.end(), f) != wanted.end()) out.push_back(f);
    for (const int f : wanted)
        if (!there.contains(f)) absent.push_back(f);
    if (!absent.empty())
        scene.notes.push_back(
            {true, "The folder has no frame " + frame_list(absent) + ", which --frames asks for."});
    return out;
}

void note_gaps(const std::vector<int>& frames, ViewScene& scene) {
    std::vector<int> gaps;
    for (std::size_t i = 1; i < frames.size(); ++i)
        for (int f = frames[i - 1] + 1; f < frames[i] && gaps.size() < 100000; ++f) gaps.push_back(f);
    if (!gaps.empty())
        scene.notes.push_back({true, "Frame" + std::string(gaps.size() == 1 ? " " : "s ") + frame_list(gaps) +
                                         (gaps.size() == 1 ? " is" : " are") +
                                         " missing; playback jumps over the gap."});
}

ViewBody read_body(const cli::BodySequence& sequence, const std::vector<int>& frames, int index,
                   ViewScene& scene) {
    const bool in_graph = std::any_of(scene.graph.boxes.begin(), scene.graph.boxes.end(),
                                      [&](const GraphBox& b) { return b.name == sequence.label.name; });
    BodyRecorder recorder(sequence.label.name, in_graph ? sequence.label.name : "", sequence.label.kind,
                          index);
    std::string first_error;
    // Creases, grain and volume come from the first file, so they do not depend on the frames chosen.
    if (const auto& [first, path] = *sequence.files.begin(); !frames.empty() && first < frames.front()) {
        try {
            recorder.set_rest(solver::read_surface(path.string()));
        } catch (const solver::Error&) { // then the first chosen frame serves
        }
    }
    for (const int frame : frames) {
        const auto file = sequence.files.find(frame);
        try {
            if (file == sequence.files.end())
                recorder.add_missing(frame);
            else
                recorder.add(frame, solver::read_surface(file->second.string()));
        } catch (const solver::Error& e) {
            if (first_error.empty()) first_error = e.what();
            recorder.add_missing(frame);
        }
    }
    if (!first_error.empty()) scene.notes.push_back({true, first_error});
    return recorder.finish(scene.notes);
}

} // namespace

ViewScene collect_folder(const fs::path& folder, const std::vector<int>& wanted) {
    ViewScene scene;
    scene.source = folder.string();
    const fs::path name = folder.filename().empty() ? folder.parent_path().filename() : folder.filename();
    scene.title = name.string();
    const cli::SequenceFolder found = cli::find_sequences(folder);
    const json report = find_report(folder);
    const auto graph = find_graph(folder, report, scene);
    if (graph) {
        scene.graph = layout_graph(*graph);
        scene.fps = graph->timing().fps;
    }
    if (found.bodies.empty()) {
        scene.notes.push_back({true, "There are no OBJ sequences in " + folder.string() +
                                         ". Make them with `sinew run GRAPH --format obj --out " +
                                         folder.string() + "`, or give `sinew view` the graph itself."});
        return scene;
    }
    scene.up = found.up;
    if (const auto units = units_of(found.bodies.front().files.begin()->second); units && *units > 0)
        scene.units_per_metre = *units;
    const std::vector<int> frames = chosen(found.frames, wanted, scene);
    if (wanted.empty()) note_gaps(frames, scene); // chosen frames have gaps by choice
    for (const int frame : frames) scene.frames.push_back({.frame = frame});
    if (is_report(report))
        for (const json& j : report["frames"]) {
            if (!j.is_object()) continue;
            const ViewFrame f = frame_of(j);
            for (ViewFrame& mine : scene.frames)
                if (mine.frame == f.frame) mine = f;
        }
    for (const cli::BodySequence& body : found.bodies)
        scene.bodies.push_back(read_body(body, frames, static_cast<int>(scene.bodies.size()), scene));
    std::erase_if(scene.bodies, [](const ViewBody& b) { return b.rest.empty(); });
    scene.notes.push_back({false,
                           "Shown from files: surfaces only. `sinew view GRAPH` also shows tets, fibres, "
                           "attachments and heat maps."});
    return scene;
}

} // namespace sinew::viewer
