// A preconditioner that also knows how bodies move each other as wholes. What touches lies outside of the pattern, so a
// factor or grids see each body pressed against something that does not give, and smoothing about contacts sees no
// farther than its rows: in a pile of loose bodies the rigid motions are what is left to the iterations. Here the
// matrix's share in those is solved exactly, before and after what preconditions the rest (balancing: Mandel,
// "Balancing domain decomposition", 1993).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"

#include <Eigen/Cholesky>
#include <functional>
#include <span>
#include <vector>

namespace sinew::solver {

class RigidCorrection {
  public:
    /// `bodies`: per row a body from 0 on whose rigid motions are taken, or -1.
    explicit RigidCorrection(std::vector<int> bodies);
    /// Where the rows are, 3 numbers each: rotations are about the middles of the bodies.
    void set_places(std::span<const double> places);
    const std::vector<int>& bodies() const { return body_; }
    /// After set_places. False: the matrix's share in the motions is not positive definite, and is not to be used.
    bool set_values(const BlockMatrix& a);
    /// z = M^-1 r, 3 numbers a row, with `inner` on what the rigid motions leave: symmetric and positive definite where
    /// inner is, and exact for A times a rigid motion of any body. The same bits for any number of threads.
    using Inner = std::function<void(const std::vector<double>& r, std::vector<double>& z)>;
    void apply(const Inner& inner, const std::vector<double>& r, std::vector<double>& z);

  private:
    /// Forces on a row by a body's translation and rotation.
    using Felt = Eigen::Matrix<double, 3, 6>;
    using RoundedFelt = Eigen::Matrix<float, 3, 6>;
    using Motion = Eigen::Matrix<double, 6, 1>;
    /// What a row feels of a body where it feels several: of two that press on each other and move together next to
    /// nothing is left, which single precision would lose.
    struct Across {
        int row, body;
        Felt felt;
    };
    struct Piece {
        std::vector<Across> across;
        std::vector<std::pair<int, Felt>> sums; ///< scratch
    };
    void add_row(const BlockMatrix& a, std::size_t row, Piece& out);
    void solve_for_motions(Eigen::VectorXd& forces);

    std::vector<int> body_;
    std::vector<std::vector<int>> rows_;            ///< per body
    std::vector<Vec3> arm_;                         ///< per row: from its body's middle, in sizes of the body
    std::vector<char> turns_;                       ///< per body: its points lie neither in one place nor on a line
    std::vector<RoundedFelt> own_;                  ///< per row, of its own body; 0 where that is in across_
    std::vector<Piece> pieces_;                     ///< of rows, scratch
    std::vector<Across> across_;                    ///< by rows
    std::vector<std::size_t> across_start_;         ///< per row and one past the end
    std::vector<std::vector<std::size_t>> felt_of_; ///< per body: those that feel it
    Eigen::MatrixXd matrix_;
    Eigen::LLT<Eigen::MatrixXd> factor_;
    Eigen::VectorXd forces_, moved_;
    std::vector<Motion> motion_; ///< per body
    std::vector<Eigen::Matrix<float, 6, 1>> rounded_motion_;
    std::vector<double> rest_;
};

} // namespace sinew::solver
