// Values between Python and Sinew: numbers, texts, arrays, meshes.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/embed/session.h"

#include <pybind11/pybind11.h>
#include <string>

namespace sinew::python {

/// A mesh as Python sees it.
struct NamedMesh {
    nodes::Mesh mesh;
    std::string name; ///< the node whose body it is; empty if it is nobody's
};

/// Numbers as they are, lists and matrices as arrays that show the value, meshes as Mesh or a list of them; None for
/// what Python has no word for.
pybind11::object to_python(const engine::Value& value);

/// Text stays text; numbers, sequences and arrays become numbers, row by row. Throws TypeError for anything else.
embed::HostValue host_value(const pybind11::handle& value);

/// From an array of shape (n, 3) and lists of corners; without `face_sizes` triangles. Throws Failure.
nodes::Mesh make_mesh(const pybind11::handle& points, const pybind11::handle& face_vertices,
                      const pybind11::handle& face_sizes);
/// A mesh of the same faces. Throws ValueError for another count of points.
nodes::Mesh with_points(const nodes::Mesh& mesh, const pybind11::handle& points);

void add_meshes(pybind11::module_& module);

} // namespace sinew::python
