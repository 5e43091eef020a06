// Vectors of eight floats or integers, and the few operations on them that kernels need.
//
// Everything here returns the same bits on every instruction set: only operations that IEEE 754
// rounds exactly are used, in one order, and nothing is contracted into fused operations
// (-ffp-contract=off). Functions are static or always inlined, so that one build can hold the same
// kernel for several instruction sets.
#pragma once

#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#define LANES_INLINE static inline __attribute__((always_inline))
#define LANES_METHOD __attribute__((always_inline))

typedef float f8 __attribute__((vector_size(32)));
typedef int32_t i8 __attribute__((vector_size(32)));
typedef float f4 __attribute__((vector_size(16)));
typedef double d4 __attribute__((vector_size(32)));
typedef int64_t l4 __attribute__((vector_size(32)));
// The same at any address.
typedef float f8_any __attribute__((vector_size(32), aligned(4), may_alias));
typedef int32_t i8_any __attribute__((vector_size(32), aligned(4), may_alias));
typedef float f4_any __attribute__((vector_size(16), aligned(4), may_alias));

#if defined(__clang__) || __GNUC__ >= 12
#define SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define SHUFFLE(a, b, ...) __builtin_shuffle(a, b, i8{__VA_ARGS__})
#endif

LANES_INLINE f8 splat(float x) { return f8{x, x, x, x, x, x, x, x}; }
LANES_INLINE i8 splat(int32_t x) { return i8{x, x, x, x, x, x, x, x}; }
LANES_INLINE f8 load(const float* p) { return *reinterpret_cast<const f8_any*>(p); }
LANES_INLINE i8 load(const int32_t* p) { return *reinterpret_cast<const i8_any*>(p); }
LANES_INLINE void store(float* p, f8 x) { *reinterpret_cast<f8_any*>(p) = x; }
LANES_INLINE void store(int32_t* p, i8 x) { *reinterpret_cast<i8_any*>(p) = x; }
LANES_INLINE f8 counting() { return f8{0, 1, 2, 3, 4, 5, 6, 7}; }

LANES_INLINE i8 bits(f8 x) {
    i8 r;
    memcpy(&r, &x, sizeof r);
    return r;
}
LANES_INLINE f8 bit_cast_float(i8 x) {
    f8 r;
    memcpy(&r, &x, sizeof r);
    return r;
}

// The smaller and the larger number; b where one is NaN.
LANES_INLINE f8 min8(f8 a, f8 b) {
#if defined(__AVX__)
    return (f8)_mm256_min_ps((__m256)a, (__m256)b);
#else
    return a < b ? a : b;
#endif
}
LANES_INLINE f8 max8(f8 a, f8 b) {
#if defined(__AVX__)
    return (f8)_mm256_max_ps((__m256)a, (__m256)b);
#else
    return a > b ? a : b;
#endif
}
LANES_INLINE f8 clamp8(f8 x, float low, float high) {
    return min8(max8(x, splat(low)), splat(high));
}
LANES_INLINE f8 sqrt8(f8 x) {
#if defined(__AVX__)
    return (f8)_mm256_sqrt_ps((__m256)x);
#elif defined(__SSE2__)
    f8 r;
    __m128 halves[2];
    memcpy(halves, &x, sizeof x);
    halves[0] = _mm_sqrt_ps(halves[0]);
    halves[1] = _mm_sqrt_ps(halves[1]);
    memcpy(&r, halves, sizeof r);
    return r;
#else
    f8 r;
    for (int k = 0; k < 8; k++) r[k] = __builtin_sqrtf(x[k]);
    return r;
#endif
}
LANES_INLINE f8 abs8(f8 x) { return bit_cast_float(bits(x) & 0x7fffffff); }
LANES_INLINE f8 negated_if(f8 x, i8 mask) {
    return bit_cast_float(bits(x) ^ (mask & static_cast<int32_t>(0x80000000u)));
}
LANES_INLINE i8 truncated(f8 x) { return __builtin_convertvector(x, i8); }
LANES_INLINE f8 to_float(i8 x) { return __builtin_convertvector(x, f8); }
// The integer part below; of numbers that fit into 32 bits.
LANES_INLINE f8 floor8(f8 x) {
#if defined(__AVX__)
    return (f8)_mm256_floor_ps((__m256)x);
#else
    const f8 t = to_float(truncated(x));
    return t > x ? t - 1.0f : t;
#endif
}
LANES_INLINE bool any(i8 mask) {
#if defined(__AVX__)
    return !_mm256_testz_si256((__m256i)mask, (__m256i)mask);
#else
    int32_t r = 0;
    for (int k = 0; k < 8; k++) r |= mask[k];
    return r != 0;
#endif
}
// One bit for each lane of a mask.
LANES_INLINE uint32_t lane_bits(i8 mask) {
#if defined(__AVX__)
    return static_cast<uint32_t>(_mm256_movemask_ps((__m256)mask));
#elif defined(__SSE2__)
    __m128 halves[2];
    memcpy(halves, &mask, sizeof mask);
    return static_cast<uint32_t>(_mm_movemask_ps(halves[0]) | _mm_movemask_ps(halves[1]) << 4);
#else
    uint32_t r = 0;
    for (int k = 0; k < 8; k++) r |= static_cast<uint32_t>(mask[k] != 0) << k;
    return r;
#endif
}
LANES_INLINE f8 mix8(f8 a, f8 b, f8 share) { return a + (b - a) * share; }

// Logarithm to base 2 of positive numbers, to 1e-4: the exponent and a quartic of the rest.
LANES_INLINE f8 log2_8(f8 x) {
    const i8 i = bits(x);
    const f8 exponent = to_float((i >> 23) - 127);
    const f8 m = bit_cast_float((i & 0x7fffff) | 0x3f800000);
    return exponent + (-1.7417939f +
                       (2.8212026f + (-1.4699568f + (0.44717955f - 0.056570851f * m) * m) * m) * m);
}
// 2 to the power of x, for -126 to 126, to 4e-6.
LANES_INLINE f8 exp2_8(f8 x) {
    x = clamp8(x, -126.0f, 126.0f);
    const f8 whole = floor8(x);
    const f8 r = x - whole;
    const f8 p =
        1.0f +
        r * (0.6931472f + r * (0.2402265f + r * (0.0555041f + r * (0.0096181f + r * 0.0013333f))));
    return bit_cast_float((truncated(whole) + 127) << 23) * p;
}

// Eight rows of eight floats to eight columns.
LANES_INLINE void transpose(f8 r[8]) {
    const f8 t0 = SHUFFLE(r[0], r[1], 0, 8, 1, 9, 4, 12, 5, 13);
    const f8 t1 = SHUFFLE(r[0], r[1], 2, 10, 3, 11, 6, 14, 7, 15);
    const f8 t2 = SHUFFLE(r[2], r[3], 0, 8, 1, 9, 4, 12, 5, 13);
    const f8 t3 = SHUFFLE(r[2], r[3], 2, 10, 3, 11, 6, 14, 7, 15);
    const f8 t4 = SHUFFLE(r[4], r[5], 0, 8, 1, 9, 4, 12, 5, 13);
    const f8 t5 = SHUFFLE(r[4], r[5], 2, 10, 3, 11, 6, 14, 7, 15);
    const f8 t6 = SHUFFLE(r[6], r[7], 0, 8, 1, 9, 4, 12, 5, 13);
    const f8 t7 = SHUFFLE(r[6], r[7], 2, 10, 3, 11, 6, 14, 7, 15);
    const f8 s0 = SHUFFLE(t0, t2, 0, 1, 8, 9, 4, 5, 12, 13);
    const f8 s1 = SHUFFLE(t0, t2, 2, 3, 10, 11, 6, 7, 14, 15);
    const f8 s2 = SHUFFLE(t1, t3, 0, 1, 8, 9, 4, 5, 12, 13);
    const f8 s3 = SHUFFLE(t1, t3, 2, 3, 10, 11, 6, 7, 14, 15);
    const f8 s4 = SHUFFLE(t4, t6, 0, 1, 8, 9, 4, 5, 12, 13);
    const f8 s5 = SHUFFLE(t4, t6, 2, 3, 10, 11, 6, 7, 14, 15);
    const f8 s6 = SHUFFLE(t5, t7, 0, 1, 8, 9, 4, 5, 12, 13);
    const f8 s7 = SHUFFLE(t5, t7, 2, 3, 10, 11, 6, 7, 14, 15);
    r[0] = SHUFFLE(s0, s4, 0, 1, 2, 3, 8, 9, 10, 11);
    r[1] = SHUFFLE(s1, s5, 0, 1, 2, 3, 8, 9, 10, 11);
    r[2] = SHUFFLE(s2, s6, 0, 1, 2, 3, 8, 9, 10, 11);
    r[3] = SHUFFLE(s3, s7, 0, 1, 2, 3, 8, 9, 10, 11);
    r[4] = SHUFFLE(s0, s4, 4, 5, 6, 7, 12, 13, 14, 15);
    r[5] = SHUFFLE(s1, s5, 4, 5, 6, 7, 12, 13, 14, 15);
    r[6] = SHUFFLE(s2, s6, 4, 5, 6, 7, 12, 13, 14, 15);
    r[7] = SHUFFLE(s3, s7, 4, 5, 6, 7, 12, 13, 14, 15);
}

// Eight numbers from every second place.
LANES_INLINE i8 every_second(const uint32_t* p) {
    const i8 low = load(reinterpret_cast<const int32_t*>(p));
    const i8 high = load(reinterpret_cast<const int32_t*>(p + 8));
    return SHUFFLE(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
}
LANES_INLINE f8 every_second(const float* p) {
    const f8 low = load(p), high = load(p + 8);
    return SHUFFLE(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
}
// Four numbers from each of two places.
LANES_INLINE f8 two_fours(const float* a, const float* b) {
    const f4 low = *reinterpret_cast<const f4_any*>(a), high = *reinterpret_cast<const f4_any*>(b);
#if defined(__AVX__)
    return (f8)_mm256_insertf128_ps(_mm256_castps128_ps256((__m128)low), (__m128)high, 1);
#else
    f8 r;
    memcpy(&r, &low, sizeof low);
    memcpy(reinterpret_cast<char*>(&r) + sizeof low, &high, sizeof high);
    return r;
#endif
}
// Eight rows of four numbers, the k-th and the one four later in `r[k]`, to four vectors.
LANES_INLINE void transpose4(const f8 (&r)[4], f8& a, f8& b, f8& c, f8& d) {
    const f8 t0 = SHUFFLE(r[0], r[1], 0, 8, 1, 9, 4, 12, 5, 13);
    const f8 t1 = SHUFFLE(r[0], r[1], 2, 10, 3, 11, 6, 14, 7, 15);
    const f8 t2 = SHUFFLE(r[2], r[3], 0, 8, 1, 9, 4, 12, 5, 13);
    const f8 t3 = SHUFFLE(r[2], r[3], 2, 10, 3, 11, 6, 14, 7, 15);
    a = SHUFFLE(t0, t2, 0, 1, 8, 9, 4, 5, 12, 13);
    b = SHUFFLE(t0, t2, 2, 3, 10, 11, 6, 7, 14, 15);
    c = SHUFFLE(t1, t3, 0, 1, 8, 9, 4, 5, 12, 13);
    d = SHUFFLE(t1, t3, 2, 3, 10, 11, 6, 7, 14, 15);
}
// The same of rows that lie side by side.
LANES_INLINE void transpose4(const float* rows, f8& a, f8& b, f8& c, f8& d) {
    f8 r[4];
    for (int k = 0; k < 4; k++) r[k] = two_fours(rows + 4 * k, rows + 4 * k + 16);
    transpose4(r, a, b, c, d);
}

// Half precision, of numbers of 0 or more that are finite there.
LANES_INLINE i8 to_half(f8 x) {
#if defined(__F16C__) && defined(__AVX2__)
    return (i8)_mm256_cvtepu16_epi32(_mm256_cvtps_ph((__m256)x, _MM_FROUND_TO_NEAREST_INT));
#else
    // To the nearest, ties to even: by the bits where the result is normal, by an addition whose
    // last place is the last of halves where it is not.
    const i8 i = bits(x);
    const i8 normal = (i - (112 << 23) + 0xfff + ((i >> 13) & 1)) >> 13;
    const i8 small = bits(x + 0.5f) - 0x3f000000;
    return i < (113 << 23) ? small : normal;
#endif
}
LANES_INLINE f8 from_half(i8 h) {
    // The bits of a half, shifted, are those of a float 2^112 times smaller.
    return bit_cast_float((h & 0x7fff) << 13) * 0x1p112f;
}
LANES_INLINE float number_of_half(uint16_t h) {
    return from_half(splat(static_cast<int32_t>(h)))[0];
}
// Eight halves that lie side by side.
LANES_INLINE f8 load_halves(const uint16_t* p) {
#if defined(__F16C__)
    return (f8)_mm256_cvtph_ps(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
#else
    i8 h;
    for (int k = 0; k < 8; k++) h[k] = p[k];
    return from_half(h);
#endif
}
// Two numbers from each of two places. Of four scalars the compiler makes four loads.
LANES_INLINE f4 two_pairs(const float* a, const float* b) {
#if defined(__SSE2__)
    const __m128 first = _mm_loadl_pi(_mm_setzero_ps(), reinterpret_cast<const __m64*>(a));
    return (f4)_mm_loadh_pi(first, reinterpret_cast<const __m64*>(b));
#else
    return f4{a[0], a[1], b[0], b[1]};
#endif
}
// Eight bytes that lie side by side.
LANES_INLINE f8 load_bytes(const void* p) {
#if defined(__AVX2__)
    return (f8)_mm256_cvtepi32_ps(
        _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p))));
#elif defined(__SSE2__)
    const __m128i zero = _mm_setzero_si128();
    const __m128i words =
        _mm_unpacklo_epi8(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)), zero);
    __m128 halves[2] = {_mm_cvtepi32_ps(_mm_unpacklo_epi16(words, zero)),
                        _mm_cvtepi32_ps(_mm_unpackhi_epi16(words, zero))};
    f8 r;
    memcpy(&r, halves, sizeof r);
    return r;
#else
    const uint8_t* b = static_cast<const uint8_t*>(p);
    f8 r;
    for (int k = 0; k < 8; k++) r[k] = b[k];
    return r;
#endif
}
