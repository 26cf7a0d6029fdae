// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/python/python_value.h"

#include "solver/error.h"
#include "solver/mesh/coordinates.h"
#include "tools/python/arrays.h"

#include <pybind11/stl.h>

namespace sinew::python {

using engine::Value;

namespace {

/// An array that keeps the whole value.
template <class T>
py::array shown(const Value& value, const T& numbers, std::vector<py::ssize_t> shape) {
    return view(numbers.data(), std::move(shape), std::make_shared<const Value>(value));
}

solver::Points points_of(const py::handle& given) {
    const Doubles array = points_array(given);
    solver::Points out(static_cast<std::size_t>(array.shape(0)));
    for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = solver::Vec3(array.data()[3 * i], array.data()[3 * i + 1], array.data()[3 * i + 2]);
    return out;
}

std::vector<int> list_of(const py::handle& given) {
    const py::array any = plain_numbers(given, "corners are whole numbers");
    const char kind = any.dtype().kind();
    if (any.size() > 0 && kind != 'i' && kind != 'u') throw py::value_error("corners are whole numbers");
    Ints out = Ints::ensure(any);
    // What does not fit into an int has become another number.
    if (!py::module_::import("numpy").attr("array_equal")(out, any).cast<bool>())
        throw py::value_error("a corner is no vertex number");
    return whole_numbers(out);
}

/// What the solver says of a mesh, as a failure of the graph.
template <class Make>
nodes::Mesh checked(Make&& make) {
    try {
        return make();
    } catch (const solver::Error& e) {
        throw embed::Misuse(e.code, e.what(), e.hint);
    }
}

} // namespace

py::object to_python(const Value& v) {
    if (v.is<bool>()) return py::bool_(v.as<bool>());
    if (v.is<std::int64_t>()) return py::int_(v.as<std::int64_t>());
    if (v.is<double>()) return py::float_(v.as<double>());
    if (v.is<std::string>()) return py::str(v.as<std::string>());
    if (v.is<engine::File>()) return py::str(v.as<engine::File>().path);
    if (v.is<engine::NumberList>()) {
        const auto& list = v.as<engine::NumberList>();
        return shown(v, list, {static_cast<py::ssize_t>(list.size())});
    }
    if (v.is<engine::Vec3>()) return shown(v, v.as<engine::Vec3>(), {3});
    if (v.is<engine::Matrix4>()) return shown(v, v.as<engine::Matrix4>(), {4, 4});
    if (v.is<nodes::Mesh>()) return py::cast(NamedMesh{v.as<nodes::Mesh>(), ""});
    if (v.is<nodes::MeshList>()) {
        py::list out;
        for (const nodes::Mesh& m : v.as<nodes::MeshList>().meshes) out.append(NamedMesh{m, ""});
        return out;
    }
    return py::none();
}

embed::HostValue host_value(const py::handle& value) {
    const char* what = "a value is a number, an array of numbers, a text, or JSON as a dict or list of dicts";
    if (py::isinstance<py::str>(value)) return value.cast<std::string>();
    if (value.is_none() || py::isinstance<py::bytes>(value)) throw py::type_error(what);
    return numbers(doubles_of(value, what));
}

nodes::Mesh make_mesh(const py::handle& points, const py::handle& face_vertices, const py::handle& face_sizes) {
    solver::Points made = points_of(points);
    const py::array faces = plain_numbers(face_vertices, "corners are whole numbers");
    std::vector<int> corners = list_of(faces), sizes;
    if (faces.ndim() > 2) throw py::value_error("face_vertices has one axis, or two: faces and their corners");
    if (!face_sizes.is_none())
        sizes = list_of(face_sizes);
    else if (faces.ndim() == 2)
        sizes.assign(static_cast<std::size_t>(faces.shape(0)), static_cast<int>(faces.shape(1)));
    else if (corners.size() % 3 == 0)
        sizes.assign(corners.size() / 3, 3);
    std::size_t sum = 0;
    for (const int size : sizes) {
        if (size < 3) throw py::value_error("a face has three corners or more");
        sum += static_cast<std::size_t>(size);
    }
    if (sum != corners.size()) throw py::value_error("face_vertices has not as many corners as the faces have");
    return checked([&] {
        solver::SurfaceMesh mesh =
            solver::SurfaceMesh::from_polygons(std::move(made), std::move(sizes), std::move(corners));
        solver::check_usable(mesh);
        return nodes::Mesh::from(std::move(mesh));
    });
}

nodes::Mesh with_points(const nodes::Mesh& mesh, const py::handle& points) {
    solver::Points made = points_of(points);
    if (made.size() != mesh.points->size())
        throw py::value_error("the mesh has " + std::to_string(mesh.points->size()) + " points, not " +
                              std::to_string(made.size()));
    return checked([&] {
        solver::check_coordinates(made);
        return mesh.with_points(std::move(made));
    });
}

void add_meshes(py::module_& module) {
    py::class_<NamedMesh>(module, "Mesh", "A surface. Its arrays show what Sinew holds, are read-only, and stay valid.")
        .def(py::init([](const py::object& points, const py::object& face_vertices, const py::object& face_sizes) {
                 return NamedMesh{make_mesh(points, face_vertices, face_sizes), ""};
             }),
             py::arg("points"), py::arg("face_vertices"), py::arg("face_sizes") = py::none(),
             "Of points (n, 3) and the corners of the faces, face after face; without face_sizes they are triangles, "
             "and an "
             "array of shape (m, k) holds faces of k corners.")
        .def(
            "with_points",
            [](const NamedMesh& m, const py::object& points) {
                return NamedMesh{with_points(m.mesh, points), m.name};
            },
            py::arg("points"), "The same faces with other points.")
        .def_readonly("name", &NamedMesh::name, "The node whose body it is; empty if it is nobody's.")
        .def_property_readonly(
            "points", [](const NamedMesh& m) { return points_view(m.mesh); }, "(n, 3), scene units")
        .def_property_readonly(
            "triangles", [](const NamedMesh& m) { return triangles_view(m.mesh); }, "(m, 3): the faces, cut")
        .def_property_readonly(
            "face_sizes", [](const NamedMesh& m) { return ints_view(m.mesh, m.mesh.topology->face_sizes); },
            "corners of each face")
        .def_property_readonly(
            "face_vertices", [](const NamedMesh& m) { return ints_view(m.mesh, m.mesh.topology->face_vertices); },
            "corners, face after face")
        .def("__repr__", [](const NamedMesh& m) {
            return "<sinew.Mesh " + (m.name.empty() ? "" : "'" + m.name + "' ") + "of " +
                   std::to_string(m.mesh.points->size()) + " points and " +
                   std::to_string(m.mesh.topology->face_sizes.size()) + " faces>";
        });
}

} // namespace sinew::python
