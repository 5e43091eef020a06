// Reading mip chains, light maps and other pictures, eight pixels at a time.
#pragma once

#include "lanes.h"
#include "render_types.h"

namespace sailenv {

// One white texel, as a texture.
alignas(16) static const uint32_t WHITE_TEXELS[4] = {~0u, ~0u, ~0u, ~0u};

// Where bilinear look-ups in one mip level begin: texels of two rows, and shares.
struct Taps {
    i8 upper, lower;
    f8 across, down;
};

// Level of detail: `ux` and so forth are the changes of uv from pixel to pixel, `log2_size` the
// texture's size. 0 is the finest level.
LANES_INLINE f8 level_of_detail(f8 ux, f8 vx, f8 uy, f8 vy, i8 log2_size, float bias) {
    const f8 size = bit_cast_float((log2_size + 127) << 23);
    const f8 longest = max8(ux * ux + vx * vx, uy * uy + vy * vy) * size * size;
    const f8 level = 0.5f * log2_8(min8(max8(longest, splat(1e-12f)), splat(1e30f))) + bias;
    return min8(max8(level, splat(0.0f)), to_float(log2_size));
}

LANES_INLINE Taps texture_taps(f8 u, f8 v, i8 log2_size, i8 level) {
    const i8 exponent = log2_size - level;
    // Of 2^n: the bits of such floats are cheaper than shifts by lanes.
    const f8 size = bit_cast_float((exponent + 127) << 23),
             finest = bit_cast_float((log2_size + 127) << 23);
    const i8 edge = truncated(size), mask = edge - 1;
    // The levels before this one hold the sum of s (s + 1) texels.
    const f8 squares = (finest * finest - size * size) * (4.0f / 3.0f);
    const i8 before = truncated(squares + 2.0f * (finest - size) + 0.5f);
    const f8 x = clamp8(u, -1e4f, 1e4f) * size - 0.5f, y = clamp8(v, -1e4f, 1e4f) * size - 0.5f;
    const f8 left = floor8(x), top = floor8(y);
    const i8 ix = truncated(left) & mask, iy = truncated(top);
    const i8 row = edge + 1;
    return {before + (iy & mask) * row + ix, before + ((iy + 1) & mask) * row + ix, x - left,
            y - top};
}

// Look-ups in the two mip levels about a level of detail, and the share of the coarser one.
struct MipTaps {
    Taps near, far;
    f8 share;
};

LANES_INLINE MipTaps mip_taps(f8 u, f8 v, i8 log2_size, f8 level) {
    const i8 fine = truncated(level);
    const i8 coarse = fine < log2_size ? fine + 1 : fine;
    return {texture_taps(u, v, log2_size, fine), texture_taps(u, v, log2_size, coarse),
            level - to_float(fine)};
}

LANES_INLINE f4 bilinear(f8 upper, f8 lower, float across, float down) {
    const float near = 1.0f - across;
    const f8 weights = {near, near, near, near, across, across, across, across};
    const f8 r = (upper + (lower - upper) * down) * weights;
#if defined(__AVX__)
    return (f4)_mm_add_ps(_mm256_castps256_ps128((__m256)r), _mm256_extractf128_ps((__m256)r, 1));
#else
    f4 halves[2];
    memcpy(halves, &r, sizeof r);
    return halves[0] + halves[1];
#endif
}
LANES_INLINE f4 sample_bytes(const uint32_t* texels, int32_t upper, int32_t lower, float across,
                             float down) {
    return bilinear(load_bytes(texels + upper), load_bytes(texels + lower), across, down);
}
LANES_INLINE f4 sample_halves(const uint16_t* upper, const uint16_t* lower, float across,
                              float down) {
    return bilinear(load_halves(upper), load_halves(lower), across, down);
}

}  // namespace sailenv
