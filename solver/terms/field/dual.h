// Numbers that carry their derivatives along x, y and z (forward differentiation): one formula gives a field's force
// and its exact tangent.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>

namespace sinew::solver {

struct Dual {
    double value = 0;
    std::array<double, 3> slope{};
    Dual() = default;
    Dual(double constant)
        : value(constant) {}
    Dual(double v, const std::array<double, 3>& s)
        : value(v)
        , slope(s) {}
};

/// a's slope x fa + b's x fb.
inline std::array<double, 3> mixed(const Dual& a, double fa, const Dual& b, double fb) {
    std::array<double, 3> out;
    for (std::size_t c = 0; c < 3; ++c) out[c] = a.slope[c] * fa + b.slope[c] * fb;
    return out;
}
/// A function's value, and its derivative times the slope of what it is a function of.
inline Dual chained(const Dual& a, double value, double derivative) {
    return {value, {derivative * a.slope[0], derivative * a.slope[1], derivative * a.slope[2]}};
}

inline Dual operator+(const Dual& a, const Dual& b) { return {a.value + b.value, mixed(a, 1, b, 1)}; }
inline Dual operator-(const Dual& a, const Dual& b) { return {a.value - b.value, mixed(a, 1, b, -1)}; }
inline Dual operator-(const Dual& a) { return chained(a, -a.value, -1); }
inline Dual operator*(const Dual& a, const Dual& b) { return {a.value * b.value, mixed(a, b.value, b, a.value)}; }
inline Dual operator/(const Dual& a, const Dual& b) {
    const double q = a.value / b.value;
    return {q, mixed(a, 1 / b.value, b, -q / b.value)};
}

inline double value_of(double a) { return a; }
inline double value_of(const Dual& a) { return a.value; }

/// Root that has no slope at zero, where a distance has none either.
inline double root(double a) { return std::sqrt(a); }
inline Dual root(const Dual& a) {
    const double r = std::sqrt(a.value);
    return chained(a, r, r > 0 ? 0.5 / r : 0);
}
/// Of a positive number.
inline double power(double a, double exponent) { return std::pow(a, exponent); }
inline Dual power(const Dual& a, double exponent) {
    const double p = std::pow(a.value, exponent);
    return chained(a, p, exponent * p / a.value);
}

/// Three of them: a place, a velocity, a force.
template <class T>
using Triple = std::array<T, 3>;

template <class T, class U>
T dot(const Triple<T>& a, const U& b) {
    return a[0] * T(b[0]) + a[1] * T(b[1]) + a[2] * T(b[2]);
}
template <class T>
Triple<T> operator*(const T& factor, const Triple<T>& a) {
    return {factor * a[0], factor * a[1], factor * a[2]};
}
template <class T>
Triple<T> operator+(const Triple<T>& a, const Triple<T>& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class T>
Triple<T> operator-(const Triple<T>& a, const Triple<T>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
T norm(const Triple<T>& a) {
    return root(dot(a, a));
}

} // namespace sinew::solver
