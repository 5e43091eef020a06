// Pictures of four halves a pixel, two pixels at a time.
#pragma once

#include "lanes.h"

namespace sailenv {

typedef uint16_t u8_any __attribute__((vector_size(16), aligned(2), may_alias));

// One number for each of two pixels. Of eight scalars side by side GCC makes stores and a load that
// waits for them.
LANES_INLINE f8 for_pair(float a, float b) {
#if defined(__AVX__)
    return (f8)_mm256_insertf128_ps(_mm256_set1_ps(a), _mm_set1_ps(b), 1);
#else
    return f8{a, a, a, a, b, b, b, b};
#endif
}

// Writes the bits of eight halves; the fourth numbers of both pixels stay as they were given.
LANES_INLINE void store_pair(uint16_t* made, i8 halves, const uint16_t* given) {
    const u8_any fourth = {0, 0, 0, 0xffff, 0, 0, 0, 0xffff};
    const u8_any kept = *reinterpret_cast<const u8_any*>(given);
    const u8_any found = __builtin_convertvector(halves, u8_any);
    *reinterpret_cast<u8_any*>(made) = (found & ~fourth) | (kept & fourth);
}

// `finish(at, pixels, given)` returns the bits of two pixels from the eight halves of these; of the
// last pixel alone, with four zeros after it, where `pixels` is 1.
template <class Finish>
void finish_pairs(const uint16_t* given, uint16_t* made, int64_t begin, int64_t end,
                  const Finish& finish) {
    int64_t at = begin;
    for (; at + 1 < end; at += 2) {
        store_pair(made + 4 * at, finish(at, 2, given + 4 * at), given + 4 * at);
    }
    if (at >= end) return;
    uint16_t last[8] = {}, out[8];
    memcpy(last, given + 4 * at, 8);
    store_pair(out, finish(at, 1, last), last);
    memcpy(made + 4 * at, out, 8);
}

}  // namespace sailenv
