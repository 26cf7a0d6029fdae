// The correction by rigid motions against the same with dense matrices.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/linear_solver.h"
#include "solver/linear/rigid_correction.h"
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

/// Loose grids of 27 points in a row, each light against what holds its points together, that press on the next with
/// the points of one side; what each feels of that itself stands in the pattern, as contact has it.
struct Row {
    static constexpr int n = 3, rows = n * n * n;
    int count;
    std::vector<std::pair<int, int>> couplings;
    BlockPattern pattern;
    BlockMatrix a;
    UnknownPlaces places;
    std::vector<double> where;

    explicit Row(int count, double skew = 0.02)
        : count(count)
        , couplings(grids(count))
        , pattern(make_pattern(count * rows, couplings))
        , a(pattern) {
        places.spacing.assign(std::size_t(count), 0.01);
        for (int i = 0; i < count * rows; ++i) {
            places.body.push_back(i / rows);
            const int p = i % rows;
            // Turned from body to body, as bodies tumble.
            const Eigen::AngleAxisd turn(0.7 * (i / rows), Vec3(1, 2, -1).normalized());
            const Vec3 at = turn * (0.01 * Vec3(p / 9, p / 3 % 3, p % 3)) + Vec3(0, 0, 0.05 * (i / rows));
            places.points.push_back(0.01 * Vec3(p / 9, p / 3 % 3, p % 3));
            where.insert(where.end(), at.data(), at.data() + 3);
            add(i, i, 0.01 * Mat3::Identity());
        }
        const Mat3 k = GridMatrix::some_coupling();
        Mat3 across = -k; // not symmetric, so that rows of a block are not taken for its columns
        across(0, 1) += skew, across(1, 0) -= skew;
        for (const auto& [i, j] : couplings) add(i, i, k), add(j, j, k), add(i, j, across);
        const Mat3 press = 3 * Mat3(Vec3(0.1, 0.2, 1).asDiagonal());
        for (int b = 0; b + 1 < count; ++b)
            for (int side = 0; side < n * n; ++side) {
                const int upper = (b + 1) * rows + n * side, lower = b * rows + n * side + 2;
                const Overlay::Carrier carriers[] = {{0, lower, 1}, {1, upper, 1}};
                a.overlay.add_across(carriers, {-press, Mat3::Zero(), Mat3::Zero()});
                add(lower, lower, press), add(upper, upper, press);
            }
        a.overlay.finish(count * rows);
    }
    static std::vector<std::pair<int, int>> grids(int count) {
        std::vector<std::pair<int, int>> out;
        for (int b = 0; b < count; ++b)
            for (int i = 0; i < rows; ++i)
                for (const int step : {9, 3, 1})
                    if (i / step % 3 < 2) out.emplace_back(b * rows + i, b * rows + i + step);
        return out;
    }
    void add(int i, int j, const Mat3& k) {
        Eigen::Map<Mat3>(a.block(std::size_t(pattern.find(i, j)))) += k.transpose(); // its blocks lie by rows
    }
    /// What the unknowns move by translations and rotations of each body, about the origin.
    MatrixXd rigid() const {
        MatrixXd out = MatrixXd::Zero(3 * count * rows, 6 * count);
        for (int i = 0; i < count * rows; ++i)
            for (int k = 0; k < 3; ++k) {
                const Vec3 p = Eigen::Map<const Vec3>(where.data() + 3 * i);
                out.block<3, 1>(3 * i, 6 * (i / rows) + k) = Vec3::Unit(k);
                out.block<3, 1>(3 * i, 6 * (i / rows) + 3 + k) = Vec3::Unit(k).cross(p);
            }
        return out;
    }
};

/// Other than the identity, and the same for all bodies: what a factor of the pattern would be.
MatrixXd inverse_of_pattern(const Row& row) {
    BlockMatrix without(row.pattern);
    without.values = row.a.values;
    return dense(without).inverse();
}

MatrixXd as_matrix(RigidCorrection& correction, const MatrixXd& inner) {
    MatrixXd out(inner.rows(), inner.cols());
    for (Eigen::Index i = 0; i < out.cols(); ++i) {
        std::vector<double> r(std::size_t(out.rows()), 0.0), z(r);
        r[std::size_t(i)] = 1;
        correction.apply(
            [&](const std::vector<double>& in, std::vector<double>& to) {
                Eigen::Map<VectorXd>(to.data(), out.rows()) = inner * as_vector(in);
            },
            r, z);
        out.col(i) = as_vector(z);
    }
    return out;
}

} // namespace

TEST_CASE("rigid correction: motions of whole bodies exactly, before and after what is around the rest", "[linear]") {
    const Row row(3);
    const MatrixXd a = dense(row.a), z = row.rigid(), inner = inverse_of_pattern(row);
    RigidCorrection correction(row.places.body);
    correction.set_places(row.where);
    REQUIRE(correction.set_values(row.a));
    const MatrixXd m = as_matrix(correction, inner);
    const MatrixXd q = z * (z.transpose() * a * z).ldlt().solve(z.transpose());
    const MatrixXd one = MatrixXd::Identity(a.rows(), a.cols());
    const MatrixXd expected = q + (one - q * a) * inner * (one - a * q);
    CHECK((m - expected).norm() < 2e-6 * expected.norm());
    CHECK((m - m.transpose()).norm() < 2e-6 * m.norm());
    CHECK((m * a * z - z).norm() < 2e-6 * z.norm());
    // The least eigenvalues of the preconditioned matrix are those of bodies that move together.
    const MatrixXd l = a.llt().matrixL();
    const auto least = [&](const MatrixXd& by) {
        const MatrixXd both = l.transpose() * (0.5 * (by + by.transpose())) * l;
        return Eigen::SelfAdjointEigenSolver<MatrixXd>(both).eigenvalues().minCoeff();
    };
    CHECK(least(inner) < 0.05);
    CHECK(least(m) > 0.2);
}

TEST_CASE("rigid correction: of some bodies alone, also where others in the pattern feel them", "[linear]") {
    Row row(3);
    std::vector<std::pair<int, int>> tied = row.couplings;
    tied.emplace_back(5, 2 * Row::rows + 7);
    const BlockPattern pattern = make_pattern(3 * Row::rows, tied);
    BlockMatrix a(pattern);
    for (int i = 0; i < pattern.rows; ++i)
        for (int e = row.pattern.row_start[std::size_t(i)]; e < row.pattern.row_start[std::size_t(i) + 1]; ++e)
            std::copy_n(row.a.block(std::size_t(e)), 9,
                        a.block(std::size_t(pattern.find(i, row.pattern.column[std::size_t(e)]))));
    Mat3 tie = GridMatrix::some_coupling();
    tie(0, 2) = 0.7; // not symmetric: the block's rows and columns must not be taken for each other
    Eigen::Map<Mat3>(a.block(std::size_t(pattern.find(5, 2 * Row::rows + 7)))) = 0.001 * tie;
    a.overlay = row.a.overlay;
    // The middle body is held by somebody else.
    std::vector<int> bodies;
    for (const int b : row.places.body) bodies.push_back(b == 0 ? 1 : b == 2 ? 0 : -1);
    MatrixXd z(a.pattern->rows * 3, 12);
    z << row.rigid().leftCols(6), row.rigid().rightCols(6);
    RigidCorrection correction(bodies);
    correction.set_places(row.where);
    REQUIRE(correction.set_values(a));
    const MatrixXd full = dense(a), one = MatrixXd::Identity(full.rows(), full.cols());
    const MatrixXd q = z * (z.transpose() * full * z).ldlt().solve(z.transpose());
    const MatrixXd expected = q + (one - q * full) * (one - full * q);
    CHECK((as_matrix(correction, one) - expected).norm() < 2e-6 * expected.norm());
    // What is not positive definite is seen.
    for (std::size_t i = 0; i < std::size_t(Row::rows); ++i)
        for (int c = 0; c < 3; ++c) a.block(std::size_t(pattern.row_start[i]))[4 * c] -= 1;
    CHECK_FALSE(correction.set_values(a));
}

TEST_CASE("rigid correction: points and lines are bodies that do not turn", "[linear]") {
    const Row row(3);
    std::vector<int> bodies(std::size_t(3 * Row::rows), -1);
    MatrixXd z(row.a.pattern->rows * 3, 12);
    z << row.rigid().leftCols(6), MatrixXd::Zero(z.rows(), 6);
    std::fill_n(bodies.begin(), Row::rows, 0);
    const auto add = [&](int at, int body) {
        bodies[std::size_t(at)] = body;
        z.block<3, 3>(3 * at, 3 + 3 * body).setIdentity();
    };
    add(Row::rows, 1);
    for (const int i : {0, 1, 2}) add(2 * Row::rows + i, 2);
    RigidCorrection correction(bodies);
    correction.set_places(row.where);
    REQUIRE(correction.set_values(row.a));
    const MatrixXd a = dense(row.a), one = MatrixXd::Identity(a.rows(), a.cols());
    const MatrixXd q = z * (z.transpose() * a * z).ldlt().solve(z.transpose());
    const MatrixXd expected = q + (one - q * a) * (one - a * q);
    CHECK((as_matrix(correction, one) - expected).norm() < 2e-6 * expected.norm());
}

TEST_CASE("rigid correction: bodies pressed together a million times as firmly as they are heavy", "[linear]") {
    Row row(3, 0);
    for (int i = 0; i < row.pattern.rows; ++i)
        for (int c = 0; c < 3; ++c)
            row.a.block(std::size_t(row.pattern.row_start[std::size_t(i)]))[4 * c] += 3e-6 - 0.01;
    RigidCorrection correction(row.places.body);
    correction.set_places(row.where);
    REQUIRE(correction.set_values(row.a));
    const MatrixXd a = dense(row.a), z = row.rigid(), one = MatrixXd::Identity(a.rows(), a.cols());
    const MatrixXd m = as_matrix(correction, one);
    CHECK((m * a * z - z).norm() < 1e-3 * z.norm());
    CHECK((m - m.transpose()).norm() < 1e-6 * m.norm());
}

TEST_CASE("rigid correction: the same bits on one thread and on two", "[linear]") {
    const Row row(5);
    const std::vector<double> r = random_numbers(row.where.size(), 4);
    std::vector<double> one(r.size()), two(r.size());
    for (auto* z : {&one, &two}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, z == &one ? 1 : 2);
        RigidCorrection correction(row.places.body);
        correction.set_places(row.where);
        REQUIRE(correction.set_values(row.a));
        correction.apply([](const std::vector<double>& in, std::vector<double>& out) { out = in; }, r, *z);
    }
    CHECK(one == two);
}

TEST_CASE("bodies that nothing but contact holds are solved for as wholes, held ones are not", "[linear]") {
    const Row row(8);
    const std::vector<double> b = random_numbers(row.where.size(), 6);
    const VectorXd expected = dense(row.a).ldlt().solve(as_vector(b));
    const std::vector<double> elastic(std::size_t(row.pattern.rows), 1.0);
    std::vector<double> springs(row.pattern.block_count(), 0.0), x(b.size());
    UnknownPlaces places = row.places;
    places.spacing.insert(places.spacing.begin(), 0.01); // all of that body is held
    for (int& body : places.body) ++body;
    std::vector<double> before = row.where; // places that they have left
    for (std::size_t i = 0; i < before.size(); i += 3) std::swap(before[i], before[i + 2]);
    const auto iterations = [&](bool from_elsewhere) {
        LinearSolver solver(row.pattern, places);
        LinearMemory memory;
        memory.factor_steps_left = 5;
        solver.begin_frame(memory);
        if (from_elsewhere) solver.begin_step(springs, elastic, before);
        solver.begin_step(springs, elastic, row.where);
        const LinearSolver::Outcome outcome =
            solver.solve(LinearMethod::automatic, row.a, b, x, 1e-6, 0, false, memory);
        CHECK(outcome.definite);
        CHECK((as_vector(x) - expected).norm() < 2e-2 * expected.norm());
        return outcome.iterations;
    };
    const int loose = iterations(false);
    CHECK(iterations(true) == loose);
    for (int body = 0; body < 6; ++body) // two are left, too few
        springs[std::size_t(row.pattern.row_start[std::size_t(body * Row::rows)])] = 1e-9;
    const int held = iterations(false);
    CHECK(loose <= 0.6 * held);
}
