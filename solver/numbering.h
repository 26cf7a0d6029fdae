// Which vertices are unknowns: every body that deforms owns vertices, those that nothing prescribes are unknowns.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <cstddef>
#include <vector>

namespace sinew::solver {

/// A body that deforms, whatever carries its vertices. Its vertices follow each other in the state's arrays, and its
/// unknowns among the unknowns.
struct Deformable {
    int body = -1; ///< in the scene
    std::size_t first_vertex = 0, vertex_count = 0;
    std::size_t first_unknown = 0, unknown_count = 0;
    double spacing = 0;    ///< mean distance of neighbouring vertices at rest [m]
    bool is_sheet = false; ///< cloth: it has an area instead of a volume
};

struct Numbering {
    std::vector<Deformable> deformables;
    std::vector<int> unknown;           ///< per vertex: its row among the unknowns; -1 if it is held
    std::vector<int> vertex_of_unknown; ///< the inverse
    std::vector<double> rest;           ///< rest positions, 3 a vertex [m]

    std::size_t unknown_count() const { return vertex_of_unknown.size(); }
    std::size_t vertex_count() const { return unknown.size(); }
    /// Appends a body: its vertices at rest, which of them are held (one flag each), and their spacing.
    const Deformable& add(int body, const Points& vertices, const std::vector<char>& held, double spacing,
                          bool is_sheet = false);
    /// Place of a body among the deformables; -1 if it does not deform.
    int deformable_of(int body) const;
};

} // namespace sinew::solver
