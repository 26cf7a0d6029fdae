// Primitive meshes with Maya's conventions for axes and subdivisions (y up, centred on the origin).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_mesh.h"

namespace sinew::solver {

/// 20 x 20 gives 382 vertices and 400 faces.
SurfaceMesh make_sphere(double radius, int subdivisions_axis, int subdivisions_height);
SurfaceMesh make_cube(double width, double height, double depth, int sub_width, int sub_height, int sub_depth);
SurfaceMesh make_plane(double width, double height, int sub_width, int sub_height);
SurfaceMesh make_cylinder(double radius, double height, int sub_axis, int sub_height, int sub_caps);
SurfaceMesh make_helix(double radius, double tube_radius, double height, double coils, int sub_axis, int sub_coil);

} // namespace sinew::solver
