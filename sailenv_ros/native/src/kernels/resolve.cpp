// From several samples a pixel to one, and from a pixel's light to what of it arrives; see
// render/supersampling.py and render/tone_map.py. Works on bits of halves of 0 or more, whose value
// as shifted floats is 2^112 times smaller.
#include "../abi.h"
#include "../threads.h"
#include "ambient_share.h"

namespace {

constexpr int64_t TILE_ROWS = 8;

LANES_INLINE uint16_t half_bits(float small) {
    int32_t shifted;
    memcpy(&shifted, &small, sizeof shifted);
    return static_cast<uint16_t>((shifted + 4096) >> 13);
}

}  // namespace

// `samples` is (times height, times width, 4), `surface` (times height, times width, 2);
// `visibility` (of the pixels, at half resolution) may be null, and then `inverse` and `surface`
// too. `out` is (height, width, 4). With `keeps_share` the fourth number is kept (of one sample a
// pixel), else it is 0.
SAILENV_KERNEL(resolve)
(int64_t threads, int64_t height, int64_t width, int64_t times, const uint16_t* samples,
 const uint8_t* visibility, const float* inverse, const float* surface, double same_surface,
 int64_t keeps_share, uint16_t* out) {
    if (height < 0 || width < 0 || times < 1 || (keeps_share != 0 && times != 1)) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    const sailenv::AmbientVisibility ambient{visibility, inverse, (height + 1) / 2, (width + 1) / 2,
                                             static_cast<float>(same_surface)};
    const float part = static_cast<float>(1.0 / static_cast<double>(times * times));
    const auto resolve_row = [&](int64_t v) {
        const sailenv::SampleRows rows(ambient, visibility != nullptr ? v / 2 : 0);
        for (int64_t u = 0; u < width; u++) {
            f4 sum = {0.0f, 0.0f, 0.0f, 0.0f};
            for (int64_t i = 0; i < times; i++) {
                const int64_t at = (v * times + i) * width * times + u * times;
                for (int64_t j = at; j < at + times; j++) {
                    const uint16_t* sample = samples + 4 * j;
                    float weight = part;
                    if (visibility != nullptr) {
                        const int32_t arrives =
                            sailenv::arriving(rows, u / 2, surface[2 * j], ambient.same_surface);
                        weight *= sailenv::arriving_factor(sample[3], arrives);
                    }
                    const f4 light = {sailenv::small_number(sample[0]),
                                      sailenv::small_number(sample[1]),
                                      sailenv::small_number(sample[2]), 0.0f};
                    sum = sum + weight * light;
                }
            }
            uint16_t* pixel = out + 4 * (v * width + u);
            for (int c = 0; c < 3; c++) pixel[c] = half_bits(sum[c]);
            pixel[3] = keeps_share != 0 ? samples[4 * (v * width + u) + 3] : uint16_t{0};
        }
    };
    const bool darkens = times == 1 && visibility != nullptr && keeps_share != 0;
    sailenv::parallel_for(threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t v = first; v < last; v++) {
            for (int64_t u = 0; darkens && u < width; u += sailenv::DARKENED) {
                const int64_t at = v * width + u;
                const int64_t count = u + sailenv::DARKENED < width ? sailenv::DARKENED : width - u;
                sailenv::darken(ambient, v, u, count, surface + 2 * at, samples + 4 * at,
                                out + 4 * at);
            }
            if (!darkens) resolve_row(v);
        }
    });
    return sailenv::STATUS_OK;
}
