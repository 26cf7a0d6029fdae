// Mesh files, by file name ending. Readers throw Error IO401 (missing), IO402 (unreadable), IO403 (wrong
// content, with the line), IO404 (unknown ending), FE2xx (unusable mesh). Writers give text or bytes; who
// calls them puts them on disk.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/tet_mesh.h"

#include <string>
#include <string_view>
#include <vector>

namespace sinew::solver {

/// .obj, .off, .ply (ascii and binary, both byte orders), .stl (ascii and binary; equal corners are welded)
SurfaceMesh read_surface(const std::string& path);
/// .mesh (Medit ascii), .vtk (legacy ascii unstructured grid), .msh (Gmsh 1, 2 and 4.1; text and binary),
/// .veg (VegaFEM), .node or .ele (TetGen; the other of the two lies beside it). Surface elements are left
/// out, solid elements other than linear tets are refused. Further kinds are refused with IO404.
TetMesh read_tets(const std::string& path);
/// TetGen's two files, wherever they lie.
TetMesh read_tets(const std::string& node_path, const std::string& ele_path);
/// The endings that they know, lower case with the dot.
std::vector<std::string> surface_endings();
std::vector<std::string> tet_endings();
/// What other programs keep scenes in, which is not read.
bool is_scene_ending(std::string_view ending);
/// The same from the bytes of a file; the ending of `path` tells the format, messages begin with `path`.
SurfaceMesh parse_surface(std::string_view bytes, const std::string& path);
TetMesh parse_tets(std::string_view bytes, const std::string& path); ///< IO404 for .node and .ele
TetMesh parse_tetgen(std::string_view node_bytes, const std::string& node_path, std::string_view ele_bytes,
                     const std::string& ele_path);

std::string write_obj(const SurfaceMesh& mesh);
std::string write_ply(const SurfaceMesh& mesh); ///< binary little-endian, double coordinates
std::string write_stl(const SurfaceMesh& mesh); ///< binary
std::string write_off(const SurfaceMesh& mesh);
/// Coverage as cell data, which read_tets takes back; the other formats lose it.
std::string write_vtk(const TetMesh& mesh);
std::string write_medit(const TetMesh& mesh); ///< .mesh
std::string write_gmsh(const TetMesh& mesh);  ///< .msh 4.1, text
std::string write_veg(const TetMesh& mesh);
std::string write_node(const TetMesh& mesh); ///< TetGen, numbers from 1
std::string write_ele(const TetMesh& mesh);

} // namespace sinew::solver
