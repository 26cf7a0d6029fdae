// Gauss-Seidel around a preconditioner against the same with dense matrices.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/overlay_smoother.h"
#include "tests/support/grid_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <tbb/global_control.h>

using namespace sinew::solver;
using namespace sinew::test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Two grids of 27 rows; springs across tie rows of one to three of the other, and what each side feels of them stands
/// in the pattern, as contact has it.
struct TwoGrids {
    static constexpr int n = 3, rows = n * n * n, size = 6 * rows;
    static constexpr int touching[] = {0, 1, 3, 4};
    BlockPattern pattern;
    BlockMatrix a;
    std::vector<int> coupled;
    RowBlocks fine;

    explicit TwoGrids(double stiffness)
        : pattern(two(GridMatrix(n).pattern))
        , a(pattern) {
        const GridMatrix grid(n);
        for (const int shift : {0, rows})
            for (int i = 0; i < rows; ++i)
                for (int e = grid.pattern.row_start[std::size_t(i)]; e < grid.pattern.row_start[std::size_t(i) + 1];
                     ++e)
                    add(i + shift, grid.pattern.column[std::size_t(e)] + shift,
                        Eigen::Map<const Mat3>(grid.a.block(std::size_t(e))));
        const Mat3 k = stiffness * Mat3(Vec3(1, 0.2, 0.1).asDiagonal());
        for (const int i : touching) {
            const Overlay::Carrier carriers[] = {
                {0, i, 1}, {1, rows + i, 1}, {2, rows + i + 1, 1}, {3, rows + i + n, 1}};
            const Mat3 across = -k / 3;
            a.overlay.add_across(carriers, {across, across, across});
            add(i, i, k);
            for (const int p : {0, 1, n})
                for (const int q : {0, 1, n})
                    if (p <= q) add(rows + i + p, rows + i + q, k / 9);
        }
        a.overlay.finish(2 * rows);
        coupled = a.overlay.rows();
        std::vector<int> source;
        std::vector<FloatBlock> sums;
        fine = make_row_blocks(pattern, source);
        copy_blocks(a, source, fine, sums);
    }
    static BlockPattern two(const BlockPattern& one) {
        std::vector<std::pair<int, int>> couplings;
        for (const int shift : {0, rows}) {
            for (int i = 0; i < rows; ++i)
                for (int e = one.row_start[std::size_t(i)]; e < one.row_start[std::size_t(i) + 1]; ++e)
                    couplings.emplace_back(i + shift, one.column[std::size_t(e)] + shift);
        }
        for (const int i : touching) couplings.emplace_back(rows + i + 1, rows + i + n); // of one triangle
        return make_pattern(2 * rows, couplings);
    }
    void add(int i, int j, const Mat3& k) {
        const int block = pattern.find(i, j);
        REQUIRE(block >= 0);
        Eigen::Map<Mat3>(a.block(std::size_t(block))) += k; // symmetric
    }
    MatrixXd pattern_alone() const {
        BlockMatrix without(pattern);
        without.values = a.values;
        return dense(without);
    }
};

/// Two sweeps of block Gauss-Seidel from 0 as a matrix, down the coupled rows or up, and nothing elsewhere.
MatrixXd two_sweeps(const MatrixXd& k, const std::vector<int>& rows, bool up) {
    const auto m = Eigen::Index(3 * rows.size());
    MatrixXd own(m, m), triangle = MatrixXd::Zero(m, m);
    for (Eigen::Index i = 0; i < m / 3; ++i)
        for (Eigen::Index j = 0; j < m / 3; ++j) {
            own.block<3, 3>(3 * i, 3 * j) = k.block<3, 3>(3 * rows[std::size_t(i)], 3 * rows[std::size_t(j)]);
            if (up ? j >= i : j <= i) triangle.block<3, 3>(3 * i, 3 * j) = own.block<3, 3>(3 * i, 3 * j);
        }
    const MatrixXd once = triangle.inverse(), twice = once + once * (MatrixXd::Identity(m, m) - own * once);
    MatrixXd out = MatrixXd::Zero(k.rows(), k.cols());
    for (Eigen::Index i = 0; i < m / 3; ++i)
        for (Eigen::Index j = 0; j < m / 3; ++j)
            out.block<3, 3>(3 * rows[std::size_t(i)], 3 * rows[std::size_t(j)]) = twice.block<3, 3>(3 * i, 3 * j);
    return out;
}

MatrixXd as_matrix(OverlaySmoother& smoother, const OverlaySmoother::Inner& inner, int size) {
    MatrixXd out(size, size);
    for (int i = 0; i < size; ++i) {
        std::vector<double> r(std::size_t(size), 0.0), z(r);
        r[std::size_t(i)] = 1;
        smoother.apply(inner, r, z);
        out.col(i) = as_vector(z);
    }
    return out;
}

/// Largest over least eigenvalue of M K, M = m symmetric.
double condition(const MatrixXd& m, const MatrixXd& k) {
    const MatrixXd l = k.llt().matrixL();
    const MatrixXd mk = l.transpose() * (0.5 * (m + m.transpose())) * l;
    const VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(mk).eigenvalues();
    CHECK(values.minCoeff() > 0);
    return values.maxCoeff() / values.minCoeff();
}

} // namespace

TEST_CASE("overlay smoother: two sweeps down, what is around them, two sweeps up", "[linear]") {
    TwoGrids g(5);
    const MatrixXd k = dense(g.a), one = MatrixXd::Identity(g.size, g.size);
    const MatrixXd down = two_sweeps(k, g.coupled, false), up = two_sweeps(k, g.coupled, true);
    OverlaySmoother smoother(g.fine);
    REQUIRE(smoother.set_values(g.a.overlay));
    const auto nothing = [](const std::vector<double>&, std::vector<double>& z) { std::fill(z.begin(), z.end(), 0.0); };
    const MatrixXd alone = down + up * (one - k * down);
    CHECK((as_matrix(smoother, nothing, g.size) - alone).norm() < 1e-5 * alone.norm());

    const MatrixXd inverse = g.pattern_alone().inverse();
    const auto exact = [&](const std::vector<double>& r, std::vector<double>& z) {
        Eigen::Map<VectorXd>(z.data(), Eigen::Index(z.size())) = inverse * as_vector(r);
    };
    const MatrixXd between = down + inverse * (one - k * down), all = between + up * (one - k * between);
    const MatrixXd found = as_matrix(smoother, exact, g.size);
    CHECK((found - all).norm() < 1e-5 * all.norm());
    CHECK((found - found.transpose()).norm() < 1e-5 * found.norm());
}

TEST_CASE("overlay smoother: follows rows and values that change", "[linear]") {
    TwoGrids g(5);
    OverlaySmoother smoother(g.fine);
    REQUIRE(smoother.set_values(g.a.overlay));
    g.a.overlay.clear(); // other rows, the last of them beside the first ones
    const Overlay::Carrier carriers[] = {{0, 5, 1}, {1, g.rows + 5, 1}, {2, g.rows + 8, 1}, {3, g.rows + 14, 1}};
    const Mat3 across = -0.1 * Mat3::Identity();
    g.a.overlay.add_across(carriers, {across, across, across});
    g.a.overlay.finish(2 * g.rows);
    REQUIRE(smoother.set_values(g.a.overlay));
    const MatrixXd k = dense(g.a), one = MatrixXd::Identity(g.size, g.size), inverse = g.pattern_alone().inverse();
    const MatrixXd down = two_sweeps(k, g.a.overlay.rows(), false), up = two_sweeps(k, g.a.overlay.rows(), true);
    const auto exact = [&](const std::vector<double>& r, std::vector<double>& z) {
        Eigen::Map<VectorXd>(z.data(), Eigen::Index(z.size())) = inverse * as_vector(r);
    };
    const MatrixXd between = down + inverse * (one - k * down), all = between + up * (one - k * between);
    CHECK((as_matrix(smoother, exact, g.size) - all).norm() < 1e-5 * all.norm());
}

namespace {

/// A grid some of whose points springs tie two by two.
struct TiedGrid {
    static constexpr int n = 9, rows = n * n * n;
    GridMatrix grid{n};
    BlockMatrix a = grid.a;
    RowBlocks fine;

    TiedGrid() {
        std::vector<int> source;
        std::vector<FloatBlock> sums;
        fine = make_row_blocks(grid.pattern, source);
        copy_blocks(a, source, fine, sums);
    }
    void tie(int one, int other) {
        Overlay::Blocks blocks;
        for (Mat3& b : blocks) b.setZero();
        blocks[Overlay::block_of(0, 0)] = blocks[Overlay::block_of(1, 1)] = 3 * Mat3::Identity();
        blocks[Overlay::block_of(0, 1)] = -3 * Mat3::Identity();
        const Overlay::Carrier carriers[] = {{0, one, 1}, {1, other, 1}};
        a.overlay.add(carriers, blocks);
    }
    /// What the smoother makes of some right side, with a tenth of what is left taken in between, on one thread and on
    /// two; against dense matrices.
    void check(OverlaySmoother& smoother, std::size_t patches) {
        const std::vector<int>& coupled = a.overlay.rows();
        const MatrixXd whole = dense(a);
        const MatrixXd down = two_sweeps(whole, coupled, false), up = two_sweeps(whole, coupled, true);
        const std::vector<double> r = random_numbers(3 * rows, 6);
        const VectorXd swept = down * as_vector(r), between = swept + 0.1 * (as_vector(r) - whole * swept),
                       expected = between + up * (as_vector(r) - whole * between);
        const auto tenth = [](const std::vector<double>& in, std::vector<double>& out) {
            for (std::size_t i = 0; i < in.size(); ++i) out[i] = 0.1 * in[i];
        };
        std::vector<std::vector<double>> found;
        for (const std::size_t threads : {1, 2}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            REQUIRE(smoother.set_values(a.overlay));
            CHECK(smoother.patches() == patches);
            found.emplace_back(3 * rows);
            smoother.apply(tenth, r, found.back());
        }
        CHECK((as_vector(found[0]) - expected).norm() < 1e-5 * expected.norm());
        CHECK(found[0] == found[1]);
    }
};

} // namespace

TEST_CASE("overlay smoother: patches that have nothing to do with each other go side by side", "[linear]") {
    TiedGrid g;
    OverlaySmoother smoother(g.fine);
    // Nine chains of 18 points that the grid couples, which are too far from each other to be coupled: three chains
    // make a patch.
    for (int x = 0; x < g.n; x += 3)
        for (int y = 0; y < g.n; ++y)
            for (int z = 0; z < g.n; z += 3) g.tie(g.grid.point(x, y, z), g.grid.point(x, y, z + 1));
    g.a.overlay.finish(g.rows);
    REQUIRE(g.a.overlay.rows().size() == 162);
    g.check(smoother, 3);
    // Three planes, each large enough for a patch, of which the springs alone make two one, first these, then those.
    for (const auto [one, other, alone] : {std::array{0, 8, 4}, std::array{0, 4, 8}}) {
        g.a.overlay.clear();
        for (int y = 0; y < g.n; ++y)
            for (int z = 0; z < g.n; ++z) {
                g.tie(g.grid.point(one, y, z), g.grid.point(other, y, z));
                if (z > 0) g.tie(g.grid.point(alone, y, z - 1), g.grid.point(alone, y, z));
            }
        g.a.overlay.finish(g.rows);
        REQUIRE(g.a.overlay.rows().size() == 243);
        g.check(smoother, 2);
    }
}

TEST_CASE("overlay smoother: what springs of a hundred times the stiffness around them couple takes few iterations",
          "[linear]") {
    TwoGrids g(1000);
    const MatrixXd k = dense(g.a), inverse = g.pattern_alone().inverse();
    OverlaySmoother smoother(g.fine);
    REQUIRE(smoother.set_values(g.a.overlay));
    const auto exact = [&](const std::vector<double>& r, std::vector<double>& z) {
        Eigen::Map<VectorXd>(z.data(), Eigen::Index(z.size())) = inverse * as_vector(r);
    };
    const double without = condition(inverse, k), with = condition(as_matrix(smoother, exact, g.size), k);
    CAPTURE(without, with);
    CHECK(without == Approx(327).epsilon(0.01));
    CHECK(with == Approx(16.75).epsilon(0.01));
}

TEST_CASE("overlay smoother: says where a coupled row cannot be positive definite", "[linear]") {
    TwoGrids g(5);
    OverlaySmoother smoother(g.fine);
    Overlay::Blocks pulls;
    for (Mat3& block : pulls) block.setZero();
    pulls[0] = -1e4 * Mat3::Identity();
    const Overlay::Carrier carriers[] = {{0, 0, 1}, {1, g.rows, 1}, {2, g.rows + 1, 1}, {3, g.rows + g.n, 1}};
    g.a.overlay.clear();
    g.a.overlay.add(carriers, pulls);
    g.a.overlay.finish(2 * g.rows);
    CHECK_FALSE(smoother.set_values(g.a.overlay));
}
