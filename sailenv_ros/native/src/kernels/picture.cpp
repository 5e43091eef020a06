// From radiance to the 8-bit picture: ambient occlusion, tone curve, sRGB; see render/tone_map.py.
#include "../abi.h"
#include "../threads.h"
#include "ambient_share.h"
#include "lanes.h"

namespace {

using sailenv::AmbientVisibility;

constexpr int64_t TILE_ROWS = 16;
constexpr int64_t CHUNK = 64;  // pixels whose factors and table indices stay in the first cache

struct Picture {
    int64_t height, width;
    const uint16_t* radiance;  // (H, W, 4), bits of halves: red, green, blue, share from around
    const float* surface;      // (H, W, 2): depth and instance id
    AmbientVisibility ambient;
    const uint8_t* table;  // (65536,): stored value of each half by its bits
};

// Share of their light that is left to neighbouring pixels of a row.
void find_factors(const Picture& p, int64_t v, int64_t first, int64_t count, float* factors) {
    const sailenv::SampleRows rows(p.ambient, v / 2);
    const float* surface = p.surface + 2 * (v * p.width + first);
    const uint16_t* radiance = p.radiance + 4 * (v * p.width + first);
    int64_t k = 0;
    for (; k + 8 <= count && (first + k) / 2 + 5 <= p.ambient.columns; k += 8) {
        store(factors + k, sailenv::arriving_factors(rows, (first + k) / 2, surface + 2 * k,
                                                     radiance + 4 * k, p.ambient.same_surface));
    }
    for (; k < count; k++) {
        const int32_t visibility =
            sailenv::arriving(rows, (first + k) / 2, surface[2 * k], p.ambient.same_surface);
        factors[k] = sailenv::arriving_factor(radiance[4 * k + 3], visibility);
    }
}

// Tells if all light arrives at neighbouring pixels of a row.
bool all_arrives(const Picture& p, int64_t v, int64_t first, int64_t count) {
    const sailenv::SampleRows rows(p.ambient, v / 2);
    const int64_t begin = first / 2, end = (first + count - 1) / 2 + 2;
    uint8_t least = 255;
    for (int64_t k = begin; k < (end < p.ambient.columns ? end : p.ambient.columns); k++) {
        least = least < rows.visibility[0][k] ? least : rows.visibility[0][k];
        least = least < rows.visibility[1][k] ? least : rows.visibility[1][k];
    }
    return least == 255;
}

// The light of a chunk less what does not arrive, as bits of halves (4 a pixel).
void scale_chunk(const Picture& p, int64_t v, int64_t first, int64_t count, uint16_t* out) {
    float factors[CHUNK + 8];
    find_factors(p, v, first, count, factors);
    const uint16_t* radiance = p.radiance + 4 * (v * p.width + first);
    int64_t k = 0;
    for (; k + 2 <= count; k += 2) {
        const float a = factors[k], b = factors[k + 1];
        const i8 light = sailenv::load_half_bits(radiance + 4 * k);
        const f8 left = bit_cast_float(light << 13) * f8{a, a, a, 1.0f, b, b, b, 1.0f};
        sailenv::store_half_bits(out + 4 * k, (bits(left) + 4096) >> 13);
    }
    if (k < count) {
        for (int c = 0; c < 3; c++) {
            const float left = sailenv::small_number(radiance[4 * k + c]) * factors[k];
            int32_t shifted;
            memcpy(&shifted, &left, sizeof shifted);
            out[4 * k + c] = static_cast<uint16_t>((shifted + 4096) >> 13);
        }
    }
}

// Writes stored values.
void tone_map_row(const Picture& p, int64_t v, uint8_t* rgb) {
    uint16_t scratch[4 * CHUNK];
    for (int64_t first = 0; first < p.width; first += CHUNK) {
        const int64_t count = first + CHUNK < p.width ? CHUNK : p.width - first;
        const uint16_t* light = p.radiance + 4 * (v * p.width + first);
        if (p.ambient.visibility != nullptr && !all_arrives(p, v, first, count)) {
            scale_chunk(p, v, first, count, scratch);
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
