// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/body_files.h"

#include "engine/digest.h"
#include "engine/format/graph_file.h"
#include "solver/mesh/mesh_files.h"
#include "tools/cli/atomic_file.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace sinew::cli {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view mark = "# sinew: "; // "# sinew: bone, y up, 100 units a metre"
constexpr std::string_view look_mark =
    "# sinew looks: "; // "# sinew looks: tendon, #d8ccb7"; only where the graph says so

constexpr std::string_view run_line = "# sinew run: "; // last: which runs belong together

std::string header(const BodyLabel& label, const SceneAxes& axes, const std::string& run) {
    std::ostringstream out;
    out << mark << render::word_of(label.kind) << ", " << axes.up << " up, " << axes.units_per_metre
        << " units a metre\n";
    if (const auto& [matter, colour] = label.appearance; matter || colour) {
        out << look_mark << nodes::word_of(render::matter_of(label.kind, label.appearance));
        if (colour) out << ", " << render::hex_of(*colour);
        out << "\n";
    }
    if (!run.empty()) out << run_line << run << "\n";
    return out.str();
}

/// Reads the first lines of a file back; leaves both as they are where they say nothing.
void read_header(const fs::path& file, BodyLabel& label, char& up) {
    std::ifstream in(file);
    std::string line;
    if (!std::getline(in, line) || !line.starts_with(mark)) return;
    const auto parts = split(std::string_view(line).substr(mark.size()), ',');
    label.kind = render::kind_of(parts[0]);
    if (parts.size() > 1 && parts[1] == " z up") up = 'z';
    if (!std::getline(in, line) || !line.starts_with(look_mark)) return;
    const auto looks = split(std::string_view(line).substr(look_mark.size()), ',');
    label.appearance.matter = render::matter_of(looks[0]);
    if (looks.size() > 1 && !looks[1].empty())
        label.appearance.colour = render::colour_of(std::string_view(looks[1]).substr(1));
}

} // namespace

std::optional<std::pair<std::string, int>> parse_frame_file(const fs::path& file, const std::string& ending) {
    if (file.extension() != "." + ending) return {};
    const std::string stem = file.stem().string();
    const std::size_t dot = stem.rfind('.');
    if (dot == std::string::npos || dot == 0) return {};
    const auto frame = to_int(std::string_view(stem).substr(dot + 1));
    if (!frame) return {};
    return std::pair(stem.substr(0, dot), *frame);
}

std::string run_mark(const engine::Graph& graph) {
    const std::string text = engine::write_graph(graph);
    auto json = nlohmann::json::parse(text, nullptr, false, true);
    engine::Hasher hasher;
    if (!json.is_object()) return hasher.add(text).finish().hex().substr(0, 16);
    for (const char* key : {"$schema", "comment", "editor"}) json.erase(key);
    if (json.contains("timing")) json["timing"].erase("end");
    return hasher.add(json.dump()).finish().hex().substr(0, 16);
}

std::string read_run_mark(const fs::path& obj) {
    std::ifstream in(obj);
    std::string line;
    while (std::getline(in, line) && line.starts_with("#"))
        if (line.starts_with(run_line)) return line.substr(run_line.size());
    return {};
}

std::string frame_file_name(const std::string& name, int frame, const std::string& ending) {
    char number[16];
    std::snprintf(number, sizeof number, frame < 0 ? "%05d" : "%04d", frame);
    return name + "." + number + "." + ending;
}

void write_body(const fs::path& folder, const std::string& format, const BodyLabel& label, const nodes::Mesh& mesh,
                int frame, const SceneAxes& axes, const std::string& run, const engine::FileAccess& files) {
    const solver::SurfaceMesh surface = mesh.surface();
    const std::string bytes =
        format == "obj" ? header(label, axes, run) + solver::write_obj(surface) : solver::write_ply(surface);
    write_file(folder / format / frame_file_name(label.name, frame, format), bytes, files);
}

SequenceFolder find_sequences(const fs::path& folder) {
    SequenceFolder out;
    std::map<std::string, BodySequence> found;
    std::error_code error;
    for (const fs::path& place : {folder / "obj", folder}) {
        if (!fs::is_directory(place)) continue;
        for (const auto& entry : fs::directory_iterator(place))
            if (const auto name = parse_frame_file(entry.path(), "obj")) {
                if (!entry.is_regular_file(error)) { // to read a pipe or a device could take for ever
                    out.no_files.push_back(entry.path());
                    continue;
                }
                found[name->first].files[name->second] = entry.path();
                out.frames.insert(name->second);
            }
        if (!found.empty()) break;
    }
    std::sort(out.no_files.begin(), out.no_files.end());
    for (auto& [name, sequence] : found) {
        sequence.label.name = name;
        read_header(sequence.files.begin()->second, sequence.label, out.up);
        out.bodies.push_back(std::move(sequence));
    }
    return out;
}

} // namespace sinew::cli
