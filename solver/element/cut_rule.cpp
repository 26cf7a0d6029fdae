// Integration points of a tet that is solid in part.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/cut_rule.h"

#include "solver/types.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

/// Corners of a regular tet at distance sqrt(3).
constexpr double simplex[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};

/// A symmetric tensor of three places in three dimensions, all 27 of its entries.
struct Cubic {
    double at[3][3][3] = {};
    double operator()(const Vec3& a, const Vec3& b, const Vec3& c) const {
        double sum = 0;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                for (int k = 0; k < 3; ++k) sum += at[i][j][k] * a[i] * b[j] * c[k];
        return sum;
    }
};

/// Turns two of three orthonormal columns about the third so that cubic(q0, q1, q2) is greatest, in turn, until no
/// more is gained.
void climb(const Cubic& cubic, Mat3& q) {
    double value = cubic(q.col(0), q.col(1), q.col(2));
    for (int sweep = 0; sweep < 20; ++sweep) {
        for (int third = 0; third < 3; ++third) {
            const int a = (third + 1) % 3, b = (third + 2) % 3;
            const Vec3 p = q.col(a), r = q.col(b), axis = q.col(third);
            // cubic(cos p + sin r, cos r - sin p, axis) = both cos 2t + (of r - of p)/2 sin 2t
            const double both = cubic(p, r, axis), half = 0.5 * (cubic(r, r, axis) - cubic(p, p, axis));
            const double angle = 0.5 * std::atan2(half, both);
            q.col(a) = std::cos(angle) * p + std::sin(angle) * r;
            q.col(b) = std::cos(angle) * r - std::sin(angle) * p;
        }
        const double next = cubic(q.col(0), q.col(1), q.col(2));
        if (!(next > value + 1e-9 * std::abs(value))) break;
        value = next;
    }
}

} // namespace

FourPoints four_points(const double* quartic) {
    const MomentTensors m(quartic);
    const double scale = 1 / m.volume;
    Vec3 mean;
    Mat3 covariance;
    for (int i = 0; i < 3; ++i) mean[i] = scale * m.first[i + 1];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) covariance(i, j) = scale * m.second[i + 1][j + 1] - mean[i] * mean[j];
    Mat3 root = covariance.llt().matrixL();
    Cubic central, white;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
                central.at[i][j][k] = scale * m.third[i + 1][j + 1][k + 1] - mean[i] * covariance(j, k) -
                                      mean[j] * covariance(i, k) - mean[k] * covariance(i, j) -
                                      mean[i] * mean[j] * mean[k];
    const Mat3 inverse = root.triangularView<Eigen::Lower>().solve(Mat3::Identity());
    const auto row = [&](int i) -> Vec3 { return inverse.row(i).transpose(); };
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
            for (int k = j; k < 3; ++k) {
                const double value = central(row(i), row(j), row(k));
                for (const auto& [a, b, c] : {std::array{i, j, k}, std::array{i, k, j}, std::array{j, i, k},
                                              std::array{j, k, i}, std::array{k, i, j}, std::array{k, j, i}})
                    white.at[a][b][c] = value;
            }
    // A start that is no symmetry of a tet or box, where a climb would stand still; others where that one's top does
    // not do.
    FourPoints best;
    double best_least = -1;
    for (int start = 0; start < 4 && best_least < 0; ++start) {
        Mat3 q = Eigen::AngleAxisd(0.7 + start, Vec3(0.36, 0.48, 0.8)).toRotationMatrix();
        climb(white, q);
        FourPoints found;
        double least = 1;
        for (std::size_t p = 0; p < 4; ++p) {
            const Vec3 b = mean + root * (q * Vec3(simplex[p][0], simplex[p][1], simplex[p][2]));
            found.point[p] = {1 - b[0] - b[1] - b[2], b[0], b[1], b[2]};
            least = std::min(least, *std::min_element(found.point[p].begin(), found.point[p].end()));
        }
        if (start == 0 || least > best_least) best = found, best_least = least;
    }
    if (best_least >= 0) return best;
    // Drawn towards the mean until the last one is in the tet.
    const double centre[4] = {1 - mean.sum(), mean[0], mean[1], mean[2]};
    double factor = 1;
    for (const Barycentric& b : best.point)
        for (std::size_t c = 0; c < 4; ++c)
            if (b[c] < 0) factor = std::min(factor, centre[c] / (centre[c] - b[c]));
    for (Barycentric& b : best.point)
        for (std::size_t c = 0; c < 4; ++c) b[c] = centre[c] + factor * (b[c] - centre[c]);
    best.exact = false;
    return best;
}

} // namespace sinew::solver
