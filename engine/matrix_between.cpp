// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/matrix_between.h"

#include <cmath>
#include <optional>

namespace sinew::engine {

namespace {

struct Mat3 {
    double m[3][3] = {};
};

Mat3 operator*(const Mat3& a, const Mat3& b) {
    Mat3 out;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k) out.m[i][j] += a.m[i][k] * b.m[k][j];
    return out;
}

Vec3 operator*(const Mat3& a, const Vec3& v) {
    Vec3 out{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) out[i] += a.m[i][k] * v[k];
    return out;
}

/// a + s b
Mat3 sum(const Mat3& a, double s, const Mat3& b) {
    Mat3 out;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) out.m[i][j] = a.m[i][j] + s * b.m[i][j];
    return out;
}

Mat3 scaled(double s, const Mat3& a) { return sum({}, s, a); }

Mat3 transposed(const Mat3& a) {
    Mat3 out;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) out.m[i][j] = a.m[j][i];
    return out;
}

constexpr Mat3 identity{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

/// The inverse transposed times the determinant.
Mat3 cofactors(const Mat3& a) {
    Mat3 out;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            out.m[i][j] = a.m[i1][j1] * a.m[i2][j2] - a.m[i1][j2] * a.m[i2][j1];
        }
    return out;
}

double determinant(const Mat3& a) {
    const Mat3 c = cofactors(a);
    return a.m[0][0] * c.m[0][0] + a.m[0][1] * c.m[0][1] + a.m[0][2] * c.m[0][2];
}

double norm(const Mat3& a) {
    double out = 0;
    for (const auto& row : a.m)
        for (const double v : row) out += v * v;
    return std::sqrt(out);
}

/// x -> R S x + t with R a rotation and S symmetric; S is negative for mirrored bodies.
struct Parts {
    Mat3 R, S;
    Vec3 t;
};

// Polar decomposition by scaled Newton steps (Higham, "Computing the polar decomposition - with applications", SIAM J.
// Sci. Stat. Comput. 7(4), 1986). Nothing for a matrix without an inverse.
std::optional<Parts> split(const Matrix4& matrix) {
    Mat3 A;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) A.m[i][j] = matrix[4 * i + j];
    Mat3 R = A;
    for (int step = 0; step < 64; ++step) {
        const double det = determinant(R);
        const Mat3 back = scaled(1 / det, cofactors(R)); // inverse transposed
        const double size = norm(R), back_size = norm(back);
        if (!(size > 0) || !std::isfinite(back_size)) return {};
        const double g = std::sqrt(back_size / size);
        const Mat3 next = sum(scaled(0.5 * g, R), 0.5 / g, back);
        const double change = norm(sum(next, -1, R));
        R = next;
        if (change < 1e-15 * norm(R)) break;
        if (step == 63 && !(change < 1e-12)) return {};
    }
    if (determinant(R) < 0) R = scaled(-1, R); // a mirror's sign goes into S, which keeps R unique
    return Parts{R, transposed(R) * A, {matrix[3], matrix[7], matrix[11]}};
}

Mat3 cross_matrix(const Vec3& w) { return {{{0, -w[2], w[1]}, {w[2], 0, -w[0]}, {-w[1], w[0], 0}}}; }

double length(const Vec3& w) { return std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]); }

/// The rotation vector of R, by its unit quaternion; half a turn has the axis of the largest component.
Vec3 rotation_vector(const Mat3& R) {
    const double trace = R.m[0][0] + R.m[1][1] + R.m[2][2];
    double w;
    Vec3 q;
    if (trace > 0) {
        w = 1 + trace;
        q = {R.m[2][1] - R.m[1][2], R.m[0][2] - R.m[2][0], R.m[1][0] - R.m[0][1]};
    } else {
        const int i = R.m[1][1] > R.m[0][0] ? (R.m[2][2] > R.m[1][1] ? 2 : 1) : (R.m[2][2] > R.m[0][0] ? 2 : 0);
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j), c = static_cast<std::size_t>(k);
        q[a] = 1 + R.m[i][i] - R.m[j][j] - R.m[k][k];
        q[b] = R.m[j][i] + R.m[i][j];
        q[c] = R.m[k][i] + R.m[i][k];
        w = R.m[k][j] - R.m[j][k];
        if (w < 0) w = -w, q = {-q[0], -q[1], -q[2]};
    }
    const double sine = length(q);
    if (sine == 0) return {0, 0, 0};
    const double angle = 2 * std::atan2(sine, w);
    return {angle * q[0] / sine, angle * q[1] / sine, angle * q[2] / sine};
}

/// sin x / x, (1 - cos x) / x^2 and (x - sin x) / x^3, by their series where those lose digits.
struct Series {
    double a, b, c;
    explicit Series(double x)
        : a(x < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x)
        , b(x < 1e-4 ? 0.5 - x * x / 24 : (1 - std::cos(x)) / (x * x))
        , c(x < 1e-4 ? 1.0 / 6 - x * x / 120 : (x - std::sin(x)) / (x * x * x)) {}
};

/// exp of the cross matrix of w (Rodrigues).
Mat3 rotation(const Vec3& w) {
    const Series s(length(w));
    const Mat3 K = cross_matrix(w);
    return sum(sum(identity, s.a, K), s.b, K * K);
}

/// The left Jacobian of SO(3): maps the linear part of a twist to the translation of its exponential (Lynch & Park,
/// Modern Robotics, 2017, section 3.3.3).
Mat3 left_jacobian(const Vec3& w) {
    const Series s(length(w));
    const Mat3 K = cross_matrix(w);
    return sum(sum(identity, s.b, K), s.c, K * K);
}

Vec3 solved(const Mat3& a, const Vec3& v) {
    const Vec3 out = transposed(cofactors(a)) * v;
    const double det = determinant(a); // of a left Jacobian: 0 only at whole turns, which no two keys are apart
    return {out[0] / det, out[1] / det, out[2] / det};
}

Matrix4 each_between(const Matrix4& from, const Matrix4& to, double u) {
    Matrix4 out = from;
    for (std::size_t i = 0; i < out.size(); ++i)
        if (from[i] != to[i]) out[i] = std::lerp(from[i], to[i], u);
    return out;
}

} // namespace

Matrix4 matrix_between(const Matrix4& from, const Matrix4& to, double u) {
    bool only_moves = true;
    for (const std::size_t i : {0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 15})
        only_moves = only_moves && from[i] == to[i];
    if (only_moves) return each_between(from, to, u);
    const auto a = split(from), b = split(to);
    if (!a || !b) return each_between(from, to, u);
    // The rigid motion D that carries a's frame to b's is a screw; u of it is exp(u log D).
    const Mat3 D = b->R * transposed(a->R);
    const Vec3 w = rotation_vector(D), carried = D * a->t;
    const Vec3 v = solved(left_jacobian(w), {b->t[0] - carried[0], b->t[1] - carried[1], b->t[2] - carried[2]});
    const Vec3 part_w{u * w[0], u * w[1], u * w[2]};
    const Mat3 part = rotation(part_w);
    const Mat3 A = part * a->R * sum(scaled(1 - u, a->S), u, b->S);
    const Vec3 turned = part * a->t, moved = left_jacobian(part_w) * Vec3{u * v[0], u * v[1], u * v[2]};
    Matrix4 out{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) out[4 * i + j] = A.m[i][j];
        out[4 * i + 3] = turned[i] + moved[i];
    }
    out[15] = 1;
    return out;
}

} // namespace sinew::engine
