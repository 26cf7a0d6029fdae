// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/term/point_triangle.h"

#include <cstddef>

namespace sinew::solver {

void add_square(const Vec3& place, const Mat3& m, PointTriangleBlocks& blocks) {
    const std::array<double, 4> weights = corner_weights_of(place);
    std::size_t entry = 0;
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t d = c; d < 4; ++d, ++entry) blocks[entry] += weights[c] * weights[d] * m;
}

PointTriangleBlocks point_triangle_hessian(const std::array<Vec3, 3>& corners, const Vec3& place, const Vec3& away,
                                           bool project) {
    const double L[4] = {1, -place[0], -place[1], -place[2]};
    // Ways along the feature: from its first corner to its others.
    int on[3], count = 0;
    for (int c = 0; c < 3; ++c)
        if (place[c] != 0) on[count++] = c;
    const int ways = count - 1;
    Vec3 along[2];
    for (int w = 0; w < ways; ++w)
        along[w] = corners[static_cast<std::size_t>(on[w + 1])] - corners[static_cast<std::size_t>(on[0])];
    Mat3 inverse = Mat3::Zero(); // of f_ss, its first `ways` rows and columns
    if (ways == 1) {
        inverse(0, 0) = 1 / along[0].squaredNorm();
    } else if (ways == 2) {
        const double a = along[0].squaredNorm(), b = along[0].dot(along[1]), c = along[1].squaredNorm();
        const double det = a * c - b * b;
        inverse(0, 0) = c / det, inverse(1, 1) = a / det, inverse(0, 1) = inverse(1, 0) = -b / det;
    }
    Vec3 mixed[4][2]; // f_xs
    for (int c = 0; c < 4; ++c)
        for (int w = 0; w < ways; ++w) {
            mixed[c][w] = -L[c] * along[w];
            if (project || c == 0) continue;
            if (c - 1 == on[0]) mixed[c][w] += away;
            if (c - 1 == on[w + 1]) mixed[c][w] -= away;
        }
    PointTriangleBlocks out;
    std::size_t entry = 0;
    for (int i = 0; i < 4; ++i) {
        Vec3 solved[2]; // f_xs f_ss^-1
        for (int w = 0; w < ways; ++w) {
            solved[w] = inverse(0, w) * mixed[i][0];
            if (ways == 2) solved[w] += inverse(1, w) * mixed[i][1];
        }
        for (int j = i; j < 4; ++j, ++entry) {
            Mat3& block = out[entry];
            block.setZero(), block.diagonal().setConstant(L[i] * L[j]);
            for (int w = 0; w < ways; ++w) block.noalias() -= solved[w] * mixed[j][w].transpose();
        }
    }
    return out;
}

} // namespace sinew::solver
