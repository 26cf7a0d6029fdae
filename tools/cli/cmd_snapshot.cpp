// `sinew snapshot`: a PNG of chosen frames or a movie of all, without a display. Draws the viewer's scene.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/text.h"
#include "tools/cli/arguments.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/body_files.h"
#include "tools/cli/commands.h"
#include "tools/cli/departure.h"
#include "tools/cli/long_task.h"
#include "tools/cli/motion_range.h"
#include "tools/cli/print.h"
#include "tools/cli/problems.h"
#include "tools/cli/read_files.h"
#include "tools/cli/writable_folder.h"
#include "tools/render/movie.h"
#include "tools/viewer/collect.h"
#include "tools/viewer/collect_glb.h"
#include "tools/viewer/shot.h"
#include "tools/viewer/shot_overlays.h"

#include <algorithm>
#include <optional>
#include <ostream>
#include <set>
#include <span>
#include <tbb/global_control.h>

namespace sinew::cli {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view frames_doc = "for example 1,64,128 or 1-24; default: first, middle and last, movies: all";

/// The frames asked for. Otherwise all for a movie, and the first, the middle and the last one for a picture.
std::vector<int> chosen_frames(const Arguments& arguments, const std::vector<int>& there) {
    if (const auto text = arguments.value("--frames")) return parse_frames(*text);
    if (arguments.has("--movie") || there.empty()) return there;
    std::vector<int> out{there.front(), there[there.size() / 2], there.back()};
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

std::vector<int> sorted(std::vector<int> frames) {
    std::sort(frames.begin(), frames.end());
    return frames;
}

/// What is drawn: indices into the scene's frames, in the order asked for.
struct Album {
    viewer::ViewScene scene;
    std::vector<std::size_t> shots;
};

Album make_album(viewer::ViewScene scene, const std::vector<int>& frames) {
    Album album{std::move(scene), {}};
    for (const int frame : frames)
        for (std::size_t f = 0; f < album.scene.frames.size(); ++f)
            if (album.scene.frames[f].frame == frame) album.shots.push_back(f);
    return album;
}

void check_kept(const Arguments& arguments, const ReadFiles& read) {
    if (const auto movie = arguments.value("--movie")) return read.check_kept(*movie, "--movie");
    read.check_kept(arguments.value("--output").value_or("snapshot.png"), "--output");
}

Album album_of_folder(const Invocation& in, const fs::path& folder) {
    ReadFiles read;
    read.add_folder(folder);
    check_kept(in.arguments, read);
    std::set<int> there = find_sequences(folder).frames;
    if (const fs::path glb = viewer::find_glb(folder); there.empty() && !glb.empty()) {
        try {
            there = viewer::GlbRun(glb).frames().numbers;
        } catch (const std::runtime_error& e) {
            throw UsageError(glb.string() + " cannot be read: " + e.what() + ".");
        }
    }
    if (there.empty())
        throw UsageError("there are no OBJ sequences and no GLB in '" + folder.string() +
                         "'; make them with `sinew run … --out " + folder.string() + "`.");
    const std::vector<int> frames = chosen_frames(in.arguments, {there.begin(), there.end()});
    for (const int frame : frames)
        if (!there.contains(frame))
            throw UsageError("there is no frame " + std::to_string(frame) + " in '" + folder.string() + "'; it has " +
                             std::to_string(*there.begin()) + " to " + std::to_string(*there.rbegin()) + ".");
    return make_album(viewer::collect_folder(folder, sorted(frames)), frames);
}

UsageError no_body(std::string_view flag, const std::string& word, const std::vector<std::string>& known) {
    const std::string near = did_you_mean(word, known);
    return UsageError(std::string(flag) + ": there is no body '" + word + "'." +
                      (near.empty() ? " Bodies: " + engine::listed(known) + "." : near));
}

/// Before anything is computed.
void check_named(const Arguments& arguments, const engine::Graph& graph, const engine::Plug& plug) {
    const std::vector<std::string> known = viewer::solver_body_names(graph, plug);
    if (known.empty()) return;
    for (const std::string_view flag : {"--focus", "--bodies"})
        for (const std::string& word : split(arguments.value(flag).value_or(""), ','))
            if (!word.empty() && std::find(known.begin(), known.end(), word) == known.end())
                throw no_body(flag, word, known);
}

Album album_of_graph(const Invocation& in) {
    const OpenGraph open = open_graph(in.arguments);
    print_diagnostics(open.notes, false, in.out, in.err);
    ReadFiles read;
    read.add(*open.graph);
    check_kept(in.arguments, read);
    const auto named = in.arguments.value("--pull");
    const engine::Plug plug = named ? parse_plug(*open.graph, *named) : default_plug(*open.graph);
    check_named(in.arguments, *open.graph, plug);
    std::vector<int> all;
    for (int frame = open.graph->timing().start; frame <= open.graph->timing().end; ++frame) all.push_back(frame);
    const std::vector<int> frames = chosen_frames(in.arguments, all);
    if (const auto doubt = find_timing_doubt(open.graph->timing(), frames, "snapshot"))
        print_diagnostics(std::span(&*doubt, 1), false, in.out, in.err);
    WarningCollector warnings(open.graph, *std::max_element(frames.begin(), frames.end()), false, in.err);
    engine::Evaluator evaluator(store_policy(in.arguments, *open.graph),
                                in.arguments.whole_number("--threads", 0, 1, most_threads), &warnings);
    viewer::Evaluation e;
    e.graph = open.graph, e.evaluator = &evaluator, e.frames = sorted(frames), e.stop = in.stop;
    e.shown = {plug};
    e.keeps_frames = false, e.with_lattices = in.arguments.has("--overlays");
    Album album = make_album(viewer::collect_graph(e), frames);
    if (album.scene.bodies.empty()) throw UsageError(plug.text() + " gives no meshes.");
    print_diagnostics(warnings.take(), false, in.out, in.err);
    return album;
}

std::pair<int, int> parse_size(const std::string& text) {
    const auto parts = split(text, 'x');
    const auto width = parts.size() == 2 ? to_int(parts[0]) : std::nullopt,
               height = parts.size() == 2 ? to_int(parts[1]) : std::nullopt;
    if (!width || !height || *width < 16 || *height < 16 || *width > 16384 || *height > 16384)
        throw UsageError("--size needs WIDTHxHEIGHT between 16x16 and 16384x16384, not '" + text + "'.");
    return {*width, *height};
}

/// The bodies that a flag names, by their own name or their node's; null if it is not given.
std::optional<std::set<std::size_t>> named_bodies(const Arguments& arguments, std::string_view flag,
                                                  const viewer::ViewScene& scene) {
    const auto text = arguments.value(flag);
    if (!text) return {};
    std::vector<std::string> known;
    for (const viewer::ViewBody& body : scene.bodies) known.push_back(body.name);
    std::set<std::size_t> out;
    for (const std::string& word : split(*text, ',')) {
        bool found = false;
        for (std::size_t b = 0; b < scene.bodies.size(); ++b)
            if (scene.bodies[b].name == word || scene.bodies[b].node == word) out.insert(b), found = true;
        if (!found) throw no_body(flag, word, known);
    }
    return out;
}

/// Leaves out what --bodies does not name, and frames what --focus names.
void choose_bodies(const Arguments& arguments, viewer::ViewScene& scene) {
    if (const auto focus = named_bodies(arguments, "--focus", scene))
        for (std::size_t b = 0; b < scene.bodies.size(); ++b) scene.bodies[b].is_framed = focus->contains(b);
    const auto kept = named_bodies(arguments, "--bodies", scene);
    if (kept) viewer::keep_bodies(scene, *kept);
}

struct Drawing {
    render::View view;
    int width = 0, height = 0, smoothing = 3;
    std::set<std::string> overlays;
};

std::set<std::string> parse_overlays(const Arguments& arguments) {
    std::set<std::string> out;
    const auto text = arguments.value("--overlays");
    if (!text) return out;
    const std::vector<std::string> known(viewer::overlay_names().begin(), viewer::overlay_names().end());
    std::string listed;
    for (const std::string& name : known) listed += (listed.empty() ? "" : ", ") + name;
    for (const std::string& word : split(*text, ',')) {
        if (!viewer::overlay_names().contains(word))
            throw UsageError("unknown overlay '" + word + "'; known are " + listed + "." + did_you_mean(word, known));
        out.insert(word);
    }
    return out;
}

Drawing parse_drawing(const Arguments& arguments) {
    const auto view_text = arguments.value("--view").value_or("corner");
    const auto view = render::parse_view(view_text);
    if (!view)
        throw UsageError("--view needs front, back, left, right, top, bottom, corner or AZIMUTH,ELEVATION in "
                         "degrees, not '" +
                         view_text + "'.");
    const auto [width, height] = parse_size(arguments.value("--size").value_or("1600x900"));
    const std::string up = arguments.value("--up").value_or("");
    if (arguments.has("--up") && up != "y" && up != "z") throw UsageError("--up needs y or z, not '" + up + "'.");
    const int smoothing = arguments.whole_number("--smooth", 3, 1, 8);
    return {*view, width, height, smoothing, parse_overlays(arguments)};
}

/// The ffmpeg to use. All that can be wrong with the words is said before anything is computed.
fs::path check_movie(const Arguments& arguments, const Drawing& drawing) {
    if (arguments.has("--output")) throw UsageError("--output is for pictures; the movie goes to the file of --movie.");
    if (fs::path(*arguments.value("--movie")).extension() != ".mp4")
        throw UsageError("--movie needs a name that ends in .mp4, not '" + *arguments.value("--movie") + "'.");
    if (drawing.width % 2 != 0 || drawing.height % 2 != 0)
        throw UsageError("a movie needs even numbers in --size, for example " +
                         std::to_string(drawing.width + drawing.width % 2) + "x" +
                         std::to_string(drawing.height + drawing.height % 2) + ".");
    const auto ffmpeg = render::find_ffmpeg();
    if (!ffmpeg)
        throw UsageError("--movie needs the program ffmpeg, which is not in the PATH. Install it (Debian and "
                         "Ubuntu: apt install ffmpeg; Fedora: dnf install ffmpeg-free) and try again, or "
                         "leave out --movie for a picture.");
    return *ffmpeg;
}

std::string movie_of(const Album& album, const Drawing& drawing, const fs::path& ffmpeg, double fps,
                     std::stop_token stop) {
    // One camera that holds the whole motion, so that what stands still does so in the movie.
    render::Framing framing(drawing.view, static_cast<double>(drawing.width) / drawing.height);
    for (const std::size_t f : album.shots)
        for (const render::Surface& surface : viewer::shot_of(album.scene, f, {}).surfaces)
            if (surface.is_framed) framing.add(surface.points);
    const render::Camera camera = framing.camera();
    render::Movie movie;
    for (const std::size_t f : album.shots) {
        if (stop.stop_requested()) throw engine::Cancelled();
        movie.add(render::labelled_picture(viewer::shot_of(album.scene, f, drawing.overlays), camera, drawing.width,
                                           drawing.height, drawing.smoothing));
    }
    std::string bytes = movie.encode(ffmpeg, fps, stop);
    if (bytes.empty()) throw engine::Cancelled();
    return bytes;
}

std::string picture_of(const Album& album, const Drawing& drawing) {
    std::vector<render::Shot> shots;
    for (const std::size_t f : album.shots) shots.push_back(viewer::shot_of(album.scene, f, drawing.overlays));
    return render::encode_png(
        render::contact_sheet(shots, drawing.view, drawing.width, drawing.height, drawing.smoothing));
}

ExitCode snapshot(const Invocation& in) {
    const Arguments& arguments = in.arguments;
    Drawing drawing = parse_drawing(arguments);
    const auto movie_file = arguments.value("--movie");
    if (!movie_file && arguments.has("--fps")) throw UsageError("--fps is for --movie.");
    const engine::FileAccess files = file_access(arguments);
    if (files.is_confined() && fs::is_directory(arguments.operand(0).value()))
        throw UsageError("--root is for graphs; '" + arguments.operand(0).value() + "' is a folder.");
    files.check(movie_file ? *movie_file : arguments.value("--output").value_or("snapshot.png"),
                movie_file ? "--movie" : "--output");
    check_writable_file(movie_file ? *movie_file : arguments.value("--output").value_or("snapshot.png"),
                        movie_file ? "--movie" : "--output");
    // What is written is a PNG, whatever the name says.
    if (const std::string ending = fs::path(arguments.value("--output").value_or("")).extension().string();
        std::set<std::string>{".jpg", ".jpeg", ".gif", ".bmp", ".tif", ".tiff", ".webp", ".svg", ".pdf", ".mp4"}
            .contains(ending))
        throw UsageError("--output writes PNG, and '" + *arguments.value("--output") +
                         "' has the ending of another format; name it .png.");
    const fs::path ffmpeg = movie_file ? check_movie(arguments, drawing) : fs::path();
    const int fps = arguments.whole_number("--fps", 0, 1),
              threads = arguments.whole_number("--threads", 0, 1, most_threads);

    const fs::path source = arguments.operand(0).value();
    check_source(source, files);
    if (fs::is_directory(source) && !drawing.overlays.empty())
        throw UsageError("--overlays is for graphs; the files in '" + source.string() + "' hold surfaces only.");
    std::optional<Departure> departure(std::in_place, in.stop, "sinew snapshot", false);
    Album album = fs::is_directory(source) ? album_of_folder(in, source) : album_of_graph(in);
    for (const viewer::ViewNote& note : album.scene.notes)
        if (note.is_warning) in.err << "sinew snapshot: " << note.text << "\n";
    if (album.scene.bodies.empty()) return graph_wrong;
    choose_bodies(arguments, album.scene);
    const std::string up = arguments.value("--up").value_or("");
    drawing.view.up = up.empty() ? album.scene.up : up[0];
    std::optional<tbb::global_control> limit; // drawing asks no evaluator for threads
    if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    if (!movie_file) {
        const std::string file = arguments.value("--output").value_or("snapshot.png");
        const LongTask task(in.err, "drawing " + file, false);
        write_file(file, picture_of(album, drawing), files);
        in.out << "wrote " << file << "\n";
        return done;
    }
    const double rate = fps > 0 ? fps : album.scene.fps;
    departure.reset(); // ffmpeg must not be left behind
    try {
        const LongTask task(in.err, "drawing " + *movie_file, false);
        write_file(*movie_file, movie_of(album, drawing, ffmpeg, rate, in.stop), files);
    } catch (const render::MovieError& e) {
        in.err << "sinew snapshot: " << e.what() << "\n";
        return internal_error;
    }
    in.out << "wrote " << *movie_file << ", " << album.shots.size()
           << (album.shots.size() == 1 ? " frame at " : " frames at ") << rate << " a second\n";
    return done;
}

} // namespace

Command snapshot_command() {
    return {
        "snapshot",
        "draw chosen frames side by side into a PNG, or all into a movie",
        {{"SOURCE", "a folder that `sinew run --out` wrote (OBJ or GLB), or a graph file"}},
        {{"--frames", "LIST", frames_doc},
         {"--output", "FILE", "default: snapshot.png", false, 'o'},
         {"--movie", "FILE.mp4", "a movie of the frames instead of a picture; needs ffmpeg"},
         {"--fps", "N", "of the movie; default: the scene's"},
         {"--size", "WxH", "of the whole picture; default: 1600x900"},
         {"--view", "VIEW", "front, back, left, right, top, bottom, corner (default) or AZIMUTH,ELEVATION in degrees"},
         {"--bodies", "LIST", "draw these bodies alone, and the marks that are about them, for example biceps,humerus"},
         {"--focus", "LIST", "let these bodies fill the picture; default: all that are drawn"},
         {"--up", "y|z", "the axis that points up; default: against the scene's gravity"},
         {"--overlays", "LIST",
          "graphs: lattice, fibers, attachments, marks; flesh is then seen through. Same colours as in the viewer"},
         {"--smooth", "N", "samples along each side of a pixel; default: 3"},
         {"--pull", "NODE.PLUG", "graphs: what to draw; default: outMeshes of the only zSolver"},
         {"--set", "NODE.ATTR=JSON", "graphs: give an input another value", true},
         {"--threads", "N", "default: all cores", false, 'j'},
         root_flag,
         memory_flag,
         cache_flag,
         no_cache_flag,
         cache_size_flag},
        "sinew snapshot out/arm --frames 1,64,128 --size 1800x600 -o out/arm/arm.png\n"
        "sinew snapshot out/arm --frames 64 --bodies biceps,humerus --focus biceps -o biceps.png\n"
        "sinew snapshot out/arm --movie out/arm/arm.mp4 --size 1280x720",
        snapshot};
}

} // namespace sinew::cli
