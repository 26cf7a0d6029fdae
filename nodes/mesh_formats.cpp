// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/mesh_formats.h"

#include "nodes/json_file.h"
#include "nodes/read_glb.h"
#include "solver/error.h"
#include "solver/mesh/mesh_files.h"

#include <cctype>
#include <filesystem>

namespace sinew::nodes {

solver::SurfaceMesh read_mesh(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (ending == ".glb") return read_glb(read_text(path), path);
    try {
        return solver::read_surface(path);
    } catch (const solver::Error& e) {
        if (e.code != "IO404") throw;
        throw solver::Error(e.code, e.what(), e.hint + ", .glb");
    }
}

std::vector<std::string> mesh_endings() {
    std::vector<std::string> out = solver::surface_endings();
    out.emplace_back(".glb");
    return out;
}

} // namespace sinew::nodes
