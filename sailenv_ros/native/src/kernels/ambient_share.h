// Which share of a pixel's light arrives, from the ambient visibility at half resolution.
#pragma once

#include "lanes.h"

namespace sailenv {

struct AmbientVisibility {
    const uint8_t* visibility;  // (rows, columns): 255 = all of it; null where all arrives
    const float* inverse;       // (rows, columns): 1 / depth, of either sign
    int64_t rows, columns;
    float same_surface;  // share of its depth by which a sample may lie off a pixel's own surface
};

// The four samples around a pixel, the nearest first: it is the first that lies on the pixel's
// surface that counts. Where none does all light arrives.
struct SampleRows {
    const float* inverse[2];
    const uint8_t* visibility[2];
    int64_t last;

    SampleRows(const AmbientVisibility& of, int64_t row) {
        const int64_t below = row + 1 < of.rows ? row + 1 : of.rows - 1;
        inverse[0] = of.inverse + row * of.columns;
        inverse[1] = of.inverse + below * of.columns;
        visibility[0] = of.visibility + row * of.columns;
        visibility[1] = of.visibility + below * of.columns;
        last = of.columns - 1;
    }
};

// 255 = all of it, of a point at depth z [m].
LANES_INLINE int32_t arriving(const SampleRows& rows, int64_t column, float z, float same_surface) {
    const int64_t columns[2] = {column, column + 1 < rows.last ? column + 1 : rows.last};
    for (int row = 0; row < 2; row++) {
        for (const int64_t at : columns) {
            const float off = __builtin_fabsf(rows.inverse[row][at]) * z - 1.0f;
            if (__builtin_fabsf(off) <= same_surface) return rows.visibility[row][at];
        }
    }
    return 255;
}

// A half of 0 or more by its bits, 2^112 times smaller.
LANES_INLINE float small_number(uint16_t half) {
    const int32_t shifted = static_cast<int32_t>(half) << 13;
    float r;
    memcpy(&r, &shifted, sizeof r);
    return r;
}

// The share of its light that is left to a point of which `ambient` (bits of a half) came from
// around.
LANES_INLINE float arriving_factor(uint16_t ambient, int32_t visibility) {
    const float share = small_number(ambient) * 0x1p112f;
    const float closed = static_cast<float>(255 - visibility) * (1.0f / 255.0f);
    return 1.0f - (share < 1.0f ? share : 1.0f) * closed;
}

typedef uint16_t u8_any __attribute__((vector_size(16), aligned(2), may_alias));

// Eight halves by their bits.
LANES_INLINE i8 load_half_bits(const uint16_t* p) {
    return __builtin_convertvector(*reinterpret_cast<const u8_any*>(p), i8);
}
LANES_INLINE void store_half_bits(uint16_t* p, i8 x) {
    *reinterpret_cast<u8_any*>(p) = __builtin_convertvector(x, u8_any);
}

// Four samples, each for two neighbouring pixels.
LANES_INLINE f8 load_twice(const float* p) {
    const f8 four = {p[0], p[1], p[2], p[3]};
    return SHUFFLE(four, four, 0, 0, 1, 1, 2, 2, 3, 3);
}

// `arriving_factor` of eight pixels of a row from an even one on, with `column` samples before it;
// `surface` has two numbers a pixel, `radiance` four. Five samples are read.
LANES_INLINE f8 arriving_factors(const SampleRows& rows, int64_t column, const float* surface,
                                 const uint16_t* radiance, float same_surface) {
    const f8 low = load(surface), high = load(surface + 8);
    const f8 z = SHUFFLE(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
    i8 missing = ~i8{};
    f8 visibility = splat(255.0f);
    for (int sample = 0; sample < 4; sample++) {
        const int row = sample / 2;
        const int64_t at = column + sample % 2;
        const f8 off = abs8(load_twice(rows.inverse[row] + at)) * z - 1.0f;
        const i8 found = missing & (abs8(off) <= same_surface);
        const uint8_t* bytes = rows.visibility[row] + at;
        f8 four = {float(bytes[0]), float(bytes[1]), float(bytes[2]), float(bytes[3])};
        visibility = found ? SHUFFLE(four, four, 0, 0, 1, 1, 2, 2, 3, 3) : visibility;
        missing = missing & ~found;
        if (!any(missing)) break;
    }
    i8 halves;
    for (int k = 0; k < 8; k++) halves[k] = radiance[4 * k + 3];
    const f8 share = bit_cast_float(halves << 13) * 0x1p112f;
    const f8 closed = (255.0f - visibility) * (1.0f / 255.0f);
    return 1.0f - (share < 1.0f ? share : splat(1.0f)) * closed;
}

}  // namespace sailenv
