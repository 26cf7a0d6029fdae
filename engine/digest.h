// 128-bit content digests: stable over processes and platforms, not cryptographic.
// Owns the canonical byte rules: little-endian, length-prefixed strings, -0.0 folded to 0.0.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sinew::engine {

struct Digest {
    std::uint64_t hi = 0, lo = 0;
    friend auto operator<=>(const Digest&, const Digest&) = default;
    /// 32 lower-case hexadecimal digits.
    std::string hex() const;
};

struct DigestHash {
    std::size_t operator()(const Digest& d) const {
        return static_cast<std::size_t>(d.hi ^ (d.lo * 0x9e3779b97f4a7c15ull));
    }
};

/// Collects bytes into a Digest. Every `add` is self-delimiting, so ("ab","c") and ("a","bc") differ.
class Hasher {
  public:
    Hasher();
    Hasher& add(std::uint64_t v);
    Hasher& add(std::int64_t v) { return add(static_cast<std::uint64_t>(v)); }
    Hasher& add(int v) { return add(static_cast<std::int64_t>(v)); }
    Hasher& add(bool v) { return add(static_cast<std::uint64_t>(v)); }
    /// NaN is hashed by its canonical form; -0.0 equals 0.0.
    Hasher& add(double v);
    Hasher& add(std::string_view text);
    Hasher& add(const char* text) { return add(std::string_view(text)); }
    Hasher& add(const Digest& d);
    Hasher& add_doubles(std::span<const double> values);
    Hasher& add_ints(std::span<const int> values);
    /// Raw bytes, length first.
    Hasher& add_bytes(std::span<const std::byte> bytes);
    Digest finish() const;

  private:
    std::uint64_t a_, b_;
};

} // namespace sinew::engine
