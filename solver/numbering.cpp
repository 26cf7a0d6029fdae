// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/numbering.h"

namespace sinew::solver {

const Deformable& Numbering::add(int body, const Points& vertices, const std::vector<char>& held, double spacing,
                                 bool is_sheet) {
    Deformable d{body, unknown.size(), vertices.size(), vertex_of_unknown.size(), 0, spacing, is_sheet};
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        for (int c = 0; c < 3; ++c) rest.push_back(vertices[v][c]);
        unknown.push_back(held[v] ? -1 : static_cast<int>(vertex_of_unknown.size()));
        if (!held[v]) vertex_of_unknown.push_back(static_cast<int>(d.first_vertex + v));
    }
    d.unknown_count = vertex_of_unknown.size() - d.first_unknown;
    return deformables.emplace_back(d);
}

int Numbering::deformable_of(int body) const {
    for (std::size_t d = 0; d < deformables.size(); ++d)
        if (deformables[d].body == body) return static_cast<int>(d);
    return -1;
}

} // namespace sinew::solver
