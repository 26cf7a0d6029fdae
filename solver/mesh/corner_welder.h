// Corners at exactly the same place become one vertex; for file formats that repeat vertices.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <array>
#include <bit>
#include <cstdint>
#include <unordered_map>

namespace sinew::solver {

/// Vertices in the order in which they first appear.
class CornerWelder {
  public:
    int add(const Vec3& p) {
        const Vec3 key = p + Vec3::Zero(); // -0 becomes +0
        const auto [entry, is_new] = numbers_.try_emplace({key[0], key[1], key[2]}, static_cast<int>(points.size()));
        if (is_new) points.push_back(key);
        return entry->second;
    }
    Points points;

  private:
    using Key = std::array<double, 3>;
    struct Hash {
        std::size_t operator()(const Key& k) const {
            std::uint64_t h = 0;
            for (double x : k) h = (h ^ std::bit_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15ull, h ^= h >> 29;
            return static_cast<std::size_t>(h);
        }
    };
    std::unordered_map<Key, int, Hash> numbers_;
};

} // namespace sinew::solver
