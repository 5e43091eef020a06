// What was found at patches, averaged and spread over texels; see relight/relighting.py.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "../abi.h"
#include "../threads.h"
#include "lanes.h"
#include "light_sampling.h"

namespace sailenv {
namespace {

// Which tiles of 4 x 4 texels lie up to `radius` tiles from a patch where something was found.
class FoundTiles {
public:
    FoundTiles(int64_t side, int64_t patches, const float* places, const uint8_t* found,
               int64_t radius)
        : tiles_((side + 3) / 4), marks_(static_cast<size_t>(tiles_ * tiles_), 0) {
        for (int64_t q = 0; q < patches; q++) {
            if (found[q] == 0) continue;
            if (!(places[2 * q] >= 0.0f) || !(places[2 * q + 1] >= 0.0f)) continue;
            const int64_t x = static_cast<int64_t>(std::min(places[2 * q], 65536.0f)) / 4;
            const int64_t y = static_cast<int64_t>(std::min(places[2 * q + 1], 65536.0f)) / 4;
            const int64_t last = std::min(x + radius, tiles_ - 1);
            for (int64_t ty = std::max<int64_t>(y - radius, 0);
                 ty <= std::min(y + radius, tiles_ - 1); ty++) {
                for (int64_t tx = std::max<int64_t>(x - radius, 0); tx <= last; tx++) {
                    marks_[static_cast<size_t>(ty * tiles_ + tx)] = 1;
                }
            }
        }
    }

    // Whether the tile of a texel, in the map, is one of them.
    bool has(int64_t x, int64_t y) const {
        if (x < 0 || y < 0 || x / 4 >= tiles_ || y / 4 >= tiles_) return false;
        return marks_[static_cast<size_t>(y / 4 * tiles_ + x / 4)] != 0;
    }

private:
    int64_t tiles_;
    std::vector<uint8_t> marks_;
};

// Null where there is no memory.
std::unique_ptr<FoundTiles> found_tiles(int64_t side, int64_t patches, const float* places,
                                        const uint8_t* found, int64_t radius) {
    try {
        return std::make_unique<FoundTiles>(side, patches, places, found, radius);
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}

}  // namespace
}  // namespace sailenv

// Spreads what was found at patches over the texels between them.
//
// places: (count,), of the texels in the map; patch_places: (patches, 2), x and y of each patch's
// middle texel. found, change: of the patches, as gather_change gives them. Result: into `texels`,
// halves of the map's first texel by channel, of which one texel's follow `steps` after another's.
SAILENV_KERNEL(spread_change)
(int64_t threads, int64_t side, int64_t count, const int32_t* places, const float* positions,
 const float* normals, const int32_t* owners, int64_t patches, const int32_t* patch_of,
 const float* patch_places, const float* patch_positions, const float* patch_normals,
 const int32_t* patch_owners, const uint8_t* found, int64_t channels, const float* change,
 uint16_t* const* texels, const int64_t* steps) {
    using namespace sailenv;
    if (side < 1 || side > 65536 || count < 0 || patches < 1 || channels < 1) {
        return STATUS_INVALID_ARGUMENT;
    }
    const std::unique_ptr<FoundTiles> tiles = found_tiles(side, patches, patch_places, found, 1);
    if (!tiles) return STATUS_OUT_OF_MEMORY;
    parallel_for(threads, count, 1024, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            const int64_t place = places[k];
            if (place < 0 || place >= side * side) continue;
            const int32_t x = static_cast<int32_t>(place % side);
            const int32_t y = static_cast<int32_t>(place / side);
            if (!tiles->has(x, y)) continue;
            const float *p = positions + 3 * k, *n = normals + 3 * k;
            int32_t near[10];
            float weight[10], total = 0.0f;
            int count_near = 0;
            bool touched = false;
            for (int dy = -4; dy <= 4; dy += 4) {
                for (int dx = -4; dx <= 4; dx += 4) {
                    const int32_t tx = x + dx, ty = y + dy;
                    if (tx < 0 || ty < 0 || tx >= side || ty >= side) continue;
                    const int32_t q = patch_of[ty * side + tx];
                    if (q < 0 || q >= patches || patch_owners[q] != owners[k]) continue;
                    if (found[q] == 3) continue;  // knows nothing
                    bool known = false;
                    for (int j = 0; j < count_near; j++) known |= near[j] == q;
                    if (known) continue;
                    const float* pn = patch_normals + 3 * static_cast<int64_t>(q);
                    const float* pp = patch_positions + 3 * static_cast<int64_t>(q);
                    const float alike = dot(pn, n);
                    const float step[3] = {pp[0] - p[0], pp[1] - p[1], pp[2] - p[2]};
                    const float far2 = dot(step, step), off = dot(step, n);
                    const bool own = dx == 0 && dy == 0;
                    if (!own && (alike < 0.7f || far2 > 0.25f || off * off > 0.1f * far2 + 1e-4f)) {
                        continue;
                    }
                    const float wx = std::fabs(patch_places[2 * q] - static_cast<float>(x)) / 6.0f;
                    const float wy =
                        std::fabs(patch_places[2 * q + 1] - static_cast<float>(y)) / 6.0f;
                    const float w = std::max(1.0f - wx, 0.0f) * std::max(1.0f - wy, 0.0f) +
                                    (own ? 0.02f : 1e-4f);
                    near[count_near] = q;
                    weight[count_near++] = w;
                    total += w;
                    touched |= found[q] != 0;
                }
            }
            if (!touched || total <= 0.0f) continue;
            for (int64_t c = 0; c < channels; c += 8) {
                const int64_t width = std::min<int64_t>(channels - c, 8);
                i8 stored = {};
                for (int64_t j = 0; j < width; j++) {
                    stored[j] = texels[c + j][steps[c + j] * place];
                }
                const f8 was = from_half(stored);
                f8 sum = {};
                for (int j = 0; j < count_near; j++) {
                    const int32_t q = near[j];
                    f8 value = {};
                    const float* from = change + q * channels + c;
                    if (width == 8) {
                        value = load(from);
                    } else {
                        for (int64_t i = 0; i < width; i++) value[i] = from[i];
                    }
                    const f8 light = found[q] == 1 ? was + value : found[q] == 2 ? value : was;
                    sum = sum + weight[j] * light;
                }
                const i8 light = to_half(min8(max8(sum / total, splat(0.0f)), splat(60000.0f)));
                for (int64_t j = 0; j < width; j++) {
                    texels[c + j][steps[c + j] * place] = static_cast<uint16_t>(light[j]);
                }
            }
        }
    });
    return STATUS_OK;
}

// Averages what was found at patches over those around them, over less where other things are
// near: there light changes quickly. Patches whose light was worked out anew and others are kept
// apart. Result: smooth: (patches, channels).
SAILENV_KERNEL(smooth_change)
(int64_t threads, int64_t side, int64_t radius, int64_t patches, const int32_t* patch_of,
 const float* patch_places, const float* patch_positions, const float* patch_normals,
 const int32_t* patch_owners, const uint8_t* found, const float* nearness, int64_t channels,
 const float* change, uint8_t* smooth_found, float* smooth) {
    using namespace sailenv;
    if (side < 1 || side > 65536 || radius < 0 || radius > 8 || patches < 0 || channels < 1) {
        return STATUS_INVALID_ARGUMENT;
    }
    const std::unique_ptr<FoundTiles> tiles =
        found_tiles(side, patches, patch_places, found, radius);
    if (!tiles) return STATUS_OUT_OF_MEMORY;
    parallel_for(threads, patches, 256, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            float* out = smooth + k * channels;
            memset(out, 0, static_cast<size_t>(channels) * sizeof(float));
            smooth_found[k] = found[k];
            if (found[k] == 3) continue;
            const float *p = patch_positions + 3 * k, *n = patch_normals + 3 * k;
            const float near = std::max(nearness[k], 0.02f), scale = 2.0f / (near * near);
            const int32_t x = static_cast<int32_t>(patch_places[2 * k]);
            const int32_t y = static_cast<int32_t>(patch_places[2 * k + 1]);
            if (!tiles->has(x, y)) continue;
            const bool whole = found[k] == 2;
            float total = 0.0f;
            bool touched = false;
            int64_t before = -1;
            for (int64_t dy = -radius; dy <= radius; dy++) {
                for (int64_t dx = -radius; dx <= radius; dx++) {
                    const int64_t tx = x + 4 * dx, ty = y + 4 * dy;
                    if (tx < 0 || ty < 0 || tx >= side || ty >= side) continue;
                    const int64_t q = patch_of[ty * side + tx];
                    if (q < 0 || q >= patches || q == before) continue;
                    if (patch_owners[q] != patch_owners[k] || found[q] == 3 ||
                        (found[q] == 2) != whole) {
                        continue;
                    }
                    const float* pp = patch_positions + 3 * q;
                    const float alike = dot(patch_normals + 3 * q, n);
                    const float step[3] = {pp[0] - p[0], pp[1] - p[1], pp[2] - p[2]};
                    const float far2 = dot(step, step), off = dot(step, n);
                    if (q != k &&
                        (alike < 0.8f || far2 > 0.25f || off * off > 0.1f * far2 + 1e-6f)) {
                        continue;
                    }
                    before = q;
                    const float w = alike * std::exp(-far2 * scale);
                    total += w;
                    touched |= found[q] != 0;
                    const float* value = change + q * channels;
                    for (int64_t c = 0; c < channels; c++) out[c] += w * value[c];
                }
            }
            if (touched && found[k] == 0) smooth_found[k] = 1;
            if (!touched || !(total > 0.0f)) continue;
            for (int64_t c = 0; c < channels; c++) out[c] /= total;
        }
    });
    return STATUS_OK;
}
