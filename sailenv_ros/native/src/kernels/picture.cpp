// From radiance to the 8-bit picture: ambient occlusion, tone curve, sRGB; see render/tone_map.py.
#include "../abi.h"
#include "../threads.h"
#include "ambient_share.h"
#include "lanes.h"

namespace {

using sailenv::AmbientVisibility;

constexpr int64_t TILE_ROWS = 16;

struct Picture {
    int64_t height, width;
    const uint16_t* radiance;  // (H, W, 4), bits of halves: red, green, blue, share from around
    const float* surface;      // (H, W, 2): depth and instance id
    AmbientVisibility ambient;
    const uint8_t* table;  // (65536,): stored value of each half by its bits
};

// Writes stored values.
void tone_map_row(const Picture& p, int64_t v, uint8_t* rgb) {
    constexpr int64_t chunk = sailenv::DARKENED;
    uint16_t scratch[4 * chunk];
    for (int64_t first = 0; first < p.width; first += chunk) {
        const int64_t count = first + chunk < p.width ? chunk : p.width - first;
        const int64_t at = v * p.width + first;
        const uint16_t* light = p.radiance + 4 * at;
        if (p.ambient.visibility != nullptr && !sailenv::all_arrives(p.ambient, v, first, count)) {
            sailenv::darken(p.ambient, v, first, count, p.surface + 2 * at, light, scratch);
            light = scratch;
        }
        uint8_t* out = rgb + 3 * first;
        for (int64_t k = 0; k < count; k++) {
            for (int c = 0; c < 3; c++) out[3 * k + c] = p.table[light[4 * k + c]];
        }
    }
}

}  // namespace

// `visibility` may be null, and then `inverse` and `surface` too. `rgb` is (height, width, 3).
SAILENV_KERNEL(make_picture)
(int64_t threads, int64_t height, int64_t width, const uint16_t* radiance, const uint8_t* table,
 const uint8_t* visibility, const float* inverse, const float* surface, double same_surface,
 uint8_t* rgb) {
    if (height < 0 || width < 0) return sailenv::STATUS_INVALID_ARGUMENT;
    const AmbientVisibility ambient{visibility, inverse, (height + 1) / 2, (width + 1) / 2,
                                    static_cast<float>(same_surface)};
    const Picture picture{height, width, radiance, surface, ambient, table};
    sailenv::parallel_for(threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t v = first; v < last; v++) {
            tone_map_row(picture, v, rgb + 3 * v * width);
        }
    });
    return sailenv::STATUS_OK;
}
