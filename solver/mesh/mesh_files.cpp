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
    // A pipe that nobody writes to would be waited for without end.
    if (!fs::is_regular_file(status)) throw Error("IO402", path + " is a pipe or a device, not a file");
    std::ifstream in(path, std::ios::binary);
    if (!in) throw Error("IO402", path + " cannot be opened: " + std::strerror(errno));
    std::string bytes;
    char block[1 << 16];
    while (in.read(block, sizeof block) || in.gcount() > 0) bytes.append(block, static_cast<std::size_t>(in.gcount()));
    if (in.bad()) throw Error("IO402", path + " cannot be read to its end");
    return bytes;
}

template <class Mesh>
struct Format {
    std::string_view ending, name;
    Mesh (*read)(std::string_view bytes, const std::string& file);
};
constexpr Format<SurfaceMesh> surface_formats[] = {
    {".obj", "", read_obj}, {".off", "", read_off}, {".ply", "", read_ply}, {".stl", "", read_stl}};
/// Those of one file; TetGen's two come beside them.
constexpr Format<TetMesh> tet_formats[] = {{".mesh", "Medit", read_medit},
                                           {".vtk", "legacy, ascii", read_vtk},
                                           {".msh", "Gmsh", read_gmsh},
                                           {".veg", "VegaFEM", read_veg}};

/// ".mesh (Medit), .vtk (legacy, ascii)", for hints.
template <class Formats>
std::string listed(const Formats& formats) {
    std::string out;
    for (const auto& format : formats) {
        out += (out.empty() ? "" : ", ") + std::string(format.ending);
        if (!format.name.empty()) out += " (" + std::string(format.name) + ")";
    }
    return out;
}

Error unknown_ending(const std::string& path, const std::string& ending, const std::string& what,
                     const std::string& known) {
    if (ending.empty())
        return Error("IO404", path + ": its name has no ending, which tells how it is to be read",
                     "give it the one that it is: " + known);
    const bool is_scene = is_scene_ending(ending);
    return Error("IO404", path + ": '" + ending + "' is not " + what + " that can be read",
                 std::string(is_scene ? "export it from the program that it is of; " : "use ") + known +
                     (is_scene ? " can be read" : ""));
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

bool is_scene_ending(std::string_view ending) {
    constexpr std::string_view scenes[] = {".gltf",  ".fbx", ".dae", ".abc", ".usd", ".usda", ".usdc", ".usdz",
                                           ".blend", ".ma",  ".mb",  ".3ds", ".max", ".c4d",  ".hip"};
    return std::find(std::begin(scenes), std::end(scenes), ending) != std::end(scenes);
}

std::vector<std::string> surface_endings() {
    std::vector<std::string> out;
    for (const auto& format : surface_formats) out.emplace_back(format.ending);
    return out;
}
std::vector<std::string> tet_endings() {
    std::vector<std::string> out;
    for (const auto& format : tet_formats) out.emplace_back(format.ending);
    out.insert(out.end(), {".node", ".ele"});
    return out;
}

namespace {

/// The ending of the format that the bytes look like; empty if of none.
std::string_view looks_like(std::string_view bytes) {
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
    if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return ".ply";
    if (bytes.starts_with("OFF") || bytes.starts_with("COFF") || bytes.starts_with("NOFF")) return ".off";
    if (bytes.starts_with("solid ")) return ".stl";
    if (bytes.starts_with("glTF")) return ".glb";
    // Vertices and then faces, each at the begin of a line.
    const std::size_t vertex = bytes.starts_with("v ") ? 0 : bytes.find("\nv ");
    if (vertex != std::string_view::npos && bytes.find("\nf ", vertex) != std::string_view::npos) return ".obj";
    return {};
}

/// What a file may be that its ending's reader refuses.
std::string other_format(std::string_view bytes, std::string_view ending) {
    if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) return {}; // told by who reads text
    const std::string_view seems = looks_like(bytes);
    if (!seems.empty() && seems != ending) return "it looks like a file that should end in " + std::string(seems);
    const bool is_text_format = ending == ".obj" || ending == ".off";
    if (is_text_format && bytes.find('\0') != std::string_view::npos)
        return "it is no text, but binary; export it anew";
    return {};
}

} // namespace

SurfaceMesh parse_surface(std::string_view bytes, const std::string& path) {
    const std::string ending = lower_ending(path);
    for (const auto& format : surface_formats) {
        if (format.ending != ending) continue;
        try {
            return format.read(bytes, path);
        } catch (Error& e) {
            if (e.code == "IO403" && e.hint.empty()) e.hint = other_format(bytes, ending);
            throw;
        }
    }
    throw unknown_ending(path, ending, "a surface format", listed(surface_formats));
}

TetMesh parse_tets(std::string_view bytes, const std::string& path) {
    const std::string ending = lower_ending(path);
    for (const auto& format : tet_formats)
        if (format.ending == ending) return format.read(bytes, path);
    if (ending == ".node" || ending == ".ele")
        throw Error("IO404", path + ": TetGen's meshes are two files", "name both the .node and the .ele file");
    throw unknown_ending(path, ending, "a tet mesh format", listed(tet_formats) + ", .node with .ele (TetGen)");
}

TetMesh parse_tetgen(std::string_view node_bytes, const std::string& node_path, std::string_view ele_bytes,
                     const std::string& ele_path) {
    return read_tetgen(node_bytes, node_path, ele_bytes, ele_path);
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
