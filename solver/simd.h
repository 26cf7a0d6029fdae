// Packs of doubles for element kernels (GCC vector types). A kernel written once as a template runs on a Pack or on a
// plain double; each lane does exactly what the scalar code does, so results do not depend on the instruction set.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>

namespace sinew::solver {

/// Elements that one kernel call handles.
inline constexpr int lanes = 4;

struct Pack {
    typedef double Vector __attribute__((vector_size(lanes * sizeof(double))));
    typedef long long Mask __attribute__((vector_size(lanes * sizeof(long long))));
    Vector v;
    Pack() = default;
    Pack(double s)
        : v(Vector{} + s) {}
    Pack(Vector x)
        : v(x) {}
    static Pack load(const double* p) {
        Pack r;
        for (int i = 0; i < lanes; ++i) r.v[i] = p[i];
        return r;
    }
    void store(double* p) const {
        for (int i = 0; i < lanes; ++i) p[i] = v[i];
    }
    double operator[](int i) const { return v[i]; }
    Pack operator-() const { return Pack(-v); }
    Pack& operator+=(Pack o) { return v += o.v, *this; }
    Pack& operator-=(Pack o) { return v -= o.v, *this; }
    Pack& operator*=(Pack o) { return v *= o.v, *this; }
    friend Pack operator+(Pack a, Pack b) { return a.v + b.v; }
    friend Pack operator-(Pack a, Pack b) { return a.v - b.v; }
    friend Pack operator*(Pack a, Pack b) { return a.v * b.v; }
    friend Pack operator/(Pack a, Pack b) { return a.v / b.v; }
    friend Mask operator<(Pack a, Pack b) { return a.v < b.v; }
    friend Mask operator>(Pack a, Pack b) { return a.v > b.v; }
};

inline Pack select(Pack::Mask m, Pack a, Pack b) { return Pack(m ? a.v : b.v); }
inline Pack sqrt(Pack a) {
    Pack r;
    for (int i = 0; i < lanes; ++i) r.v[i] = std::sqrt(a.v[i]);
    return r;
}
inline Pack abs(Pack a) { return select(a < Pack(0.0), -a, a); }
inline Pack max(Pack a, Pack b) { return select(a < b, b, a); }
inline Pack log(Pack a) {
    Pack r;
    for (int i = 0; i < lanes; ++i) r.v[i] = std::log(a.v[i]);
    return r;
}

// The same names for plain numbers.
inline double select(bool m, double a, double b) { return m ? a : b; }
using std::abs;
using std::log;
using std::sqrt;
inline double max(double a, double b) { return a < b ? b : a; }

} // namespace sinew::solver
