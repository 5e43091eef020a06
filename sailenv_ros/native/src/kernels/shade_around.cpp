// Shading: the light around each point, and the share of the main light that arrives there.
#include <algorithm>

#include "layer_sum.h"
#include "shade_chunk.h"
#include "texture.h"

namespace sailenv {
namespace {

// Share of the main light that a shadow map lets through, bilinear between four texels.
f8 lit_share(const float* inverse_depth, int32_t size, f8 x, f8 y, f8 near) {
    const float last = static_cast<float>(size) - 1.001f;
    const f8 tx = clamp8(x * static_cast<float>(size) - 0.5f, 0.0f, last);
    const f8 ty = clamp8(y * static_cast<float>(size) - 0.5f, 0.0f, last);
    const i8 ix = truncated(tx), iy = truncated(ty);
    const f8 across = tx - to_float(ix), down = ty - to_float(iy);
    const int32_t stride = size + ROW_PADDING;
    const i8 at = iy * stride + ix;
    alignas(32) float texels[4 * 8];
    for (int k = 0; k < 8; k++) {
        const float* p = inverse_depth + at[k];
        *reinterpret_cast<f4_any*>(texels + 4 * k) = two_pairs(p, p + stride);
    }
    f8 corner[4], lit[4];
    transpose4(texels, corner[0], corner[1], corner[2], corner[3]);
    for (int k = 0; k < 4; k++) lit[k] = near >= corner[k] ? splat(1.0f) : splat(0.0f);
    const f8 upper = lit[0] + (lit[1] - lit[0]) * across;
    const f8 lower = lit[2] + (lit[3] - lit[2]) * across;
    return upper + (lower - upper) * down;
}

struct MapPlace {
    f8 x, y, near;  // in the shadow map, 0 to 1; 1 - depth
};

// How far above its surface a point is looked up, lest this casts shadows on itself [texels]:
// between four texels, or around that.
LANES_INLINE f8 lift_between_texels(f8 facing) {
    return 0.2f + 1.5f * sqrt8(max8(1.0f - facing * facing, splat(0.0f)));
}
LANES_INLINE f8 lift_around(f8 facing) { return 1.0f + 2.0f * (1.0f - facing); }

LANES_INLINE MapPlace in_shadow_map(const Light& light, const Chunk& c, int32_t i, f8 lift) {
    const Vec3x8 above = c.point.at(i) + c.normal.at(i) * (lift * light.texel_m);
    const Vec3x8 place = light.map_from_world * above;
    return {place.x, place.y, 1.0f - clamp8(place.z, 0.0f, 1.0f)};
}

// Shares of the main light where its shadows end: from blocks of four by four points a texel,
// with a border. `at` are texels above and left of the places, `across` and `down` how far beyond
// their centres these lie.
f8 edge_shares(const Light& light, const int32_t* at, const float* across, const float* down,
               f8 share) {
    alignas(32) float result[8];
    store(result, share);
    const int32_t width = light.light_map_width;
    for (int k = 0; k < 8; k++) {
        if (!(result[k] > 0.0f && result[k] < 1.0f)) continue;
        const int32_t right = across[k] >= 0.5f ? 1 : 0, below = down[k] >= 0.5f ? 1 : 0;
        const int32_t block = light.edge_index[at[k] + right + below * width];
        if (block < 0) continue;
        const float x = 4.0f * (across[k] + (right ? -0.5f : 0.5f)) + 0.5f;
        const float y = 4.0f * (down[k] + (below ? -0.5f : 0.5f)) + 0.5f;
        const int32_t ix = std::min(static_cast<int32_t>(x), 4);
        const int32_t iy = std::min(static_cast<int32_t>(y), 4);
        const float u = x - static_cast<float>(ix), v = y - static_cast<float>(iy);
        const uint8_t* p = light.edge_blocks + 36 * static_cast<int64_t>(block) + 6 * iy + ix;
        const float a = static_cast<float>(p[0]), b = static_cast<float>(p[1]),
                    c = static_cast<float>(p[6]), d = static_cast<float>(p[7]);
        const float upper = a + (b - a) * u, lower = c + (d - c) * u;
        result[k] = (upper + (lower - upper) * v) * (1.0f / 255.0f);
    }
    return load(result);
}

}  // namespace

Vec3x8 light_of_instances(const Light& light, i8 ids, i8 wanted, Vec3x8 normal, Vec3x8 point) {
    Vec3x8 found = splat(vec3(0.0f, 0.0f, 0.0f));
    // Eight pixels seldom see more than one.
    for (i8 left = wanted; any(left);) {
        const int32_t id = ids[__builtin_ctz(lane_bits(left))];
        const i8 own = left & (ids == id);
        left = left & ~own;
        const float* row = light.instance_light + INSTANCE_ROW * static_cast<int64_t>(id);
        const float* axes = row + 3 * LIGHT_TERMS;
        f8 front[3], back[3], sum[3];
        for (int k = 0; k < 3; k++) {
            const f8 along = dot(vec3(axes[4 * k], axes[4 * k + 1], axes[4 * k + 2]), normal);
            const f8 square = along * along;
            front[k] = along > 0.0f ? square : splat(0.0f);
            back[k] = along > 0.0f ? splat(0.0f) : square;
        }
        for (int c = 0; c < 3; c++) {
            f8 terms[LIGHT_TERMS];
            for (int j = 0; j < LIGHT_TERMS; j++) terms[j] = splat(row[LIGHT_TERMS * c + j]);
            sum[c] = irradiance_of_terms(terms, normal, Vec3x8(front[0], front[1], front[2]),
                                         Vec3x8(back[0], back[1], back[2]), point);
        }
        found = where(own, max(Vec3x8(sum[0], sum[1], sum[2]), 0.0f), found);
    }
    return found;
}

void light_from_bake(const Shading& s, Chunk& c) {
    const Light& light = *s.light;
    const int32_t width = light.light_map_width, height = light.light_map_height;
    alignas(32) int32_t at[CHUNK];
    alignas(32) float across[CHUNK], down[CHUNK];
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 x = clamp8(load(c.light_u + i) * static_cast<float>(width) - 0.5f, 0.0f,
                            static_cast<float>(width) - 1.001f);
        const f8 v = load(c.light_u + i) > 0.0f ? load(c.light_v + i) : splat(0.0f);
        const f8 y = clamp8(v * static_cast<float>(height) - 0.5f, 0.0f,
                            static_cast<float>(height) - 1.001f);
        const i8 ix = truncated(x), iy = truncated(y);
        store(across + i, x - to_float(ix));
        store(down + i, y - to_float(iy));
        store(at + i, iy * width + ix);
    }
    const LayerSum& map = *light.light_map;
    for (int32_t i = 0; i < c.padded; i += 8) need_texels(map, at + i, width);
    const bool has_main = has_main_light(light);
    const int64_t row = 4 * static_cast<int64_t>(width);
    alignas(32) float texels[4 * 8];
    for (int32_t i = 0; i < c.padded; i += 8) {
        for (int k = 0; k < 8; k++) {
            const uint16_t* p = map.texels + 4 * static_cast<int64_t>(at[i + k]);
            *reinterpret_cast<f4_any*>(texels + 4 * k) =
                sample_halves(p, p + row, across[i + k], down[i + k]);
        }
        Vec3x8 around;
        f8 share;
        transpose4(texels, around.x, around.y, around.z, share);
        const i8 charted = load(c.light_u + i) > 0.0f;
        const i8 there = ~load(c.empty + i);
        const i8 free = ~charted & there;
        if (any(free)) {
            Vec3x8 found =
                light_of_instances(light, load(c.id + i), free, c.normal.at(i), c.point.at(i));
            found = found * vertex_factor(load(c.light_u + i));
            const f8 hidden = load(c.light_v + i);
            if (any(free & (hidden > 0.0f))) {
                const Vec3x8 albedo = c.base.at(i) * (1.0f - load(c.metallic + i));
                found = found * Vec3x8(arriving_share(hidden, albedo.x),
                                       arriving_share(hidden, albedo.y),
                                       arriving_share(hidden, albedo.z));
            }
            around = where(charted, around, found);
        }
        c.around.set(i, around);
        const f8 facing = dot(c.normal.at(i), light.main_towards);
        const i8 mapped = light.main_baked > 0.0f ? charted : splat(0);
        if (light.edge_index != nullptr && any(mapped & there & (share > 0.0f) & (share < 1.0f))) {
            share = edge_shares(light, at + i, across + i, down + i, share);
        }
        const i8 asked = there & (facing > 0.0f) & (~mapped | (share > 0.0f));
        f8 arrives = splat(0.0f);
        if (has_main && any(asked)) {
            // What stands still is not among what casts into the map of what moves.
            const f8 lift = mapped ? splat(0.0f) : lift_between_texels(facing);
            const MapPlace place = in_shadow_map(light, c, i, lift);
            f8 past = share;
            if (any(asked & ~mapped)) {
                const f8 standing = lit_share(light.static_shadow.inverse_depth, light.shadow_size,
                                              place.x, place.y, place.near);
                past = mapped ? share : light.main_clear * standing;
            }
            arrives = past * lit_share(light.shadow.inverse_depth, light.shadow_size, place.x,
                                       place.y, place.near);
        }
        store(c.arrives + i, arrives);
    }
}

void light_from_sky(const Shading& s, Chunk& c) {
    const Light& light = *s.light;
    const bool has_main = has_main_light(light);
    const float step = 1.6f / static_cast<float>(light.shadow_size);
    for (int32_t i = 0; i < c.padded; i += 8) {
        c.around.set(i, light_of_sky(light, load(c.normal.z + i)));
        const f8 facing = dot(c.normal.at(i), light.main_towards);
        f8 arrives = splat(0.0f);
        if (has_main && any(~load(c.empty + i) & (facing > 0.0f))) {
            const MapPlace p = in_shadow_map(light, c, i, lift_around(facing));
            const float across[4] = {0.94f, -0.34f, -0.94f, 0.34f},
                        down[4] = {0.34f, 0.94f, -0.34f, -0.94f};
            for (int k = 0; k < 4; k++) {
                arrives = arrives + lit_share(light.shadow.inverse_depth, light.shadow_size,
                                              p.x + across[k] * step, p.y + down[k] * step, p.near);
            }
            arrives = arrives * 0.25f;
            const i8 outside = (p.x < 0.0f) | (p.x > 1.0f) | (p.y < 0.0f) | (p.y > 1.0f) |
                               (p.near <= 0.0f) | (p.near >= 1.0f);
            arrives = outside ? splat(1.0f) : arrives;
        }
        store(c.arrives + i, arrives);
    }
}

}  // namespace sailenv
