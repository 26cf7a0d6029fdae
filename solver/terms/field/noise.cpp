// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/field/noise.h"

namespace sinew::solver {

namespace {

std::uint64_t scrambled(std::uint64_t n) {
    n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9u;
    n = (n ^ (n >> 27)) * 0x94d049bb133111ebu;
    return n ^ (n >> 31);
}

/// 0 to 1, with two derivatives of zero at both ends.
template <class T>
T blend(const T& t) {
    return t * t * t * (t * (t * T(6) - T(15)) + T(10));
}

/// A quarter of the bits as a number in [-1, 1).
double signed_part(std::uint64_t bits, int part) {
    const std::uint64_t number = (bits >> (16 * part)) & 0xffffu;
    return (static_cast<double>(number) + 0.5) / 32768 - 1;
}

/// 1 / root mean square of three components whose gradients are uniform in [-1, 1]^4: each has the mean square
/// 1/3 x 4 b a^3, a = 181/231 and b = 535/9009 the integrals over a cell of the squared blends, and of those times the
/// squared distance.
const double unit = 1 / std::sqrt(4 * (535.0 / 9009) * (181.0 / 231) * (181.0 / 231) * (181.0 / 231));

} // namespace

template <class T>
Triple<T> noise(const Triple<T>& place, double time, int layer) {
    double cell[4];
    T within[3], weight[3][2];
    for (int c = 0; c < 3; ++c) {
        cell[c] = std::floor(value_of(place[static_cast<std::size_t>(c)]));
        within[c] = place[static_cast<std::size_t>(c)] - T(cell[c]);
        weight[c][1] = blend(within[c]);
        weight[c][0] = T(1) - weight[c][1];
    }
    cell[3] = std::floor(time);
    for (const double number : cell) // no place to look up: further on it shows as what it is
        if (!(std::abs(number) < 1e15)) return {T(number - number), T(0), T(0)};
    const double after = time - cell[3], later[2] = {1 - blend(after), blend(after)};
    Triple<T> out{T(0), T(0), T(0)};
    for (int corner = 0; corner < 16; ++corner) {
        std::uint64_t key = static_cast<std::uint64_t>(layer);
        for (int c = 0; c < 4; ++c)
            key = scrambled(key + 0x9e3779b97f4a7c15u +
                            static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[c]) + (corner >> c & 1)));
        const T w =
            weight[0][corner & 1] * weight[1][corner >> 1 & 1] * weight[2][corner >> 2 & 1] * T(later[corner >> 3 & 1]);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint64_t bits = scrambled(key + k + 1);
            T along(signed_part(bits, 3) * (after - (corner >> 3 & 1)));
            for (int c = 0; c < 3; ++c) along = along + T(signed_part(bits, c)) * (within[c] - T(corner >> c & 1));
            out[k] = out[k] + w * along;
        }
    }
    return T(unit) * out;
}

template Triple<double> noise(const Triple<double>&, double, int);
template Triple<Dual> noise(const Triple<Dual>&, double, int);

} // namespace sinew::solver
