// A chain of XXH3's 128 bits (the library xxHash): each word, and the hash of each list or text with its count, is
// hashed behind what the chain has come to. So a hasher is 16 bytes, and long lists go through at XXH3's speed.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/digest.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

// Compiled in, so that it uses what the processor has and programs that link Sinew need no further library.
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace sinew::engine {

namespace {

static_assert(std::endian::native == std::endian::little,
              "what is hashed are little-endian words, as they lie in memory");

/// What a chain begins with: XXH3 of no bytes.
constexpr std::uint64_t start_hi = 0x99aa06d3014798d8ull, start_lo = 0x6001c324468d497full;

void hash_behind(std::uint64_t& hi, std::uint64_t& lo, std::span<const std::uint64_t> words) {
    std::uint64_t all[5] = {hi, lo};
    std::copy(words.begin(), words.end(), all + 2);
    const XXH128_hash_t h = XXH3_128bits(all, (2 + words.size()) * sizeof(std::uint64_t));
    hi = h.high64, lo = h.low64;
}

/// Lists and texts: five words, so that none is taken for single words.
void hash_list_behind(std::uint64_t& hi, std::uint64_t& lo, std::uint64_t count, const XXH128_hash_t& list) {
    const std::uint64_t words[] = {count, list.high64, list.low64};
    hash_behind(hi, lo, words);
}

double canonical(double v) {
    if (v == 0) v = 0; // -0.0 and 0.0 are one number to every consumer
    return std::isnan(v) ? std::numeric_limits<double>::quiet_NaN() : v;
}

XXH128_hash_t hash_canonical(std::span<const double> values) {
    double block[512]; // 4 KB: stays in the fastest cache
    const auto fill = [&](std::span<const double> part) {
        std::transform(part.begin(), part.end(), block, canonical);
        return part.size_bytes();
    };
    if (values.size() <= std::size(block)) return XXH3_128bits(block, fill(values));
    XXH3_state_t state;
    XXH3_128bits_reset(&state);
    for (std::size_t at = 0; at < values.size(); at += std::size(block))
        XXH3_128bits_update(&state, block, fill(values.subspan(at, std::min(values.size() - at, std::size(block)))));
    return XXH3_128bits_digest(&state);
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
    : a_(start_hi)
    , b_(start_lo) {}

Hasher& Hasher::add(std::uint64_t v) {
    hash_behind(a_, b_, {&v, 1});
    return *this;
}

Hasher& Hasher::add(double v) { return add(std::bit_cast<std::uint64_t>(canonical(v))); }

Hasher& Hasher::add(std::string_view text) { return add_bytes(std::as_bytes(std::span(text))); }

Hasher& Hasher::add(const Digest& d) {
    const std::uint64_t words[] = {d.hi, d.lo};
    hash_behind(a_, b_, words);
    return *this;
}

Hasher& Hasher::add_doubles(std::span<const double> values) {
    hash_list_behind(a_, b_, values.size(), hash_canonical(values));
    return *this;
}

Hasher& Hasher::add_ints(std::span<const int> values) {
    static_assert(sizeof(int) == 4);
    hash_list_behind(a_, b_, values.size(), XXH3_128bits(values.data(), values.size_bytes()));
    return *this;
}

Hasher& Hasher::add_bytes(std::span<const std::byte> bytes) {
    hash_list_behind(a_, b_, bytes.size(), XXH3_128bits(bytes.data(), bytes.size()));
    return *this;
}

Digest Hasher::finish() const { return {a_, b_}; }

} // namespace sinew::engine
