// The scalar direct solver: right, repeatable, and able to go on after a matrix that is not positive definite.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/scalar_cholesky.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <vector>

using namespace sinew::solver;
using Sparse = Eigen::SparseMatrix<double>;

namespace {

/// The seven-point Laplacian of a cube of n^3 points, plus `shift` on the diagonal.
Sparse laplacian(int n, double shift) {
    std::vector<Eigen::Triplet<double>> entries;
    const auto at = [n](int i, int j, int k) { return (i * n + j) * n + k; };
    const auto join = [&](int a, int b) {
        entries.emplace_back(a, b, -1.0);
        entries.emplace_back(b, a, -1.0);
        entries.emplace_back(a, a, 1.0);
        entries.emplace_back(b, b, 1.0);
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k) {
                entries.emplace_back(at(i, j, k), at(i, j, k), shift);
                if (i + 1 < n) join(at(i, j, k), at(i + 1, j, k));
                if (j + 1 < n) join(at(i, j, k), at(i, j + 1, k));
                if (k + 1 < n) join(at(i, j, k), at(i, j, k + 1));
            }
    Sparse a(n * n * n, n * n * n);
    a.setFromTriplets(entries.begin(), entries.end());
    return a;
}

Eigen::VectorXd waves(Eigen::Index n) {
    Eigen::VectorXd b(n);
    for (Eigen::Index i = 0; i < n; ++i) b[i] = std::sin(0.37 * static_cast<double>(i));
    return b;
}

} // namespace

TEST_CASE("one analysis and factor serve several right-hand sides, to rounding and with the same bits every time",
          "[linear]") {
    const Sparse a = laplacian(14, 0.01);
    ScalarCholesky first(a), second(a);
    REQUIRE(first.factorize(a));
    REQUIRE(second.factorize(a));
    for (const double scale : {1.0, -3.0}) {
        const Eigen::VectorXd b = scale * waves(a.rows());
        const Eigen::VectorXd x = first.solve(b);
        REQUIRE((a * x - b).norm() < 1e-12 * b.norm());
        REQUIRE(x == second.solve(b));
    }
}

TEST_CASE("a matrix that is not positive definite has no factor, and the next one may have", "[linear]") {
    const Sparse bad = laplacian(6, -0.5), good = laplacian(6, 1);
    ScalarCholesky solver(good);
    REQUIRE_FALSE(solver.factorize(bad));
    REQUIRE(solver.factorize(good));
    const Eigen::VectorXd b = waves(good.rows());
    REQUIRE((good * solver.solve(b) - b).norm() < 1e-12 * b.norm());
    Sparse lost = good;
    lost.coeffRef(0, 0) = std::numeric_limits<double>::quiet_NaN();
    REQUIRE_FALSE(solver.factorize(lost));
}
