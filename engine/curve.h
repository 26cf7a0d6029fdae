// Keyframed numbers and matrices: step, linear, smooth (monotone tangents) or smooth with given tangents. Exact on flat
// spans: between two equal keys the value is that key's value, bit for bit (std::lerp and its like).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/value.h"

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

namespace sinew::engine {

enum class Interpolation { step, linear, smooth };

/// The numbers of a key. Shared and never changed: hosts send a frame after the other, each as an edit, and each edit
/// copies the curve, but not the numbers of all frames before.
class KeyNumbers {
  public:
    KeyNumbers() = default;
    KeyNumbers(std::vector<double> numbers)
        : numbers_(std::make_shared<const std::vector<double>>(std::move(numbers))) {}
    KeyNumbers(std::initializer_list<double> numbers)
        : KeyNumbers(std::vector<double>(numbers)) {}
    const std::vector<double>& list() const {
        static const std::vector<double> none;
        return numbers_ ? *numbers_ : none;
    }
    double operator[](std::size_t i) const { return (*numbers_)[i]; }
    double front() const { return (*numbers_)[0]; }
    std::size_t size() const { return numbers_ ? numbers_->size() : 0; }
    bool empty() const { return size() == 0; }
    auto begin() const { return list().begin(); }
    auto end() const { return list().end(); }
    friend bool operator==(const KeyNumbers& a, const KeyNumbers& b) {
        return a.numbers_ == b.numbers_ || a.list() == b.list();
    }

  private:
    std::shared_ptr<const std::vector<double>> numbers_;
};

struct Key {
    double frame = 0;
    KeyNumbers value; ///< one number, three for a vector, 16 for a matrix, any count for a list of numbers
    std::vector<double> tangent_in = {}, tangent_out = {}; ///< value per frame; empty = automatic
    /// Edit::set_input put it in front of a frame that was sent, and it keeps what holds until there: it follows what
    /// is sent before it. A file does not say so.
    bool keeps = false;
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
