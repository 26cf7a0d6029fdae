// The 128-bit mix: two 64-bit lanes that feed each other. Each absorbed word changes the pair of lanes by a
// bijection, so two inputs that differ in one word can never meet again through that word alone.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/digest.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace sinew::engine {

namespace {

// Odd constants from the fractional digits of the golden ratio and of the square roots of 3, 5 and 7.
constexpr std::uint64_t c1 = 0x9e3779b97f4a7c15ull;
constexpr std::uint64_t c2 = 0xbb67ae8584caa73bull;
constexpr std::uint64_t c3 = 0x3c6ef372fe94f82bull;
constexpr std::uint64_t c4 = 0xa54ff53a5f1d36f1ull;

void absorb(std::uint64_t& a, std::uint64_t& b, std::uint64_t word) {
    std::uint64_t w = word * c1;
    w ^= w >> 32;
    a = std::rotl(a ^ w, 27) * c2 + b;
    b = std::rotl(b ^ (word * c4), 41) * c3 + a;
}

std::uint64_t avalanche(std::uint64_t x) {
    x ^= x >> 32;
    x *= c2;
    x ^= x >> 29;
    x *= c4;
    x ^= x >> 32;
    return x;
}

std::uint64_t little_endian(std::uint64_t v) {
    if constexpr (std::endian::native == std::endian::big) return __builtin_bswap64(v);
    return v;
}

std::uint64_t canonical_bits(double v) {
    if (v == 0) v = 0; // -0.0 and 0.0 are one number to every consumer
    if (std::isnan(v)) v = std::numeric_limits<double>::quiet_NaN();
    return std::bit_cast<std::uint64_t>(v);
}

void absorb_bytes(std::uint64_t& a, std::uint64_t& b, const void* data, std::size_t count) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    absorb(a, b, count);
    for (; count >= 8; bytes += 8, count -= 8) {
        std::uint64_t word;
        std::memcpy(&word, bytes, 8);
        absorb(a, b, little_endian(word));
    }
    if (count == 0) return;
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, count);
    absorb(a, b, little_endian(word));
}

} // namespace

std::string Digest::hex() const {
    static constexpr char digits[] = "0123456789abcdef";
    std::string out(32, '0');
    for (int i = 0; i < 16; ++i) {
        out[static_cast<std::size_t>(15 - i)] = digits[(hi >> (4 * i)) & 15];
        out[static_cast<std::size_t>(31 - i)] = digits[(lo >> (4 * i)) & 15];
    }
    return out;
}

Hasher::Hasher()
    : a_(c3)
    , b_(c4) {}

Hasher& Hasher::add(std::uint64_t v) {
    absorb(a_, b_, v);
    return *this;
}

Hasher& Hasher::add(double v) { return add(canonical_bits(v)); }

Hasher& Hasher::add(std::string_view text) {
    absorb_bytes(a_, b_, text.data(), text.size());
    return *this;
}

Hasher& Hasher::add(const Digest& d) {
    absorb(a_, b_, d.hi);
    absorb(a_, b_, d.lo);
    return *this;
}

Hasher& Hasher::add_doubles(std::span<const double> values) {
    absorb(a_, b_, values.size());
    for (double v : values) absorb(a_, b_, canonical_bits(v));
    return *this;
}

Hasher& Hasher::add_ints(std::span<const int> values) {
    absorb(a_, b_, values.size());
    std::size_t i = 0;
    for (; i + 2 <= values.size(); i += 2)
        absorb(a_, b_,
               static_cast<std::uint32_t>(values[i]) |
                   static_cast<std::uint64_t>(static_cast<std::uint32_t>(values[i + 1])) << 32);
    if (i < values.size()) absorb(a_, b_, static_cast<std::uint32_t>(values[i]));
    return *this;
}

Hasher& Hasher::add_bytes(std::span<const std::byte> bytes) {
    absorb_bytes(a_, b_, bytes.data(), bytes.size());
    return *this;
}

Digest Hasher::finish() const {
    std::uint64_t a = a_ + b_, b = b_;
    a = avalanche(a);
    b = avalanche(b + a);
    return {a + b, b};
}

} // namespace sinew::engine
