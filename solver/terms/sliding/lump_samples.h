// Fewer samples that do as much: of the points of a surface that one tet carries, a few with other weights.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <span>
#include <vector>

namespace sinew::solver {

struct LumpedSample {
    std::array<double, 4> coordinates;
    double weight;
};

/// Two to four points of the same weight, one where all samples are in one place, with the same sums of weight x p for
/// every polynomial p up to degree 2: mean and covariance. They lie about the samples' mean plane, not on the skin.
std::vector<LumpedSample> lump_into_few(std::span<const std::array<double, 4>> coordinates,
                                        std::span<const double> weights);

/// Samples at barycentric coordinates of one tet with positive weights: of them a subset with positive weights that
/// has the same sums of weight x p for every polynomial p up to `degree`, so that a spring at every sample across a
/// plane does the same to a tet whose shape functions are of half that degree. No more are left than there are such
/// polynomials: 10 of degree 2, 35 of degree 4. (Carathéodory's theorem; a weight after the other is let go along a
/// direction that changes no sum.)
std::vector<LumpedSample> lump_samples(std::span<const std::array<double, 4>> coordinates,
                                       std::span<const double> weights, int degree);

} // namespace sinew::solver
