// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/mesh_formats.h"

#include "engine/file_sequence.h"
#include "nodes/json_file.h"
#include "nodes/read_glb.h"
#include "solver/error.h"
#include "solver/mesh/mesh_files.h"

#include <cctype>
#include <filesystem>

namespace sinew::nodes {

solver::SurfaceMesh read_mesh(const engine::FileAccess& files, const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (!files.refusal(path) && engine::names_sequence(path))
        throw solver::Error("IO401", "'" + path + "' stands for numbered files, and one mesh is meant here",
                            "Name one of them; meshSequence gives that of each frame.");
    const std::string bytes = read_text(files, path);
    if (ending == ".glb") return read_glb(bytes, path);
    try {
        return solver::parse_surface(bytes, path);
    } catch (const solver::Error& e) {
        if (e.code != "IO404") throw;
        throw solver::Error(e.code, e.what(), e.hint + ", .glb");
    }
}

solver::TetMesh read_tets(const engine::FileAccess& files, const std::string& path, const std::string& elements) {
    if (elements.empty()) return solver::parse_tets(read_text(files, path), path);
    return solver::parse_tetgen(read_text(files, path), path, read_text(files, elements), elements);
}

std::vector<std::string> mesh_endings() {
    std::vector<std::string> out = solver::surface_endings();
    out.emplace_back(".glb");
    return out;
}

} // namespace sinew::nodes
