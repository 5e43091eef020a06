// Light of opaque surfaces and of the sky: the same model as shaders/lighting.frag and sky.frag.
//
// A band is walked down in chunks of pixels, which go through one stage after the other:
// shade_gather.cpp, shade_material.cpp, shade_around.cpp, shade_reflections.cpp, shade_sampled.cpp,
// shade_traced.cpp, shade_combine.cpp.
#include "shade.h"

#include <algorithm>

#include "shade_chunk.h"

namespace sailenv {
namespace {

void set_rays(const Shading& s, Chunk& c) {
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 x = load(c.at_x + i), y = load(c.at_y + i);
        c.ray.set(i,
                  s.table == nullptr ? ray_to(s, x, y) : rays_of_faces(s, x, y, load(c.face + i)));
        const Vec3x8 normal = c.normal.at(i);
        c.normal.set(i, normal * inverse_length(normal));
    }
}

// Depth and instance id, as `write_surface` does it, of what was gathered.
void write_gathered_surface(const Shading& s, const Chunk& c) {
    float* out = s.outputs->surface + 2 * (c.y * s.width + c.x);
    alignas(32) float pairs[2 * CHUNK];
    for (int32_t i = 0; i < c.padded; i += 8) {
        const f8 id = to_float(load(c.id + i));
        f8 depth = load(c.empty + i) ? splat(__builtin_inff()) : load(c.depth + i);
        if (s.table != nullptr) depth = depth * stretch(load(c.at_x + i), load(c.at_y + i));
        store(pairs + 2 * i, SHUFFLE(depth, id, 0, 8, 1, 9, 2, 10, 3, 11));
        store(pairs + 2 * i + 8, SHUFFLE(depth, id, 4, 12, 5, 13, 6, 14, 7, 15));
    }
    memcpy(out, pairs, static_cast<size_t>(c.count) * 8);
}

// Where pixels are on the triangles of models that deform.
void write_places(const Shading& s, const Chunk& c) {
    const uint32_t* visible = s.visible + c.y * s.stride + c.x;
    TrianglePlace* out = s.outputs->places + (c.y * s.width + c.x);
    const LensTable* lens = s.table;
    const int64_t begin = lens == nullptr ? 0 : c.y * lens->stride + c.x;
    uint32_t last = NOTHING;
    int32_t first = RIGID;
    const Triangle* t = nullptr;
    for (int32_t i = 0; i < c.count; i++) {
        if (visible[i] != last) {
            last = visible[i];
            t = last == NOTHING ? nullptr : &s.set->triangles[last];
            first = t == nullptr ? RIGID : s.parts->parts[t->part].first_vertex;
        }
        if (first == RIGID) continue;
        const float x = lens == nullptr ? static_cast<float>(c.x + i) : lens->x[begin + i];
        const float y = lens == nullptr ? static_cast<float>(c.y) : lens->y[begin + i];
        float weights[3], sum = 0.0f;
        for (int k = 0; k < 3; k++) {
            const float* e = t->edge + 3 * k;
            weights[k] = std::max(e[0] * x + (e[1] * y + e[2]), 0.0f);
            sum += weights[k];
        }
        for (int k = 0; k < 3; k++) {
            out[i].vertices[k] = static_cast<uint32_t>(first + t->vertex[k]);
            out[i].weights[k] = weights[k] / sum;
        }
    }
}

void place_points(const Shading& s, Chunk& c) {
    for (int32_t i = 0; i < c.padded; i += 8) {
        const Vec3x8 begin = begin_of_ray(s, load(c.at_x + i), load(c.at_y + i));
        c.point.set(i, begin + c.ray.at(i) * load(c.depth + i));
        finish_material(c, i);
    }
}

// Which of eight pixels see what lies outside the room.
LANES_INLINE i8 sees_outside(const Light& light, const Chunk& c, int32_t i) {
    return load(c.id + i) == light.outside_id;
}

bool sees_outside_alone(const Shading& s, const Chunk& c) {
    if (s.light->outside_id == 0) return false;
    for (int32_t i = 0; i < c.padded; i += 8) {
        if (any(~(sees_outside(*s.light, c, i) | load(c.empty + i)))) return false;
    }
    return true;
}

// What lies outside shines as the sky does: no light falls on it.
void shine_as_outside(const Shading& s, Chunk& c) {
    for (int32_t i = 0; i < c.padded; i += 8) {
        const i8 outside = sees_outside(*s.light, c, i);
        const Vec3x8 root = c.base.at(i);
        c.light.set(i, where(outside, root * root * s.light->outside_radiance, c.light.at(i)));
        store(c.from_around + i, outside ? splat(0.0f) : load(c.from_around + i));
    }
}

// The light of what was gathered in pixels; `before` as in `trace_reflections`.
void light_chunk(const Shading& s, Chunk& c, const int32_t* x, const int32_t* y,
                 TracedRow* before) {
    if (!c.hit) {
        for (int32_t i = 0; i < c.padded; i += 8) {
            c.light.set(i, splat(vec3(0.0f, 0.0f, 0.0f)));
            store(c.from_around + i, splat(0.0f));
        }
        return;
    }
    if (c.coloured) colour_for_picture(c);
    if (sees_outside_alone(s, c)) {
        for (int32_t i = 0; i < c.padded; i += 8) {
            c.light.set(i, splat(vec3(0.0f, 0.0f, 0.0f)));
            store(c.from_around + i, splat(0.0f));
        }
        shine_as_outside(s, c);
        return;
    }
    if (c.detailed) apply_detail_maps(s, c);
    place_points(s, c);
    if (s.light->baked) {
        light_from_bake(s, c);
    } else {
        light_from_sky(s, c);
    }
    mirror_surroundings(s, c);
    if (traces_reflections(s)) {
        correct_mirrored(s, x, y, c);
        trace_reflections(s, c, before);
        mirror_rough(s, x, y, c);
        for (int32_t i = 0; i < c.padded; i += 8) {
            c.mirrored.set(i, c.mirrored.at(i) + c.faces.at(i));
        }
    }
    reflect_to_eye(s, c);
}

// Exposed radiance and the share of it that came from around, as halves.
void write_radiance(const Shading& s, const Chunk& c, uint16_t* radiance) {
    const Light& light = *s.light;
    alignas(32) int32_t out[2 * CHUNK];
    for (int32_t i = 0; i < c.padded; i += 8) {
        Vec3x8 sum = c.light.at(i);
        f8 share = load(c.from_around + i) / max8(luminance(sum), splat(1e-6f));
        const i8 empty = load(c.empty + i);
        if (c.missed && any(empty)) {
            Vec3x8 beyond = background(light, c.ray.at(i));
            if (s.table != nullptr) {
                // Beyond what the lens sees it is dark.
                beyond = where(load(c.face + i) == NO_FACE, splat(vec3(0.0f, 0.0f, 0.0f)), beyond);
            }
            sum = where(empty, beyond, sum);
            share = empty ? splat(0.0f) : share;
        }
        // Half precision ends at 65504.
        const Vec3x8 exposed = clamp(sum * light.exposure, 0.0f, 6e4f);
        const i8 r = to_half(exposed.x), g = to_half(exposed.y), b = to_half(exposed.z);
        const i8 a = to_half(clamp8(share, 0.0f, 1.0f));
        const i8 rg = r | (g << 16), ba = b | (a << 16);
        store(out + 2 * i, (i8)SHUFFLE(rg, ba, 0, 8, 1, 9, 2, 10, 3, 11));
        store(out + 2 * i + 8, (i8)SHUFFLE(rg, ba, 4, 12, 5, 13, 6, 14, 7, 15));
    }
    memcpy(radiance, out, static_cast<size_t>(c.count) * 8);
}

void shade_chunk(const Shading& s, Chunk& c, TracedRow* before) {
    const Outputs& wanted = *s.outputs;
    if (!wanted.radiance && !wants_attributes(wanted)) {
        if (wanted.surface != nullptr) write_surface(s, c.x, c.y, c.count);
        if (wanted.places != nullptr) write_places(s, c);
        return;
    }
    if (s.table == nullptr) {
        gather(s, c);
    } else {
        gather_through_lens(s, c);
    }
    if (wanted.surface != nullptr) write_gathered_surface(s, c);
    if (wanted.places != nullptr) write_places(s, c);
    set_rays(s, c);
    write_attributes(s, c);
    if (s.outputs->radiance == nullptr) return;
    alignas(32) int32_t x[CHUNK], y[CHUNK];
    for (int32_t i = 0; i < c.padded; i += 8) {
        store(x + i, truncated(counting()) + (c.x + i));
        store(y + i, splat(c.y));
    }
    light_chunk(s, c, x, y, before);
    write_radiance(s, c, s.outputs->radiance + 4 * (c.y * s.width + c.x));
}

}  // namespace

Vec3x8 rays_of_faces(const Shading& s, f8 x, f8 y, i8 faces) {
    const int32_t first = faces[0];
    if (first != NO_FACE && !any(faces != first)) return ray_at(s.world_from_face[first], x, y);
    Vec3x8 rays = splat(vec3(0.0f, 0.0f, 0.0f));
    for (int32_t face = 0; face < CUBE_FACES; face++) {
        const i8 here = faces == face;
        if (any(here)) rays = where(here, ray_at(s.world_from_face[face], x, y), rays);
    }
    return rays;
}

bool traces_reflections(const Shading& s) {
    return s.outputs->radiance != nullptr && s.light->reflecting && s.light->traced != nullptr;
}

void shade_band(const Shading& s, int32_t first_row, int32_t last_row) {
    Chunk chunk;
    const int32_t columns = static_cast<int32_t>((s.width + CHUNK - 1) / CHUNK);
    // One more on either side, of which nothing is known.
    std::vector<TracedRow> before;
    if (traces_reflections(s)) before.resize(static_cast<size_t>(columns) + 2);
    for (int32_t y = first_row; y < last_row; y++) {
        for (int32_t column = 0; column < columns; column++) {
            chunk.x = column * CHUNK;
            const int64_t rest = s.width - chunk.x;
            chunk.count = static_cast<int32_t>(rest < CHUNK ? rest : CHUNK);
            chunk.padded = (chunk.count + 7) & ~7;
            chunk.y = y;
            shade_chunk(s, chunk,
                        before.empty() ? nullptr : &before[static_cast<size_t>(column) + 1]);
        }
    }
}

void gather_points(const Shading& s, const Fragment* fragments, Chunk& c) {
    gather_fragments(s, fragments, c);
    set_rays(s, c);
    if (c.coloured) colour_for_picture(c);
    if (c.detailed) apply_detail_maps(s, c);
    place_points(s, c);
}

void shade_fragments(const Shading& s, const Fragment* fragments, int64_t count, uint16_t* out) {
    Chunk chunk;
    alignas(32) int32_t x[CHUNK], y[CHUNK];
    for (int64_t first = 0; first < count; first += CHUNK) {
        const int64_t rest = count - first;
        chunk.count = static_cast<int32_t>(rest < CHUNK ? rest : CHUNK);
        chunk.padded = (chunk.count + 7) & ~7;
        for (int32_t i = 0; i < chunk.padded; i++) {
            const Fragment& own = fragments[first + (i < chunk.count ? i : 0)];
            x[i] = own.pixel_x;
            y[i] = own.pixel_y;
        }
        gather_fragments(s, fragments + first, chunk);
        set_rays(s, chunk);
        light_chunk(s, chunk, x, y, nullptr);
        write_radiance(s, chunk, out + 4 * first);
    }
}

}  // namespace sailenv
