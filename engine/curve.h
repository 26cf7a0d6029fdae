// Keyframed numbers and matrices: step, linear, smooth (monotone tangents) or smooth with given tangents. Exact on flat
// spans: between two equal keys the value is that key's value, bit for bit (std::lerp and its like).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/value.h"

#include <cstddef>
#include <vector>

namespace sinew::engine {

enum class Interpolation { step, linear, smooth };

struct Key {
    double frame = 0;
    std::vector<double> value;                             ///< one number, three for a vector, 16 for a matrix
    std::vector<double> tangent_in = {}, tangent_out = {}; ///< value per frame; empty = automatic
};

/// Keys sorted by frame, all of one width. Before the first and after the last key the value is constant.
struct Curve {
    Interpolation interpolation = Interpolation::linear;
    std::vector<Key> keys;
    std::vector<double> at(double frame) const;
    /// One component of `at`, without an allocation.
    double component_at(double frame, std::size_t component) const;
    /// For keys of 16 numbers: between keys as matrix_between, with step the earlier one.
    Matrix4 matrix_at(double frame) const;
    std::size_t width() const { return keys.empty() ? 0 : keys.front().value.size(); }
};

} // namespace sinew::engine
