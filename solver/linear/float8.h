// Packs of eight floats for the dense kernels of factors in single precision.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <cstring>
#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace sinew::solver {

typedef float Float8 __attribute__((vector_size(32)));

inline Float8 load8(const float* p) {
    Float8 v;
    std::memcpy(&v, p, sizeof v);
    return v;
}
inline void store8(Float8 v, float* p) { std::memcpy(p, &v, sizeof v); }

#if defined(__AVX2__) && defined(__FMA__)
/// Lanes below `count` (0…8) at one, the others at zero.
inline __m256i first_lanes(int count) {
    return _mm256_cmpgt_epi32(_mm256_set1_epi32(count), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
}
/// The first `count` numbers, and zeros; reads no others.
inline Float8 load_first(const float* p, int count) { return (Float8)_mm256_maskload_ps(p, first_lanes(count)); }
inline void store_first(Float8 v, float* p, int count) { _mm256_maskstore_ps(p, first_lanes(count), (__m256)v); }
/// a b + c, rounded once: written out, so that no compiler's choice changes bits.
inline Float8 multiply_add(Float8 a, Float8 b, Float8 c) {
    return (Float8)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
}
#else
inline Float8 load_first(const float* p, int count) {
    Float8 v{};
    for (int i = 0; i < count; ++i) v[i] = p[i];
    return v;
}
inline void store_first(Float8 v, float* p, int count) {
    for (int i = 0; i < count; ++i) p[i] = v[i];
}
inline Float8 multiply_add(Float8 a, Float8 b, Float8 c) { return a * b + c; }
#endif
/// The lanes from `first` on, and zeros before them.
inline Float8 lanes_from(Float8 v, int first) {
    typedef std::int32_t Int8 __attribute__((vector_size(32)));
    const Int8 lane = {0, 1, 2, 3, 4, 5, 6, 7};
    return (Float8)((Int8)v & (lane >= Int8{} + first));
}

#if defined(__AVX2__) && defined(__F16C__)
/// A number in 16 bits: three digits, for what is below 65,000 and of no account below 1e-7.
using Short = std::uint16_t;
inline Float8 load8(const Short* p) {
    __m128i v;
    std::memcpy(&v, p, sizeof v);
    return (Float8)_mm256_cvtph_ps(v);
}
inline void store8(Float8 v, Short* p) {
    const __m128i rounded = _mm256_cvtps_ph((__m256)v, _MM_FROUND_TO_NEAREST_INT);
    std::memcpy(p, &rounded, sizeof rounded);
}
inline float to_float(Short s) { return _cvtsh_ss(s); }
#else
/// Where processors know no numbers of 16 bits, as it is.
using Short = float;
inline float to_float(float s) { return s; }
#endif
inline Float8 all8(float s) { return Float8{s, s, s, s, s, s, s, s}; }

} // namespace sinew::solver
