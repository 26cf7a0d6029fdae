// Vertex, triangle and tet numbers are signed; containers count with std::size_t.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

namespace sinew::solver {

/// A number that is not negative, as a position in a container.
template <class Int>
constexpr std::size_t at(Int i) {
    return static_cast<std::size_t>(i);
}

} // namespace sinew::solver
