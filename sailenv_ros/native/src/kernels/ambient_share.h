// Which share of a pixel's light arrives, from the ambient visibility at half resolution.
#pragma once

#include "lanes.h"
#include "pixel_pairs.h"

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

// Eight halves by their bits.
LANES_INLINE i8 load_half_bits(const uint16_t* p) {
    return __builtin_convertvector(*reinterpret_cast<const u8_any*>(p), i8);
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

// Tells if all light arrives at neighbouring pixels of row `v`.
inline bool all_arrives(const AmbientVisibility& ambient, int64_t v, int64_t first, int64_t count) {
    const SampleRows rows(ambient, v / 2);
    const int64_t begin = first / 2, end = (first + count - 1) / 2 + 2;
    uint8_t least = 255;
    for (int64_t k = begin; k < (end < ambient.columns ? end : ambient.columns); k++) {
        least = least < rows.visibility[0][k] ? least : rows.visibility[0][k];
        least = least < rows.visibility[1][k] ? least : rows.visibility[1][k];
    }
    return least == 255;
}

// The light of up to `DARKENED` neighbouring pixels of row `v` less what does not arrive, as bits
// of halves (4 a pixel; the fourth are kept). Arrays begin at the first pixel.
constexpr int64_t DARKENED = 64;

inline void darken(const AmbientVisibility& ambient, int64_t v, int64_t first, int64_t count,
                   const float* surface, const uint16_t* radiance, uint16_t* out) {
    float factors[DARKENED + 8] = {};
    const SampleRows rows(ambient, v / 2);
    int64_t k = 0;
    for (; k + 8 <= count && (first + k) / 2 + 5 <= ambient.columns; k += 8) {
        store(factors + k, arriving_factors(rows, (first + k) / 2, surface + 2 * k,
                                            radiance + 4 * k, ambient.same_surface));
    }
    for (; k < count; k++) {
        const int32_t visibility =
            arriving(rows, (first + k) / 2, surface[2 * k], ambient.same_surface);
        factors[k] = arriving_factor(radiance[4 * k + 3], visibility);
    }
    finish_pairs(radiance, out, 0, count, [&factors](int64_t at, int64_t, const uint16_t* given) {
        const f8 light = bit_cast_float(load_half_bits(given) << 13);
        return (bits(light * for_pair(factors[at], factors[at + 1])) + 4096) >> 13;
    });
}

}  // namespace sailenv
