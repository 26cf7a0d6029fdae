// A term's gradient by the vertices of all bodies that deform, held ones too, and where it goes from there.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/index.h"
#include "solver/numbering.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace sinew::solver {

class VertexGradient {
  public:
    /// All zero, 3 numbers a vertex.
    void clear(std::size_t numbers) { values_.assign(numbers, 0.0); }
    double* data() { return values_.data(); }

    /// To a gradient of 3 numbers an unknown.
    void add_to_unknowns(const Numbering& numbering, std::span<double> gradient) const {
        const std::vector<int>& vertex_of = numbering.vertex_of_unknown;
        for (std::size_t u = 0; u < vertex_of.size(); ++u)
            for (std::size_t c = 0; c < 3; ++c) gradient[3 * u + c] += values_[3 * at(vertex_of[u]) + c];
    }
    /// Of held vertices alone, to 3 numbers a vertex.
    void add_held(const Numbering& numbering, std::span<double> by_vertices) const {
        for (std::size_t v = 0; v < numbering.unknown.size(); ++v)
            for (std::size_t c = 3 * v; numbering.unknown[v] < 0 && c < 3 * v + 3; ++c) by_vertices[c] += values_[c];
    }
    /// Raises each deformable's number to the norm of its part [N].
    void raise(const Numbering& numbering, std::span<double> largest) const {
        for (std::size_t d = 0; d < numbering.deformables.size(); ++d) {
            const Deformable& body = numbering.deformables[d];
            double square = 0;
            for (std::size_t i = 3 * body.first_vertex; i < 3 * (body.first_vertex + body.vertex_count); ++i)
                square += values_[i] * values_[i];
            largest[d] = std::max(largest[d], std::sqrt(square));
        }
    }

  private:
    std::vector<double> values_;
};

} // namespace sinew::solver
