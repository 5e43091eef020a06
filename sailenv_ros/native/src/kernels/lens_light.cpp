// Light that a lens and a camera's balance weaken, pixel by pixel and colour by colour; see
// render/picture/optics.py and white_balance.py.
#include "../abi.h"
#include "../threads.h"
#include "lanes.h"
#include "pixel_pairs.h"
#include "scratch.h"

namespace {

constexpr int64_t TILE_ROWS = 8;
constexpr float GREATEST = 65504.0f;  // of half precision

// Two pixels of a row as floats; the second is 0 where there is none.
LANES_INLINE f8 two_pixels(const uint16_t* radiance, int64_t pixels) {
    if (pixels == 2) return load_halves(radiance);
    uint16_t halves[8] = {};
    memcpy(halves, radiance, 4 * sizeof halves[0]);
    return load_halves(halves);
}

// One number for each of two pixels.
LANES_INLINE f8 for_two(const float* of_pixels, int64_t pixels) {
    return sailenv::for_pair(of_pixels[0], of_pixels[pixels - 1]);
}

}  // namespace

// Sums of red, green and blue, each pixel's times its weight: row by row, so that they do not
// depend on threads. `radiance` is (height, width, 4), `weight` (height, width), `sums` (3,).
SAILENV_KERNEL(weigh_light)
(int64_t threads, int64_t height, int64_t width, const uint16_t* radiance, const float* weight,
 double* sums) {
    if (height < 0 || width < 0) return sailenv::STATUS_INVALID_ARGUMENT;
    sums[0] = sums[1] = sums[2] = 0.0;
    const auto rows = sailenv::allocate<double>(height > 0 ? 3 * height : 1);
    if (!rows) return sailenv::STATUS_OUT_OF_MEMORY;
    sailenv::parallel_for(threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t v = first; v < last; v++) {
            double even[4] = {}, odd[4] = {};
            for (int64_t u = 0; u < width; u += 2) {
                const int64_t at = v * width + u, pixels = u + 1 < width ? 2 : 1;
                const f8 light =
                    two_pixels(radiance + 4 * at, pixels) * for_two(weight + at, pixels);
                for (int c = 0; c < 4; c++) {
                    even[c] += static_cast<double>(light[c]);
                    odd[c] += static_cast<double>(light[4 + c]);
                }
            }
            for (int c = 0; c < 3; c++) rows[static_cast<size_t>(3 * v + c)] = even[c] + odd[c];
        }
    });
    for (int64_t v = 0; v < height; v++) {
        for (int c = 0; c < 3; c++) sums[c] += rows[static_cast<size_t>(3 * v + c)];
    }
    return sailenv::STATUS_OK;
}

// Light times the share of each pixel and the factor of each colour, and what arrives everywhere.
// `share` is (height, width) or null for 1, `factors` and `offsets` are (3,).
SAILENV_KERNEL(scale_light)
(int64_t threads, int64_t height, int64_t width, const uint16_t* radiance, const float* share,
 const float* factors, const float* offsets, uint16_t* out) {
    if (height < 0 || width < 0) return sailenv::STATUS_INVALID_ARGUMENT;
    const f8 times{factors[0], factors[1], factors[2], 1.0f,
                   factors[0], factors[1], factors[2], 1.0f};
    const f8 more{offsets[0], offsets[1], offsets[2], 0.0f,
                  offsets[0], offsets[1], offsets[2], 0.0f};
    sailenv::parallel_for(threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
        const auto finish = [times, more, share](int64_t at, int64_t pixels,
                                                 const uint16_t* given) {
            f8 light = load_halves(given) * times;
            if (share != nullptr) light = light * for_two(share + at, pixels);
            return to_half(clamp8(light + more, 0.0f, GREATEST));
        };
        sailenv::finish_pairs(radiance, out, first * width, last * width, finish);
    });
    return sailenv::STATUS_OK;
}
