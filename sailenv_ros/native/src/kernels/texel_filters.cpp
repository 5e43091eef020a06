// Filters over the texels of a light map, as far as a surface goes on; see bake/denoise.py.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <vector>

#include "../abi.h"
#include "../threads.h"
#include "bake_types.h"

namespace sailenv {
namespace {

constexpr int64_t BLOCK = 16;  // channels that are averaged at a time

// How far texels share light, as a part of the distance of what they see: what lies in the gap
// behind a picture keeps its shadow to itself.
constexpr double NEAR_SHARE = 0.25;

// The texel at a place of the map, -1 for none.
int64_t texel_at(const TexelMap& map, int64_t row, int64_t column) {
    if (row < 0 || row >= map.height || column < 0 || column >= map.width) return -1;
    const int32_t texel = map.index[row * map.width + column];
    return texel < map.count ? texel : -1;
}

// The texel at a place of the map if it is of texel k's surface, else -1.
int64_t neighbour(const TexelMap& map, int64_t row, int64_t column, int64_t k) {
    const int64_t other = texel_at(map, row, column);
    if (other < 0 || map.owners[other] != map.owners[k]) return -1;
    double alike = 0.0;
    for (int c = 0; c < 3; c++) alike += map.faces[3 * other + c] * map.faces[3 * k + c];
    return alike > 0.5 ? other : -1;
}

// Calls body(k, other) for all known neighbours of unknown texels, and then done(k).
template <class Body, class Done>
bool for_neighbours(const TexelMap& map, int64_t count, const int32_t* unknown,
                    const uint8_t* known, const Body& body, const Done& done) {
    for (int64_t place = 0; place < count; place++) {
        const int64_t k = unknown[place];
        if (k < 0 || k >= map.count) return false;
        for (int down = -1; down < 2; down++) {
            for (int right = -1; right < 2; right++) {
                const int64_t other = neighbour(map, map.rows[k] + down, map.columns[k] + right, k);
                if (other >= 0 && known[other] != 0) body(k, other);
            }
        }
        done(k);
    }
    return true;
}

}  // namespace
}  // namespace sailenv

// Averages over tiles of 4 by 4 texels, twice; over less where other things are near either texel.
// values: (count, channels); valid, nearness: (count,). Result: result, (count, channels), of valid
// texels.
SAILENV_KERNEL(denoise_texels)
(int64_t threads, const sailenv::TexelMap* texels, int64_t channels, const float* values,
 const uint8_t* valid, const float* nearness, float* result) {
    using namespace sailenv;
    const TexelMap& map = *texels;
    if (map.count < 0 || channels < 1) return STATUS_INVALID_ARGUMENT;
    parallel_for(threads, map.count, 1024, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            if (valid[k] == 0) continue;
            const float *p = map.positions + 3 * k, *n = map.normals + 3 * k;
            int64_t near[49];
            double weight[49], weights = 0.0;
            int count = 0;
            for (int down = -3; down < 4; down++) {
                for (int right = -3; right < 4; right++) {
                    const int64_t other = texel_at(map, map.rows[k] + down, map.columns[k] + right);
                    if (other < 0 || valid[other] == 0 || map.owners[other] != map.owners[k]) {
                        continue;
                    }
                    double alike = 0.0, far2 = 0.0, off = 0.0;
                    for (int c = 0; c < 3; c++) {
                        alike += map.normals[3 * other + c] * n[c];
                        const float step = map.positions[3 * other + c] - p[c];
                        far2 += step * step;
                        off += step * n[c];
                    }
                    if (alike < 0.8 || far2 > 0.04 || off * off > 0.1 * far2 + 1e-8) continue;
                    const int tent = (4 - std::abs(down)) * (4 - std::abs(right));
                    const double close = NEAR_SHARE * std::min(nearness[k], nearness[other]);
                    near[count] = other;
                    weight[count] = tent * alike * std::exp(-far2 / std::max(close * close, 1e-7));
                    weights += weight[count++];
                }
            }
            if (!(weights > 0.0)) continue;  // another stands at its place
            for (int64_t begin = 0; begin < channels; begin += BLOCK) {
                const int64_t width = std::min(channels - begin, BLOCK);
                float total[BLOCK] = {};
                for (int j = 0; j < count; j++) {
                    const float* from = values + near[j] * channels + begin;
                    for (int64_t c = 0; c < width; c++) {
                        total[c] = static_cast<float>(total[c] + weight[j] * from[c]);
                    }
                }
                for (int64_t c = 0; c < width; c++) {
                    result[k * channels + begin + c] = static_cast<float>(total[c] / weights);
                }
            }
        }
    });
    return STATUS_OK;
}

// Gives some texels the means of their neighbours that are known; known texels are not written.
// unknown: (count,), their numbers; before: (texels,), known so far. Result: known: (texels,) and
// values: (texels, channels), of those that have such neighbours.
SAILENV_KERNEL(dilate_texels)
(const sailenv::TexelMap* texels, int64_t count, const int32_t* unknown, const uint8_t* before,
 int64_t channels, uint8_t* known, float* values) {
    using namespace sailenv;
    if (count < 0 || channels < 1) return STATUS_INVALID_ARGUMENT;
    std::unique_ptr<float[]> total(new (std::nothrow) float[static_cast<size_t>(channels)]());
    if (!total) return STATUS_OUT_OF_MEMORY;
    int found = 0;
    const auto add = [&](int64_t, int64_t other) {
        found++;
        for (int64_t c = 0; c < channels; c++) total[c] += values[other * channels + c];
    };
    const auto done = [&](int64_t k) {
        for (int64_t c = 0; c < channels; c++) {
            if (found > 0) values[k * channels + c] = static_cast<float>(total[c] / double(found));
            total[c] = 0.0f;
        }
        if (found > 0) known[k] = 1;
        found = 0;
    };
    const bool sound = for_neighbours(*texels, count, unknown, before, add, done);
    return sound ? STATUS_OK : STATUS_INVALID_ARGUMENT;
}

// Finds which known neighbour's light stands for some texels: the nearest one. unknown, before,
// known: as in dilate_texels. Result: found: (texels,), the texel that stands for each.
SAILENV_KERNEL(texel_stand_ins)
(const sailenv::TexelMap* texels, int64_t count, const int32_t* unknown, const uint8_t* before,
 uint8_t* known, int32_t* found) {
    using namespace sailenv;
    if (count < 0) return STATUS_INVALID_ARGUMENT;
    const TexelMap& map = *texels;
    double nearest = std::numeric_limits<double>::infinity();
    const auto compare = [&](int64_t k, int64_t other) {
        const int64_t one = found[other];
        if (one < 0 || one >= map.count) return;
        double far2 = 0.0;
        for (int c = 0; c < 3; c++) {
            const float step = map.positions[3 * one + c] - map.positions[3 * k + c];
            far2 += step * step;
        }
        if (far2 < nearest) {
            nearest = far2;
            known[k] = 1;
            found[k] = static_cast<int32_t>(one);
        }
    };
    const auto done = [&](int64_t) { nearest = std::numeric_limits<double>::infinity(); };
    const bool sound = for_neighbours(map, count, unknown, before, compare, done);
    return sound ? STATUS_OK : STATUS_INVALID_ARGUMENT;
}
