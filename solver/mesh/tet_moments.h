// Integrals of polynomials over part of a tet, in its barycentric coordinates: what an element has to know about the
// part of it that is solid.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>

namespace sinew::solver {

/// Barycentric coordinates in a tet.
using Barycentric = std::array<double, 4>;

/// Degrees that are kept: 1 (volume and centroid, all that a linear tet asks for) and 4 (the mass of a quadratic tet).
/// The four coordinates sum to one, so the homogeneous monomials of one degree hold all polynomials up to it.
constexpr std::size_t moment_count(int degree) { return degree == 1 ? 4 : 35; }
constexpr std::size_t most_moments = moment_count(4);

/// Exponents of the 35 monomials of degree 4, in the order in which their integrals are kept. Those of degree 1 are in
/// the order of the corners.
extern const std::array<std::array<int, 4>, most_moments> quartic_exponents;
/// Place of the monomial l_i l_j l_k l_l.
std::size_t quartic_index(std::size_t i, std::size_t j, std::size_t k, std::size_t l);

/// Integrals of all monomials of one degree over part of a tet, per volume of the tet.
struct TetMoments {
    int degree = 4;
    std::array<double, most_moments> value{};

    /// Adds the integrals over a smaller tet, `volume` its share of the tet's volume; negative ones take it away.
    /// Exact up to rounding.
    void add(const std::array<Barycentric, 4>& piece, double volume);
    void add(const TetMoments& other, double factor);
    /// Share of the tet: the integral of 1.
    double volume() const;
};

/// Moments of the whole tet.
TetMoments whole_moments(int degree);

/// All moments of degrees 1 to 4 as symmetric tensors, from those of degree 4.
struct MomentTensors {
    explicit MomentTensors(const double* quartic);
    double volume = 0, first[4] = {}, second[4][4] = {}, third[4][4][4] = {};
};

} // namespace sinew::solver
