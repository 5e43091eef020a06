// Shading, first stage: what the corners of the triangles that a chunk's pixels see say of them.
#include "shade_chunk.h"
#include "texture.h"

namespace sailenv {
namespace {

// What the corners of a triangle know, over its depth: planes of a row of the picture. Where rays
// are parallel they are over 1, and the last one is the depth.
struct RowPlanes {
    f8 slope, offset, moved;  // normal (world frame), uv, light uv, 1; `moved` is added at the end
    f8 look, maps;            // see `Chunk`: material, and how uv change from pixel to pixel
    const uint32_t *colour_texels, *detail_texels;
    float inverse_depth_slope, inverse_depth_offset;
    int32_t id;
    bool coloured, detailed;
    vec3 bend;  // see `Chunk`
};

// The same of a face, through a lens that bends lines: `offset` and the like are at y = 0.
struct FacePlanes : RowPlanes {
    f8 down;
    float inverse_depth_down;
};

LANES_INLINE float inverse_depth_at(const RowPlanes& r, float x, float) {
    return r.inverse_depth_slope * x + r.inverse_depth_offset;
}
LANES_INLINE f8 inverse_depth_at(const RowPlanes& r, f8 x, f8) {
    return r.inverse_depth_slope * x + r.inverse_depth_offset;
}
LANES_INLINE f8 attributes_at(const RowPlanes& r, float x, float) { return r.slope * x + r.offset; }
LANES_INLINE f8 attribute_at(const RowPlanes& r, int k, f8 x, f8) {
    return r.slope[k] * x + r.offset[k];
}
template <class Real>
LANES_INLINE Real inverse_depth_at(const FacePlanes& r, Real x, Real y) {
    return r.inverse_depth_slope * x + (r.inverse_depth_down * y + r.inverse_depth_offset);
}
LANES_INLINE f8 attributes_at(const FacePlanes& r, float x, float y) {
    return r.slope * x + (r.down * y + r.offset);
}
LANES_INLINE f8 attribute_at(const FacePlanes& r, int k, f8 x, f8 y) {
    return r.slope[k] * x + (r.down[k] * y + r.offset[k]);
}

constexpr f8 NOTHING_THERE = {1, 0, 0, 0, 0, 0, 0, 1}, PLAIN = {0, 0, 0, 0, 1, 0, 0, 0},
             NO_MAPS = {0, 0, 0, 0, NO_MAP, 0, 0, 0};

// How unit normals change from pixel to pixel; see `Chunk`. `normal` is at a place.
vec3 bend_of(f8 normal, f8 right, f8 down) {
    const auto unit_of = [](f8 n) { return unit(vec3(n[0], n[1], n[2])); };
    const vec3 here = unit_of(normal);
    const vec3 across = unit_of(normal + right) - here, along = unit_of(normal + down) - here;
    return dot(across, across) > dot(along, along) ? across : along;
}

// Sets planes up at a row; `down`, if it is asked for, is how they change from row to row. `x` is a
// place in the row.
LANES_INLINE void set_planes(const Shading& s, const Triangle& t, float x, float y, RowPlanes& r,
                             f8* down) {
    const Part& part = s.parts->parts[t.part];
    const InstanceFrame& frame = s.frames[part.instance];
    const float* factors = factors_of(s.light, part, t.back);
    const f8 a0 = vertex_of(part, factors, t.vertex[0]);
    const f8 a1 = vertex_of(part, factors, t.vertex[1]);
    const f8 a2 = vertex_of(part, factors, t.vertex[2]);
    const float q = t.inverse_det;
    const f8 object_x = a0 * (t.edge[0] * q) + a1 * (t.edge[3] * q) + a2 * (t.edge[6] * q);
    const f8 object_0 = a0 * ((t.edge[1] * y + t.edge[2]) * q) +
                        a1 * ((t.edge[4] * y + t.edge[5]) * q) +
                        a2 * ((t.edge[7] * y + t.edge[8]) * q);
    const bool charted = part.has_chart && s.at_baked_pose[part.instance];
    // What has no chart has a factor and the share that it hides of itself there.
    const float free = part.has_chart ? 0.0f : 1.0f;
    const f8 kept = {0, 0, 0, 1, 1, charted ? part.chart[2] : free, charted ? part.chart[3] : free,
                     0};
    r.moved = f8{0, 0, 0, 0, 0, charted ? part.chart[0] : 0.0f, charted ? part.chart[1] : 0.0f, 0};
    const float turned = t.back ? -1.0f : 1.0f;
    const f8 n0 = load(frame.normal_columns[0]) * turned,
             n1 = load(frame.normal_columns[1]) * turned,
             n2 = load(frame.normal_columns[2]) * turned;
    r.slope = object_x * kept + n0 * object_x[0] + n1 * object_x[1] + n2 * object_x[2];
    constexpr i8 NORMAL = {-1, -1, -1, 0, 0, 0, 0, 0};
    const bool bends = part.roughness < ROUGH && s.light != nullptr && s.light->reflecting &&
                       any(((a0 != a1) | (a0 != a2)) & NORMAL);
    f8 downwards{};
    if (down != nullptr || bends) {
        const f8 object_y = a0 * (t.edge[1] * q) + a1 * (t.edge[4] * q) + a2 * (t.edge[7] * q);
        downwards = object_y * kept + n0 * object_y[0] + n1 * object_y[1] + n2 * object_y[2];
        if (down != nullptr) *down = downwards;
    }
    const bool parallel = s.sight == Sight::PARALLEL;
    const float inverse_depth_0 = t.inverse_depth[1] * y + t.inverse_depth[2];
    const f8 depth_lane = {0, 0, 0, 0, 0, 0, 0, parallel ? -inverse_depth_0 : 1.0f};
    r.offset =
        object_0 * kept + n0 * object_0[0] + n1 * object_0[1] + n2 * object_0[2] + depth_lane;
    r.bend = bends ? bend_of(r.slope * x + r.offset, r.slope, downwards) : vec3(0.0f, 0.0f, 0.0f);
    if (parallel) r.slope[7] = -t.inverse_depth[0];
    r.look = f8{part.colour[0], part.colour[1], part.colour[2], t.inverse_depth[0],
                part.roughness, part.metallic,  part.emission,  t.inverse_depth[1]};
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
    r.inverse_depth_slope = parallel ? 0.0f : t.inverse_depth[0];
    r.inverse_depth_offset = parallel ? 1.0f : inverse_depth_0;
    r.id = part.id;
}

LANES_INLINE RowPlanes row_planes(const Shading& s, const Triangle& t, float x, float y) {
    RowPlanes r;
    set_planes(s, t, x, y, r, nullptr);
    return r;
}

LANES_INLINE FacePlanes face_planes(const Shading& s, const Triangle& t) {
    FacePlanes r;
    set_planes(s, t, 0.0f, 0.0f, r, &r.down);
    r.bend = vec3(0.0f, 0.0f, 0.0f);
    r.inverse_depth_down = t.inverse_depth[1];
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
    put(c.bend, i, vec3(0.0f, 0.0f, 0.0f));
}

template <class Planes>
LANES_INLINE void set_pixel(const Planes& r, Chunk& c, PixelRows& rows, int32_t i) {
    const float x = c.at_x[i], y = c.at_y[i];
    const float depth = 1.0f / inverse_depth_at(r, x, y);
    store(rows.attributes + 8 * i, attributes_at(r, x, y) * depth + r.moved);
    store(rows.material + 8 * i, r.look);
    store(rows.maps + 8 * i, r.maps);
    put(c.bend, i, r.bend);
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
    return {{c.normal.x, c.normal.y, c.normal.z, c.u, c.v, c.light_u, c.light_v, c.depth},
            {c.base.x, c.base.y, c.base.z, c.inverse_depth_x, c.roughness, c.metallic, c.emission,
             c.inverse_depth_y},
            {c.ux, c.vx, c.uy, c.vy, c.colour_log2, c.detail_log2, c.finish, c.relief}};
}

// Eight pixels of one triangle: each number at its place at once.
template <class Planes>
LANES_INLINE void set_eight(const Planes& r, Chunk& c, int32_t i) {
    const f8 xs = load(c.at_x + i), ys = load(c.at_y + i);
    const f8 depth = 1.0f / inverse_depth_at(r, xs, ys);
    const Columns columns = columns_of(c);
    for (int k = 0; k < 8; k++) {
        store(columns.attributes[k] + i, attribute_at(r, k, xs, ys) * depth + r.moved[k]);
        store(columns.material[k] + i, splat(r.look[k]));
        store(columns.maps[k] + i, splat(r.maps[k]));
    }
    store(c.id + i, splat(r.id));
    store(c.empty + i, splat(0));
    c.bend.set(i, splat(r.bend));
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

// Asks for what the table says of the next row's pixels.
LANES_INLINE void prefetch(const LensTable& lens, int32_t y, int32_t x, bool with_places) {
    const float *steps = first_step(lens, y, x), *places = lens.x + y * lens.stride + x;
    for (int32_t i = 0; i < CHUNK; i += 16) {
        if (with_places) {
            __builtin_prefetch(places + i);
            __builtin_prefetch(lens.y + y * lens.stride + x + i);
        }
        for (int k = 0; k < 4; k++) __builtin_prefetch(steps + 4 * i + 16 * k);
    }
}

// From slopes along the axes of a face to changes from pixel to pixel.
LANES_INLINE void set_steps(Chunk& c, int32_t i, const LensSteps& steps) {
    store(c.x_right + i, steps.x_right);
    store(c.y_right + i, steps.y_right);
    store(c.x_down + i, steps.x_down);
    store(c.y_down + i, steps.y_down);
}
void turn_slopes(Chunk& c) {
    for (int32_t i = 0; i < c.padded; i += 8) {
        const LensSteps steps = {load(c.x_right + i), load(c.y_right + i), load(c.x_down + i),
                                 load(c.y_down + i)};
        const auto turn = [&](float* across, float* along) {
            const f8 a = load(across + i), b = load(along + i);
            store(across + i, to_right(steps, a, b));
            store(along + i, downwards(steps, a, b));
        };
        turn(c.inverse_depth_x, c.inverse_depth_y);
        if (!c.coloured && !c.detailed) continue;
        turn(c.ux, c.uy);
        turn(c.vx, c.vy);
    }
}

// Interpolates what is seen at the places of a row's pixels; `planes_of` sets a triangle's planes
// up.
template <class PlanesOf>
LANES_INLINE void gather_runs(const Shading& s, Chunk& c, const PlanesOf& planes_of) {
    const uint32_t* visible = s.visible + c.y * s.stride + c.x;
    PixelRows rows;
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
        const auto planes = planes_of(*triangles[r], c.at_x[i]);
        c.hit = true;
        c.coloured |= planes.coloured;
        c.detailed |= planes.detailed;
        while (i < end) {
            if ((i & 7) == 0 && end - i >= 8) {
                whole |= 1u << (i / 8);
                set_eight(planes, c, i);
                i += 8;
            } else {
                set_pixel(planes, c, rows, i);
                i++;
            }
        }
    }
    for (int32_t i = c.count; i < c.padded; i++) set_empty(c, rows, i);
    for (int32_t i = 0; i < c.padded; i += 8) {
        if (!(whole >> (i / 8) & 1)) sort_eight(rows, c, i);
    }
}

}  // namespace

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
        const float id = static_cast<float>(s.parts->parts[t.part].id);
        if (s.table != nullptr) {
            const int64_t row = y * s.table->stride + x;
            for (; i < end; i++) {
                const float across = s.table->x[row + i], down = s.table->y[row + i];
                const float depth = 1.0f / (t.inverse_depth[0] * across +
                                            (t.inverse_depth[1] * down + t.inverse_depth[2]));
                surface[2 * i] = depth * stretch(across, down);
                surface[2 * i + 1] = id;
            }
            continue;
        }
        const float offset = t.inverse_depth[1] * static_cast<float>(y) + t.inverse_depth[2];
        if (s.sight == Sight::PARALLEL) {
            for (; i < end; i++) {
                surface[2 * i] = -(t.inverse_depth[0] * static_cast<float>(x + i) + offset);
                surface[2 * i + 1] = id;
            }
            continue;
        }
        for (; i < end; i++) {
            surface[2 * i] = 1.0f / (t.inverse_depth[0] * static_cast<float>(x + i) + offset);
            surface[2 * i + 1] = id;
        }
    }
}

void gather(const Shading& s, Chunk& c) {
    const float y = static_cast<float>(c.y);
    c.parallel = s.sight == Sight::PARALLEL;
    for (int32_t i = 0; i < c.padded; i += 8) {
        store(c.at_x + i, counting() + static_cast<float>(c.x + i));
        store(c.at_y + i, splat(y));
    }
    gather_runs(s, c, [&](const Triangle& t, float x) { return row_planes(s, t, x, y); });
}

void gather_through_lens(const Shading& s, Chunk& c) {
    const LensTable& lens = *s.table;
    const int64_t first = c.y * lens.stride + c.x;
    // The centres of pixels are among the fine samples, which were looked at just now.
    const LensTable* fine = s.fine_table;
    const int64_t fine_first = fine == nullptr ? 0 : (2 * c.y + 1) * fine->stride + 2 * c.x + 1;
    c.parallel = false;
    for (int32_t i = 0; i < c.padded; i += 8) {
        f8 x, y;
        if (fine == nullptr) {
            x = load(lens.x + first + i);
            y = load(lens.y + first + i);
        } else {
            x = every_second(fine->x + fine_first + 2 * i);
            y = every_second(fine->y + fine_first + 2 * i);
        }
        const i8 seen = x == x;
        const i8 face = lens.several ? faces_at(lens.face + first + i) : splat(0);
        store(c.at_x + i, seen ? x : splat(0.0f));
        store(c.at_y + i, seen ? y : splat(0.0f));
        store(c.face + i, seen ? face : splat(NO_FACE));
        set_steps(c, i, steps_at(lens, c.y, c.x + i));
    }
    prefetch(lens, c.y + 1, c.x, fine == nullptr);
    gather_runs(s, c, [&](const Triangle& t, float) { return face_planes(s, t); });
    turn_slopes(c);
}

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
    c.parallel = s.sight == Sight::PARALLEL;
    for (int32_t i = 0; i < c.padded; i++) {
        const Fragment& f = fragments[i < c.count ? i : 0];
        c.at_x[i] = f.x;
        c.at_y[i] = f.y;
        c.face[i] = f.face;
        if (i >= c.count || f.tag == NOTHING) {
            c.missed |= i < c.count;
            set_empty(c, rows, i);
            continue;
        }
        const RowPlanes planes = row_planes(s, s.set->triangles[f.tag], f.x, f.y);
        c.hit = true;
        c.coloured |= planes.coloured;
        c.detailed |= planes.detailed;
        set_pixel(planes, c, rows, i);
    }
    for (int32_t i = 0; i < c.padded; i += 8) sort_eight(rows, c, i);
    if (s.table == nullptr) return;
    for (int32_t i = 0; i < c.padded; i++) {
        const Fragment& f = fragments[i < c.count ? i : 0];
        const PixelStep steps = step_at(*s.table, f.pixel_y, f.pixel_x);
        c.x_right[i] = steps.x_right;
        c.y_right[i] = steps.y_right;
        c.x_down[i] = steps.x_down;
        c.y_down[i] = steps.y_down;
    }
    turn_slopes(c);
}

}  // namespace sailenv
