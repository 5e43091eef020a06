// Light that goes from surface to surface: which texels rays met, and what these send out.
#include <algorithm>
#include <cstring>

#include "../abi.h"
#include "../threads.h"
#include "bake_types.h"
#include "sky_picture.h"

namespace sailenv {
namespace {

constexpr int32_t NOTHING = -1, BACK = -2;  // of a texel: the sky, a back that sends out nothing
constexpr int64_t BLOCK = 8;                // channels that are added up at a time

int64_t clamped(double x, int64_t size) {
    return x > 0.0 ? static_cast<int64_t>(std::min(x, static_cast<double>(size - 1))) : 0;
}

int32_t texel_met(const MappedTriangles& map, int32_t t, float second, float third,
                  const float* d) {
    if (t < 0 || t >= map.count) return NOTHING;
    const float* face = map.faces + 3 * static_cast<int64_t>(t);
    float weights[3] = {static_cast<float>(1.0 - second - third), second, third};
    const bool from_behind = d[0] * face[0] + d[1] * face[1] + d[2] * face[2] > 0.0f;
    if (from_behind && map.two_sided[t] == 0) {
        const int32_t twin = map.twin[t];
        if (twin < 0 || twin >= map.count) return BACK;
        const int32_t* corner = map.corner + 3 * static_cast<int64_t>(t);
        const float own[3] = {weights[0], weights[1], weights[2]};
        for (int k = 0; k < 3; k++) weights[std::min(std::max(corner[k], 0), 2)] = own[k];
        t = twin;
    }
    const float* places = map.places + 6 * static_cast<int64_t>(t);
    double x = 0.0, y = 0.0;
    for (int k = 0; k < 3; k++) {
        x += weights[k] * places[2 * k];
        y += weights[k] * places[2 * k + 1];
    }
    const int32_t texel = map.index[clamped(y, map.height) * map.width + clamped(x, map.width)];
    return texel >= 0 ? texel : BACK;
}

// The mean of some channels over the sources of a patch.
template <int64_t CHANNELS>
void mean_of_sources(const int32_t* sources, int64_t rays, int64_t patches, const float* radiance,
                     int64_t step, float* mean) {
    float sum[CHANNELS] = {};
    for (int64_t k = 0; k < rays; k++) {
        if (sources[k] < 0 || sources[k] >= patches) continue;
        const float* from = radiance + sources[k] * step;
        for (int64_t c = 0; c < CHANNELS; c++) sum[c] += from[c];
    }
    const double all = static_cast<double>(rays);
    for (int64_t c = 0; c < CHANNELS; c++) {
        mean[c] = rays == 0 ? 0.0f : static_cast<float>(sum[c] / all);
    }
}

}  // namespace
}  // namespace sailenv

// Which texel each ray met, NOTHING or BACK. triangle, second, third: (rays,), as in
// rays/light_rays.py; directions: (rays, 3). Result: found: (rays,).
SAILENV_KERNEL(met_texels)
(const sailenv::MappedTriangles* map, int64_t rays, const int32_t* triangle, const float* second,
 const float* third, const float* directions, int32_t* found) {
    using namespace sailenv;
    if (rays < 0 || map->height < 1 || map->width < 1) return STATUS_INVALID_ARGUMENT;
    for (int64_t ray = 0; ray < rays; ray++) {
        found[ray] = texel_met(*map, triangle[ray], second[ray], third[ray], directions + 3 * ray);
    }
    return STATUS_OK;
}

// The mean radiance that rays met: irradiance / pi. texels: (count, rays), others than those of
// `size` texels are dark; radiance: (size, channels). Result: light: (count, channels).
SAILENV_KERNEL(mean_radiance_met)
(int64_t count, int64_t rays, const int32_t* texels, int64_t size, int64_t channels,
 const float* radiance, float* light) {
    using namespace sailenv;
    if (count < 0 || rays < 1 || channels < 1) return STATUS_INVALID_ARGUMENT;
    for (int64_t k = 0; k < count; k++) {
        float* own = light + k * channels;
        memset(own, 0, static_cast<size_t>(channels) * sizeof(float));
        for (int64_t m = 0; m < rays; m++) {
            const int32_t texel = texels[k * rays + m];
            if (texel < 0 || texel >= size) continue;
            const float* from = radiance + texel * channels;
            for (int64_t c = 0; c < channels; c++) own[c] += from[c];
        }
        for (int64_t c = 0; c < channels; c++) {
            own[c] = static_cast<float>(own[c] / static_cast<double>(rays));
        }
    }
    return STATUS_OK;
}

// Adds what single rays met to points. point, texel, weight: (rays,); radiance: (size, channels);
// light: (count, channels).
SAILENV_KERNEL(add_radiance_met)
(int64_t rays, const int32_t* point, const int32_t* texel, const float* weight, int64_t size,
 int64_t channels, const float* radiance, int64_t count, float* light) {
    using namespace sailenv;
    for (int64_t ray = 0; ray < rays; ray++) {
        if (point[ray] < 0 || point[ray] >= count || texel[ray] < 0 || texel[ray] >= size) {
            return STATUS_INVALID_ARGUMENT;
        }
        const float* from = radiance + texel[ray] * channels;
        float* to = light + point[ray] * channels;
        for (int64_t c = 0; c < channels; c++) to[c] += weight[ray] * from[c];
    }
    return STATUS_OK;
}

// What arrives at points in the air; see LightLayer.probe_bounced. texels, clear: (count, rays);
// directions: (rays, 3); radiance: (size, channels). Result: light: (count, 4, channels).
SAILENV_KERNEL(probe_radiance)
(int64_t threads, const sailenv::SkyWindows* sky, int64_t count, int64_t rays,
 const float* directions, const int32_t* texels, const float* clear, int64_t size, int64_t channels,
 const float* radiance, float* light) {
    using namespace sailenv;
    if (count < 0 || rays < 1 || channels < 3 || sky->height < 1 || sky->width < 1) {
        return STATUS_INVALID_ARGUMENT;
    }
    parallel_for(threads, count, 16, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t k = first; k < last; k++) {
            float* own = light + 4 * k * channels;
            memset(own, 0, static_cast<size_t>(4 * channels) * sizeof(float));
            for (int64_t m = 0; m < rays; m++) {
                const int32_t texel = texels[k * rays + m];
                if (texel == BACK || texel >= size) continue;
                const float* d = directions + 3 * m;
                double from_sky[3] = {0.0, 0.0, 0.0};
                if (texel < 0) picture_radiance(sky->picture, sky->height, sky->width, d, from_sky);
                const int64_t all = texel < 0 ? 3 : channels;
                for (int64_t c = 0; c < all; c++) {
                    const double value = texel < 0 ? clear[k * rays + m] * from_sky[c]
                                                   : radiance[texel * channels + c];
                    const double each = static_cast<double>(rays);
                    own[c] = static_cast<float>(own[c] + value / each);
                    for (int64_t axis = 0; axis < 3; axis++) {
                        float& to = own[(1 + axis) * channels + c];
                        to = static_cast<float>(to + 2.0 * value * d[axis] / each);
                    }
                }
            }
        }
    });
    return STATUS_OK;
}

// Which patches the rays of each patch met; see bake/bounces.py. members: the texels of the
// patches, those of patch p from bounds[p] to bounds[p + 1]; seen: (texels, rays); met: the patch
// of each texel; turns: how many texels of a patch share the rays. Result: sources, those of patch
// p from ends[p] to ends[p + 1].
SAILENV_KERNEL(patch_sources)
(int64_t patches, const int32_t* members, const int64_t* bounds, int64_t texels, int64_t rays,
 const int32_t* seen, const int32_t* met, const int64_t* turns, const int64_t* ends,
 int32_t* sources) {
    using namespace sailenv;
    for (int64_t patch = 0; patch < patches; patch++) {
        int64_t at = ends[patch];
        if (turns[patch] < 1) return STATUS_INVALID_ARGUMENT;
        // Neighbours take turns with the rays: together they have all directions.
        const int64_t own = rays / turns[patch];
        for (int64_t place = bounds[patch]; place < bounds[patch + 1]; place++) {
            const int64_t member = members[place];
            if (member < 0 || member >= texels) return STATUS_INVALID_ARGUMENT;
            const int64_t begin = (place - bounds[patch]) % turns[patch] * own;
            for (int64_t m = begin; m < begin + own; m++) {
                const int32_t texel = seen[member * rays + m];
                sources[at++] = texel >= 0 && texel < texels ? met[texel] : -1;
            }
        }
    }
    return STATUS_OK;
}

// Hands radiance on once: the mean over the sources of each patch, of which negative ones are dark.
// radiance: (patches, channels), channels a multiple of eight. Result: arriving, likewise.
SAILENV_KERNEL(hand_on)
(int64_t threads, int64_t patches, const int64_t* ends, const int32_t* sources, int64_t channels,
 const float* radiance, float* arriving) {
    using namespace sailenv;
    if (patches < 0 || channels < 1 || channels % BLOCK != 0) return STATUS_INVALID_ARGUMENT;
    parallel_for(threads, patches, 1024, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t patch = first; patch < last; patch++) {
            const int64_t rays = ends[patch + 1] - ends[patch];
            const int32_t* own = sources + ends[patch];
            float* to = arriving + patch * channels;
            // Rows of 16 channels are one cache line.
            int64_t c = 0;
            for (; c + 2 * BLOCK <= channels; c += 2 * BLOCK) {
                mean_of_sources<2 * BLOCK>(own, rays, patches, radiance + c, channels, to + c);
            }
            if (c < channels) {
                mean_of_sources<BLOCK>(own, rays, patches, radiance + c, channels, to + c);
            }
        }
    });
    return STATUS_OK;
}
