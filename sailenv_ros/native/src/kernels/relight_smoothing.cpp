// What was found at patches, averaged and spread over texels; see relight/relighting.py.
#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <vector>

#include "../abi.h"
#include "../threads.h"
#include "lanes.h"
#include "light_sampling.h"
#include "relight_types.h"

namespace sailenv {
namespace {

// Which tiles of 4 x 4 texels lie up to `radius` tiles from a patch where something was found.
class FoundTiles {
public:
    FoundTiles(const PatchMap& map, const uint8_t* found, int64_t radius)
        : tiles_((map.side + 3) / 4), marks_(static_cast<size_t>(tiles_ * tiles_), 0) {
        for (int64_t q = 0; q < map.count; q++) {
            const float* place = map.places + 2 * q;
            if (found[q] == PATCH_AS_IT_WAS) continue;
            if (!(place[0] >= 0.0f) || !(place[1] >= 0.0f)) continue;
            const int64_t x = static_cast<int64_t>(std::min(place[0], 65536.0f)) / 4;
            const int64_t y = static_cast<int64_t>(std::min(place[1], 65536.0f)) / 4;
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
std::unique_ptr<FoundTiles> found_tiles(const PatchMap& map, const uint8_t* found, int64_t radius) {
    try {
        return std::make_unique<FoundTiles>(map, found, radius);
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}

bool sound(const PatchMap& map) { return map.side >= 1 && map.side <= 65536 && map.count >= 0; }

// The patch of a texel, -1 for none.
int64_t patch_at(const PatchMap& map, int64_t x, int64_t y) {
    if (x < 0 || y < 0 || x >= map.side || y >= map.side) return -1;
    const int32_t patch = map.of_texel[y * map.side + x];
    return patch < map.count ? patch : -1;
}

// Where a patch lies from a surface at p with normal n.
struct Offset {
    float alike, far2, off;  // cosine of the normals, squared distance, distance from the plane
};

Offset offset_of(const PatchMap& map, int64_t q, const float* p, const float* n) {
    const float* at = map.positions + 3 * q;
    const float step[3] = {at[0] - p[0], at[1] - p[1], at[2] - p[2]};
    return {dot(map.normals + 3 * q, n), dot(step, step), dot(step, n)};
}

// The patches around a texel that share its surface, and how much each counts.
struct Nearby {
    int64_t patch[9];
    float weight[9], total = 0.0f;
    int count = 0;
    bool touched = false;

    void add(int64_t q, float w) {
        patch[count] = q;
        weight[count++] = w;
        total += w;
    }
};

Nearby nearby(const PatchMap& map, const MappedTexels& texels, int64_t k, const uint8_t* found) {
    Nearby near;
    const int64_t x = texels.places[k] % map.side, y = texels.places[k] / map.side;
    for (int dy = -4; dy <= 4; dy += 4) {
        for (int dx = -4; dx <= 4; dx += 4) {
            const int64_t q = patch_at(map, x + dx, y + dy);
            if (q < 0 || map.owners[q] != texels.owners[k] || found[q] == PATCH_INSIDE) continue;
            if (std::find(near.patch, near.patch + near.count, q) != near.patch + near.count) {
                continue;
            }
            const Offset o = offset_of(map, q, texels.positions + 3 * k, texels.normals + 3 * k);
            const bool own = dx == 0 && dy == 0;
            const bool elsewhere = o.alike < 0.7f || o.far2 > 0.25f;
            if (!own && (elsewhere || o.off * o.off > 0.1f * o.far2 + 1e-4f)) continue;
            const float wx = std::fabs(map.places[2 * q] - static_cast<float>(x)) / 6.0f;
            const float wy = std::fabs(map.places[2 * q + 1] - static_cast<float>(y)) / 6.0f;
            near.add(q,
                     std::max(1.0f - wx, 0.0f) * std::max(1.0f - wy, 0.0f) + (own ? 0.02f : 1e-4f));
            near.touched |= found[q] != PATCH_AS_IT_WAS;
        }
    }
    return near;
}

// Brings eight channels of a texel up to date, or fewer.
void spread_channels(const Nearby& near, const uint8_t* found, const float* change, int64_t place,
                     int64_t begin, const HalfMaps& maps) {
    const int64_t width = std::min<int64_t>(maps.channels - begin, 8);
    i8 stored = {};
    for (int64_t j = 0; j < width; j++) {
        stored[j] = maps.texels[begin + j][maps.steps[begin + j] * place];
    }
    const f8 was = from_half(stored);
    f8 sum = {};
    for (int j = 0; j < near.count; j++) {
        const int64_t q = near.patch[j];
        const float* from = change + q * maps.channels + begin;
        f8 value = {};
        if (width == 8) {
            value = load(from);
        } else {
            for (int64_t i = 0; i < width; i++) value[i] = from[i];
        }
        const f8 light = found[q] == PATCH_CHANGED ? was + value
                         : found[q] == PATCH_WHOLE ? value
                                                   : was;
        sum = sum + near.weight[j] * light;
    }
    const i8 light = to_half(min8(max8(sum / near.total, splat(0.0f)), splat(60000.0f)));
    for (int64_t j = 0; j < width; j++) {
        maps.texels[begin + j][maps.steps[begin + j] * place] = static_cast<uint16_t>(light[j]);
    }
}

}  // namespace
}  // namespace sailenv

// Spreads what was found at patches over the texels between them. found: (patches,); change:
// (patches, channels), as gather_change gives them. Result: into `maps`.
SAILENV_KERNEL(spread_change)
(int64_t threads, const sailenv::MappedTexels* texels, const sailenv::PatchMap* patches,
 const uint8_t* found, const float* change, const sailenv::HalfMaps* maps) {
    using namespace sailenv;
    const PatchMap& map = *patches;
    if (!sound(map) || map.count < 1 || texels->count < 0 || maps->channels < 1) {
        return STATUS_INVALID_ARGUMENT;
    }
    const std::unique_ptr<FoundTiles> tiles = found_tiles(map, found, 1);
    if (!tiles) return STATUS_OUT_OF_MEMORY;
    parallel_for(threads, texels->count, 1024, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            const int64_t place = texels->places[k];
            if (place < 0 || place >= map.side * map.side) continue;
            if (!tiles->has(place % map.side, place / map.side)) continue;
            const Nearby near = nearby(map, *texels, k, found);
            if (!near.touched || near.total <= 0.0f) continue;
            for (int64_t c = 0; c < maps->channels; c += 8) {
                spread_channels(near, found, change, place, c, *maps);
            }
        }
    });
    return STATUS_OK;
}

// Averages what was found at patches over those around them, over less where other things are
// near to either: there light changes quickly. Neighbours are `step` texels apart. Patches whose
// light was worked out anew and others are kept apart. found, nearness: (patches,); change:
// (patches, channels). Result: smooth_found and smooth, likewise.
SAILENV_KERNEL(smooth_change)
(int64_t threads, const sailenv::PatchMap* patches, int64_t radius, int64_t step,
 const uint8_t* found, const float* nearness, int64_t channels, const float* change,
 uint8_t* smooth_found, float* smooth) {
    using namespace sailenv;
    const PatchMap& map = *patches;
    if (!sound(map) || radius < 0 || radius > 8 || step < 1 || step > 4 || channels < 1) {
        return STATUS_INVALID_ARGUMENT;
    }
    const std::unique_ptr<FoundTiles> tiles = found_tiles(map, found, radius);
    if (!tiles) return STATUS_OUT_OF_MEMORY;
    parallel_for(threads, map.count, 256, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            float* out = smooth + k * channels;
            std::fill_n(out, channels, 0.0f);
            smooth_found[k] = found[k];
            if (found[k] == PATCH_INSIDE) continue;
            const int32_t x = static_cast<int32_t>(map.places[2 * k]);
            const int32_t y = static_cast<int32_t>(map.places[2 * k + 1]);
            if (!tiles->has(x, y)) continue;
            const bool whole = found[k] == PATCH_WHOLE;
            float total = 0.0f;
            bool touched = false;
            int64_t before = -1;
            for (int64_t dy = -radius; dy <= radius; dy++) {
                for (int64_t dx = -radius; dx <= radius; dx++) {
                    const int64_t q = patch_at(map, x + step * dx, y + step * dy);
                    if (q < 0 || q == before || map.owners[q] != map.owners[k]) continue;
                    if (found[q] == PATCH_INSIDE || (found[q] == PATCH_WHOLE) != whole) continue;
                    const Offset o = offset_of(map, q, map.positions + 3 * k, map.normals + 3 * k);
                    const bool elsewhere = o.alike < 0.8f || o.far2 > 0.25f;
                    if (q != k && (elsewhere || o.off * o.off > 0.1f * o.far2 + 1e-6f)) continue;
                    before = q;
                    // What lies under something says nothing of what lies beside it.
                    const float near = std::max(std::min(nearness[k], nearness[q]), 0.02f);
                    const float w = o.alike * std::exp(-2.0f * o.far2 / (near * near));
                    total += w;
                    touched |= found[q] != PATCH_AS_IT_WAS;
                    const float* value = change + q * channels;
                    for (int64_t c = 0; c < channels; c++) out[c] += w * value[c];
                }
            }
            if (touched && found[k] == PATCH_AS_IT_WAS) smooth_found[k] = PATCH_CHANGED;
            if (!touched || !(total > 0.0f)) continue;
            for (int64_t c = 0; c < channels; c++) out[c] /= total;
        }
    });
    return STATUS_OK;
}
