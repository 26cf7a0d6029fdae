// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/rigid_correction.h"

#include "solver/index.h"
#include "solver/parallel.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>

namespace sinew::solver {

namespace {

/// Rows that are one piece of work.
constexpr std::size_t piece = 128;
/// A body whose moment of inertia about some axis is less than this, of its size and of one of its rows, does not
/// turn about that: its points lie on a line.
constexpr double least_inertia = 1e-6;

typedef double Double4 __attribute__((vector_size(32)));

/// Three numbers of a block's nine, and in the fourth lane some other of them.
Double4 row_of(const double* block, int row) {
    Double4 out;
    std::memcpy(&out, block + (row < 2 ? 3 * row : 5), sizeof out);
    return row < 2 ? out : __builtin_shufflevector(out, out, 1, 2, 3, 0);
}
Double4 next(Double4 v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); }
Double4 after_next(Double4 v) { return __builtin_shufflevector(v, v, 2, 0, 1, 3); }

/// B Z summed over blocks of one row, where Z is what a row moves by a translation and a rotation. Of a block as it
/// stands the rows lie in memory side by side, of one that stands for its transpose the columns: each kind has its sum.
struct OwnSum {
    Double4 by_columns[6] = {}, by_rows[6] = {};
    void add(const double* block, const Vec3& arm) {
        const Double4 a{arm[0], arm[1], arm[2], 0}, a1 = next(a), a2 = after_next(a);
        for (int r = 0; r < 3; ++r) {
            const Double4 b = row_of(block, r);
            by_rows[r] += b, by_rows[3 + r] += a1 * after_next(b) - a2 * next(b);
        }
    }
    void add_transposed(const double* block, const Vec3& arm) {
        const Double4 b0 = row_of(block, 0), b1 = row_of(block, 1), b2 = row_of(block, 2);
        by_columns[0] += b0, by_columns[1] += b1, by_columns[2] += b2;
        by_columns[3] += arm[1] * b2 - arm[2] * b1;
        by_columns[4] += arm[2] * b0 - arm[0] * b2;
        by_columns[5] += arm[0] * b1 - arm[1] * b0;
    }
    void add_to(Eigen::Matrix<double, 3, 6>& out) const {
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) {
                out(r, c) += by_columns[c][r] + by_rows[r][c];
                out(r, 3 + c) += by_columns[3 + c][r] + by_rows[3 + r][c];
            }
    }
};

/// Adds B Z, where B has these columns and Z is what a row moves by a translation and a rotation.
template <class Column>
void add_product(const Column& b0, const Column& b1, const Column& b2, const Vec3& arm,
                 Eigen::Matrix<double, 3, 6>& to) {
    to.col(0) += b0, to.col(1) += b1, to.col(2) += b2;
    to.col(3) += arm[1] * b2 - arm[2] * b1;
    to.col(4) += arm[2] * b0 - arm[0] * b2;
    to.col(5) += arm[0] * b1 - arm[1] * b0;
}

} // namespace

RigidCorrection::RigidCorrection(std::vector<int> bodies)
    : body_(std::move(bodies))
    , arm_(body_.size(), Vec3::Zero())
    , own_(body_.size())
    , pieces_((body_.size() + piece - 1) / piece) {
    for (std::size_t i = 0; i < body_.size(); ++i) {
        if (body_[i] < 0) continue;
        if (rows_.size() <= at(body_[i])) rows_.resize(at(body_[i]) + 1);
        rows_[at(body_[i])].push_back(static_cast<int>(i));
    }
    felt_of_.resize(rows_.size()), turns_.resize(rows_.size());
    motion_.resize(rows_.size()), rounded_motion_.resize(rows_.size());
    const auto size = static_cast<Eigen::Index>(6 * rows_.size());
    matrix_.resize(size, size), forces_.resize(size), moved_.resize(size);
}

void RigidCorrection::set_places(std::span<const double> places) {
    for (std::size_t b = 0; b < rows_.size(); ++b) {
        const auto place = [&](int row) { return Eigen::Map<const Vec3>(places.data() + 3 * at(row)); };
        Vec3 middle = Vec3::Zero();
        for (const int row : rows_[b]) middle += place(row) / static_cast<double>(rows_[b].size());
        double size2 = 0;
        for (const int row : rows_[b]) size2 = std::max(size2, (place(row) - middle).squaredNorm());
        const double size = size2 > 0 ? std::sqrt(size2) : 1;
        Mat3 inertia = Mat3::Zero();
        for (const int row : rows_[b]) {
            const Vec3 arm = (place(row) - middle) / size;
            arm_[at(row)] = arm;
            inertia += arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose();
        }
        Eigen::SelfAdjointEigenSolver<Mat3> axes;
        axes.computeDirect(inertia, Eigen::EigenvaluesOnly);
        turns_[b] = axes.eigenvalues()[0] > least_inertia;
        if (!turns_[b])
            for (const int row : rows_[b]) arm_[at(row)].setZero();
    }
}

void RigidCorrection::add_row(const BlockMatrix& a, std::size_t row, Piece& out) {
    const BlockPattern& p = *a.pattern;
    Felt own = Felt::Zero();
    out.sums.clear();
    const auto sum_of = [&](int body) -> Felt& {
        if (body == body_[row]) return own;
        for (auto& [other, felt] : out.sums)
            if (other == body) return felt;
        return out.sums.emplace_back(body, Felt(Felt::Zero())).second;
    };
    const auto add = [&](int column, const auto& block) {
        if (const int body = body_[at(column)]; body >= 0)
            add_product(block.col(0), block.col(1), block.col(2), arm_[at(column)], sum_of(body));
    };
    // The matrix keeps its blocks by rows, Mat3 by columns. Nearly all are of one body.
    OwnSum sum;
    const bool moves = body_[row] >= 0;
    for (int e = p.lower_start[row]; e < p.lower_start[row + 1]; ++e) {
        const auto [block, column] = p.lower[at(e)];
        if (moves && body_[at(column)] == body_[row])
            sum.add_transposed(a.block(at(block)), arm_[at(column)]);
        else
            add(column, Eigen::Map<const Mat3>(a.block(at(block))));
    }
    for (int e = p.row_start[row]; e < p.row_start[row + 1]; ++e) {
        const int column = p.column[at(e)];
        if (moves && body_[at(column)] == body_[row])
            sum.add(a.block(at(e)), arm_[at(column)]);
        else
            add(column, Eigen::Map<const Mat3>(a.block(at(e))).transpose());
    }
    sum.add_to(own);
    a.overlay.visit_row(static_cast<int>(row), [&](int column, double factor, const Mat3& block, bool transposed) {
        add(column, transposed ? Mat3(factor * block.transpose()) : Mat3(factor * block));
    });
    if (out.sums.empty()) {
        own_[row] = own.cast<float>();
        return;
    }
    own_[row].setZero();
    if (moves) out.across.push_back({static_cast<int>(row), body_[row], own});
    for (const auto& [body, felt] : out.sums) out.across.push_back({static_cast<int>(row), body, felt});
}

bool RigidCorrection::set_values(const BlockMatrix& a) {
    parallel_for(pieces_.size(), 1, [&](std::size_t k) {
        pieces_[k].across.clear();
        for (std::size_t row = k * piece; row < std::min((k + 1) * piece, body_.size()); ++row)
            add_row(a, row, pieces_[k]);
    });
    across_.clear(), across_start_.assign(body_.size() + 1, 0);
    for (const Piece& p : pieces_) across_.insert(across_.end(), p.across.begin(), p.across.end());
    for (const Across& x : across_) ++across_start_[at(x.row) + 1];
    for (std::size_t row = 0; row < body_.size(); ++row) across_start_[row + 1] += across_start_[row];
    for (auto& list : felt_of_) list.clear();
    for (std::size_t k = 0; k < across_.size(); ++k) felt_of_[at(across_[k].body)].push_back(k);
    parallel_for(rows_.size(), 1, [&](std::size_t b) {
        const auto own = static_cast<Eigen::Index>(6 * b);
        matrix_.middleRows(own, 6).setZero();
        Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
        const auto add = [&](const Vec3& arm, const Felt& felt, auto&& to) {
            for (int c = 0; c < 6; ++c) {
                const Vec3 force = felt.col(c);
                to.col(c).template head<3>() += force, to.col(c).template tail<3>() += arm.cross(force);
            }
        };
        for (const int row : rows_[b]) {
            add(arm_[at(row)], own_[at(row)].cast<double>(), sum);
            for (std::size_t k = across_start_[at(row)]; k < across_start_[at(row) + 1]; ++k)
                add(arm_[at(row)], across_[k].felt, matrix_.block<6, 6>(own, 6 * across_[k].body));
        }
        auto block = matrix_.block<6, 6>(own, own);
        block += sum;
        if (!turns_[b]) block.bottomRightCorner<3, 3>().setIdentity(); // of no force, and so no motion
    });
    factor_.compute(matrix_);
    return factor_.info() == Eigen::Success;
}

/// The motions that the forces, and moments, on all bodies make.
void RigidCorrection::solve_for_motions(Eigen::VectorXd& forces) {
    factor_.solveInPlace(forces);
    for (std::size_t b = 0; b < motion_.size(); ++b)
        motion_[b] = forces.segment<6>(static_cast<Eigen::Index>(6 * b)), rounded_motion_[b] = motion_[b].cast<float>();
}

void RigidCorrection::apply(const Inner& inner, const std::vector<double>& r, std::vector<double>& z) {
    const auto of_row = [](const auto& v, std::size_t row) { return Eigen::Map<const Vec3>(v.data() + 3 * row); };
    parallel_for(rows_.size(), 1, [&](std::size_t b) {
        Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
        for (const int row : rows_[b]) {
            const Vec3 f = of_row(r, at(row));
            force += f, moment += arm_[at(row)].cross(f);
        }
        forces_.segment<6>(static_cast<Eigen::Index>(6 * b)) << force, moment;
    });
    moved_ = forces_;
    solve_for_motions(moved_);
    rest_.resize(r.size());
    parallel_for(body_.size(), piece, [&](std::size_t i) {
        Vec3 taken = Vec3::Zero();
        if (body_[i] >= 0) taken = (own_[i] * rounded_motion_[at(body_[i])]).cast<double>();
        for (std::size_t k = across_start_[i]; k < across_start_[i + 1]; ++k)
            taken += across_[k].felt * motion_[at(across_[k].body)];
        Eigen::Map<Vec3>(rest_.data() + 3 * i) = of_row(r, i) - taken;
    });
    inner(rest_, z);
    // What that leaves of forces on whole bodies: none was left to it.
    parallel_for(rows_.size(), 1, [&](std::size_t b) {
        Motion sum = Motion::Zero();
        for (const int row : rows_[b])
            sum -= (own_[at(row)].transpose() * of_row(z, at(row)).template cast<float>()).template cast<double>();
        for (const std::size_t k : felt_of_[b]) sum -= across_[k].felt.transpose() * of_row(z, at(across_[k].row));
        forces_.segment<6>(static_cast<Eigen::Index>(6 * b)) = sum;
    });
    solve_for_motions(forces_);
    moved_ += forces_;
    parallel_for(body_.size(), piece, [&](std::size_t i) {
        if (body_[i] < 0) return;
        const auto m = moved_.segment<6>(6 * static_cast<Eigen::Index>(body_[i]));
        Eigen::Map<Vec3>(z.data() + 3 * i) += m.head<3>() + Vec3(m.tail<3>()).cross(arm_[i]);
    });
}

} // namespace sinew::solver
