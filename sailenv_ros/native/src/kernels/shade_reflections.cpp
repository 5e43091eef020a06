// Shading: what surfaces mirror, and what is seen where there are none.
#include "shade_chunk.h"
#include "texture.h"

namespace sailenv {
namespace {

// The angle whose tangent is y / x, to 1e-6 (Abramowitz and Stegun 4.4.49).
f8 arc_tangent(f8 y, f8 x) {
    const f8 ax = abs8(x), ay = abs8(y);
    const f8 a = min8(ax, ay) / max8(max8(ax, ay), splat(1e-20f)), q = a * a;
    f8 r = a *
           (0.9999993329f +
            q * (-0.3332985605f +
                 q * (0.1994653599f +
                      q * (-0.1390853351f +
                           q * (0.0964200441f + q * (-0.0559098861f +
                                                     q * (0.0218612288f + q * -0.0040540580f)))))));
    r = ay > ax ? 0.5f * PI - r : r;
    r = x < 0.0f ? PI - r : r;
    return negated_if(r, bits(y) >> 31);
}

// What eight points in baked light mirror, by the pictures from `point`.
Vec3x8 mirrored_around(const Light& light, i8 point, Chunk& c, int32_t i) {
    alignas(32) float open[4][8];
    for (int k = 0; k < 8; k++) {
        for (int j = 0; j < 4; j++) open[j][k] = light.reflection_points[point[k]].light[j];
    }
    const Vec3x8 around = c.around.at(i), normal = c.normal.at(i);
    const f8 roughness = load(c.roughness + i);
    const Vec3x8 room = mirrored_room(light, point, c.point.at(i), mirrored_ray(c, i), roughness);
    // Where less light arrives than in the middle of the room, less of the room is seen.
    const Vec3x8 bent = {load(open[1]), load(open[2]), load(open[3])};
    const f8 there = load(open[0]) + bent.x * normal.x + bent.y * normal.y + bent.z * normal.z;
    const f8 share = clamp8(luminance(around) / max8(there, splat(1e-4f)), 0.0f, 1.0f);
    const f8 rough = share_mirrored_around(roughness);
    store(c.open + i, share);
    c.darkened.set(i, room * ((1.0f - share) * (1.0f - rough)));
    return mix(room * share, around, rough);
}

}  // namespace

Vec3x8 background(const Light& light, Vec3x8 d) {
    if (light.background_plain) return splat(light.background);
    if (light.sky_map == nullptr) return analytic_sky(light, d.z * inverse_length(d));
    const f8 across = 0.5f - arc_tangent(d.y, d.x) * (0.5f / PI);
    const f8 down = arc_tangent(sqrt8(d.x * d.x + d.y * d.y), d.z) * (1.0f / PI);
    const float width = static_cast<float>(light.sky_width);
    f8 x = across * width - 0.5f;
    // The first column is repeated behind the last.
    x = x < 0.0f ? x + width : x;
    x = clamp8(x, 0.0f, width - 0.001f);
    const f8 y = clamp8(down * static_cast<float>(light.sky_height) - 0.5f, 0.0f,
                        static_cast<float>(light.sky_height) - 1.001f);
    const f8 left = floor8(x), top = floor8(y);
    const i8 ix = truncated(left), iy = truncated(top);
    const f8 share_x = x - left, share_y = y - top;
    const int64_t row = 4 * (static_cast<int64_t>(light.sky_width) + 1);
    alignas(32) float texels[4 * 8];
    for (int k = 0; k < 8; k++) {
        const uint16_t* p = light.sky_map + row * iy[k] + 4 * static_cast<int64_t>(ix[k]);
        *reinterpret_cast<f4_any*>(texels + 4 * k) =
            sample_halves(p, p + row, share_x[k], share_y[k]);
    }
    Vec3x8 seen;
    f8 unused;
    transpose4(texels, seen.x, seen.y, seen.z, unused);
    return seen * light.sky_factor;
}

void mirror_surroundings(const Shading& s, Chunk& c) {
    const Light& light = *s.light;
    for (int32_t i = 0; i < c.padded; i += 8) {
        const Vec3x8 around = c.around.at(i);
        const f8 roughness = load(c.roughness + i);
        Vec3x8 seen = around;
        c.darkened.set(i, splat(vec3(0.0f, 0.0f, 0.0f)));
        store(c.open + i, splat(1.0f));
        if (!light.baked) {
            const Vec3x8 d = mirrored_ray(c, i);
            const Vec3x8 soft =
                sky_irradiance(d.z, light.sky_zenith, light.sky_horizon, light.sky_ground);
            const f8 share = min8(roughness * 1.4f, splat(1.0f));
            seen = light.ambient + light.sky_share * mix(analytic_sky(light, d.z), soft, share);
        } else if (light.reflecting && any((roughness < MIRRORS_AROUND) & ~load(c.empty + i))) {
            i8 point{};
            const i8 ids = load(c.id + i);
            // Where nothing is, the id is 0, and so is the point.
            for (int k = 0; k < 8; k++) point[k] = light.reflection_table[ids[k]];
            seen = mirrored_around(light, point, c, i);
        }
        c.mirrored.set(i, seen);
    }
}

Vec3x8 mirrored_room(const Light& light, i8 point, Vec3x8 at, Vec3x8 d, f8 roughness) {
    // A little beside 0, where the reciprocal is finite.
    const Vec3x8 inverse = {1.0f / (d.x + 1e-6f), 1.0f / (d.y + 1e-6f), 1.0f / (d.z + 1e-6f)};
    alignas(32) float from[3][8];
    for (int k = 0; k < 8; k++) {
        const vec3 position = light.reflection_points[point[k]].position;
        from[0][k] = position.x;
        from[1][k] = position.y;
        from[2][k] = position.z;
    }
    const Vec3x8 low = (light.room_low - at) * inverse, high = (light.room_high - at) * inverse;
    const f8 end = min8(max8(low.x, high.x), min8(max8(low.y, high.y), max8(low.z, high.z)));
    const f8 reach = max8(end, splat(0.05f));
    const Vec3x8 to = at + d * reach - Vec3x8(load(from[0]), load(from[1]), load(from[2]));
    const f8 scale = 1.0f / max8(abs8(to.x) + abs8(to.y) + abs8(to.z), splat(1e-20f));
    f8 nx = to.x * scale, ny = to.y * scale;
    const f8 fold = max8(-to.z * scale, splat(0.0f));
    nx = nx >= 0.0f ? nx + fold : nx - fold;
    ny = ny >= 0.0f ? ny + fold : ny - fold;
    const float edge = static_cast<float>(light.reflection_edge);
    const float half = 0.5f * light.reflection_scale * edge, middle = 0.5f * edge - 0.5f;
    const f8 u = clamp8(nx * half + middle, 0.0f, edge - 1.001f);
    const f8 v = clamp8(ny * half + middle, 0.0f, edge - 1.001f);
    const f8 layer = clamp8(roughness * light.layers_per_roughness, 0.0f,
                            static_cast<float>(light.reflection_layers) - 1.001f);
    const i8 iu = truncated(u), iv = truncated(v), il = truncated(layer);
    const f8 across = u - to_float(iu), down = v - to_float(iv), share = layer - to_float(il);
    const i8 texel = ((point * light.reflection_layers + il) * light.reflection_edge + iv) *
                         light.reflection_edge +
                     iu;
    const int64_t row = 4 * static_cast<int64_t>(light.reflection_edge);
    const int64_t next = row * light.reflection_edge;
    alignas(32) float texels[4 * 8];
    for (int k = 0; k < 8; k++) {
        const uint16_t* p = light.reflections + 4 * static_cast<int64_t>(texel[k]);
        const f4 near = sample_halves(p, p + row, across[k], down[k]);
        const f4 far = sample_halves(p + next, p + next + row, across[k], down[k]);
        *reinterpret_cast<f4_any*>(texels + 4 * k) = near + (far - near) * share[k];
    }
    Vec3x8 seen;
    f8 unused;
    transpose4(texels, seen.x, seen.y, seen.z, unused);
    return seen;
}

}  // namespace sailenv
