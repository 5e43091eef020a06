// See-through surfaces over a finished picture; the same model as shaders/glass.frag.
#include "shade.h"
#include "texture.h"

namespace sailenv {
namespace {

// A triangle's corners, as planes over depth: object normal, uv.
struct Planes {
    f8 along_x, along_y, at_0;
};

Planes planes_of(const Triangle& t, const Part& part) {
    Planes p{splat(0.0f), splat(0.0f), splat(0.0f)};
    for (int k = 0; k < 3; k++) {
        const f8 corner = load(part.vertices + 8 * static_cast<int64_t>(t.vertex[k]));
        p.along_x += corner * (t.edge[3 * k] * t.inverse_det);
        p.along_y += corner * (t.edge[3 * k + 1] * t.inverse_det);
        p.at_0 += corner * (t.edge[3 * k + 2] * t.inverse_det);
    }
    return p;
}

// Square root of base colour, and alpha.
struct Base8 {
    f8 x, y, z, a;
};

Base8 base_colour(const Part& part, const Planes& p, const Triangle& t, f8 depth, f8 u, f8 v,
                  i8 wanted) {
    const float* factor = part.colour;
    if (part.colour_map == nullptr) {
        return {splat(factor[0]), splat(factor[1]), splat(factor[2]), splat(factor[3])};
    }
    const i8 size = splat(static_cast<int32_t>(part.colour_map->log2_size));
    const f8 level = level_of_detail(depth * (p.along_x[3] - u * t.nearness[0]),
                                     depth * (p.along_x[4] - v * t.nearness[0]),
                                     depth * (p.along_y[3] - u * t.nearness[1]),
                                     depth * (p.along_y[4] - v * t.nearness[1]), size, 0.0f);
    const i8 fine = truncated(level);
    const i8 coarse = fine < size ? fine + 1 : fine;
    const Taps near = texture_taps(u, v, size, fine), far = texture_taps(u, v, size, coarse);
    const f8 share = level - as_float(fine);
    const uint32_t* texels = part.colour_map->texels;
    alignas(32) float found[4 * 8] = {};
    for (int k = 0; k < 8; k++) {
        if (!wanted[k]) continue;
        const f4 a =
            sample_bytes(texels, near.upper[k], near.lower[k], near.across[k], near.down[k]);
        const f4 b = sample_bytes(texels, far.upper[k], far.lower[k], far.across[k], far.down[k]);
        *reinterpret_cast<f4_any*>(found + 4 * k) = a + (b - a) * share[k];
    }
    Base8 c;
    transpose4(found, c.x, c.y, c.z, c.a);
    const float over = 1.0f / 255.0f;
    return {c.x * (factor[0] * over), c.y * (factor[1] * over), c.z * (factor[2] * over),
            c.a * (factor[3] * over)};
}

// Irradiance / pi on a surface.
Vec3x8 light_around(const Light& light, int32_t id, f8 nx, f8 ny, f8 nz) {
    if (light.baked) {
        const float* p = light.instance_light + 12 * static_cast<int64_t>(id);
        const f8 none = splat(0.0f);
        return {max8(p[0] + p[1] * nx + p[2] * ny + p[3] * nz, none),
                max8(p[4] + p[5] * nx + p[6] * ny + p[7] * nz, none),
                max8(p[8] + p[9] * nx + p[10] * ny + p[11] * nz, none)};
    }
    return light_of_sky(light, nz);
}

// Dims what lies behind eight pixels and adds what the glass mirrors and scatters.
void blend(const Shading& s, const Triangle& t, const Part& part, const Planes& p, int32_t x,
           int32_t y, f8 nearness, i8 wanted) {
    const Light& light = *s.light;
    const f8 at = counting() + static_cast<float>(x);
    const float row = static_cast<float>(y);
    const f8 depth = 1.0f / (wanted ? nearness : splat(1.0f));
    auto attribute = [&](int k) {
        return (p.along_x[k] * at + (p.along_y[k] * row + p.at_0[k])) * depth;
    };
    const f8 u = attribute(3), v = attribute(4);
    Base8 base = base_colour(part, p, t, depth, u, v, wanted);
    base.x *= base.x;
    base.y *= base.y;
    base.z *= base.z;
    const float* m = s.world_from_camera;
    const f8 cx = (at - s.cx) * (1.0f / s.focal);
    const float cy = (row - s.cy) / s.focal;
    const f8 rx = m[0] * cx + (m[1] * cy + m[2]), ry = m[3] * cx + (m[4] * cy + m[5]),
             rz = m[6] * cx + (m[7] * cy + m[8]);
    const f8 to_eye = -inverse_length(rx, ry, rz);
    const f8 vx = rx * to_eye, vy = ry * to_eye, vz = rz * to_eye;
    const InstanceFrame& frame = s.frames[part.instance];
    const f8 ox = attribute(0), oy = attribute(1), oz = attribute(2);
    const float (*n)[8] = frame.normal_columns;
    f8 nx = n[0][0] * ox + n[1][0] * oy + n[2][0] * oz;
    f8 ny = n[0][1] * ox + n[1][1] * oy + n[2][1] * oz;
    f8 nz = n[0][2] * ox + n[1][2] * oy + n[2][2] * oz;
    const f8 unit = inverse_length(nx, ny, nz);
    f8 facing = (nx * vx + ny * vy + nz * vz) * unit;
    const f8 side = facing < 0.0f ? -unit : unit;
    nx *= side;
    ny *= side;
    nz *= side;
    facing = abs8(facing);
    // Schlick's term for a refractive index of 1.5.
    const f8 grazing = 1.0f - min8(facing, splat(1.0f));
    const f8 g2 = grazing * grazing;
    const f8 fresnel = 0.04f + 0.96f * (g2 * g2 * grazing);
    const f8 rest = 1.0f - fresnel;
    const f8 brightest = max8(max8(base.x, max8(base.y, base.z)), splat(1e-3f));
    const f8 clear = rest * (1.0f - base.a);
    const f8 mx = 2.0f * facing * nx - vx, my = 2.0f * facing * ny - vy,
             mz = 2.0f * facing * nz - vz;
    Vec3x8 seen;
    if (light.baked && light.reflecting) {
        seen = mirrored_room(light, splat(light.reflection_table[part.id]), s.eye[0] + rx * depth,
                             s.eye[1] + ry * depth, s.eye[2] + rz * depth, mx, my, mz,
                             splat(part.roughness));
    } else {
        seen = light.ambient + light.sky_share * analytic_sky(light, mz);
    }
    const Vec3x8 around = light_around(light, part.id, nx, ny, nz);
    const f8 scattered = rest * base.a;
    uint16_t* radiance = s.outputs->radiance + 4 * (y * s.width + x);
    alignas(32) float behind[4 * 8] = {};
    for (int k = 0; k < 8; k++) {
        if (!wanted[k]) continue;
        for (int j = 0; j < 3; j++) {
            behind[8 * j + k] = from_half(splat(static_cast<int32_t>(radiance[4 * k + j])))[0];
        }
    }
    auto over = [&](int j, f8 colour, f8 mirrored, f8 from_around) {
        const f8 added =
            fresnel * mirrored + scattered * colour * from_around + colour * part.emission;
        // What comes through takes the hue of the material, the more the denser it is.
        const f8 through = clear * mix8(splat(1.0f), colour / brightest, base.a);
        const f8 sum = clamp8(added * light.exposure, 0.0f, 6e4f) + load(behind + 8 * j) * through;
        return to_half(clamp8(sum, 0.0f, 6e4f));
    };
    const i8 r = over(0, base.x, seen.x, around.x), g = over(1, base.y, seen.y, around.y),
             b = over(2, base.z, seen.z, around.z);
    for (int k = 0; k < 8; k++) {
        if (!wanted[k]) continue;
        // The share of light from around stays that of what lies behind.
        radiance[4 * k] = static_cast<uint16_t>(r[k]);
        radiance[4 * k + 1] = static_cast<uint16_t>(g[k]);
        radiance[4 * k + 2] = static_cast<uint16_t>(b[k]);
    }
}

LANES_INLINE float least_inside(const float* edge) {
    const bool own = edge[0] > 0.0f || (edge[0] == 0.0f && edge[1] > 0.0f);
    return own ? 0.0f : 1.1754944e-38f;
}

}  // namespace

void draw_glass_band(const Shading& s, const TriangleSet& glass, const DrawList& parts,
                     const Projection& projection, int32_t band, int32_t band_rows,
                     const float* nearness) {
    const int32_t first_row = band * band_rows;
    const int32_t end = first_row + band_rows;
    const int32_t last_row = (end < projection.height ? end : projection.height) - 1;
    for (int64_t g = 0; g < glass.segment_count; g++) {
        const Segment& segment = glass.segments[static_cast<size_t>(g)];
        for (uint32_t k = segment.starts[static_cast<size_t>(band)];
             k < segment.starts[static_cast<size_t>(band) + 1]; k++) {
            const Triangle& t = glass.triangles[segment.entries[k]];
            const Part& part = parts.parts[t.part];
            const Planes planes = planes_of(t, part);
            const int32_t y0 = t.y0 > first_row ? t.y0 : first_row;
            const int32_t y1 = t.y1 < last_row ? t.y1 : last_row;
            const float least0 = least_inside(t.edge), least1 = least_inside(t.edge + 3),
                        least2 = least_inside(t.edge + 6);
            for (int32_t y = y0; y <= y1; y++) {
                const float row = static_cast<float>(y);
                const float c0 = t.edge[1] * row + t.edge[2], c1 = t.edge[4] * row + t.edge[5],
                            c2 = t.edge[7] * row + t.edge[8],
                            cn = t.nearness[1] * row + t.nearness[2];
                for (int32_t x = t.x0; x <= t.x1; x += 8) {
                    const f8 at = counting() + static_cast<float>(x);
                    const f8 n = t.nearness[0] * at + cn;
                    // Beyond the picture's right side are other pixels' numbers.
                    const i8 drawn =
                        (t.edge[0] * at + c0 >= least0) & (t.edge[3] * at + c1 >= least1) &
                        (t.edge[6] * at + c2 >= least2) & (n > load(nearness + y * s.stride + x)) &
                        (n <= projection.greatest_nearness) &
                        (at < static_cast<float>(projection.width));
                    if (any(drawn)) blend(s, t, part, planes, x, y, n, drawn);
                }
            }
        }
    }
}

}  // namespace sailenv
