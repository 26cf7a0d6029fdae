// NumPy arrays that show what lies in Sinew's values, without a copy. Each keeps alive what it shows.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/values.h"

#include <memory>
#include <pybind11/numpy.h>
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

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Ints = py::array_t<int, py::array::c_style | py::array::forcecast>;

inline std::vector<double> numbers(const Doubles& a) { return {a.data(), a.data() + a.size()}; }
inline std::vector<int> whole_numbers(const Ints& a) { return {a.data(), a.data() + a.size()}; }

} // namespace sinew::python
