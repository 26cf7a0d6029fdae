// Integrals of polynomials over part of a tet.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/tet_moments.h"

#include <numeric>

namespace sinew::solver {

namespace {

constexpr std::array<std::array<int, 4>, most_moments> list_exponents() {
    std::array<std::array<int, 4>, most_moments> out{};
    std::size_t next = 0;
    for (int a = 4; a >= 0; --a)
        for (int b = 4 - a; b >= 0; --b)
            for (int c = 4 - a - b; c >= 0; --c) out[next++] = {a, b, c, 4 - a - b - c};
    return out;
}

constexpr std::size_t place_of(const std::array<int, 4>& exponents) {
    constexpr auto all = list_exponents();
    for (std::size_t m = 0; m < most_moments; ++m)
        if (all[m] == exponents) return m;
    return most_moments;
}

using Places = std::array<std::array<std::array<std::array<unsigned char, 4>, 4>, 4>, 4>;
constexpr Places list_places() {
    Places out{};
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
            for (std::size_t k = 0; k < 4; ++k)
                for (std::size_t l = 0; l < 4; ++l) {
                    std::array<int, 4> exponents{};
                    ++exponents[i], ++exponents[j], ++exponents[k], ++exponents[l];
                    out[i][j][k][l] = static_cast<unsigned char>(place_of(exponents));
                }
    return out;
}
constexpr Places places = list_places();

/// Products of two coordinates, and each monomial of degree 4 as a product of two of them.
constexpr std::size_t pairs[10][2] = {{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1}, {1, 2}, {1, 3}, {2, 2}, {2, 3}, {3, 3}};
struct Halves {
    std::size_t first[most_moments], second[most_moments];
};
constexpr Halves list_halves() {
    Halves out{};
    for (std::size_t p = 0; p < 10; ++p)
        for (std::size_t q = p; q < 10; ++q) {
            const std::size_t m = places[pairs[p][0]][pairs[p][1]][pairs[q][0]][pairs[q][1]];
            out.first[m] = p, out.second[m] = q;
        }
    return out;
}
constexpr Halves halves = list_halves();

/// Walkington's rule of 14 points, exact to degree 5: four points on each of two orbits near to or far from a corner,
/// six on the lines between the middles of opposite edges. Two points of no weight fill the vectors.
struct Rule {
    static constexpr std::size_t size = 16;
    double point[4][size] = {}, weight[size] = {};
};
constexpr Rule make_rule() {
    Rule rule;
    std::size_t next = 0;
    const auto add_corner_orbit = [&](double others, double weight) {
        for (std::size_t own = 0; own < 4; ++own, ++next) {
            for (std::size_t c = 0; c < 4; ++c) rule.point[c][next] = c == own ? 1 - 3 * others : others;
            rule.weight[next] = weight;
        }
    };
    add_corner_orbit(0.31088591926330060980, 0.11268792571801585080);
    add_corner_orbit(0.092735250310891226402, 0.073493043116361949544);
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j, ++next) {
            for (std::size_t c = 0; c < 4; ++c)
                rule.point[c][next] = c == i || c == j ? 0.5 - 0.045503704125649649492 : 0.045503704125649649492;
            rule.weight[next] = 0.042546020777081466438;
        }
    return rule;
}
constexpr Rule rule = make_rule();

} // namespace

const std::array<std::array<int, 4>, most_moments> quartic_exponents = list_exponents();

std::size_t quartic_index(std::size_t i, std::size_t j, std::size_t k, std::size_t l) { return places[i][j][k][l]; }

void TetMoments::add(const std::array<Barycentric, 4>& piece, double volume) {
    if (degree == 1) {
        for (std::size_t c = 0; c < 4; ++c)
            value[c] += 0.25 * volume * (piece[0][c] + piece[1][c] + piece[2][c] + piece[3][c]);
        return;
    }
    double point[4][Rule::size], product[10][Rule::size];
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t p = 0; p < Rule::size; ++p)
            point[c][p] = rule.point[0][p] * piece[0][c] + rule.point[1][p] * piece[1][c] +
                          rule.point[2][p] * piece[2][c] + rule.point[3][p] * piece[3][c];
    for (std::size_t k = 0; k < 10; ++k)
        for (std::size_t p = 0; p < Rule::size; ++p) product[k][p] = point[pairs[k][0]][p] * point[pairs[k][1]][p];
    double weighted[10][Rule::size];
    for (std::size_t k = 0; k < 10; ++k)
        for (std::size_t p = 0; p < Rule::size; ++p) weighted[k][p] = volume * rule.weight[p] * product[k][p];
    for (std::size_t m = 0; m < most_moments; ++m) {
        const double *a = weighted[halves.first[m]], *b = product[halves.second[m]];
        double sums[4] = {};
        for (std::size_t p = 0; p < Rule::size; p += 4)
            for (std::size_t l = 0; l < 4; ++l) sums[l] += a[p + l] * b[p + l];
        value[m] += (sums[0] + sums[1]) + (sums[2] + sums[3]);
    }
}

void TetMoments::add(const TetMoments& other, double factor) {
    for (std::size_t m = 0; m < moment_count(degree); ++m) value[m] += factor * other.value[m];
}

double TetMoments::volume() const {
    if (degree == 1) return std::accumulate(value.begin(), value.begin() + 4, 0.0);
    return MomentTensors(value.data()).volume;
}

TetMoments whole_moments(int degree) {
    constexpr double factorial[5] = {1, 1, 2, 6, 24};
    TetMoments out;
    out.degree = degree;
    for (std::size_t m = 0; m < moment_count(degree); ++m) {
        out.value[m] = degree == 1 ? 0.25 : 6.0 / 5040;
        if (degree == 4)
            for (const int e : quartic_exponents[m]) out.value[m] *= factorial[e];
    }
    return out;
}

MomentTensors::MomentTensors(const double* quartic) {
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            for (std::size_t k = 0; k < 4; ++k) {
                for (std::size_t l = 0; l < 4; ++l) third[i][j][k] += quartic[places[i][j][k][l]];
                second[i][j] += third[i][j][k];
            }
            first[i] += second[i][j];
        }
        volume += first[i];
    }
}

} // namespace sinew::solver
