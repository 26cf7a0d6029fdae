// One reader a file format, from the bytes of a file. `file` is the name that messages begin with.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/tet_mesh.h"

#include <string>
#include <string_view>

namespace sinew::solver {

// All throw Error IO403 (with the line or byte), FE201, FE202, FE203, FE208, FE215; they never read past
// `bytes` and never ask for memory that the size of `bytes` does not justify.
SurfaceMesh read_obj(std::string_view bytes, const std::string& file);
SurfaceMesh read_off(std::string_view bytes, const std::string& file);
SurfaceMesh read_ply(std::string_view bytes, const std::string& file);
SurfaceMesh read_stl(std::string_view bytes, const std::string& file);
TetMesh read_medit(std::string_view bytes, const std::string& file);
TetMesh read_vtk(std::string_view bytes, const std::string& file);
TetMesh read_gmsh(std::string_view bytes, const std::string& file);
TetMesh read_veg(std::string_view bytes, const std::string& file);
TetMesh read_tetgen(std::string_view node_bytes, const std::string& node_file, std::string_view ele_bytes,
                    const std::string& ele_file);

/// Polygons to a checked mesh; Errors get the file's name in front.
SurfaceMesh finish_surface(const std::string& file, Points points, std::vector<int> face_sizes,
                           std::vector<int> face_vertices);
/// `coverage`: one a tet, or none for 1.
TetMesh finish_tets(const std::string& file, Points vertices, std::vector<Tet> tets, std::vector<double> coverage = {});

} // namespace sinew::solver
