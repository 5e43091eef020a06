// Light of opaque surfaces and of the sky: the same model as shaders/lighting.frag and sky.frag.
//
// A band is walked down in chunks of 64 pixels of a row. A chunk's numbers lie in arrays, one for
// each quantity, and each stage goes over them eight at a time.
#include "shade.h"

#include "layer_sum.h"
#include "texture.h"

namespace sailenv {
namespace {

constexpr int32_t CHUNK = 64;
constexpr float PI = 3.14159265f;
// Pictures of colour maps are nearest to the mean over the pixel a little finer: measured
// beside 4 x 4 samples a pixel. The same as in shaders/textures.glsl.
constexpr float PICTURE_BIAS = -0.25f;
constexpr float MOST_LOOK_UPS = 4.0f;
constexpr float NO_MAP = -1.0f;  // in place of the logarithm of a texture's size

struct Chunk {
    int32_t x, y, count, padded;                 // of a row; `x` and `y` not of fragments
    alignas(32) float at_x[CHUNK], at_y[CHUNK];  // [pixels]
    bool hit, missed, coloured, detailed;        // what there is among the pixels
    alignas(32) float depth[CHUNK], nx[CHUNK], ny[CHUNK], nz[CHUNK];  // normal: world frame
    alignas(32) float u[CHUNK], v[CHUNK], light_u[CHUNK], light_v[CHUNK];
    // Changes of uv / depth and of 1 / depth from pixel to pixel.
    alignas(32) float ux[CHUNK], vx[CHUNK], uy[CHUNK], vy[CHUNK], nearness_x[CHUNK],
        nearness_y[CHUNK];
    alignas(32) float red[CHUNK], green[CHUNK], blue[CHUNK];  // base colour
    alignas(32) float roughness[CHUNK], metallic[CHUNK], emission[CHUNK];
    alignas(32) float colour_log2[CHUNK], detail_log2[CHUNK], finish[CHUNK], relief[CHUNK];
    const uint32_t* colour_texels[CHUNK];
    const uint32_t* detail_texels[CHUNK];
    alignas(32) int32_t id[CHUNK], empty[CHUNK];                 // empty: all bits where nothing is
    alignas(32) float ray_x[CHUNK], ray_y[CHUNK], ray_z[CHUNK];  // world frame, depth 1
    alignas(32) float px[CHUNK], py[CHUNK], pz[CHUNK];           // world [m]
    alignas(32) float around_r[CHUNK], around_g[CHUNK], around_b[CHUNK];
    alignas(32) float mirrored_r[CHUNK], mirrored_g[CHUNK], mirrored_b[CHUNK];
    alignas(32) float arrives[CHUNK];  // share of the main light
    alignas(32) float light_r[CHUNK], light_g[CHUNK], light_b[CHUNK], from_around[CHUNK];
};

LANES_INLINE f8 joined(const float* a, const float* b) {
    f8 r;
    memcpy(&r, a, 16);
    memcpy(reinterpret_cast<char*>(&r) + 16, b, 16);
    return r;
}

void write_surface(const Shading& s, int32_t x, int32_t y, int32_t count) {
    const uint32_t* visible = s.visible + y * s.stride + x;
    float* surface = s.outputs->surface + 2 * (y * s.width + x);
    for (int32_t i = 0; i < count;) {
        const uint32_t tag = visible[i];
        int32_t end = i + 1;
        while (end < count && visible[end] == tag) end++;
        if (tag == NOTHING) {
            for (; i < end; i++) {
                surface[2 * i] = __builtin_inff();
                surface[2 * i + 1] = 0.0f;
            }
            continue;
        }
        const Triangle& t = s.set->triangles[tag];
        const float offset = t.nearness[1] * static_cast<float>(y) + t.nearness[2];
        const float id = static_cast<float>(s.parts->parts[t.part].id);
        for (; i < end; i++) {
            surface[2 * i] = 1.0f / (t.nearness[0] * static_cast<float>(x + i) + offset);
            surface[2 * i + 1] = id;
        }
    }
}

// What the corners of a triangle know, over its depth: planes of a row of the picture.
struct RowPlanes {
    f8 slope, offset, moved;  // normal (world frame), uv, light uv, 1; `moved` is added at the end
    f8 look, maps;            // see `Chunk`: material, and how uv change from pixel to pixel
    const uint32_t *colour_texels, *detail_texels;
    float nearness_slope, nearness_offset;
    int32_t id;
    bool coloured, detailed;
};

constexpr f8 NOTHING_THERE = {1, 0, 0, 0, 0, 0, 0, 1}, PLAIN = {0, 0, 0, 0, 1, 0, 0, 0},
             NO_MAPS = {0, 0, 0, 0, NO_MAP, 0, 0, 0};

LANES_INLINE RowPlanes row_planes(const Shading& s, const Triangle& t, float y) {
    RowPlanes r;
    const Part& part = s.parts->parts[t.part];
    const InstanceFrame& frame = s.frames[part.instance];
    const float* vertex = part.vertices;
    const f8 a0 = load(vertex + 8 * static_cast<int64_t>(t.vertex[0]));
    const f8 a1 = load(vertex + 8 * static_cast<int64_t>(t.vertex[1]));
    const f8 a2 = load(vertex + 8 * static_cast<int64_t>(t.vertex[2]));
    const float q = t.inverse_det;
    const f8 object_x = a0 * (t.edge[0] * q) + a1 * (t.edge[3] * q) + a2 * (t.edge[6] * q);
    const f8 object_0 = a0 * ((t.edge[1] * y + t.edge[2]) * q) +
                        a1 * ((t.edge[4] * y + t.edge[5]) * q) +
                        a2 * ((t.edge[7] * y + t.edge[8]) * q);
    const bool charted = part.has_chart && s.at_baked_pose[part.instance];
    const f8 kept = {0, 0, 0, 1, 1, charted ? part.chart[2] : 0.0f, charted ? part.chart[3] : 0.0f,
                     0};
    r.moved = f8{0, 0, 0, 0, 0, charted ? part.chart[0] : 0.0f, charted ? part.chart[1] : 0.0f, 0};
    const float turned = t.back ? -1.0f : 1.0f;
    const f8 n0 = load(frame.normal_columns[0]) * turned,
             n1 = load(frame.normal_columns[1]) * turned,
             n2 = load(frame.normal_columns[2]) * turned;
    r.slope = object_x * kept + n0 * object_x[0] + n1 * object_x[1] + n2 * object_x[2];
    const f8 depth_lane = {0, 0, 0, 0, 0, 0, 0, 1};
    r.offset =
        object_0 * kept + n0 * object_0[0] + n1 * object_0[1] + n2 * object_0[2] + depth_lane;
    r.look = f8{part.colour[0], part.colour[1], part.colour[2], t.nearness[0],
                part.roughness, part.metallic,  part.emission,  t.nearness[1]};
    r.coloured = part.colour_map != nullptr;
    r.detailed = part.detail_map != nullptr;
    r.maps = NO_MAPS;
    r.colour_texels = r.coloured ? part.colour_map->texels : WHITE_TEXELS;
    r.detail_texels = r.detailed ? part.detail_map->texels : WHITE_TEXELS;
    if (r.coloured || r.detailed) {
        const f8 at_y = a0 * (t.edge[1] * q) + a1 * (t.edge[4] * q) + a2 * (t.edge[7] * q);
        r.maps = f8{object_x[3],
                    object_x[4],
                    at_y[3],
                    at_y[4],
                    r.coloured ? static_cast<float>(part.colour_map->log2_size) : NO_MAP,
                    r.detailed ? static_cast<float>(part.detail_map->log2_size) : 0.0f,
                    part.flags & PART_FINISH_MAP ? 1.0f : 0.0f,
                    part.flags & PART_NORMAL_MAP ? 1.0f : 0.0f};
    }
    r.nearness_slope = t.nearness[0];
    r.nearness_offset = t.nearness[1] * y + t.nearness[2];
    r.id = part.id;
    return r;
}

// A chunk's numbers pixel by pixel, before they are sorted by quantity.
struct PixelRows {
    alignas(32) float attributes[8 * CHUNK], material[8 * CHUNK], maps[8 * CHUNK];
};

LANES_INLINE void set_empty(Chunk& c, PixelRows& rows, int32_t i) {
    store(rows.attributes + 8 * i, NOTHING_THERE);
    store(rows.material + 8 * i, PLAIN);
    store(rows.maps + 8 * i, NO_MAPS);
    c.colour_texels[i] = c.detail_texels[i] = WHITE_TEXELS;
    c.id[i] = 0;
    c.empty[i] = -1;
}

LANES_INLINE void set_pixel(const RowPlanes& r, float x, Chunk& c, PixelRows& rows, int32_t i) {
    const float depth = 1.0f / (r.nearness_slope * x + r.nearness_offset);
    store(rows.attributes + 8 * i, (r.slope * x + r.offset) * depth + r.moved);
    store(rows.material + 8 * i, r.look);
    store(rows.maps + 8 * i, r.maps);
    c.colour_texels[i] = r.colour_texels;
    c.detail_texels[i] = r.detail_texels;
    c.id[i] = r.id;
    c.empty[i] = 0;
}

// Where a chunk keeps the eight numbers of each kind of row.
struct Columns {
    float *attributes[8], *material[8], *maps[8];
};
LANES_INLINE Columns columns_of(Chunk& c) {
    return {
        {c.nx, c.ny, c.nz, c.u, c.v, c.light_u, c.light_v, c.depth},
        {c.red, c.green, c.blue, c.nearness_x, c.roughness, c.metallic, c.emission, c.nearness_y},
        {c.ux, c.vx, c.uy, c.vy, c.colour_log2, c.detail_log2, c.finish, c.relief}};
}

// Eight pixels of one triangle: each number at its place at once.
LANES_INLINE void set_eight(const RowPlanes& r, Chunk& c, int32_t i) {
    const f8 xs = load(c.at_x + i);
    const f8 depth = 1.0f / (r.nearness_slope * xs + r.nearness_offset);
    const Columns columns = columns_of(c);
    for (int k = 0; k < 8; k++) {
        store(columns.attributes[k] + i, (r.slope[k] * xs + r.offset[k]) * depth + r.moved[k]);
        store(columns.material[k] + i, splat(r.look[k]));
        store(columns.maps[k] + i, splat(r.maps[k]));
    }
    store(c.id + i, splat(r.id));
    store(c.empty + i, splat(0));
    for (int k = 0; k < 8; k++) {
        c.colour_texels[i + k] = r.colour_texels;
        c.detail_texels[i + k] = r.detail_texels;
    }
}

// Rows of eight pixels to the columns of a chunk, from the i-th pixel on.
LANES_INLINE void sort_rows(const float* rows, float* const (&columns)[8], int32_t i) {
    f8 r[8];
    for (int k = 0; k < 8; k++) r[k] = load(rows + 8 * (i + k));
    transpose(r);
    for (int k = 0; k < 8; k++) store(columns[k] + i, r[k]);
}

// Sorts by quantity eight pixels from the i-th on.
void sort_eight(const PixelRows& rows, Chunk& c, int32_t i) {
    const Columns columns = columns_of(c);
    sort_rows(rows.attributes, columns.attributes, i);
    sort_rows(rows.material, columns.material, i);
    if (c.coloured || c.detailed) sort_rows(rows.maps, columns.maps, i);
}

// Asks for the memory of a triangle, or of its corners, before it is needed.
LANES_INLINE void prefetch(const Triangle* t) {
    __builtin_prefetch(t);
    __builtin_prefetch(reinterpret_cast<const char*>(t) + 64);
}
LANES_INLINE void prefetch_corners(const Shading& s, const Triangle& t) {
    const float* vertices = s.parts->parts[t.part].vertices;
    for (int k = 0; k < 3; k++) {
        __builtin_prefetch(vertices + 8 * static_cast<int64_t>(t.vertex[k]));
    }
}

// Interpolates what the triangles' corners know, and notes the materials.
void gather(const Shading& s, Chunk& c) {
    const uint32_t* visible = s.visible + c.y * s.stride + c.x;
    PixelRows rows;
    const float y = static_cast<float>(c.y);
    for (int32_t i = 0; i < c.padded; i += 8) {
        store(c.at_x + i, counting() + static_cast<float>(c.x + i));
        store(c.at_y + i, splat(y));
    }
    int16_t begins[CHUNK + 1];
    const Triangle* triangles[CHUNK];
    int32_t runs = 0;
    for (int32_t i = 0; i < c.count;) {
        const uint32_t tag = visible[i];
        begins[runs] = static_cast<int16_t>(i);
        const Triangle* t = tag == NOTHING ? nullptr : s.set->triangles.data() + tag;
        if (t != nullptr) prefetch(t);
        triangles[runs++] = t;
        do i++;
        while (i < c.count && visible[i] == tag);
    }
    begins[runs] = static_cast<int16_t>(c.count);
    for (int32_t r = 0; r < runs; r++) {
        if (triangles[r] != nullptr) prefetch_corners(s, *triangles[r]);
    }
    c.hit = c.missed = c.coloured = c.detailed = false;
    uint32_t whole = 0;  // groups of eight pixels that are filled in already
    for (int32_t r = 0; r < runs; r++) {
        int32_t i = begins[r];
        const int32_t end = begins[r + 1];
        if (triangles[r] == nullptr) {
            c.missed = true;
            for (; i < end; i++) set_empty(c, rows, i);
            continue;
        }
        const RowPlanes planes = row_planes(s, *triangles[r], y);
        c.hit = true;
        c.coloured |= planes.coloured;
        c.detailed |= planes.detailed;
        while (i < end) {
            if ((i & 7) == 0 && end - i >= 8) {
                whole |= 1u << (i / 8);
                set_eight(planes, c, i);
                i += 8;
            } else {
                set_pixel(planes, c.at_x[i], c, rows, i);
                i++;
            }
        }
    }
    for (int32_t i = c.count; i < c.padded; i++) set_empty(c, rows, i);
    for (int32_t i = 0; i < c.padded; i += 8) {
        if (!(whole >> (i / 8) & 1)) sort_eight(rows, c, i);
    }
}

// The same of points anywhere in the picture.
void gather_fragments(const Shading& s, const Fragment* fragments, Chunk& c) {
    PixelRows rows;
    for (int32_t i = 0; i < c.count; i++) {
        if (fragments[i].tag != NOTHING) prefetch(s.set->triangles.data() + fragments[i].tag);
    }
    for (int32_t i = 0; i < c.count; i++) {
        if (fragments[i].tag != NOTHING) {
            prefetch_corners(s, s.set->triangles[fragments[i].tag]);
        }
    }
    c.hit = c.missed = c.coloured = c.detailed = false;
    for (int32_t i = 0; i < c.padded; i++) {
        const Fragment& f = fragments[i < c.count ? i : 0];
        c.at_x[i] = f.x;
        c.at_y[i] = f.y;
        if (i >= c.count || f.tag == NOTHING) {
            c.missed |= i < c.count;
            set_empty(c, rows, i);
            continue;
        }
        const RowPlanes planes = row_planes(s, s.set->triangles[f.tag], f.y);
        c.hit = true;
        c.coloured |= planes.coloured;
        c.detailed |= planes.detailed;
        set_pixel(planes, f.x, c, rows, i);
    }
    for (int32_t i = 0; i < c.padded; i += 8) sort_eight(rows, c, i);
}

void set_rays(const Shading& s, Chunk& c) {
    const float* m = s.world_from_camera;
    const float inverse = 1.0f / s.focal;
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 x = (load(c.at_x + i) - s.cx) * inverse, y = (load(c.at_y + i) - s.cy) / s.focal;
        store(c.ray_x + i, m[0] * x + (m[1] * y + m[2]));
        store(c.ray_y + i, m[3] * x + (m[4] * y + m[5]));
        store(c.ray_z + i, m[6] * x + (m[7] * y + m[8]));
        const f8 nx = load(c.nx + i), ny = load(c.ny + i), nz = load(c.nz + i);
        const f8 scale = inverse_length(nx, ny, nz);
        store(c.nx + i, nx * scale);
        store(c.ny + i, ny * scale);
        store(c.nz + i, nz * scale);
    }
}

void write_normals(const Shading& s, const Chunk& c) {
    const float* m = s.camera_from_world;
    float* out = s.outputs->normals + 3 * (c.y * s.width + c.x);
    alignas(32) float x[CHUNK], y[CHUNK], z[CHUNK];
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 nx = load(c.nx + i), ny = load(c.ny + i), nz = load(c.nz + i);
        const i8 there = ~load(c.empty + i);
        store(x + i, number(bits(m[0] * nx + m[1] * ny + m[2] * nz) & there));
        store(y + i, number(bits(m[3] * nx + m[4] * ny + m[5] * nz) & there));
        store(z + i, number(bits(m[6] * nx + m[7] * ny + m[8] * nz) & there));
    }
    for (int32_t i = 0; i < c.count; i++) {
        out[3 * i] = x[i];
        out[3 * i + 1] = y[i];
        out[3 * i + 2] = z[i];
    }
}

// Changes of uv from pixel to pixel, of eight pixels.
struct Slopes {
    f8 ux, vx, uy, vy;
};

LANES_INLINE Slopes uv_slopes(const Chunk& c, int32_t i) {
    const f8 depth = load(c.depth + i), u = load(c.u + i), v = load(c.v + i);
    const f8 nx = load(c.nearness_x + i), ny = load(c.nearness_y + i);
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
    const f8 share = level - as_float(whole);
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

// Multiplies base colours by what colour maps hold: by the mean of up to `most` look-ups along the
// longer side of what a pixel covers. `bias` chooses finer levels where below 0.
void colour(Chunk& c, float bias, float most) {
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 log2 = load(c.colour_log2 + i);
        const i8 mapped = log2 >= 0.0f;
        if (!any(mapped)) continue;
        const i8 size = truncated(max8(log2, splat(0.0f)));
        const Slopes d = uv_slopes(c, i);
        const f8 across = d.ux * d.ux + d.vx * d.vx, down = d.uy * d.uy + d.vy * d.vy;
        const i8 wide = across >= down;
        const f8 longer = wide ? across : down, shorter = wide ? down : across;
        const f8 ratio = sqrt8(longer / max8(shorter, longer * 0.001f + 1e-20f));
        const f8 count = clamp8(floor8(ratio + 0.5f), 1.0f, most), share = 1.0f / count;
        const f8 along_u = (wide ? d.ux : d.uy) * share, along_v = (wide ? d.vx : d.vy) * share;
        const f8 level = level_of_detail(along_u, along_v, along_u, along_v, size, bias);
        const f8 first = 0.5f - 0.5f * count;
        const f8 u = load(c.u + i) + along_u * first, v = load(c.v + i) + along_v * first;
        alignas(32) float texels[4 * 8] = {};
        i8 wanted = mapped;
        for (float k = 0.0f; any(wanted); k += 1.0f, wanted &= count > k) {
            look_up(c.colour_texels + i, u + along_u * k, v + along_v * k, size, level, wanted,
                    texels);
        }
        Vec3x8 sum;
        f8 alpha;
        transpose4(texels, sum.x, sum.y, sum.z, alpha);
        const f8 unit = share * (1.0f / 255.0f);
        store(c.red + i, load(c.red + i) * (mapped ? sum.x * unit : splat(1.0f)));
        store(c.green + i, load(c.green + i) * (mapped ? sum.y * unit : splat(1.0f)));
        store(c.blue + i, load(c.blue + i) * (mapped ? sum.z * unit : splat(1.0f)));
    }
}

// Linear base colour. What glows is shaded in the glow's colour, so its own is looked up here.
void write_albedo(const Shading& s, Chunk& c) {
    alignas(32) float shaded[3][CHUNK];
    float* const channels[3] = {c.red, c.green, c.blue};
    for (int k = 0; k < 3; k++) {
        memcpy(shaded[k], channels[k], sizeof(shaded[k]));
        for (int32_t i = 0; i < c.padded; i += 8) store(channels[k] + i, splat(1.0f));
    }
    if (c.coloured) colour(c, 0.0f, 1.0f);
    const uint32_t* visible = s.visible + c.y * s.stride + c.x;
    float* out = s.outputs->albedo + 3 * (c.y * s.width + c.x);
    for (int32_t i = 0; i < c.count; i++) {
        const uint32_t tag = visible[i];
        const float* base =
            tag == NOTHING ? nullptr : s.parts->parts[s.set->triangles[tag].part].base;
        for (int k = 0; k < 3; k++) {
            const float root = base == nullptr ? 0.0f : base[k] * channels[k][i];
            out[3 * i + k] = root * root;
        }
    }
    for (int k = 0; k < 3; k++) memcpy(channels[k], shaded[k], sizeof(shaded[k]));
}

// Normal, roughness and metallic as the detail map has them; see shaders/textures.glsl.
void detail(const Shading& s, Chunk& c) {
    TapRows taps;
    for (int32_t i = 0; i < c.padded; i += 8) {
        const Slopes d = uv_slopes(c, i);
        const i8 size = truncated(load(c.detail_log2 + i));
        const f8 level = level_of_detail(d.ux, d.vx, d.uy, d.vy, size, 0.5f);
        store_taps(taps, i, texture_taps(load(c.u + i), load(c.v + i), size, truncated(level)));
    }
    const float* m = s.world_from_camera;
    const float inverse = 1.0f / s.focal;
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
        // How the point moves from pixel to pixel, over its depth.
        const f8 depth = load(c.depth + i);
        const f8 zx = -depth * load(c.nearness_x + i), zy = -depth * load(c.nearness_y + i);
        const f8 rx = load(c.ray_x + i), ry = load(c.ray_y + i), rz = load(c.ray_z + i);
        const f8 ax = m[0] * inverse + rx * zx, ay = m[3] * inverse + ry * zx,
                 az = m[6] * inverse + rz * zx;
        const f8 bx = m[1] * inverse + rx * zy, by = m[4] * inverse + ry * zy,
                 bz = m[7] * inverse + rz * zy;
        const f8 nx = load(c.nx + i), ny = load(c.ny + i), nz = load(c.nz + i);
        const f8 across_yx = by * nz - bz * ny, across_yy = bz * nx - bx * nz,
                 across_yz = bx * ny - by * nx;
        const f8 across_xx = ny * az - nz * ay, across_xy = nz * ax - nx * az,
                 across_xz = nx * ay - ny * ax;
        const f8 tangent_x = across_yx * d.ux + across_xx * d.uy,
                 tangent_y = across_yy * d.ux + across_xy * d.uy,
                 tangent_z = across_yz * d.ux + across_xz * d.uy;
        const f8 bitangent_x = across_yx * d.vx + across_xx * d.vy,
                 bitangent_y = across_yy * d.vx + across_xy * d.vy,
                 bitangent_z = across_yz * d.vx + across_xz * d.vy;
        const f8 longest =
            max8(tangent_x * tangent_x + tangent_y * tangent_y + tangent_z * tangent_z,
                 bitangent_x * bitangent_x + bitangent_y * bitangent_y + bitangent_z * bitangent_z);
        const f8 scale = 1.0f / sqrt8(max8(longest, splat(1e-30f)));
        const f8 lx = tx * (2.0f / 255.0f) - 1.0f, ly = ty * (2.0f / 255.0f) - 1.0f;
        const f8 upright = sqrt8(max8(1.0f - lx * lx - ly * ly, splat(0.0f)));
        const f8 sx = -lx * scale, sy = -ly * scale;
        const f8 x = tangent_x * sx + bitangent_x * sy + nx * upright;
        const f8 y = tangent_y * sx + bitangent_y * sy + ny * upright;
        const f8 z = tangent_z * sx + bitangent_z * sy + nz * upright;
        const f8 unit = inverse_length(x, y, z);
        const i8 there = (relief > 0.0f) & (longest >= 1e-30f);
        store(c.nx + i, there ? x * unit : nx);
        store(c.ny + i, there ? y * unit : ny);
        store(c.nz + i, there ? z * unit : nz);
    }
}

// Share of the main light that a shadow map lets through, bilinear between four texels.
f8 lit_share(const float* nearness, int32_t size, f8 x, f8 y, f8 near) {
    const float last = static_cast<float>(size) - 1.001f;
    const f8 tx = clamp8(x * static_cast<float>(size) - 0.5f, 0.0f, last);
    const f8 ty = clamp8(y * static_cast<float>(size) - 0.5f, 0.0f, last);
    const i8 ix = truncated(tx), iy = truncated(ty);
    const f8 across = tx - as_float(ix), down = ty - as_float(iy);
    const int32_t stride = size + 8;
    const i8 at = iy * stride + ix;
    alignas(32) float corner[4][8];
    for (int k = 0; k < 8; k++) {
        const float* p = nearness + at[k];
        corner[0][k] = p[0];
        corner[1][k] = p[1];
        corner[2][k] = p[stride];
        corner[3][k] = p[stride + 1];
    }
    f8 lit[4];
    for (int k = 0; k < 4; k++) {
        lit[k] = near >= load(corner[k]) ? splat(1.0f) : splat(0.0f);
    }
    const f8 upper = lit[0] + (lit[1] - lit[0]) * across;
    const f8 lower = lit[2] + (lit[3] - lit[2]) * across;
    return upper + (lower - upper) * down;
}

struct MapPlace {
    f8 x, y, near;  // in the shadow map, 0 to 1; 1 - depth
};

LANES_INLINE MapPlace in_shadow_map(const Light& light, const Chunk& c, int32_t i, f8 facing) {
    const float* m = light.map_from_world;
    const f8 lift = light.texel_m * (1.0f + 2.0f * (1.0f - facing));
    const f8 x = load(c.px + i) + load(c.nx + i) * lift, y = load(c.py + i) + load(c.ny + i) * lift,
             z = load(c.pz + i) + load(c.nz + i) * lift;
    return {m[0] * x + m[1] * y + m[2] * z + m[3], m[4] * x + m[5] * y + m[6] * z + m[7],
            1.0f - clamp8(m[8] * x + m[9] * y + m[10] * z + m[11], 0.0f, 1.0f)};
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

// The light around each point and the share of the main light that arrives, from baked light.
void baked_light(const Shading& s, Chunk& c) {
    const Light& light = *s.light;
    const int32_t width = light.light_map_width, height = light.light_map_height;
    alignas(32) int32_t at[CHUNK];
    alignas(32) float across[CHUNK], down[CHUNK];
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 x = clamp8(load(c.light_u + i) * static_cast<float>(width) - 0.5f, 0.0f,
                            static_cast<float>(width) - 1.001f);
        const f8 y = clamp8(load(c.light_v + i) * static_cast<float>(height) - 0.5f, 0.0f,
                            static_cast<float>(height) - 1.001f);
        const i8 ix = truncated(x), iy = truncated(y);
        store(across + i, x - as_float(ix));
        store(down + i, y - as_float(iy));
        store(at + i, iy * width + ix);
    }
    const LayerSum& map = *light.light_map;
    for (int32_t i = 0; i < c.padded; i += 8) need_texels(map, at + i, width);
    const vec3 main = light.main_towards;
    const bool has_main = light.main_colour.x + light.main_colour.y + light.main_colour.z > 0.0f;
    const int64_t row = 4 * static_cast<int64_t>(width);
    alignas(32) float texels[4 * 8];
    for (int32_t i = 0; i < c.padded; i += 8) {
        for (int k = 0; k < 8; k++) {
            const uint16_t* p = map.texels + 4 * static_cast<int64_t>(at[i + k]);
            *reinterpret_cast<f4_any*>(texels + 4 * k) =
                sample_halves(p, p + row, across[i + k], down[i + k]);
        }
        f8 r, g, b, share;
        transpose4(texels, r, g, b, share);
        const i8 charted = load(c.light_u + i) > 0.0f;
        const i8 there = ~load(c.empty + i);
        if (any(~charted & there)) {
            alignas(32) float probed[3][8];
            for (int k = 0; k < 8; k++) {
                const float* p = light.instance_light + 12 * static_cast<int64_t>(c.id[i + k]);
                for (int j = 0; j < 3; j++) {
                    probed[j][k] = p[4 * j] + p[4 * j + 1] * c.nx[i + k] +
                                   p[4 * j + 2] * c.ny[i + k] + p[4 * j + 3] * c.nz[i + k];
                }
            }
            r = charted ? r : max8(load(probed[0]), splat(0.0f));
            g = charted ? g : max8(load(probed[1]), splat(0.0f));
            b = charted ? b : max8(load(probed[2]), splat(0.0f));
        }
        store(c.around_r + i, r);
        store(c.around_g + i, g);
        store(c.around_b + i, b);
        const f8 facing =
            load(c.nx + i) * main.x + load(c.ny + i) * main.y + load(c.nz + i) * main.z;
        const i8 mapped = light.main_baked > 0.0f ? charted : splat(0);
        if (light.edge_index != nullptr && any(mapped & there & (share > 0.0f) & (share < 1.0f))) {
            share = edge_shares(light, at + i, across + i, down + i, share);
        }
        const i8 asked = there & (facing > 0.0f) & (~mapped | (share > 0.0f));
        f8 arrives = splat(0.0f);
        if (has_main && any(asked)) {
            const MapPlace place = in_shadow_map(light, c, i, facing);
            f8 past = share;
            if (any(asked & ~mapped)) {
                const f8 standing = lit_share(light.static_shadow.nearness, light.shadow_size,
                                              place.x, place.y, place.near);
                past = mapped ? share : light.main_clear * standing;
            }
            arrives = past * lit_share(light.shadow.nearness, light.shadow_size, place.x, place.y,
                                       place.near);
        }
        store(c.arrives + i, arrives);
    }
}

// The same where nothing is baked: an analytic sky, and the shadow map alone.
void live_light(const Shading& s, Chunk& c) {
    const Light& light = *s.light;
    const vec3 main = light.main_towards;
    const bool has_main = light.main_colour.x + light.main_colour.y + light.main_colour.z > 0.0f;
    const float step = 1.6f / static_cast<float>(light.shadow_size);
    for (int32_t i = 0; i < c.padded; i += 8) {
        const Vec3x8 sky = light_of_sky(light, load(c.nz + i));
        store(c.around_r + i, sky.x);
        store(c.around_g + i, sky.y);
        store(c.around_b + i, sky.z);
        const f8 facing =
            load(c.nx + i) * main.x + load(c.ny + i) * main.y + load(c.nz + i) * main.z;
        f8 arrives = splat(0.0f);
        if (has_main && any(~load(c.empty + i) & (facing > 0.0f))) {
            const MapPlace p = in_shadow_map(light, c, i, facing);
            const float across[4] = {0.94f, -0.34f, -0.94f, 0.34f},
                        down[4] = {0.34f, 0.94f, -0.34f, -0.94f};
            for (int k = 0; k < 4; k++) {
                arrives = arrives + lit_share(light.shadow.nearness, light.shadow_size,
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

// The direction from which a surface mirrors light to the eye.
struct Direction8 {
    f8 x, y, z;
};
LANES_INLINE Direction8 mirrored_ray(const Chunk& c, int32_t i) {
    const f8 rx = load(c.ray_x + i), ry = load(c.ray_y + i), rz = load(c.ray_z + i);
    const f8 nx = load(c.nx + i), ny = load(c.ny + i), nz = load(c.nz + i);
    const f8 scale = inverse_length(rx, ry, rz);
    const f8 twice = 2.0f * (rx * nx + ry * ny + rz * nz) * scale;
    return {rx * scale - twice * nx, ry * scale - twice * ny, rz * scale - twice * nz};
}

void mirrored_light(const Shading& s, Chunk& c) {
    const Light& light = *s.light;
    for (int32_t i = 0; i < c.padded; i += 8) {
        const Vec3x8 around = {load(c.around_r + i), load(c.around_g + i), load(c.around_b + i)};
        const f8 roughness = load(c.roughness + i);
        Vec3x8 seen = around;
        if (!light.baked) {
            const Direction8 d = mirrored_ray(c, i);
            const Vec3x8 soft =
                sky_irradiance(d.z, light.sky_zenith, light.sky_horizon, light.sky_ground);
            const f8 share = min8(roughness * 1.4f, splat(1.0f));
            seen = light.ambient + light.sky_share * mix(analytic_sky(light, d.z), soft, share);
        } else if (light.reflecting && any((roughness < 0.7f) & ~load(c.empty + i))) {
            const Direction8 d = mirrored_ray(c, i);
            i8 point{};
            alignas(32) float open[4][8];
            const i8 ids = load(c.id + i);
            for (int k = 0; k < 8; k++) {
                // Where nothing is, the id is 0, and so is the point.
                point[k] = light.reflection_table[ids[k]];
                for (int j = 0; j < 4; j++) {
                    open[j][k] = light.reflection_points[point[k]].light[j];
                }
            }
            const Vec3x8 room = mirrored_room(light, point, load(c.px + i), load(c.py + i),
                                              load(c.pz + i), d.x, d.y, d.z, roughness);
            // Where less light arrives than in the middle of the room, less of the room is seen.
            const f8 there = load(open[0]) + load(open[1]) * load(c.nx + i) +
                             load(open[2]) * load(c.ny + i) + load(open[3]) * load(c.nz + i);
            const f8 share = clamp8(luminance(around) / max8(there, splat(1e-4f)), 0.0f, 1.0f);
            const Vec3x8 dimmed = {room.x * share, room.y * share, room.z * share};
            // The rougher, the more of the half space it mirrors: that is the light around.
            seen = mix(dimmed, around, smoothstep(0.25f, 0.7f, roughness));
        }
        store(c.mirrored_r + i, seen.x);
        store(c.mirrored_g + i, seen.y);
        store(c.mirrored_b + i, seen.z);
    }
}

// A surface of eight pixels, as the light from one direction meets it.
struct Surface8 {
    f8 nx, ny, nz, vx, vy, vz;  // normal, and direction to the eye
    Vec3x8 diffuse, f0;
    f8 a2, nv;  // roughness to the fourth power, cosine of the viewing angle
};

// GGX distribution, height-correlated Smith visibility, Schlick's Fresnel term.
LANES_INLINE void add_reflected(const Surface8& s, f8 lx, f8 ly, f8 lz, const Vec3x8& power,
                                Vec3x8& sum) {
    const f8 nl = clamp8(s.nx * lx + s.ny * ly + s.nz * lz, 0.0f, 1.0f);
    f8 hx = lx + s.vx, hy = ly + s.vy, hz = lz + s.vz;
    const f8 scale = inverse_length(hx, hy, hz);
    hx *= scale;
    hy *= scale;
    hz *= scale;
    const f8 nh = clamp8(s.nx * hx + s.ny * hy + s.nz * hz, 0.0f, 1.0f);
    const f8 vh = clamp8(s.vx * hx + s.vy * hy + s.vz * hz, 0.0f, 1.0f);
    const f8 rest = 1.0f - s.a2;
    const f8 spread = 1.0f - nh * nh * rest;
    const f8 smith = nl * sqrt8(s.nv * s.nv * rest + s.a2) + s.nv * sqrt8(nl * nl * rest + s.a2);
    // Distribution times visibility.
    const f8 lobe = 0.5f * s.a2 / (PI * spread * spread * smith);
    const f8 grazing = 1.0f - vh, g2 = grazing * grazing, g5 = g2 * g2 * grazing;
    const f8 fr = s.f0.x + (1.0f - s.f0.x) * g5, fg = s.f0.y + (1.0f - s.f0.y) * g5,
             fb = s.f0.z + (1.0f - s.f0.z) * g5;
    const float over_pi = 1.0f / PI;
    sum.x = sum.x + power.x * nl * (s.diffuse.x * (1.0f - fr) * over_pi + fr * lobe);
    sum.y = sum.y + power.y * nl * (s.diffuse.y * (1.0f - fg) * over_pi + fg * lobe);
    sum.z = sum.z + power.z * nl * (s.diffuse.z * (1.0f - fb) * over_pi + fb * lobe);
}

void add_lamp(const Lamp& lamp, const Chunk& c, int32_t i, const Surface8& s, Vec3x8& sum) {
    if (lamp.kind == LIGHT_DIRECTIONAL) {
        const vec3 towards = -lamp.direction;
        add_reflected(s, splat(towards.x), splat(towards.y), splat(towards.z), splat(lamp.colour),
                      sum);
        return;
    }
    const Vec3x8 offset = lamp.position - Vec3x8(load(c.px + i), load(c.py + i), load(c.pz + i));
    const f8 square = lamp_square(offset);
    const Vec3x8 towards = offset * (1.0f / sqrt8(square));
    const f8 share = lamp_falloff(lamp, square, -dot(towards, lamp.direction));
    const f8 facing = s.nx * towards.x + s.ny * towards.y + s.nz * towards.z;
    if (!any((share > 0.0f) & (facing > 0.0f))) return;
    add_reflected(s, towards.x, towards.y, towards.z, lamp.colour * share, sum);
}

void combine(const Shading& s, Chunk& c) {
    const Light& light = *s.light;
    const bool has_main = light.main_colour.x + light.main_colour.y + light.main_colour.z > 0.0f;
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 rx = load(c.ray_x + i), ry = load(c.ray_y + i), rz = load(c.ray_z + i);
        const f8 scale = -inverse_length(rx, ry, rz);
        Surface8 here;
        here.vx = rx * scale;
        here.vy = ry * scale;
        here.vz = rz * scale;
        here.nx = load(c.nx + i);
        here.ny = load(c.ny + i);
        here.nz = load(c.nz + i);
        const Vec3x8 base = {load(c.red + i), load(c.green + i), load(c.blue + i)};
        const f8 metallic = load(c.metallic + i), roughness = load(c.roughness + i);
        const f8 matt = 1.0f - metallic;
        here.f0 = mix(vec3(0.04f, 0.04f, 0.04f), base, metallic);
        here.diffuse = {base.x * matt, base.y * matt, base.z * matt};
        const f8 square = roughness * roughness;
        here.a2 = square * square;
        here.nv = abs8(here.nx * here.vx + here.ny * here.vy + here.nz * here.vz) + 1e-4f;
        // Split-sum environment term, analytic fit for GGX (Karis, "Physically based shading on
        // mobile").
        const f8 nv = min8(here.nv, splat(1.0f));
        const f8 q0 = 1.0f - roughness, q1 = 0.0425f - 0.0275f * roughness,
                 q2 = 1.04f - 0.572f * roughness, q3 = 0.022f * roughness - 0.04f;
        const f8 a = min8(q0 * q0, exp2_8(-9.28f * nv)) * q0 + q1;
        const f8 term_x = -1.04f * a + q2, term_y = 1.04f * a + q3;
        const f8 lost = 1.0f - (term_x + term_y);
        const Vec3x8 around = {load(c.around_r + i), load(c.around_g + i), load(c.around_b + i)};
        const Vec3x8 seen = {load(c.mirrored_r + i), load(c.mirrored_g + i),
                             load(c.mirrored_b + i)};
        // Single bounces in the microfacets, and what comes back from further ones (Fdez-Aguera
        // 2019, "A multiple-scattering microfacet model").
        auto of_environment = [&](f8 f0, f8 diffuse, f8 mirrored, f8 from_around) {
            const f8 once = f0 * term_x + term_y;
            const f8 mean = f0 + (1.0f - f0) * (1.0f / 21.0f);
            const f8 again = lost * once * mean / (1.0f - mean * lost);
            return once * mirrored + (again + diffuse * (1.0f - once - again)) * from_around;
        };
        Vec3x8 sum = {of_environment(here.f0.x, here.diffuse.x, seen.x, around.x),
                      of_environment(here.f0.y, here.diffuse.y, seen.y, around.y),
                      of_environment(here.f0.z, here.diffuse.z, seen.z, around.z)};
        store(c.from_around + i, luminance(sum));
        const f8 glow = load(c.emission + i);
        sum = {sum.x + base.x * glow, sum.y + base.y * glow, sum.z + base.z * glow};
        const f8 arrives = load(c.arrives + i);
        if (has_main && any(arrives > 0.0f)) {
            add_reflected(here, splat(light.main_towards.x), splat(light.main_towards.y),
                          splat(light.main_towards.z), light.main_colour * arrives, sum);
        }
        for (int32_t k = 0; k < light.lamp_count; k++) add_lamp(light.lamps[k], c, i, here, sum);
        store(c.light_r + i, sum.x);
        store(c.light_g + i, sum.y);
        store(c.light_b + i, sum.z);
    }
}

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

// What is seen where nothing was hit; see shaders/sky.frag.
Vec3x8 background(const Light& light, f8 dx, f8 dy, f8 dz) {
    if (light.background_plain) return splat(light.background);
    if (light.sky_map == nullptr) return analytic_sky(light, dz * inverse_length(dx, dy, dz));
    const f8 across = 0.5f - arc_tangent(dy, dx) * (0.5f / PI);
    const f8 down = arc_tangent(sqrt8(dx * dx + dy * dy), dz) * (1.0f / PI);
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
    return seen;
}

// Exposed radiance and the share of it that came from around, as halves.
void finish(const Shading& s, const Chunk& c, uint16_t* radiance) {
    const Light& light = *s.light;
    alignas(32) int32_t out[2 * CHUNK];
    for (int32_t i = 0; i < c.padded; i += 8) {
        Vec3x8 sum = {load(c.light_r + i), load(c.light_g + i), load(c.light_b + i)};
        f8 share = load(c.from_around + i) / max8(luminance(sum), splat(1e-6f));
        const i8 empty = load(c.empty + i);
        if (c.missed && any(empty)) {
            const Vec3x8 sky =
                background(light, load(c.ray_x + i), load(c.ray_y + i), load(c.ray_z + i));
            sum = {empty ? sky.x : sum.x, empty ? sky.y : sum.y, empty ? sky.z : sum.z};
            share = empty ? splat(0.0f) : share;
        }
        // Half precision ends at 65504.
        const i8 r = to_half(clamp8(sum.x * light.exposure, 0.0f, 6e4f));
        const i8 g = to_half(clamp8(sum.y * light.exposure, 0.0f, 6e4f));
        const i8 b = to_half(clamp8(sum.z * light.exposure, 0.0f, 6e4f));
        const i8 a = to_half(clamp8(share, 0.0f, 1.0f));
        const i8 rg = r | (g << 16), ba = b | (a << 16);
        store(out + 2 * i, (i8)SHUFFLE(rg, ba, 0, 8, 1, 9, 2, 10, 3, 11));
        store(out + 2 * i + 8, (i8)SHUFFLE(rg, ba, 4, 12, 5, 13, 6, 14, 7, 15));
    }
    memcpy(radiance, out, static_cast<size_t>(c.count) * 8);
}

void place_points(const Shading& s, Chunk& c) {
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 depth = load(c.depth + i);
        store(c.px + i, s.eye[0] + load(c.ray_x + i) * depth);
        store(c.py + i, s.eye[1] + load(c.ray_y + i) * depth);
        store(c.pz + i, s.eye[2] + load(c.ray_z + i) * depth);
        store(c.roughness + i, clamp8(load(c.roughness + i), 0.045f, 1.0f));
        store(c.metallic + i, clamp8(load(c.metallic + i), 0.0f, 1.0f));
        const f8 r = load(c.red + i), g = load(c.green + i), b = load(c.blue + i);
        store(c.red + i, r * r);
        store(c.green + i, g * g);
        store(c.blue + i, b * b);
    }
}

// The same as `write_surface`, of a chunk that was gathered.
void write_gathered_surface(const Shading& s, const Chunk& c) {
    float* out = s.outputs->surface + 2 * (c.y * s.width + c.x);
    alignas(32) float pairs[2 * CHUNK];
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 id = as_float(load(c.id + i));
        const f8 depth = load(c.empty + i) ? splat(__builtin_inff()) : load(c.depth + i);
        store(pairs + 2 * i, SHUFFLE(depth, id, 0, 8, 1, 9, 2, 10, 3, 11));
        store(pairs + 2 * i + 8, SHUFFLE(depth, id, 4, 12, 5, 13, 6, 14, 7, 15));
    }
    memcpy(out, pairs, static_cast<size_t>(c.count) * 8);
}

// The light of what was gathered.
void light_chunk(const Shading& s, Chunk& c) {
    if (!c.hit) {
        for (int32_t i = 0; i < c.padded; i += 8) {
            store(c.light_r + i, splat(0.0f));
            store(c.light_g + i, splat(0.0f));
            store(c.light_b + i, splat(0.0f));
            store(c.from_around + i, splat(0.0f));
        }
        return;
    }
    if (c.coloured) colour(c, PICTURE_BIAS, MOST_LOOK_UPS);
    if (c.detailed) detail(s, c);
    place_points(s, c);
    if (s.light->baked) {
        baked_light(s, c);
    } else {
        live_light(s, c);
    }
    mirrored_light(s, c);
    combine(s, c);
}

void shade_chunk(const Shading& s, Chunk& c) {
    const Outputs& wanted = *s.outputs;
    if (!wanted.radiance && !wanted.normals && !wanted.albedo) {
        if (wanted.surface != nullptr) write_surface(s, c.x, c.y, c.count);
        return;
    }
    gather(s, c);
    if (wanted.surface != nullptr) write_gathered_surface(s, c);
    set_rays(s, c);
    if (wanted.normals != nullptr) write_normals(s, c);
    if (wanted.albedo != nullptr) write_albedo(s, c);
    if (s.outputs->radiance == nullptr) return;
    light_chunk(s, c);
    finish(s, c, s.outputs->radiance + 4 * (c.y * s.width + c.x));
}

}  // namespace

Vec3x8 mirrored_room(const Light& light, i8 point, f8 x, f8 y, f8 z, f8 dx, f8 dy, f8 dz,
                     f8 roughness) {
    const f8 ix = 1.0f / (dx + 1e-6f), iy = 1.0f / (dy + 1e-6f), iz = 1.0f / (dz + 1e-6f);
    const float *low = light.room_low, *high = light.room_high;
    alignas(32) float from[3][8];
    for (int k = 0; k < 8; k++) {
        for (int j = 0; j < 3; j++) {
            from[j][k] = light.reflection_points[point[k]].position[j];
        }
    }
    const f8 end_x = max8((low[0] - x) * ix, (high[0] - x) * ix);
    const f8 end_y = max8((low[1] - y) * iy, (high[1] - y) * iy);
    const f8 end_z = max8((low[2] - z) * iz, (high[2] - z) * iz);
    const f8 reach = max8(min8(end_x, min8(end_y, end_z)), splat(0.05f));
    const f8 tx = x + dx * reach - load(from[0]), ty = y + dy * reach - load(from[1]),
             tz = z + dz * reach - load(from[2]);
    const f8 inverse = 1.0f / max8(abs8(tx) + abs8(ty) + abs8(tz), splat(1e-20f));
    f8 nx = tx * inverse, ny = ty * inverse;
    const f8 fold = max8(-tz * inverse, splat(0.0f));
    nx = nx >= 0.0f ? nx - fold : nx + fold;
    ny = ny >= 0.0f ? ny - fold : ny + fold;
    const float edge = static_cast<float>(light.reflection_edge);
    const float half = 0.5f * light.reflection_scale * edge, middle = 0.5f * edge - 0.5f;
    const f8 u = clamp8(nx * half + middle, 0.0f, edge - 1.001f);
    const f8 v = clamp8(ny * half + middle, 0.0f, edge - 1.001f);
    const f8 layer = clamp8(roughness * light.layers_per_roughness, 0.0f,
                            static_cast<float>(light.reflection_layers) - 1.001f);
    const i8 iu = truncated(u), iv = truncated(v), il = truncated(layer);
    const f8 across = u - as_float(iu), down = v - as_float(iv), share = layer - as_float(il);
    const i8 at = ((point * light.reflection_layers + il) * light.reflection_edge + iv) *
                      light.reflection_edge +
                  iu;
    const int64_t row = 4 * static_cast<int64_t>(light.reflection_edge);
    const int64_t next = row * light.reflection_edge;
    alignas(32) float texels[4 * 8];
    for (int k = 0; k < 8; k++) {
        const uint16_t* p = light.reflections + 4 * static_cast<int64_t>(at[k]);
        const f4 near = sample_halves(p, p + row, across[k], down[k]);
        const f4 far = sample_halves(p + next, p + next + row, across[k], down[k]);
        *reinterpret_cast<f4_any*>(texels + 4 * k) = near + (far - near) * share[k];
    }
    Vec3x8 seen;
    f8 unused;
    transpose4(texels, seen.x, seen.y, seen.z, unused);
    return seen;
}

void shade_band(const Shading& s, int32_t first_row, int32_t last_row) {
    Chunk chunk;
    for (int32_t x = 0; x < s.width; x += CHUNK) {
        const int64_t rest = s.width - x;
        chunk.x = x;
        chunk.count = static_cast<int32_t>(rest < CHUNK ? rest : CHUNK);
        chunk.padded = (chunk.count + 7) & ~7;
        for (int32_t y = first_row; y < last_row; y++) {
            chunk.y = y;
            shade_chunk(s, chunk);
        }
    }
}

void shade_fragments(const Shading& s, const Fragment* fragments, int64_t count, uint16_t* out) {
    Chunk chunk;
    for (int64_t first = 0; first < count; first += CHUNK) {
        const int64_t rest = count - first;
        chunk.count = static_cast<int32_t>(rest < CHUNK ? rest : CHUNK);
        chunk.padded = (chunk.count + 7) & ~7;
        gather_fragments(s, fragments + first, chunk);
        set_rays(s, chunk);
        light_chunk(s, chunk);
        finish(s, chunk, out + 4 * first);
    }
}

}  // namespace sailenv
