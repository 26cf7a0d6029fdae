// `sinew snapshot`: a PNG of chosen frames, without a display.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/mesh_files.h"
#include "tools/cli/arguments.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/body_files.h"
#include "tools/cli/commands.h"
#include "tools/cli/print.h"
#include "tools/cli/problems.h"
#include "tools/render/picture.h"
#include "tools/render/shading_mesh.h"

#include <algorithm>
#include <ostream>

namespace sinew::cli {

namespace fs = std::filesystem;

namespace {

/// A body as it is drawn in every frame: split along creases and painted once.
struct Model {
    BodyLabel label;
    render::ShadingMesh shading;
    solver::Points grain;
    render::Look look;
};

Model make_model(const BodyLabel& label, const solver::Points& rest,
                 const std::vector<solver::Triangle>& triangles, int index) {
    Model model{
        label, render::split_creases(rest, triangles), {}, render::look_of(label.kind, label.name, index)};
    if (model.look.stripes > 0) model.grain = model.shading.gather(render::grain_of(rest));
    return model;
}

render::Surface posed(const Model& model, const solver::Points& points) {
    render::Surface surface;
    surface.points = model.shading.gather(points);
    surface.triangles = model.shading.triangles;
    surface.normals = solver::vertex_normals(surface.points, surface.triangles);
    surface.grain = model.grain;
    surface.look = model.look;
    return surface;
}

struct Album {
    std::vector<render::Shot> shots;
    char up = 'y';
};

std::string label_of(int frame) { return "frame " + std::to_string(frame); }

/// The frames asked for, or the first, the middle and the last one.
std::vector<int> chosen_frames(const Arguments& arguments, const std::vector<int>& there) {
    if (const auto text = arguments.value("--frames")) return parse_frames(*text);
    std::vector<int> out{there.front(), there[there.size() / 2], there.back()};
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

Album album_of_folder(const Arguments& arguments, const fs::path& folder) {
    const SequenceFolder found = find_sequences(folder);
    if (found.bodies.empty())
        throw UsageError("there are no OBJ sequences in '" + folder.string() +
                         "'; make them with `sinew run … --format obj --out " + folder.string() + "`.");
    Album album;
    album.up = found.up;
    std::vector<Model> models;
    for (const BodySequence& body : found.bodies) {
        const solver::SurfaceMesh first = solver::read_surface(body.files.begin()->second.string());
        models.push_back(
            make_model(body.label, first.points, first.triangles, static_cast<int>(models.size())));
    }
    for (const int frame : chosen_frames(arguments, {found.frames.begin(), found.frames.end()})) {
        if (!found.frames.contains(frame))
            throw UsageError("there is no frame " + std::to_string(frame) + " in '" + folder.string() +
                             "'; it has " + std::to_string(*found.frames.begin()) + " to " +
                             std::to_string(*found.frames.rbegin()) + ".");
        render::Shot shot{label_of(frame), {}};
        for (std::size_t b = 0; b < models.size(); ++b)
            if (const auto file = found.bodies[b].files.find(frame); file != found.bodies[b].files.end())
                shot.surfaces.push_back(posed(models[b], solver::read_surface(file->second.string()).points));
        album.shots.push_back(std::move(shot));
    }
    return album;
}

Album album_of_graph(const Invocation& in) {
    const OpenGraph open = open_graph(in.arguments);
    const auto named = in.arguments.value("--pull");
    const engine::Plug plug = named ? parse_plug(*open.graph, *named) : default_plug(*open.graph);
    const std::vector<std::string> needed = upstream_of(*open.graph, {plug.node});
    WarningCollector warnings;
    engine::Evaluator evaluator({}, in.arguments.whole_number("--threads", 0, 1), &warnings);
    const auto meshes_at = [&](int frame) {
        return meshes_in(evaluator.pull({open.graph, plug, static_cast<double>(frame), in.stop}));
    };
    const auto rest = meshes_at(start_frame(*open.graph, needed));
    if (rest.empty()) throw UsageError(plug.text() + " gives no meshes.");
    const std::vector<BodyLabel> labels = body_labels(*open.graph, plug, rest.size());
    std::vector<Model> models;
    for (std::size_t b = 0; b < rest.size(); ++b)
        models.push_back(
            make_model(labels[b], *rest[b].points, rest[b].topology->triangles, static_cast<int>(b)));
    Album album;
    album.up = scene_axes(*open.graph, needed).up;
    std::vector<int> all;
    for (int frame = open.graph->timing().start; frame <= open.graph->timing().end; ++frame)
        all.push_back(frame);
    for (const int frame : chosen_frames(in.arguments, all)) {
        const auto meshes = meshes_at(frame);
        render::Shot shot{label_of(frame), {}};
        for (std::size_t b = 0; b < models.size() && b < meshes.size(); ++b)
            shot.surfaces.push_back(posed(models[b], *meshes[b].points));
        album.shots.push_back(std::move(shot));
    }
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

ExitCode snapshot(const Invocation& in) {
    const Arguments& arguments = in.arguments;
    const auto view_text = arguments.value("--view").value_or("corner");
    auto view = render::parse_view(view_text);
    if (!view)
        throw UsageError("--view needs front, back, left, right, top, bottom, corner or AZIMUTH,ELEVATION in "
                         "degrees, not '" +
                         view_text + "'.");
    const auto [width, height] = parse_size(arguments.value("--size").value_or("1600x900"));
    const std::string up = arguments.value("--up").value_or("");
    if (arguments.has("--up") && up != "y" && up != "z")
        throw UsageError("--up needs y or z, not '" + up + "'.");
    const int smoothing = arguments.whole_number("--smooth", 3, 1);
    if (smoothing > 8) throw UsageError("--smooth needs at most 8.");

    const fs::path source = arguments.operand(0).value();
    const Album album = fs::is_directory(source) ? album_of_folder(arguments, source) : album_of_graph(in);
    view->up = up.empty() ? album.up : up[0];
    const std::string file = arguments.value("--output").value_or("snapshot.png");
    write_file(file, render::encode_png(render::contact_sheet(album.shots, *view, width, height, smoothing)));
    in.out << "wrote " << file << "\n";
    return done;
}

} // namespace

Command snapshot_command() {
    return {"snapshot",
            "draw chosen frames side by side into a PNG",
            {{"SOURCE", "a folder that `sinew run --format obj` wrote, or a graph file"}},
            {{"--frames", "LIST", "for example 1,64,128; default: first, middle and last"},
             {"--output", "FILE", "default: snapshot.png", false, 'o'},
             {"--size", "WxH", "of the whole picture; default: 1600x900"},
             {"--view", "VIEW",
              "front, back, left, right, top, bottom, corner (default) or AZIMUTH,ELEVATION in degrees"},
             {"--up", "y|z", "the axis that points up; default: against the scene's gravity"},
             {"--smooth", "N", "samples along each side of a pixel; default: 3"},
             {"--pull", "NODE.PLUG", "graphs: what to draw; default: outMeshes of the only zSolver"},
             {"--set", "NODE.ATTR=JSON", "graphs: give an input another value", true},
             {"--threads", "N", "graphs: default: all cores", false, 'j'}},
            "sinew snapshot out/arm --frames 1,64,128 --size 1800x600 -o out/arm/arm.png",
            snapshot};
}

} // namespace sinew::cli
