// `sinew view`: a run as one HTML page that opens from disk.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/arguments.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/commands.h"
#include "tools/cli/departure.h"
#include "tools/cli/long_task.h"
#include "tools/cli/motion_range.h"
#include "tools/cli/open_graph.h"
#include "tools/cli/print.h"
#include "tools/cli/problems.h"
#include "tools/cli/progress.h"
#include "tools/cli/read_files.h"
#include "tools/cli/writable_folder.h"
#include "tools/viewer/collect.h"
#include "tools/viewer/page.h"
#include "tools/viewer/recorder.h"

#include <algorithm>
#include <numeric>
#include <ostream>
#include <unistd.h>

namespace sinew::cli {

namespace fs = std::filesystem;

namespace {

std::vector<int> wanted_frames(const Arguments& arguments) {
    const auto text = arguments.value("--frames");
    std::vector<int> frames = text ? parse_frames(*text) : std::vector<int>{};
    std::sort(frames.begin(), frames.end());
    return frames;
}

std::string counted(std::size_t count, const std::string& one, const std::string& several) {
    return std::to_string(count) + " " + (count == 1 ? one : several);
}

void note_outside(const engine::Timing& timing, const std::vector<int>& frames, viewer::ViewScene& scene) {
    const std::vector<int> outside = frames_outside(timing, frames);
    if (!outside.empty())
        scene.notes.push_back({true, "Frame" + std::string(outside.size() == 1 ? " " : "s ") +
                                         viewer::frame_list(outside) + (outside.size() == 1 ? " lies" : " lie") +
                                         " outside the graph's timing, " + std::to_string(timing.start) + " to " +
                                         std::to_string(timing.end) + "."});
}

/// view.html, unless that is a page with more in it than the folder's meshes can give.
fs::path page_in(const fs::path& folder) {
    const fs::path usual = folder / "view.html";
    return viewer::holds_evaluated_page(usual) ? folder / "view_files.html" : usual;
}

/// Where the page goes.
fs::path page_of(const Arguments& arguments) {
    const fs::path source = arguments.operand(0).value();
    const fs::path usual = fs::is_directory(source) ? page_in(source) : fs::path(source.stem().string() + ".html");
    return arguments.value("--output").value_or(usual.string());
}

OpenGraph read_graph(const Invocation& in, const fs::path& file, bool settings) {
    const Departure departure(in.stop, "sinew view", false);
    return settings ? open_graph(in.arguments, file.string()) : open_graph(file.string(), file_access(in.arguments));
}

/// `settings`: with --set.
viewer::ViewScene scene_of_graph(const Invocation& in, const fs::path& file, bool settings) {
    const OpenGraph open = read_graph(in, file, settings);
    print_diagnostics(open.notes, false, in.out, in.err);
    const std::vector<std::string> shown = viewer::shown_nodes(*open.graph);
    if (shown.empty())
        throw UsageError("the graph has neither a zSolver nor a zEmbedder, so there is nothing to show.");
    viewer::Evaluation e;
    e.graph = open.graph;
    e.frames = wanted_frames(in.arguments);
    e.stop = in.stop;
    e.with_lattices = !in.arguments.has("--surfaces");
    if (e.frames.empty()) {
        const engine::Timing& timing = open.graph->timing();
        e.frames.resize(static_cast<std::size_t>(std::max(0, timing.end - timing.start + 1)));
        std::iota(e.frames.begin(), e.frames.end(), timing.start);
    }
    const ProgressStyle style = in.arguments.has("--quiet")                      ? ProgressStyle::quiet
                                : isatty(STDERR_FILENO) && isatty(STDOUT_FILENO) ? ProgressStyle::bar
                                                                                 : ProgressStyle::lines;
    Progress progress(style, open.graph, static_cast<int>(e.frames.size()), in.out, in.err);
    engine::Evaluator evaluator(store_policy(in.arguments, *open.graph),
                                in.arguments.whole_number("--threads", 0, 1, most_threads), &progress);
    const auto needed = upstream_of(*open.graph, shown);
    if (auto problems = find_problems(open.graph, evaluator, needed, in.stop); has_error(problems))
        throw engine::Failure(std::move(problems));
    e.evaluator = &evaluator;
    e.begin_frame = [&](int frame) { progress.begin_frame(frame); };
    const bool simulates = !simulations(*open.graph, needed).empty();
    e.was_stepped = [&, simulates](int frame) { return !simulates || progress.was_stepped(frame); };
    e.end_frame = [&](const viewer::ViewFrame& f) { progress.end_frame({f.frame, f.reused, f.wall_s, f.step}, ""); };
    viewer::ViewScene scene = viewer::collect_graph(e);
    note_outside(open.graph->timing(), e.frames, scene);
    progress.clear();
    return scene;
}

void add_source(const Invocation& in, const fs::path& source, bool settings, ReadFiles& read) {
    if (fs::is_directory(source))
        read.add_folder(source);
    else
        read.add(*read_graph(in, source, settings).graph);
}

viewer::ViewScene scene_of(const Invocation& in, const fs::path& source, bool settings) {
    if (!fs::is_directory(source)) return scene_of_graph(in, source, settings);
    const Departure departure(in.stop, "sinew view", false);
    const LongTask task(in.err, "reading " + source.string(), in.arguments.has("--quiet"));
    return viewer::collect_folder(source, wanted_frames(in.arguments));
}

/// Two runs of one graph, or folders of one name, are named after what makes them differ.
void tell_apart(const Invocation& in, viewer::ViewScene& scene, viewer::ViewScene& other) {
    if (scene.title != other.title) return;
    for (const std::string& setting : in.arguments.values("--set")) scene.title += ", " + setting;
    if (scene.title != other.title) return;
    if (scene.source != other.source) scene.title = scene.source, other.title = other.source;
    if (scene.title == other.title) other.title += " again";
}

std::string summary(const viewer::ViewScene& scene, const viewer::Page& page) {
    std::size_t vertices = 0, tets = 0;
    for (const viewer::ViewBody& b : scene.bodies) {
        vertices += b.vertex_count();
        if (b.lattice) tets += b.lattice->tets.size();
    }
    using viewer::size_text;
    return size_text(page.html.size()) + ": " + counted(scene.bodies.size(), "body", "bodies") + ", " +
           counted(vertices, "vertex", "vertices") + ", " + counted(tets, "tet", "tets") + ", " +
           counted(scene.frames.size(), "frame", "frames") + "; the run takes " + size_text(page.packed_bytes) +
           " of it, the viewer " + size_text(page.asset_bytes);
}

ExitCode view(const Invocation& in) {
    const fs::path source = in.arguments.operand(0).value();
    const bool is_folder = fs::is_directory(source);
    if (is_folder && (in.arguments.has("--set") || in.arguments.has("--surfaces") || in.arguments.has("--threads") ||
                      in.arguments.has("--memory")))
        throw UsageError("--set, --surfaces, --threads and --memory are for graphs; '" + source.string() +
                         "' is a folder.");
    const engine::FileAccess files = file_access(in.arguments);
    for (const fs::path& named : {source, fs::path(in.arguments.value("--against").value_or(""))})
        if (files.is_confined() && fs::is_directory(named))
            throw UsageError("--root is for graphs; '" + named.string() + "' is a folder.");
    const fs::path file = page_of(in.arguments);
    files.check(file, "--output");
    if (const fs::path page = in.arguments.value("--output").value_or(""); fs::is_directory(page)) // before a long run
        throw UsageError("--output names the folder '" + page.string() + "'; give the page a name, for example " +
                         (page / "view.html").string() + ".");
    check_writable_file(file, "--output");
    check_source(source, files);
    if (const auto against = in.arguments.value("--against")) check_source(*against, files);
    ReadFiles read;
    add_source(in, source, true, read);
    if (const auto against = in.arguments.value("--against")) add_source(in, *against, false, read);
    read.check_kept(file, "--output");
    viewer::PageOptions options;
    options.most_motion_bytes = static_cast<std::size_t>(in.arguments.whole_number("--most-mb", 256, 1)) << 20;
    viewer::ViewScene scene = scene_of(in, source, true);
    std::optional<viewer::ViewScene> other;
    if (const auto against = in.arguments.value("--against"); against && !in.stop.stop_requested()) {
        other = scene_of(in, *against, false);
        tell_apart(in, scene, *other);
    }
    const viewer::Page page = [&] {
        const LongTask task(in.err, "writing " + file.string(), in.arguments.has("--quiet"));
        // Where the run was cancelled this page is what is left of it.
        std::optional<Departure> departure;
        if (!in.stop.stop_requested()) departure.emplace(in.stop, "sinew view", false);
        viewer::Page out = viewer::write_page(scene, options, other);
        write_file(file, out.html, files);
        return out;
    }();
    for (const viewer::ViewNote& note : page.notes)
        if (note.is_warning) in.err << "sinew view: " << note.text << "\n";
    if (!in.arguments.has("--quiet")) {
        if (is_folder && !in.arguments.has("--output") && file.filename() != "view.html")
            in.out << "kept " << (source / "view.html").string()
                   << ", which `sinew run --open` or `sinew view GRAPH` made\n";
        in.out << "wrote " << file.string() << ", " << summary(scene, page) << "\n"
               << "open " << file_url(fs::absolute(file)) << "\n";
    }
    if (in.stop.stop_requested()) {
        in.err << "sinew view: cancelled\n";
        return cancelled;
    }
    // The page says what is wrong, and so does the exit code: a folder without a run is no success.
    return scene.bodies.empty() ? graph_wrong : done;
}

} // namespace

Command view_command() {
    return {
        "view",
        "write a page that plays a run in a browser, with overlays, the graph and a time line",
        {{"SOURCE", "a graph file, which is evaluated, or a folder that `sinew run --out` wrote (OBJ or GLB)"}},
        {{"--output", "FILE", "the page; default: NAME.html, or view.html in the folder", false, 'o'},
         {"--frames", "A-B", "frames, for example 12, 1-24 or 1,64,128; default: all"},
         {"--surfaces", "", "graphs: leave out tets, fibres and attachments; a smaller page"},
         {"--most-mb", "N", "above this size of positions, before compression, frames are thinned out; default: 256"},
         {"--against", "SOURCE",
          "a second run, a graph or a folder, to compare with: side by side or as the difference"},
         {"--set", "NODE.ATTR=JSON", "graphs: give an input another value; not in --against", true},
         {"--threads", "N", "graphs: default: all cores", false, 'j'},
         root_flag,
         memory_flag,
         cache_flag,
         no_cache_flag,
         cache_size_flag,
         {"--quiet", "", "print warnings and errors only", false, 'q'}},
        "sinew view graphs/scenes/arm.json -o out/arm.html\n"
        "sinew view out/arm\n"
        "sinew view graphs/scenes/arm.json --set solver.substeps=2 --against graphs/scenes/arm.json -o out/steps.html",
        view};
}

} // namespace sinew::cli
