// Shading: what the maps of a material say of a chunk's surfaces.
#include "shade_chunk.h"
#include "texture.h"

namespace sailenv {
namespace {

// Pictures of colour maps are nearest to the mean over the pixel a little finer: measured
// beside 4 x 4 samples a pixel. The same as in shaders/textures.glsl.
constexpr float PICTURE_BIAS = -0.25f;
constexpr float MOST_LOOK_UPS = 4.0f;

// Changes of uv from pixel to pixel, of eight pixels.
struct Slopes {
    f8 ux, vx, uy, vy;
};

LANES_INLINE Slopes uv_slopes(const Chunk& c, int32_t i) {
    if (c.parallel) return {load(c.ux + i), load(c.vx + i), load(c.uy + i), load(c.vy + i)};
    const f8 depth = load(c.depth + i), u = load(c.u + i), v = load(c.v + i);
    const f8 nx = load(c.inverse_depth_x + i), ny = load(c.inverse_depth_y + i);
    return {depth * (load(c.ux + i) - u * nx), depth * (load(c.vx + i) - v * nx),
            depth * (load(c.uy + i) - u * ny), depth * (load(c.vy + i) - v * ny)};
}

// Addresses and shares of a chunk's look-ups.
struct TapRows {
    alignas(32) int32_t upper[CHUNK], lower[CHUNK];
    alignas(32) float across[CHUNK], down[CHUNK];
};
LANES_INLINE void store_taps(TapRows& rows, int32_t i, const Taps& taps) {
    store(rows.upper + i, taps.upper);
    store(rows.lower + i, taps.lower);
    store(rows.across + i, taps.across);
    store(rows.down + i, taps.down);
}

// Looks colours up between two levels of maps, for the pixels of a mask; others keep their number
// in `texels`.
LANES_INLINE void look_up(const uint32_t* const* maps, f8 u, f8 v, i8 size, f8 level, i8 wanted,
                          float* texels) {
    const i8 whole = truncated(level);
    const f8 share = level - to_float(whole);
    const Taps fine = texture_taps(u, v, size, whole);
    const bool between = any(share > 0.0f);
    const Taps coarse = between ? texture_taps(u, v, size, whole < size ? whole + 1 : whole) : fine;
    for (int k = 0; k < 8; k++) {
        if (!wanted[k]) continue;
        f4 found =
            sample_bytes(maps[k], fine.upper[k], fine.lower[k], fine.across[k], fine.down[k]);
        if (between) {
            const f4 far = sample_bytes(maps[k], coarse.upper[k], coarse.lower[k], coarse.across[k],
                                        coarse.down[k]);
            found = found + (far - found) * share[k];
        }
        f4_any* sum = reinterpret_cast<f4_any*>(texels + 4 * k);
        *sum = *sum + found;
    }
}

// Where a chunk's colours are looked up: the first place, the step to the next, how many there are,
// and the level of detail.
struct LookUps {
    alignas(32) float u[CHUNK], v[CHUNK], step_u[CHUNK], step_v[CHUNK], count[CHUNK], level[CHUNK];
};

LANES_INLINE i8 colour_size(f8 log2) { return truncated(max8(log2, splat(0.0f))); }

// Finds them, and has the first texels of each pixel on their way before any is needed.
LANES_INLINE void find_look_ups(const Chunk& c, float bias, float most, LookUps& found) {
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 log2 = load(c.colour_log2 + i);
        const i8 mapped = log2 >= 0.0f;
        if (!any(mapped)) continue;
        const i8 size = colour_size(log2);
        const Slopes d = uv_slopes(c, i);
        const f8 across = d.ux * d.ux + d.vx * d.vx, down = d.uy * d.uy + d.vy * d.vy;
        const i8 wide = across >= down;
        const f8 longer = wide ? across : down, shorter = wide ? down : across;
        const f8 ratio = sqrt8(longer / max8(shorter, longer * 0.001f + 1e-20f));
        const f8 count = clamp8(floor8(ratio + 0.5f), 1.0f, most), share = 1.0f / count;
        const f8 step_u = (wide ? d.ux : d.uy) * share, step_v = (wide ? d.vx : d.vy) * share;
        const f8 level = level_of_detail(step_u, step_v, step_u, step_v, size, bias);
        const f8 first = 0.5f - 0.5f * count;
        const f8 u = load(c.u + i) + step_u * first, v = load(c.v + i) + step_v * first;
        store(found.u + i, u);
        store(found.v + i, v);
        store(found.step_u + i, step_u);
        store(found.step_v + i, step_v);
        store(found.count + i, count);
        store(found.level + i, level);
        const Taps taps = texture_taps(u, v, size, truncated(level));
        for (int k = 0; k < 8; k++) {
            if (!mapped[k]) continue;
            __builtin_prefetch(c.colour_texels[i + k] + taps.upper[k]);
            __builtin_prefetch(c.colour_texels[i + k] + taps.lower[k]);
        }
    }
}

// Multiplies base colours by what colour maps hold: by the mean of up to `most` look-ups along the
// longer side of what a pixel covers. `bias` chooses finer levels where below 0.
void multiply_by_maps(Chunk& c, float bias, float most) {
    LookUps at;
    find_look_ups(c, bias, most, at);
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 log2 = load(c.colour_log2 + i);
        const i8 mapped = log2 >= 0.0f;
        if (!any(mapped)) continue;
        const i8 size = colour_size(log2);
        const f8 u = load(at.u + i), v = load(at.v + i), level = load(at.level + i);
        const f8 step_u = load(at.step_u + i), step_v = load(at.step_v + i);
        const f8 count = load(at.count + i);
        alignas(32) float texels[4 * 8] = {};
        i8 wanted = mapped;
        for (float k = 0.0f; any(wanted); k += 1.0f, wanted &= count > k) {
            look_up(c.colour_texels + i, u + step_u * k, v + step_v * k, size, level, wanted,
                    texels);
        }
        Vec3x8 sum;
        f8 alpha;
        transpose4(texels, sum.x, sum.y, sum.z, alpha);
        const f8 unit = (1.0f / count) * (1.0f / 255.0f);
        c.base.set(i, c.base.at(i) * where(mapped, sum * unit, splat(vec3(1.0f, 1.0f, 1.0f))));
    }
}

// How rays change from pixel to pixel, from changes of their places on faces.
Vec3x8 face_steps(const Shading& s, const Chunk& c, int32_t i, const float* x, const float* y) {
    const int32_t first = c.face[i];
    if (first != NO_FACE && !any(load(c.face + i) != first)) {
        const Mat3& turn = s.world_from_face[first];
        return turn.column(0) * load(x + i) + turn.column(1) * load(y + i);
    }
    Vec3x8 steps;
    for (int32_t k = 0; k < 8; k++) {
        const int32_t at = i + k, face = c.face[at] == NO_FACE ? 0 : c.face[at];
        const Mat3& turn = s.world_from_face[face];
        const vec3 step = turn.column(0) * x[at] + turn.column(1) * y[at];
        steps.x[k] = step.x;
        steps.y[k] = step.y;
        steps.z[k] = step.z;
    }
    return steps;
}

}  // namespace

void colour_for_picture(Chunk& c) { multiply_by_maps(c, PICTURE_BIAS, MOST_LOOK_UPS); }

void colour_of_pixels(Chunk& c) { multiply_by_maps(c, 0.0f, 1.0f); }

void apply_detail_maps(const Shading& s, Chunk& c) {
    TapRows taps;
    for (int32_t i = 0; i < c.padded; i += 8) {
        const Slopes d = uv_slopes(c, i);
        const i8 size = truncated(load(c.detail_log2 + i));
        const f8 level = level_of_detail(d.ux, d.vx, d.uy, d.vy, size, 0.5f);
        store_taps(taps, i, texture_taps(load(c.u + i), load(c.v + i), size, truncated(level)));
        for (int32_t at = i; at < i + 8; at++) {
            __builtin_prefetch(c.detail_texels[at] + taps.upper[at]);
            __builtin_prefetch(c.detail_texels[at] + taps.lower[at]);
        }
    }
    const RaySteps everywhere = ray_steps(s.lens, s.world_from_camera);
    alignas(32) float texels[4 * 8];
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 relief = load(c.relief + i), finish = load(c.finish + i);
        if (!any((relief > 0.0f) | (finish > 0.0f))) continue;
        for (int k = 0; k < 8; k++) {
            const int32_t at = i + k;
            *reinterpret_cast<f4_any*>(texels + 4 * k) =
                sample_bytes(c.detail_texels[at], taps.upper[at], taps.lower[at], taps.across[at],
                             taps.down[at]);
        }
        f8 tx, ty, rough, metal;
        transpose4(texels, tx, ty, rough, metal);
        const f8 with_finish = 1.0f / 255.0f * finish;
        store(c.roughness + i, load(c.roughness + i) * (1.0f - finish + rough * with_finish));
        store(c.metallic + i, load(c.metallic + i) * (1.0f - finish + metal * with_finish));
        if (!any(relief > 0.0f)) continue;
        const Slopes d = uv_slopes(c, i);
        // How the point moves from pixel to pixel, over its depth; where rays are parallel over 1.
        const f8 depth = c.parallel ? splat(1.0f) : load(c.depth + i);
        const f8 zx = -depth * load(c.inverse_depth_x + i),
                 zy = -depth * load(c.inverse_depth_y + i);
        const Vec3x8 ray = c.ray.at(i), normal = c.normal.at(i);
        Vec3x8 right = splat(everywhere.right), down = splat(everywhere.down);
        if (s.table != nullptr) {
            right = face_steps(s, c, i, c.x_right, c.y_right);
            down = face_steps(s, c, i, c.x_down, c.y_down);
        }
        const Vec3x8 across_y = cross(down + ray * zy, normal);
        const Vec3x8 across_x = cross(normal, right + ray * zx);
        const Vec3x8 tangent = across_y * d.ux + across_x * d.uy;
        const Vec3x8 bitangent = across_y * d.vx + across_x * d.vy;
        const f8 longest = max8(dot(tangent, tangent), dot(bitangent, bitangent));
        const f8 scale = 1.0f / sqrt8(max8(longest, splat(1e-30f)));
        const f8 lx = tx * (2.0f / 255.0f) - 1.0f, ly = ty * (2.0f / 255.0f) - 1.0f;
        const f8 upright = sqrt8(max8(1.0f - lx * lx - ly * ly, splat(0.0f)));
        const Vec3x8 bent = tangent * (-lx * scale) + bitangent * (-ly * scale) + normal * upright;
        const i8 there = (relief > 0.0f) & (longest >= 1e-30f);
        c.normal.set(i, where(there, bent * inverse_length(bent), normal));
    }
}

}  // namespace sailenv
