// Dense kernels of factors in single precision, against Eigen's in double.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/block_column.h"
#include "tests/support/fields.h"

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>
#include <limits>
#include <random>
#include <vector>

using namespace sinew::solver;

namespace {

/// The columns of a matrix L (rows x columns, lower) with a diagonal from 1 to 2, and room beyond that holds what may
/// not be read.
struct Columns {
    int rows, columns;
    Eigen::MatrixXd l, a; ///< a = L L_topᵀ: what the factor is made from
    std::vector<float> values, inverse_diagonal;
    std::vector<Short> kept;

    Columns(int rows, int columns)
        : rows(rows)
        , columns(columns)
        , l(rows, columns)
        , values(std::size_t(rows) * std::size_t(columns), std::numeric_limits<float>::quiet_NaN())
        , inverse_diagonal(std::size_t(columns))
        , kept(std::size_t(ShortColumn::stride(rows)) * std::size_t(columns)) {
        std::mt19937 random(7);
        const auto number = [&] { return static_cast<double>(random()) / 4294967296.0; };
        for (int c = 0; c < columns; ++c)
            for (int r = 0; r < rows; ++r) l(r, c) = r < c ? 0 : r == c ? 1 + number() : (number() - 0.5) / 4;
        a = l * l.topRows(columns).transpose();
        for (int c = 0; c < columns; ++c)
            for (int r = c; r < rows; ++r) values[std::size_t(c * rows + r)] = static_cast<float>(a(r, c));
    }
    BlockColumn column() { return {values.data(), inverse_diagonal.data(), rows, columns, rows}; }
    ShortColumn short_column() const { return {kept.data(), inverse_diagonal.data(), rows, columns}; }
};

constexpr std::pair<int, int> sizes[] = {{3, 3},  {6, 3},   {9, 9},   {15, 6},   {21, 12},  {24, 15},
                                         {45, 3}, {99, 27}, {150, 6}, {303, 96}, {600, 300}};

} // namespace

TEST_CASE("columns of a matrix become those of its factor, and tell the least pivot", "[linear]") {
    for (const auto& [rows, columns] : sizes) {
        Columns m(rows, columns);
        const float least = make_factor(m.column());
        CHECK(least == Approx(m.l.diagonal().array().square().minCoeff()).epsilon(1e-4));
        for (int c = 0; c < columns; ++c) {
            CHECK(m.inverse_diagonal[std::size_t(c)] == Approx(1 / m.l(c, c)).epsilon(1e-5));
            for (int r = c; r < rows; ++r)
                if (!(std::abs(m.values[std::size_t(c * rows + r)] - m.l(r, c)) < 2e-5))
                    FAIL_CHECK(rows << " x " << columns << ", row " << r << ", column " << c);
        }
    }
}

TEST_CASE("columns with a pivot that is not above zero tell it", "[linear]") {
    for (const int bad : {0, 4, 11, 25}) {
        Columns m(60, 27);
        // The pivot of a column is its diagonal entry less what earlier columns stand for.
        m.values[std::size_t(bad * 60 + bad)] -= static_cast<float>(m.l(bad, bad) * m.l(bad, bad) + 0.25);
        CHECK(make_factor(m.column()) == Approx(-0.25).epsilon(1e-4));
        m.values[std::size_t(bad * 60 + bad)] = std::numeric_limits<float>::quiet_NaN();
        CHECK_FALSE(make_factor(m.column()) > 0);
    }
}

TEST_CASE("solves down and up a block column are those with the lower triangle, to what is kept of it", "[linear]") {
    for (const auto& [rows, columns] : sizes) {
        Columns m(rows, columns);
        REQUIRE(make_factor(m.column()) > 0);
        shorten(m.column(), m.kept.data());
        const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(rows, -1, 2);
        const auto top = m.l.topRows(columns).triangularView<Eigen::Lower>();
        std::vector<float> x(std::size_t(ShortColumn::stride(rows)), 0.0f);
        for (int r = 0; r < rows; ++r) x[std::size_t(r)] = static_cast<float>(right[r]);
        solve_down(m.short_column(), x.data());
        Eigen::VectorXd down = right;
        down.head(columns) = top.solve(right.head(columns));
        down.tail(rows - columns) -= m.l.bottomRows(rows - columns) * down.head(columns);
        const auto differs = [&](const Eigen::VectorXd& expected) {
            double most = 0;
            for (int r = 0; r < rows; ++r) most = std::max(most, std::abs(double(x[std::size_t(r)]) - expected[r]));
            return most / expected.lpNorm<Eigen::Infinity>();
        };
        CHECK(differs(down) < 1e-3);
        for (std::size_t r = std::size_t(rows); r < x.size(); ++r) CHECK(x[r] == 0);

        for (int r = 0; r < rows; ++r) x[std::size_t(r)] = static_cast<float>(right[r]);
        solve_up(m.short_column(), x.data());
        Eigen::VectorXd up = right;
        const Eigen::VectorXd less = m.l.bottomRows(rows - columns).transpose() * right.tail(rows - columns);
        up.head(columns) = top.transpose().solve(right.head(columns) - less);
        CHECK(differs(up) < 1e-3);
    }
}

TEST_CASE("products with the transposed rows of a block column, of the lower triangle alone", "[linear]") {
    // Rows 3…3+n-1 of a block column of k columns times rows from 3 + above on.
    for (const auto& [m, n, k, above] : {std::array{1, 3, 1, 0},
                                         {3, 3, 3, 0},
                                         {21, 12, 6, 0},
                                         {40, 9, 15, 0},
                                         {50, 21, 7, 6},
                                         {96, 48, 300, 0},
                                         {17, 33, 40, 24}}) {
        const int stride = 3 + above + m + std::max(0, n - m - above) + 5;
        Eigen::MatrixXf block = Eigen::MatrixXf::Random(stride, k);
        std::vector<float> out(std::size_t(m) * std::size_t(n), -7.0f);
        multiply_transposed(block.data() + 3 + above, block.data() + 3, stride, m, n, k, above, out.data());
        const Eigen::MatrixXd exact =
            block.middleRows(3 + above, m).cast<double>() * block.middleRows(3, n).cast<double>().transpose();
        for (int c = 0; c < n; ++c)
            for (int r = std::max(0, c - above); r < m; ++r)
                if (!(std::abs(out[std::size_t(c * m + r)] - exact(r, c)) < 1e-5 * k))
                    FAIL_CHECK(m << " x " << n << " x " << k << ", row " << r << ", column " << c);
        // Columns whose rows lie all above are left as they are.
        if (n > m + above + 6) CHECK(out[std::size_t((n - 1) * m)] == -7.0f);
    }
}
