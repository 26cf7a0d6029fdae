// Matrices of 3x3 blocks whose inverses are known: the seven-point Laplacian of a grid of points with fixed values
// around it, times a 3x3 matrix K. Its eigenvectors are products of sines.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/multigrid.h"

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

namespace sinew::test {

struct GridMatrix {
    int n; ///< points along each side
    solver::BlockPattern pattern;
    solver::BlockMatrix a;
    Eigen::Matrix3d k;

    explicit GridMatrix(int n, const Eigen::Matrix3d& k = some_coupling())
        : n(n)
        , pattern(couplings(n))
        , a(pattern)
        , k(k) {
        for (int i = 0; i < pattern.rows; ++i)
            for (int e = pattern.row_start[std::size_t(i)]; e < pattern.row_start[std::size_t(i) + 1]; ++e) {
                const double l = pattern.column[std::size_t(e)] == i ? 6 : -1;
                for (int c = 0; c < 9; ++c) a.block(std::size_t(e))[c] = l * k(c / 3, c % 3);
            }
    }
    /// Symmetric, positive definite, entries that single precision holds.
    static Eigen::Matrix3d some_coupling() {
        Eigen::Matrix3d k;
        k << 2, 0.5, 0.25, 0.5, 1.5, -0.5, 0.25, -0.5, 1;
        return k;
    }
    int point(int x, int y, int z) const { return (x * n + y) * n + z; }
    /// Waves along the three sides times a vector; `factor`: on it A gives b = factor-fold, with K applied.
    std::vector<double> wave(int p, int q, int r, const Eigen::Vector3d& v) const {
        std::vector<double> out(std::size_t(3 * n * n * n));
        const double unit = std::acos(-1.0) / (n + 1);
        for (int x = 0; x < n; ++x)
            for (int y = 0; y < n; ++y)
                for (int z = 0; z < n; ++z)
                    for (int c = 0; c < 3; ++c)
                        out[std::size_t(3 * point(x, y, z) + c)] = std::sin(p * unit * (x + 1)) *
                                                                   std::sin(q * unit * (y + 1)) *
                                                                   std::sin(r * unit * (z + 1)) * v[c];
        return out;
    }
    double eigenvalue(int p, int q, int r) const {
        const double unit = std::acos(-1.0) / (n + 1);
        return 6 - 2 * std::cos(p * unit) - 2 * std::cos(q * unit) - 2 * std::cos(r * unit);
    }
    solver::UnknownPlaces places(double spacing = 0.01) const {
        solver::UnknownPlaces out;
        out.spacing = {spacing};
        for (int x = 0; x < n; ++x)
            for (int y = 0; y < n; ++y)
                for (int z = 0; z < n; ++z) out.points.push_back(spacing * solver::Vec3(x, y, z));
        out.body.assign(out.points.size(), 0);
        return out;
    }

  private:
    static solver::BlockPattern couplings(int n) {
        std::vector<std::pair<int, int>> out;
        const auto number = [n](int x, int y, int z) { return (x * n + y) * n + z; };
        for (int x = 0; x < n; ++x)
            for (int y = 0; y < n; ++y)
                for (int z = 0; z < n; ++z) {
                    if (x + 1 < n) out.emplace_back(number(x, y, z), number(x + 1, y, z));
                    if (y + 1 < n) out.emplace_back(number(x, y, z), number(x, y + 1, z));
                    if (z + 1 < n) out.emplace_back(number(x, y, z), number(x, y, z + 1));
                }
        return solver::make_pattern(n * n * n, std::move(out));
    }
};

/// The matrix with every entry, both triangles, and its overlay.
inline Eigen::MatrixXd dense(const solver::BlockMatrix& a) {
    const solver::BlockPattern& p = *a.pattern;
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * p.rows, 3 * p.rows);
    for (int i = 0; i < p.rows; ++i)
        for (int e = p.row_start[std::size_t(i)]; e < p.row_start[std::size_t(i) + 1]; ++e)
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) {
                    const int row = 3 * i + r, column = 3 * p.column[std::size_t(e)] + c;
                    out(row, column) = out(column, row) = a.block(std::size_t(e))[3 * r + c];
                }
    if (a.overlay.empty()) return out;
    for (Eigen::Index c = 0; c < out.cols(); ++c) {
        const Eigen::VectorXd unit = Eigen::VectorXd::Unit(out.cols(), c);
        a.overlay.add_product(unit.data(), out.col(c).data());
    }
    return out;
}

inline std::vector<double> random_numbers(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<double> out(count);
    for (double& x : out) x = normal(random);
    return out;
}

inline Eigen::Map<const Eigen::VectorXd> as_vector(const std::vector<double>& v) {
    return {v.data(), static_cast<Eigen::Index>(v.size())};
}

} // namespace sinew::test
