// Mesh files by file name ending.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/mesh_files.h"

#include "solver/error.h"
#include "solver/mesh/mesh_readers.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace sinew::solver {
namespace {

std::string lower_ending(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return ending;
}

std::string read_bytes(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    if (!fs::exists(status)) throw Error("IO401", path + " does not exist");
    if (fs::is_directory(status)) throw Error("IO402", path + " is a directory");
    std::ifstream in(path, std::ios::binary);
    if (!in) throw Error("IO402", path + " cannot be opened: " + std::strerror(errno));
    std::string bytes;
    char block[1 << 16];
    while (in.read(block, sizeof block) || in.gcount() > 0) bytes.append(block, static_cast<std::size_t>(in.gcount()));
    if (in.bad()) throw Error("IO402", path + " cannot be read to its end");
    return bytes;
}

/// Runs `make`; puts the file's name in front of an Error that does not name it.
template <class Make>
auto in_file(const std::string& file, const Make& make) {
    try {
        return make();
    } catch (const Error& e) {
        const std::string message = e.what();
        if (message.compare(0, file.size(), file) == 0) throw;
        throw Error(e.code, file + ": " + message, e.hint);
    }
}

} // namespace

SurfaceMesh finish_surface(const std::string& file, Points points, std::vector<int> face_sizes,
                           std::vector<int> face_vertices) {
    return in_file(file, [&] {
        SurfaceMesh mesh =
            SurfaceMesh::from_polygons(std::move(points), std::move(face_sizes), std::move(face_vertices));
        check_usable(mesh);
        return mesh;
    });
}

TetMesh finish_tets(const std::string& file, Points vertices, std::vector<Tet> tets, std::vector<double> coverage) {
    return in_file(file, [&] {
        TetMesh mesh;
        mesh.vertices = std::move(vertices);
        mesh.tets = std::move(tets);
        mesh.coverage = std::move(coverage);
        check_and_orient(mesh);
        return mesh;
    });
}

std::vector<std::string> surface_endings() { return {".obj", ".off", ".ply", ".stl"}; }
std::vector<std::string> tet_endings() { return {".mesh", ".vtk", ".msh", ".veg", ".node", ".ele"}; }

SurfaceMesh parse_surface(std::string_view bytes, const std::string& path) {
    const std::string ending = lower_ending(path);
    if (ending == ".obj") return read_obj(bytes, path);
    if (ending == ".off") return read_off(bytes, path);
    if (ending == ".ply") return read_ply(bytes, path);
    if (ending == ".stl") return read_stl(bytes, path);
    throw Error("IO404", path + ": '" + ending + "' is not a surface format that can be read",
                "use .obj, .off, .ply or .stl");
}

TetMesh parse_tets(std::string_view bytes, const std::string& path) {
    const std::string ending = lower_ending(path);
    if (ending == ".mesh") return read_medit(bytes, path);
    if (ending == ".vtk") return read_vtk(bytes, path);
    if (ending == ".msh") return read_gmsh(bytes, path);
    if (ending == ".veg") return read_veg(bytes, path);
    if (ending == ".node" || ending == ".ele")
        throw Error("IO404", path + ": TetGen's meshes are two files", "name both the .node and the .ele file");
    throw Error("IO404", path + ": '" + ending + "' is not a tet mesh format that can be read",
                "use .mesh (Medit), .vtk (legacy, ascii), .msh (Gmsh), .veg (VegaFEM) or .node with .ele (TetGen)");
}

SurfaceMesh read_surface(const std::string& path) { return parse_surface(read_bytes(path), path); }
TetMesh read_tets(const std::string& node_path, const std::string& ele_path) {
    return read_tetgen(read_bytes(node_path), node_path, read_bytes(ele_path), ele_path);
}
TetMesh read_tets(const std::string& path) {
    const std::string ending = lower_ending(path);
    if (ending != ".node" && ending != ".ele") return parse_tets(read_bytes(path), path);
    const auto beside = [&](const char* other) {
        return std::filesystem::path(path).replace_extension(other).string();
    };
    return ending == ".node" ? read_tets(path, beside(".ele")) : read_tets(beside(".node"), path);
}

} // namespace sinew::solver
