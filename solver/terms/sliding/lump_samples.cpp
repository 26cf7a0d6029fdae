// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/sliding/lump_samples.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace sinew::solver {

namespace {

/// All products of up to `degree` of three coordinates.
Eigen::VectorXd monomials(const std::array<double, 4>& at, int degree) {
    std::vector<double> out;
    for (int i = 0; i <= degree; ++i)
        for (int j = 0; i + j <= degree; ++j)
            for (int k = 0; i + j + k <= degree; ++k)
                out.push_back(std::pow(at[1], i) * std::pow(at[2], j) * std::pow(at[3], k));
    return Eigen::Map<Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

struct Kept {
    std::size_t sample;
    double weight;
};

/// Takes one sample out of `kept`; false: their monomials are independent.
bool let_one_go(const std::vector<Eigen::VectorXd>& of, std::vector<Kept>& kept) {
    Eigen::MatrixXd sums(of.front().size(), static_cast<Eigen::Index>(kept.size()));
    for (std::size_t i = 0; i < kept.size(); ++i) sums.col(static_cast<Eigen::Index>(i)) = of[kept[i].sample];
    Eigen::FullPivLU<Eigen::MatrixXd> lu(sums);
    lu.setThreshold(1e-10); // of the largest pivot: coordinates of samples in a plane are dependent but for rounding
    if (lu.dimensionOfKernel() == 0) return false;
    const Eigen::VectorXd along = lu.kernel().col(0);
    // The step along it, either way, after which the first weight is 0.
    double step = std::numeric_limits<double>::infinity();
    std::size_t first = 0;
    for (const double way : {1.0, -1.0})
        for (std::size_t i = 0; i < kept.size(); ++i) {
            const double falls = -way * along[static_cast<Eigen::Index>(i)];
            if (falls > 0 && kept[i].weight / falls < std::abs(step)) step = way * kept[i].weight / falls, first = i;
        }
    for (std::size_t i = 0; i < kept.size(); ++i) kept[i].weight += step * along[static_cast<Eigen::Index>(i)];
    kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(first));
    // Others that came to 0 with it, but for rounding.
    std::erase_if(kept, [](const Kept& s) { return !(s.weight > 0); });
    return !kept.empty();
}

} // namespace

std::vector<LumpedSample> lump_into_few(std::span<const std::array<double, 4>> coordinates,
                                        std::span<const double> weights) {
    const auto place = [&](std::size_t i) {
        return Eigen::Vector3d(coordinates[i][1], coordinates[i][2], coordinates[i][3]);
    };
    double sum = 0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i], mean += weights[i] * place(i);
    mean /= sum;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < weights.size(); ++i)
        covariance += weights[i] / sum * (place(i) - mean) * (place(i) - mean).transpose();
    // A root of it by Cholesky's method, a column a direction in which they spread.
    Eigen::Matrix3d rest = covariance, root;
    int ways = 0;
    for (int k = 0; k < 3; ++k) {
        if (!(rest(k, k) > 1e-10 * (covariance(k, k) + 1e-10))) continue; // rounding
        root.col(ways) = rest.col(k) / std::sqrt(rest(k, k));
        root.col(ways).head(k).setZero();
        rest -= root.col(ways) * root.col(ways).transpose();
        ++ways;
    }
    // Corners of a regular simplex, whose mean is 0 and whose covariance is 1.
    const double half = std::sqrt(0.5), high = std::sqrt(1.5);
    const std::vector<std::vector<Eigen::Vector3d>> simplex{{{0, 0, 0}},
                                                            {{1, 0, 0}, {-1, 0, 0}},
                                                            {{2 * half, 0, 0}, {-half, high, 0}, {-half, -high, 0}},
                                                            {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};
    const auto& corners = simplex[static_cast<std::size_t>(ways)];
    std::vector<LumpedSample> out;
    for (const Eigen::Vector3d& corner : corners) {
        const Eigen::Vector3d p = mean + root.leftCols(ways) * corner.head(ways);
        out.push_back({{1 - p.sum(), p[0], p[1], p[2]}, sum / static_cast<double>(corners.size())});
    }
    return out;
}

std::vector<LumpedSample> lump_samples(std::span<const std::array<double, 4>> coordinates,
                                       std::span<const double> weights, int degree) {
    std::vector<Eigen::VectorXd> of;
    std::vector<Kept> kept;
    for (std::size_t i = 0; i < coordinates.size(); ++i) {
        of.push_back(monomials(coordinates[i], degree));
        kept.push_back({i, weights[i]});
        if (static_cast<Eigen::Index>(kept.size()) > of.back().size()) let_one_go(of, kept);
    }
    while (kept.size() > 1 && let_one_go(of, kept)) {
    }
    std::vector<LumpedSample> out;
    for (const Kept& k : kept) out.push_back({coordinates[k.sample], k.weight});
    return out;
}

} // namespace sinew::solver
