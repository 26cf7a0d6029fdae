// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/part_text.h"

#include "tools/rig/wrap.h"

namespace sinew::rig {

namespace {

/// NAMELids.outMesh.
void write_lids(GraphText& text, const Rig& rig, const Part& part) {
    std::vector<std::string> points, corners;
    for (const solver::Vec3& p : part.lids.points)
        for (int axis = 0; axis < 3; ++axis) points.push_back(coordinate(p[axis]));
    for (const solver::Triangle& t : part.lids.triangles)
        for (const int v : t) corners.push_back(std::to_string(v));
    text.comment("Its holes are as wide as " + length_text(rig, part.lids.widest) +
                 ". These lids close them, straight across; make them anew if the file changes.");
    text.node(part.name + "Lids", "hostMesh", {{"points", list(points)}, {"faceVertices", list(corners)}});
}

} // namespace

std::string length_text(const Rig& rig, double value) { return rough(value) + " " + rig.unit.name; }

std::string head_text(const Rig& rig, const TextOptions& options) {
    std::string out = "Made by: " + options.made_by +
                      "\nAll of it is guessed from the meshes' shapes and names; look at it " +
                      "before you trust it.\nUnit: " + rig.unit.name + " (" + rig.unit.how_known +
                      "). Up: " + rig.up.axis + " (" + rig.up.how_known + ").";
    for (const engine::Diagnostic& d : rig.notes)
        out += "\nNot sure: " + (d.node.empty() ? "" : d.node + ": ") + d.message + ". " + d.hint;
    return out;
}

int last_frame(const TextOptions& options) {
    return options.end.value_or(options.motion ? options.motion->frames(graph_fps) : 24);
}

void write_mesh(GraphText& text, const Rig& rig, const Part& part, const TextOptions& options) {
    const std::string file = text_of(path_from(options.folder, part.file));
    if (!part.is_wrapped) {
        text.node(part.name + "Mesh", "meshFile", {{"file", file}});
        return;
    }
    text.comment("The file cannot be used as it is, because " + part.why_wrapped + ": a closed surface " +
                 (part.wrap > 0 ? length_text(rig, part.wrap) + " around it." : "in its place."));
    text.node(part.name + "Polygons", "meshFile", {{"file", file}});
    std::vector<std::string> meshes{wire(part.name + "Polygons", "outMesh")};
    if (part.lids.count > 0) {
        write_lids(text, rig, part);
        meshes.push_back(wire(part.name + "Lids", "outMesh"));
    }
    Inputs inputs{{"meshes", list(meshes)}};
    if (part.wrap > 0) inputs.emplace_back("isoValue", number(part.wrap));
    inputs.emplace_back("resolution", std::to_string(wrap_resolution));
    text.node(part.name + "Mesh", "zIsoMesh", inputs);
}

void write_bone(GraphText& text, const Rig& rig, const Part& part, const TextOptions& options, const Inputs& more) {
    write_mesh(text, rig, part, options);
    Inputs inputs{{"mesh", wire(part.name + "Mesh", "outMesh")}};
    if (options.motion && options.motion->tracks.contains(part.name)) {
        const Motion& motion = *options.motion;
        Inputs move{{"track", text_of(path_from(options.folder, motion.file))},
                    {"trackName", text_of(motion.tracks.at(part.name))}};
        if (motion.first != 1) move.emplace_back("trackOffset", number(motion.first - 1));
        if (motion.fps != graph_fps) move.emplace_back("trackRate", number(motion.fps / graph_fps));
        text.node(part.name + "Move", "transform", move);
        inputs.emplace_back("matrix", wire(part.name + "Move", "outMatrix"));
    }
    inputs.insert(inputs.end(), more.begin(), more.end());
    text.node(part.name, "zBone", inputs);
}

void add_space(Inputs& inputs, const Rig& rig) {
    inputs.emplace_back("scale", number(rig.unit.per_metre));
    if (rig.up.axis == 'z') inputs.emplace_back("gravity", "[0, 0, -9.8]");
}

} // namespace sinew::rig
