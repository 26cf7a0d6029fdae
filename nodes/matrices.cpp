// Composes and applies 4x4 matrices (row-major, column vectors: p' = M p).
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/matrices.h"

#include "solver/mesh/coordinates.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

namespace sinew::nodes {

using engine::Matrix4;
using engine::Vec3;

namespace {

/// Cosine and sine of an angle in degrees; exact at multiples of 90, so that a quarter turn leaves no dust.
std::array<double, 2> cos_sin(double degrees) {
    const double turn = std::remainder(degrees, 360.0);
    if (turn == 0) return {1, 0};
    if (turn == 90) return {0, 1};
    if (turn == -90) return {0, -1};
    if (turn == 180 || turn == -180) return {-1, 0};
    const double angle = turn * std::numbers::pi / 180;
    return {std::cos(angle), std::sin(angle)};
}

Matrix4 rotation(char axis, double degrees) {
    const auto [c, s] = cos_sin(degrees);
    if (axis == 'x') return {1, 0, 0, 0, 0, c, -s, 0, 0, s, c, 0, 0, 0, 0, 1};
    if (axis == 'y') return {c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0, 0, 0, 0, 1};
    return {c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
}

Matrix4 translation(const Vec3& t) { return {1, 0, 0, t[0], 0, 1, 0, t[1], 0, 0, 1, t[2], 0, 0, 0, 1}; }

} // namespace

Matrix4 multiply(const Matrix4& a, const Matrix4& b) {
    if (b == identity_matrix) return a;
    if (a == identity_matrix) return b;
    Matrix4 out{};
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
            for (std::size_t k = 0; k < 4; ++k) out[4 * i + j] += a[4 * i + k] * b[4 * k + j];
    return out;
}

Matrix4 compose(const Vec3& translate, const Vec3& rotate, const Vec3& scale, std::string_view order,
                const Vec3& rotate_pivot) {
    Matrix4 turned = identity_matrix;
    for (char axis : order) turned = multiply(rotation(axis, rotate[static_cast<std::size_t>(axis - 'x')]), turned);
    const Vec3 back{-rotate_pivot[0], -rotate_pivot[1], -rotate_pivot[2]};
    turned = multiply(translation(rotate_pivot), multiply(turned, translation(back)));
    const Matrix4 scaled{scale[0], 0, 0, 0, 0, scale[1], 0, 0, 0, 0, scale[2], 0, 0, 0, 0, 1};
    return multiply(translation(translate), multiply(turned, scaled));
}

bool is_affine(const Matrix4& matrix) {
    constexpr double rounding = 1e-6;
    for (std::size_t c = 0; c < 4; ++c)
        if (!(std::abs(matrix[12 + c] - identity_matrix[12 + c]) <= rounding)) return false;
    return true;
}

void check_affine(const engine::Reads& in, std::string_view attribute, const Matrix4& matrix) {
    if (is_affine(matrix)) return;
    std::string row;
    for (std::size_t c = 0; c < 4; ++c) {
        char number[32];
        std::snprintf(number, sizeof number, " %g", matrix[12 + c]);
        row += number;
    }
    in.fail(attribute, "FE252", "the last row of the matrix is" + row + ", not 0 0 0 1",
            "Write it row by row for column vectors, with the translation in the last column; a matrix for row vectors "
            "has to be transposed.");
}

double volume_factor(const Matrix4& matrix) {
    const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> m(matrix.data());
    const solver::Mat3 linear = m.topLeftCorner<3, 3>();
    // By the axes' own lengths, so that rounding is told from what is small: a matrix of 1e-6 is not flat.
    const double axes = linear.colwise().norm().prod(), volume = linear.determinant();
    return std::abs(volume) > 1e-12 * axes ? volume : 0;
}

void refuse_flat(const engine::Reads& in, std::string_view attribute, const Matrix4& matrix) {
    if (volume_factor(matrix) != 0) return;
    in.fail(attribute, "FE332", "the matrix makes everything flat: what it moves has no volume left",
            "Scale along each axis by a number other than 0; 1 leaves the size alone.");
}

Mesh moved(const Mesh& mesh, const Matrix4& matrix) {
    return matrix == identity_matrix ? mesh : mesh.with_points(moved(*mesh.points, matrix));
}

solver::Points moved(const solver::Points& points, const Matrix4& matrix) {
    if (matrix == identity_matrix) return points;
    const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> m(matrix.data());
    const solver::Mat3 linear = m.topLeftCorner<3, 3>();
    const solver::Vec3 offset = m.topRightCorner<3, 1>();
    solver::Points out(points);
    for (solver::Vec3& p : out) p = linear * p + offset;
    solver::check_coordinates(out);
    return out;
}

} // namespace sinew::nodes
