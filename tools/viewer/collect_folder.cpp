// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "solver/error.h"
#include "solver/mesh/mesh_files.h"
#include "tools/cli/body_files.h"
#include "tools/cli/unfinished.h"
#include "tools/viewer/collect.h"
#include "tools/viewer/collect_glb.h"
#include "tools/viewer/faults.h"
#include "tools/viewer/read_report.h"
#include "tools/viewer/recorder.h"

#include <algorithm>
#include <fstream>

namespace sinew::viewer {

namespace fs = std::filesystem;

namespace {

/// "# sinew: bone, y up, 100 units a metre"
std::optional<double> units_of(const fs::path& obj) {
    std::ifstream in(obj);
    std::string line;
    if (!std::getline(in, line) || !line.starts_with("# sinew:")) return {};
    const std::size_t comma = line.rfind(", ");
    if (comma == std::string::npos) return {};
    return cli::to_number(line.substr(comma + 2, line.find(' ', comma + 2) - comma - 2));
}

std::shared_ptr<const engine::Graph> find_graph(const fs::path& folder, const std::string& named, ViewScene& scene) {
    std::vector<fs::path> places{folder / "graph.json"};
    if (!named.empty()) {
        places.push_back(named);
        places.push_back(folder / fs::path(named).filename());
    }
    for (const fs::path& place : places) {
        if (!fs::is_regular_file(place)) continue;
        try {
            return engine::load_graph(nodes::make_registry(), place.string()).graph;
        } catch (const engine::Failure&) {
            scene.notes.push_back({true, "The graph " + place.string() + " cannot be read; its nodes are not shown."});
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
        scene.notes.push_back({true, "The folder has no frame " + frame_list(absent) + ", which --frames asks for."});
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

std::string frames_text(const std::vector<int>& frames) {
    return std::string(frames.size() == 1 ? "Frame " : "Frames ") + frame_list(frames);
}

/// When the last file of a frame was written.
fs::file_time_type written(const cli::SequenceFolder& found, int frame) {
    fs::file_time_type latest = fs::file_time_type::min();
    std::error_code error;
    for (const cli::BodySequence& body : found.bodies)
        if (const auto file = body.files.find(frame); file != body.files.end())
            latest = std::max(latest, fs::last_write_time(file->second, error));
    return latest;
}

bool overlap(const FoundReport& a, const FoundReport& b) {
    return std::any_of(a.frames.begin(), a.frames.end(), [&](const auto& f) { return b.frames.contains(f.first); });
}

/// Frames of an older run that the newest report does not know are taken out, unless they were asked for.
/// Ranges that several runs share a folder for have reports that do not overlap; those frames belong.
void drop_stale(const cli::SequenceFolder& found, const std::vector<FoundReport>& reports, std::set<int>& frames,
                bool are_chosen, ViewScene& scene) {
    if (reports.empty() || reports.front().frames.empty()) return;
    const FoundReport& newest = reports.front();
    const std::string name = newest.file.filename().string();
    std::vector<int> stale, unlisted;
    for (const int frame : frames) {
        if (newest.frames.contains(frame)) continue;
        const bool is_neighbour = std::any_of(reports.begin() + 1, reports.end(), [&](const FoundReport& r) {
            return r.frames.contains(frame) && r.graph == newest.graph && !overlap(r, newest);
        });
        if (is_neighbour) continue;
        (written(found, frame) <= newest.written ? stale : unlisted).push_back(frame);
    }
    if (!unlisted.empty())
        scene.notes.push_back({true, frames_text(unlisted) + (unlisted.size() == 1 ? " is" : " are") + " newer than " +
                                         name + ", which does not list " + (unlisted.size() == 1 ? "it." : "them.")});
    if (stale.empty()) return;
    const std::string which = frames_text(stale) + (stale.size() == 1 ? " is" : " are") + " stale: older than " + name +
                              " and not listed there, so from an earlier run.";
    if (are_chosen || stale.size() == frames.size()) {
        scene.notes.push_back({true, which});
        return;
    }
    for (const int frame : stale) frames.erase(frame);
    scene.notes.push_back({true, which + " They are not played; --frames shows them."});
}

/// Files of runs whose graphs differ do not belong together, and nothing else may tell of it.
void note_several_runs(const cli::SequenceFolder& found, const std::vector<int>& frames, ViewScene& scene) {
    struct Files {
        std::set<int> frames;
        std::vector<std::string> names;
        fs::file_time_type latest = fs::file_time_type::min();
    };
    std::map<std::string, Files> runs; // by mark
    std::error_code error;
    for (const cli::BodySequence& body : found.bodies)
        for (const int frame : frames) {
            const auto file = body.files.find(frame);
            const std::string mark = file == body.files.end() ? "" : cli::read_run_mark(file->second);
            if (mark.empty()) continue;
            Files& files = runs[mark];
            files.frames.insert(frame);
            if (files.names.empty() || files.names.back() != body.label.name) files.names.push_back(body.label.name);
            files.latest = std::max(files.latest, fs::last_write_time(file->second, error));
        }
    if (runs.size() < 2) return;
    const auto newest = std::max_element(
        runs.begin(), runs.end(), [](const auto& a, const auto& b) { return a.second.latest < b.second.latest; });
    for (const auto& [mark, files] : runs)
        if (mark != newest->first) {
            std::string who;
            for (const std::string& name : files.names) who += (who.empty() ? "" : ", ") + name;
            scene.notes.push_back({true, frames_text({files.frames.begin(), files.frames.end()}) + " of " + who +
                                             " are from an earlier run of another graph, or with other values, than "
                                             "the rest of the folder."});
        }
}

/// What became of the runs that wrote here.
void note_ends(const fs::path& folder, const std::vector<FoundReport>& reports, ViewScene& scene) {
    if (!reports.empty() && reports.front().error) scene.notes.push_back({true, ended_early(*reports.front().error)});
    for (const cli::UnfinishedRun& run : cli::find_unfinished(folder)) {
        const std::string range = run.count <= 1 ? "frame " + std::to_string(run.first)
                                                 : std::to_string(run.count) + " frames, " + std::to_string(run.first) +
                                                       " to " + std::to_string(run.last);
        if (run.error)
            scene.notes.push_back({true, ended_early(*run.error)});
        else
            scene.notes.push_back({true, run.is_alive
                                             ? "A run is still writing into this folder: " + range + "."
                                             : "A run into this folder was killed before it was through. It was "
                                               "to give " +
                                                   range + "."});
    }
    auto& notes = scene.notes; // the report and the mark may say the same
    for (std::size_t i = 0; i < notes.size(); ++i)
        for (std::size_t k = notes.size(); k-- > i + 1;)
            if (notes[k].text == notes[i].text) notes.erase(notes.begin() + static_cast<std::ptrdiff_t>(k));
}

/// Bodies by the frames that they miss, so that a run which stopped in the middle of a frame gives one note.
using Missing = std::map<std::vector<int>, std::vector<std::string>>;

void note_missing(const Missing& missing, ViewScene& scene) {
    constexpr std::size_t most_named = 4;
    for (const auto& [frames, names] : missing) {
        std::string who;
        for (std::size_t i = 0; i < names.size() && i < most_named; ++i) who += (i ? ", " : "") + names[i];
        if (names.size() > most_named) who += " and " + std::to_string(names.size() - most_named) + " more bodies";
        const bool is_last = scene.frames.size() > 1 && scene.bodies.size() > names.size() && frames.size() == 1 &&
                             frames[0] == scene.frames.back().frame;
        scene.notes.push_back(
            {true, who + ": nothing for frame" + (frames.size() == 1 ? " " : "s ") + frame_list(frames) +
                       "; hidden there." +
                       (is_last ? " That is the last frame: the run may have been stopped in it." : "")});
    }
}

/// The node that a file's name stands for: names that no file may have were changed when it was written.
std::string node_of(const std::string& file_name, const GraphDrawing& graph) {
    for (const GraphBox& box : graph.boxes)
        if (cli::file_name(box.name) == file_name) return box.name;
    return "";
}

/// The number of vertices that most frames of a sequence have. Empty: the first readable one's.
struct Reference {
    std::optional<solver::SurfaceMesh> rest;
};

BodyRecorder record(const cli::BodySequence& sequence, const std::vector<int>& frames, int index,
                    const Reference& reference, ViewScene& scene, std::map<std::size_t, std::pair<int, int>>& counts) {
    const std::string node = node_of(sequence.label.name, scene.graph);
    BodyRecorder recorder(node.empty() ? sequence.label.name : node, node, sequence.label.kind, index,
                          sequence.label.appearance);
    std::string first_error;
    if (reference.rest) {
        recorder.set_rest(*reference.rest);
        // Creases, grain and volume come from the first file, so they do not depend on the frames chosen.
    } else if (const auto& [first, path] = *sequence.files.begin(); !frames.empty() && first < frames.front()) {
        try {
            recorder.set_rest(solver::read_surface(path.string()));
        } catch (const solver::Error&) { // then the first chosen frame serves
        }
    }
    for (const int frame : frames) {
        const auto file = sequence.files.find(frame);
        if (file == sequence.files.end()) {
            recorder.add_missing(frame);
            continue;
        }
        try {
            const solver::SurfaceMesh mesh = solver::read_surface(file->second.string());
            const auto it = counts.try_emplace(mesh.points.size(), frame, 0).first;
            ++it->second.second;
            if (mesh.points.empty())
                recorder.add_missing(frame);
            else
                recorder.add(frame, mesh);
        } catch (const solver::Error& e) {
            if (first_error.empty()) first_error = e.what();
            recorder.add_missing(frame);
        }
    }
    if (!first_error.empty() && !reference.rest) scene.notes.push_back({true, first_error});
    return recorder;
}

ViewBody read_body(const cli::BodySequence& sequence, const std::vector<int>& frames, int index, Missing& missing,
                   ViewScene& scene) {
    std::map<std::size_t, std::pair<int, int>> counts; // vertices -> first frame, number of frames
    BodyRecorder recorder = record(sequence, frames, index, {}, scene, counts);
    if (2 * recorder.other_count().size() > frames.size()) {
        // The first frame is the odd one: most others have another number of vertices.
        const auto usual = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
            return a.second.second < b.second.second;
        });
        if (usual->first > 0) {
            const Reference reference{solver::read_surface(sequence.files.at(usual->second.first).string())};
            counts.clear();
            recorder = record(sequence, frames, index, reference, scene, counts);
        }
    }
    if (std::vector<int> none = recorder.take_missing(); !none.empty())
        missing[std::move(none)].push_back(recorder.body().name);
    return recorder.finish(scene.notes);
}

void take_reports(const std::vector<FoundReport>& reports, ViewScene& scene) {
    for (ViewFrame& mine : scene.frames)
        for (const FoundReport& report : reports)
            if (const auto it = report.frames.find(mine.frame); it != report.frames.end()) {
                mine = it->second;
                break;
            }
}

void add_frames(const std::vector<int>& frames, const std::vector<int>& wanted, const std::vector<FoundReport>& reports,
                ViewScene& scene) {
    if (wanted.empty()) note_gaps(frames, scene); // chosen frames have gaps by choice
    for (const int frame : frames) scene.frames.push_back({.frame = frame});
    take_reports(reports, scene);
}

void read_sequences(const cli::SequenceFolder& found, const std::vector<FoundReport>& reports,
                    const std::vector<int>& wanted, ViewScene& scene) {
    scene.up = found.up;
    if (const auto units = units_of(found.bodies.front().files.begin()->second); units && *units > 0)
        scene.units_per_metre = *units;
    std::set<int> there = found.frames;
    if (!wanted.empty())
        std::erase_if(there, [&](int f) { return std::find(wanted.begin(), wanted.end(), f) == wanted.end(); });
    drop_stale(found, reports, there, !wanted.empty(), scene);
    const std::vector<int> frames = chosen(wanted.empty() ? there : found.frames, wanted, scene);
    note_several_runs(found, frames, scene);
    add_frames(frames, wanted, reports, scene);
    Missing missing;
    for (const cli::BodySequence& body : found.bodies)
        scene.bodies.push_back(read_body(body, frames, static_cast<int>(scene.bodies.size()), missing, scene));
    std::erase_if(scene.bodies, [](const ViewBody& b) { return b.rest.empty(); });
    note_missing(missing, scene);
}

void read_glb(const fs::path& file, const std::vector<FoundReport>& reports, const std::vector<int>& wanted,
              ViewScene& scene) {
    try {
        const GlbRun run(file);
        scene.up = run.frames().up, scene.units_per_metre = run.frames().units_per_metre;
        scene.fps = run.frames().fps;
        const std::vector<int> frames = chosen(run.frames().numbers, wanted, scene);
        std::vector<ViewBody> bodies = run.bodies(frames, scene.notes);
        add_frames(frames, wanted, reports, scene);
        for (ViewBody& body : bodies) {
            if (const std::string node = node_of(body.name, scene.graph); !node.empty()) body.name = body.node = node;
            scene.bodies.push_back(std::move(body));
        }
    } catch (const std::runtime_error& e) {
        scene.notes.push_back({true, file.string() + " cannot be shown: " + e.what() + "."});
    }
}

} // namespace

ViewScene collect_folder(const fs::path& folder, const std::vector<int>& wanted) {
    ViewScene scene;
    scene.source = folder.string();
    const fs::path name = folder.filename().empty() ? folder.parent_path().filename() : folder.filename();
    scene.title = name.string();
    const cli::SequenceFolder found = cli::find_sequences(folder);
    if (const std::size_t others = found.no_files.size(); others > 0)
        scene.notes.push_back({true, found.no_files.front().string() +
                                         (others > 1 ? " and " + std::to_string(others - 1) + " more are" : " is") +
                                         " called as a frame is, but no file that can be read; left out."});
    const std::vector<FoundReport> reports = find_reports(folder, scene.notes);
    note_ends(folder, reports, scene);
    std::string named = reports.empty() ? "" : reports.front().graph;
    if (named.empty())
        if (const auto left = cli::find_unfinished(folder); !left.empty()) named = left.front().graph;
    if (const auto graph = find_graph(folder, named, scene)) {
        scene.graph = layout_graph(*graph);
        scene.fps = graph->timing().fps;
    }
    const fs::path glb = found.bodies.empty() ? find_glb(folder) : fs::path();
    if (!found.bodies.empty())
        read_sequences(found, reports, wanted, scene);
    else if (!glb.empty())
        read_glb(glb, reports, wanted, scene);
    else
        scene.notes.push_back({true, "There are no OBJ sequences and no GLB in " + folder.string() +
                                         ". Make them with `sinew run GRAPH --out " + folder.string() +
                                         "`, or give `sinew view` the graph itself."});
    if (scene.bodies.empty()) return scene;
    find_faults(scene);
    scene.notes.push_back({false, "Shown from " + (glb.empty() ? "files" : glb.filename().string()) +
                                      ": surfaces only. `sinew view GRAPH` also shows tets, fibres, attachments and "
                                      "heat maps."});
    return scene;
}

} // namespace sinew::viewer
