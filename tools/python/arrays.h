// NumPy arrays that show what lies in Sinew's values, without a copy. Each keeps alive what it shows.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/values.h"

#include <memory>
#include <pybind11/numpy.h>
#include <string>
#include <vector>

namespace sinew::python {

namespace py = pybind11;

/// A read-only array of `data`, which `owner` keeps alive as long as the array or any view of it lives.
template <class T>
py::array view(const T* data, std::vector<py::ssize_t> shape, std::shared_ptr<const void> owner) {
    auto* kept = new std::shared_ptr<const void>(std::move(owner));
    const py::capsule base(kept, [](void* p) { delete static_cast<std::shared_ptr<const void>*>(p); });
    py::array out(py::dtype::of<T>(), std::move(shape), data, base);
    out.attr("setflags")(py::arg("write") = false);
    return out;
}

inline py::array points_view(const nodes::Mesh& m) {
    static_assert(sizeof(solver::Vec3) == 3 * sizeof(double));
    const auto n = static_cast<py::ssize_t>(m.points->size());
    return view(n ? m.points->front().data() : nullptr, {n, 3}, m.points);
}

inline py::array triangles_view(const nodes::Mesh& m) {
    static_assert(sizeof(solver::Triangle) == 3 * sizeof(int));
    const auto n = static_cast<py::ssize_t>(m.topology->triangles.size());
    return view(n ? m.topology->triangles.front().data() : nullptr, {n, 3}, m.topology);
}

inline py::array ints_view(const nodes::Mesh& m, const std::vector<int>& list) {
    return view(list.data(), {static_cast<py::ssize_t>(list.size())}, m.topology);
}

/// Switches, whole and floating-point numbers, alone, in sequences or arrays, as an array. Throws TypeError for all
/// else: NumPy would make numbers of complex ones, of masked ones, dates and texts, too.
/// \param what it is, for the message
inline py::array plain_numbers(const py::handle& given, const std::string& what) {
    const auto refuse = [&] {
        throw py::type_error(what + ", not a " +
                             py::str(py::type::handle_of(given).attr("__name__")).cast<std::string>());
    };
    const py::module_ numpy = py::module_::import("numpy");
    if (numpy.attr("ma").attr("isMaskedArray")(given).cast<bool>()) refuse();
    py::array out;
    try {
        out = numpy.attr("asarray")(given);
    } catch (const py::error_already_set& e) {
        if (!e.matches(PyExc_ValueError) && !e.matches(PyExc_TypeError)) throw;
        refuse();
    }
    const char kind = out.dtype().kind();
    if (out.size() > 0 && kind != 'b' && kind != 'i' && kind != 'u' && kind != 'f')
        throw py::type_error(what + ", not of NumPy's type " + py::str(out.dtype()).cast<std::string>());
    return out;
}

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Ints = py::array_t<int, py::array::c_style | py::array::forcecast>;

/// Throws as plain_numbers.
inline Doubles doubles_of(const py::handle& given, const std::string& what) {
    return Doubles::ensure(plain_numbers(given, what));
}

/// Of shape (n, 3). Throws as plain_numbers, and ValueError for another shape.
inline Doubles points_array(const py::handle& given) {
    const Doubles out = doubles_of(given, "points are an array of numbers of shape (n, 3)");
    if (out.ndim() != 2 || out.shape(1) != 3) throw py::value_error("points are an array of shape (n, 3)");
    return out;
}

inline std::vector<double> numbers(const Doubles& a) { return {a.data(), a.data() + a.size()}; }
inline std::vector<int> whole_numbers(const Ints& a) { return {a.data(), a.data() + a.size()}; }

} // namespace sinew::python
