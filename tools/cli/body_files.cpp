// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/body_files.h"

#include "solver/mesh/mesh_files.h"
#include "tools/cli/atomic_file.h"

#include <cstdio>
#include <fstream>
#include <sstream>

namespace sinew::cli {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view mark = "# sinew: "; // "# sinew: bone, y up, 100 units a metre"

std::string header(const BodyLabel& label, const SceneAxes& axes) {
    std::ostringstream out;
    out << mark << render::word_of(label.kind) << ", " << axes.up << " up, " << axes.units_per_metre
        << " units a metre\n";
    return out.str();
}

/// Reads the first line of a file back; leaves both as they are where it says nothing.
void read_header(const fs::path& file, BodyLabel& label, char& up) {
    std::ifstream in(file);
    std::string line;
    if (!std::getline(in, line) || !line.starts_with(mark)) return;
    const auto parts = split(std::string_view(line).substr(mark.size()), ',');
    label.kind = render::kind_of(parts[0]);
    if (parts.size() > 1 && parts[1] == " z up") up = 'z';
}

/// "biceps.0001.obj" -> (biceps, 1).
std::optional<std::pair<std::string, int>> parse_name(const fs::path& file) {
    if (file.extension() != ".obj") return {};
    const std::string stem = file.stem().string();
    const std::size_t dot = stem.rfind('.');
    if (dot == std::string::npos || dot == 0) return {};
    const auto frame = to_int(std::string_view(stem).substr(dot + 1));
    if (!frame) return {};
    return std::pair(stem.substr(0, dot), *frame);
}

} // namespace

std::string frame_file_name(const std::string& name, int frame, const std::string& ending) {
    char number[16];
    std::snprintf(number, sizeof number, frame < 0 ? "%05d" : "%04d", frame);
    return name + "." + number + "." + ending;
}

void write_body(const fs::path& folder, const std::string& format, const BodyLabel& label, const nodes::Mesh& mesh,
                int frame, const SceneAxes& axes) {
    const solver::SurfaceMesh surface = mesh.surface();
    const std::string bytes =
        format == "obj" ? header(label, axes) + solver::write_obj(surface) : solver::write_ply(surface);
    write_file(folder / format / frame_file_name(label.name, frame, format), bytes);
}

SequenceFolder find_sequences(const fs::path& folder) {
    SequenceFolder out;
    std::map<std::string, BodySequence> found;
    for (const fs::path& place : {folder / "obj", folder}) {
        if (!fs::is_directory(place)) continue;
        for (const auto& entry : fs::directory_iterator(place))
            if (const auto name = parse_name(entry.path())) {
                found[name->first].files[name->second] = entry.path();
                out.frames.insert(name->second);
            }
        if (!found.empty()) break;
    }
    for (auto& [name, sequence] : found) {
        sequence.label.name = name;
        read_header(sequence.files.begin()->second, sequence.label, out.up);
        out.bodies.push_back(std::move(sequence));
    }
    return out;
}

} // namespace sinew::cli
