// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/curve.h"

#include "engine/matrix_between.h"

#include <algorithm>
#include <cmath>

namespace sinew::engine {

namespace {

double slope(const std::vector<Key>& keys, std::size_t i, std::size_t c) {
    return (keys[i + 1].value[c] - keys[i].value[c]) / (keys[i + 1].frame - keys[i].frame);
}

// Monotone tangent: flat at the ends and at turning points, else the weighted harmonic mean of the two
// slopes, which keeps a cubic between its keys (Fritsch and Butland, "A method for constructing local
// monotone piecewise cubic interpolants", SIAM J. Sci. Stat. Comput. 5(2), 1984).
double automatic_tangent(const std::vector<Key>& keys, std::size_t i, std::size_t c) {
    if (i == 0 || i + 1 == keys.size()) return 0;
    const double s0 = slope(keys, i - 1, c), s1 = slope(keys, i, c);
    if (!(s0 * s1 > 0)) return 0;
    const double h0 = keys[i].frame - keys[i - 1].frame, h1 = keys[i + 1].frame - keys[i].frame;
    const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
    return (w0 + w1) / (w0 / s0 + w1 / s1);
}

double smooth(const std::vector<Key>& keys, std::size_t i, std::size_t c, double t) {
    const Key &a = keys[i], &b = keys[i + 1];
    const bool given_a = !a.tangent_out.empty(), given_b = !b.tangent_in.empty();
    const double m0 = given_a ? a.tangent_out[c] : automatic_tangent(keys, i, c);
    const double m1 = given_b ? b.tangent_in[c] : automatic_tangent(keys, i + 1, c);
    const double v0 = a.value[c], v1 = b.value[c];
    if (v0 == v1 && m0 == 0 && m1 == 0) return v0; // flat: bit for bit, so that no frame is simulated again
    const double h = b.frame - a.frame, u = 1 - t;
    const double v = std::lerp(v0, v1, t * t * (3 - 2 * t)) + h * t * u * (u * m0 - t * m1);
    // Automatic tangents never overshoot; rounding must not either, or a value could leave its limits.
    return given_a || given_b ? v : std::clamp(v, std::min(v0, v1), std::max(v0, v1));
}

} // namespace

namespace {

/// The key from which a frame goes on, and how far it is on the way to the next; 0: it has the key's value.
struct Span {
    std::size_t from;
    double t;
};

Span find_span(const std::vector<Key>& keys, Interpolation interpolation, double frame) {
    if (!(frame > keys.front().frame)) return {0, 0};
    if (frame >= keys.back().frame) return {keys.size() - 1, 0};
    const auto after =
        std::upper_bound(keys.begin(), keys.end(), frame, [](double f, const Key& k) { return f < k.frame; });
    const auto i = static_cast<std::size_t>(after - keys.begin()) - 1;
    const Key &a = keys[i], &b = keys[i + 1];
    if (interpolation == Interpolation::step) return {i, 0};
    return {i, (frame - a.frame) / (b.frame - a.frame)};
}

double value_in(const std::vector<Key>& keys, Interpolation interpolation, const Span& span, std::size_t c) {
    const double a = keys[span.from].value[c];
    if (span.t == 0) return a;
    if (interpolation == Interpolation::smooth) return smooth(keys, span.from, c, span.t);
    const double b = keys[span.from + 1].value[c];
    return a == b ? a : std::lerp(a, b, span.t);
}

} // namespace

double Curve::component_at(double frame, std::size_t c) const {
    if (keys.empty()) return 0;
    return value_in(keys, interpolation, find_span(keys, interpolation, frame), c);
}

Matrix4 Curve::matrix_at(double frame) const {
    const auto matrix = [](const Key& k) {
        Matrix4 out{};
        std::copy_n(k.value.begin(), std::min(out.size(), k.value.size()), out.begin());
        return out;
    };
    if (keys.empty()) return {};
    if (!(frame > keys.front().frame)) return matrix(keys.front());
    const auto after =
        std::upper_bound(keys.begin(), keys.end(), frame, [](double f, const Key& k) { return f < k.frame; });
    const Key& a = *(after - 1);
    if (after == keys.end() || frame == a.frame || interpolation == Interpolation::step || a.value == after->value)
        return matrix(a);
    return matrix_between(matrix(a), matrix(*after), (frame - a.frame) / (after->frame - a.frame));
}

std::vector<double> Curve::at(double frame) const {
    if (keys.empty()) return {};
    const Span span = find_span(keys, interpolation, frame);
    if (span.t == 0) return keys[span.from].value.list();
    std::vector<double> out(width());
    for (std::size_t c = 0; c < out.size(); ++c) out[c] = value_in(keys, interpolation, span, c);
    return out;
}

} // namespace sinew::engine
