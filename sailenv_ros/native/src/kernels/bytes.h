// Vectors of sixteen bytes, and the few operations on them that kernels need.
#pragma once

#include "lanes.h"

typedef uint8_t b16 __attribute__((vector_size(16)));

LANES_INLINE b16 splat16(uint8_t x) { return b16{} + x; }
LANES_INLINE b16 load16(const uint8_t* p) {
    b16 r;
    memcpy(&r, p, sizeof r);
    return r;
}
LANES_INLINE b16 max16(b16 a, b16 b) {
#if defined(__SSE2__)
    return (b16)_mm_max_epu8((__m128i)a, (__m128i)b);
#else
    return a > b ? a : b;
#endif
}
LANES_INLINE b16 min16(b16 a, b16 b) {
#if defined(__SSE2__)
    return (b16)_mm_min_epu8((__m128i)a, (__m128i)b);
#else
    return a < b ? a : b;
#endif
}
LANES_INLINE b16 distance16(b16 a, b16 b) { return max16(a, b) - min16(a, b); }

// The bytes of two vectors in turn: of their first halves, of their second halves.
LANES_INLINE b16 first_halves(b16 a, b16 b) {
    return SHUFFLE(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
}
LANES_INLINE b16 second_halves(b16 a, b16 b) {
    return SHUFFLE(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
}

// Sixteen rows of sixteen bytes to sixteen columns.
LANES_INLINE void transpose16(b16 rows[16]) {
    for (int stage = 0; stage < 4; stage++) {
        b16 next[16];
        for (int k = 0; k < 8; k++) {
            next[2 * k] = first_halves(rows[k], rows[k + 8]);
            next[2 * k + 1] = second_halves(rows[k], rows[k + 8]);
        }
        memcpy(rows, next, sizeof next);
    }
}

// One bit for each byte of a mask, whose bytes are 0 or 255.
template <class Mask>
LANES_INLINE uint32_t mask16(Mask mask) {
#if defined(__SSE2__)
    return static_cast<uint32_t>(_mm_movemask_epi8((__m128i)mask));
#else
    uint32_t r = 0;
    for (int k = 0; k < 16; k++) r |= static_cast<uint32_t>(mask[k] & 1) << k;
    return r;
#endif
}
