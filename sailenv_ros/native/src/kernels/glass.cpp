// See-through surfaces over a finished picture; the same model as shaders/glass.frag.
#include <algorithm>

#include "shade.h"
#include "texture.h"

namespace sailenv {
namespace {

// What glass mirrors is looked at by rays if it is brighter than a share of what else is seen; from
// the larger one on rays tell all of it.
constexpr float LEAST_SEEN = 0.2f, WELL_SEEN = 0.4f;
constexpr float MOST_BENT = 0.3f;  // what a pixel bends more has no picture [rad]
constexpr float DARK = 1e-4f;      // radiance, exposed

// A triangle's corners, as planes over depth, or over 1 where rays are parallel: object normal, uv,
// place in the light map or a factor and what is hidden.
struct Planes {
    f8 along_x, along_y, at_0;
};

Planes planes_of(const Triangle& t, const Part& part, const Light* light) {
    Planes p{splat(0.0f), splat(0.0f), splat(0.0f)};
    const float* factors = factors_of(light, part, t.back);
    for (int k = 0; k < 3; k++) {
        const f8 corner = vertex_of(part, factors, t.vertex[k]);
        p.along_x += corner * (t.edge[3 * k] * t.inverse_det);
        p.along_y += corner * (t.edge[3 * k + 1] * t.inverse_det);
        p.at_0 += corner * (t.edge[3 * k + 2] * t.inverse_det);
    }
    return p;
}

// Square root of base colour, and alpha.
struct Base8 {
    Vec3x8 colour;
    f8 alpha;
};

// `over` is what the planes are over: 1 / over is a function with slopes `over_x` and `over_y`.
template <class Steps>
Base8 base_colour(const Part& part, const Planes& p, const Steps& steps, f8 over, float over_x,
                  float over_y, f8 u, f8 v, i8 wanted) {
    const float* factor = part.colour;
    if (part.colour_map == nullptr) {
        return {splat(vec3(factor[0], factor[1], factor[2])), splat(factor[3])};
    }
    const i8 size = splat(static_cast<int32_t>(part.colour_map->log2_size));
    const f8 ux = over * (p.along_x[3] - u * over_x), vx = over * (p.along_x[4] - v * over_x),
             uy = over * (p.along_y[3] - u * over_y), vy = over * (p.along_y[4] - v * over_y);
    const f8 level =
        level_of_detail(to_right(steps, ux, uy), to_right(steps, vx, vy), downwards(steps, ux, uy),
                        downwards(steps, vx, vy), size, 0.0f);
    const auto [near, far, share] = mip_taps(u, v, size, level);
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
    transpose4(found, c.colour.x, c.colour.y, c.colour.z, c.alpha);
    const float per_byte = 1.0f / 255.0f;
    return {c.colour * vec3(factor[0] * per_byte, factor[1] * per_byte, factor[2] * per_byte),
            c.alpha * (factor[3] * per_byte)};
}

// Irradiance / pi on a surface.
Vec3x8 light_around(const Light& light, int32_t id, Vec3x8 normal, Vec3x8 point) {
    if (!light.baked) return light_of_sky(light, normal.z);
    return light_of_instances(light, splat(id), ~splat(0), normal, point);
}

// Radiance that eight points of an instance mirror.
Vec3x8 mirrored_light(const Light& light, const Part& part, Vec3x8 point, Vec3x8 direction,
                      f8 roughness) {
    if (!light.baked || !light.reflecting) {
        return light.ambient + light.sky_share * analytic_sky(light, direction.z);
    }
    const i8 seen_from = splat(light.reflection_table[part.id]);
    return mirrored_room(light, seen_from, point, direction, roughness);
}

// How a surface curves within eight pixels.
struct Curve {
    f8 least;  // of the square of the cosine to the view: what it is in the middle of a border
    f8 bend;   // of the normal, from pixel to pixel [rad]
};

// `right` and `down` are what a normal, whose length's inverse is `unit`, changes by to the next
// pixels. At a border the square of the cosine grows evenly from 0 on.
Curve curve_of(Vec3x8 normal, f8 unit, f8 facing, Vec3x8 view, Vec3x8 right, Vec3x8 down) {
    const auto growth = [&](Vec3x8 step) {
        const Vec3x8 beside = normal + step;
        const f8 cosine = dot(beside, view) * inverse_length(beside);
        return abs8(cosine * cosine - facing * facing);
    };
    return {0.5f * max8(growth(right), growth(down)),
            sqrt8(max8(dot(right, right), dot(down, down))) * unit};
}

// Dims what lies behind eight pixels and adds what the glass mirrors and scatters. `at` and `row`
// are their places, `ray` leads there in the world frame from `begin`.
template <class Row, class Steps>
void blend(const Shading& s, const Triangle& t, const Part& part, const Planes& p, int32_t x,
           int32_t y, f8 at, Row row, const Steps& steps, Vec3x8 begin, Vec3x8 ray,
           f8 inverse_depth, i8 wanted) {
    const Light& light = *s.light;
    const bool parallel = s.sight == Sight::PARALLEL;
    const f8 depth = parallel ? -inverse_depth : 1.0f / (wanted ? inverse_depth : splat(1.0f));
    const f8 over = parallel ? splat(1.0f) : depth;
    const float over_x = parallel ? 0.0f : t.inverse_depth[0],
                over_y = parallel ? 0.0f : t.inverse_depth[1];
    const auto attribute = [&](int k) {
        return (p.along_x[k] * at + (p.along_y[k] * row + p.at_0[k])) * over;
    };
    const f8 u = attribute(3), v = attribute(4);
    const Base8 base = base_colour(part, p, steps, over, over_x, over_y, u, v, wanted);
    const Vec3x8 colour = base.colour * base.colour;
    const Vec3x8 view = ray * -inverse_length(ray);
    const float (*n)[8] = s.frames[part.instance].normal_columns;
    const auto in_world = [&](Vec3x8 a) {
        return vec3(n[0][0], n[0][1], n[0][2]) * a.x + vec3(n[1][0], n[1][1], n[1][2]) * a.y +
               vec3(n[2][0], n[2][1], n[2][2]) * a.z;
    };
    const Vec3x8 own_normal(attribute(0), attribute(1), attribute(2));
    Vec3x8 normal = in_world(own_normal);
    const f8 unit = inverse_length(normal);
    f8 facing = dot(normal, view) * unit;
    const bool mirrors = part.roughness < LEAST_CLOTH;
    Curve curve{};
    if (mirrors) {
        const auto slope = [&](const float* along, float over_along) {
            return over * (vec3(along[0], along[1], along[2]) - own_normal * over_along);
        };
        const float x_along[3] = {p.along_x[0], p.along_x[1], p.along_x[2]},
                    y_along[3] = {p.along_y[0], p.along_y[1], p.along_y[2]};
        const Vec3x8 slope_x = slope(x_along, over_x), slope_y = slope(y_along, over_y);
        const Vec3x8 right(to_right(steps, slope_x.x, slope_y.x),
                           to_right(steps, slope_x.y, slope_y.y),
                           to_right(steps, slope_x.z, slope_y.z)),
            down(downwards(steps, slope_x.x, slope_y.x), downwards(steps, slope_x.y, slope_y.y),
                 downwards(steps, slope_x.z, slope_y.z));
        curve = curve_of(normal, unit, facing, view, in_world(right), in_world(down));
    }
    normal = normal * (facing < 0.0f ? -unit : unit);
    facing = abs8(facing);
    // A pixel at a border mirrors what it does in its middle, wherever its centre lies.
    const f8 across = sqrt8(max8(facing * facing, curve.least));
    const f8 share = pane_reflectance(across, part.roughness), rest = 1.0f - share;
    const Vec3x8 point = begin + ray * depth;
    const Vec3x8 direction = 2.0f * facing * normal - view;
    Vec3x8 mirrored = splat(vec3(0.0f, 0.0f, 0.0f));
    if (mirrors) {
        // What a pixel mirrors in many directions is as if it were rough.
        const f8 roughness = clamp8(curve.bend, part.roughness, 1.0f);
        mirrored = mirrored_light(light, part, point, direction, roughness);
    }
    Vec3x8 around = light_around(light, part.id, normal, point);
    const f8 hidden = attribute(5) > 0.0f ? splat(0.0f) : attribute(6);
    around = around * vertex_factor(attribute(5));
    if (any(wanted & (hidden > 0.0f))) {
        around = around * Vec3x8(arriving_share(hidden, colour.x), arriving_share(hidden, colour.y),
                                 arriving_share(hidden, colour.z));
    }
    const Vec3x8 own = rest * base.alpha * colour * around + colour * part.emission;
    // What comes through takes the hue of the material, the more the denser it is.
    const Vec3x8 hue = colour / max(largest(colour), 1e-3f);
    const Vec3x8 through =
        rest * (1.0f - base.alpha) * mix(vec3(1.0f, 1.0f, 1.0f), hue, base.alpha);
    uint16_t* radiance = s.outputs->radiance + 4 * (y * s.width + x);
    alignas(32) float behind[4 * 8] = {};
    for (int k = 0; k < 8; k++) {
        if (!wanted[k]) continue;
        for (int j = 0; j < 3; j++) {
            behind[8 * j + k] = number_of_half(radiance[4 * k + j]);
        }
    }
    const Vec3x8 seen_through = Vec3x8(load(behind), load(behind + 8), load(behind + 16)) * through;
    if (mirrors && light.reflecting && light.traced != nullptr) {
        const f8 seen = luminance(own * light.exposure + seen_through);
        // In the dark all is seen that glass mirrors.
        const f8 clear = (luminance(mirrored) * share * light.exposure + DARK) / (seen + DARK);
        const i8 looked_at = wanted & (clear >= LEAST_SEEN) & (curve.bend < MOST_BENT);
        if (any(looked_at)) {
            const f8 far = depth / inverse_length(ray);
            const Vec3x8 met = trace_glass(s, point, direction, far, looked_at, mirrored);
            const f8 weight = smoothstep(LEAST_SEEN, WELL_SEEN, clear);
            mirrored = mirrored + (met - mirrored) * weight;
        }
    }
    const Vec3x8 added = share * mirrored + own;
    const Vec3x8 sum = clamp(clamp(added * light.exposure, 0.0f, 6e4f) + seen_through, 0.0f, 6e4f);
    const i8 r = to_half(sum.x), g = to_half(sum.y), b = to_half(sum.z);
    for (int k = 0; k < 8; k++) {
        if (!wanted[k]) continue;
        // The share of light from around stays that of what lies behind.
        radiance[4 * k] = static_cast<uint16_t>(r[k]);
        radiance[4 * k + 1] = static_cast<uint16_t>(g[k]);
        radiance[4 * k + 2] = static_cast<uint16_t>(b[k]);
    }
}

// Blends a triangle's pixels of a row; beyond the picture's right side are other pixels' numbers.
void draw_row(const Shading& s, const Triangle& t, const Part& part, const Planes& planes,
              const Projection& projection, int32_t y, const float* inverse_depth) {
    const float least0 = least_inside(t.edge), least1 = least_inside(t.edge + 3),
                least2 = least_inside(t.edge + 6);
    const float row = static_cast<float>(y);
    const float c0 = t.edge[1] * row + t.edge[2], c1 = t.edge[4] * row + t.edge[5],
                c2 = t.edge[7] * row + t.edge[8],
                cn = t.inverse_depth[1] * row + t.inverse_depth[2];
    for (int32_t x = t.x0; x <= t.x1; x += 8) {
        const f8 at = counting() + static_cast<float>(x);
        const f8 n = t.inverse_depth[0] * at + cn;
        const i8 drawn = (t.edge[0] * at + c0 >= least0) & (t.edge[3] * at + c1 >= least1) &
                         (t.edge[6] * at + c2 >= least2) & (n > load(inverse_depth + x)) &
                         (n <= projection.greatest_inverse_depth) &
                         (at < static_cast<float>(projection.width));
        if (!any(drawn)) continue;
        blend(s, t, part, planes, x, y, at, row, PixelSteps{}, begin_of_ray(s, at, row),
              ray_to(s, at, row), n, drawn);
    }
}

// The same through a lens that bends lines; there is nothing beyond a row of its table.
void draw_lens_row(const Shading& s, const Triangle& t, const Part& part, const Planes& planes,
                   const Projection& projection, int32_t y, const float* inverse_depth) {
    const float least0 = least_inside(t.edge), least1 = least_inside(t.edge + 3),
                least2 = least_inside(t.edge + 6);
    const LensTable& lens = *projection.table;
    const int64_t first = y * lens.stride;
    const auto function = [](const float* f, f8 x, f8 down) {
        return f[0] * x + (f[1] * down + f[2]);
    };
    // From a whole eight on: `steps_at` is quick there.
    for (int32_t x = t.x0 / 8 * 8; x <= t.x1; x += 8) {
        const f8 at = load(lens.x + first + x), down = load(lens.y + first + x);
        const f8 n = function(t.inverse_depth, at, down);
        const i8 drawn =
            (function(t.edge, at, down) >= least0) & (function(t.edge + 3, at, down) >= least1) &
            (function(t.edge + 6, at, down) >= least2) & (n > load(inverse_depth + x)) &
            (n <= projection.greatest_inverse_depth) & lies_on(lens.face + first + x, t.face);
        if (!any(drawn)) continue;
        const Vec3x8 ray = ray_at(s.world_from_face[t.face], at, down);
        blend(s, t, part, planes, x, y, at, down, steps_at(lens, y, x), splat(s.eye), ray, n,
              drawn);
    }
}

// How near the middle of a triangle's box in the picture is; see `Triangle::inverse_depth`.
float nearness(const Triangle& t, const Projection& projection) {
    const int32_t x = (t.x0 + t.x1) / 2, y = (t.y0 + t.y1) / 2;
    float at = static_cast<float>(x), down = static_cast<float>(y);
    if (projection.table != nullptr) {
        const int64_t place = y * projection.table->stride + x;
        at = projection.table->x[place];
        down = projection.table->y[place];
    }
    return t.inverse_depth[0] * at + (t.inverse_depth[1] * down + t.inverse_depth[2]);
}

// The triangles of a band, part by part in their order, of each part the most distant first: the
// far wall of a vessel before the near one, which dims what it sends.
std::vector<uint32_t> farthest_first(const TriangleSet& glass, const Projection& projection,
                                     int32_t band) {
    std::vector<uint32_t> order;
    for_triangles(glass, band, [&](uint32_t number) { order.push_back(number); });
    const auto part = [&](uint32_t number) { return glass.triangles[number].part; };
    for (auto first = order.begin(); first != order.end();) {
        const auto end = std::find_if(
            first, order.end(), [&](uint32_t number) { return part(number) != part(*first); });
        std::stable_sort(first, end, [&](uint32_t a, uint32_t b) {
            return nearness(glass.triangles[a], projection) <
                   nearness(glass.triangles[b], projection);
        });
        first = end;
    }
    return order;
}

}  // namespace

void draw_glass_band(const Shading& s, const TriangleSet& glass, const DrawList& parts,
                     const Projection& projection, int32_t band, int32_t band_rows,
                     const float* inverse_depth) {
    const int32_t first_row = band * band_rows;
    const int32_t end_row = first_row + band_rows;
    const int32_t last_row = (end_row < projection.height ? end_row : projection.height) - 1;
    for (const uint32_t number : farthest_first(glass, projection, band)) {
        const Triangle& t = glass.triangles[number];
        const Part& part = parts.parts[t.part];
        const Planes planes = planes_of(t, part, s.light);
        const int32_t y0 = t.y0 > first_row ? t.y0 : first_row;
        const int32_t y1 = t.y1 < last_row ? t.y1 : last_row;
        for (int32_t y = y0; y <= y1; y++) {
            if (projection.table != nullptr) {
                draw_lens_row(s, t, part, planes, projection, y, inverse_depth + y * s.stride);
            } else {
                draw_row(s, t, part, planes, projection, y, inverse_depth + y * s.stride);
            }
        }
    }
}

}  // namespace sailenv
