// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/embedded_point.h"

#include "solver/element/quadratic_tets.h"

#include <algorithm>

namespace sinew::solver {

PointWeights embedded_point(const Tet& corners, const std::array<int, 6>* edges,
                            const std::array<double, 4>& barycentric) {
    PointWeights out;
    const auto add = [&](int vertex, double weight) {
        if (weight != 0) out.vertex[out.count] = vertex, out.weight[out.count++] = weight;
    };
    // Far outside its tet a point is carried by the corners alone: a parabola would swing it about.
    const bool outside = *std::min_element(barycentric.begin(), barycentric.end()) < -0.25;
    if (!edges || outside) {
        for (std::size_t c = 0; c < 4; ++c) add(corners[c], barycentric[c]);
        return out;
    }
    double shape[quadratic_nodes];
    quadratic_shape(barycentric.data(), shape);
    for (std::size_t c = 0; c < 4; ++c) add(corners[c], shape[c]);
    for (std::size_t e = 0; e < 6; ++e) add((*edges)[e], shape[4 + e]);
    return out;
}

} // namespace sinew::solver
