// 64 pixels of a row on their way from surfaces to light: what each stage of shading reads and
// writes. A chunk's numbers lie in arrays, one for each quantity, and each stage goes over them
// eight at a time.
#pragma once

#include "shade.h"

namespace sailenv {

constexpr int32_t CHUNK = 64;
constexpr float PI = 3.14159265f;

// Vectors or colours of a chunk.
struct Vectors {
    alignas(32) float x[CHUNK], y[CHUNK], z[CHUNK];

    LANES_METHOD Vec3x8 at(int32_t i) const { return {load(x + i), load(y + i), load(z + i)}; }
    LANES_METHOD void set(int32_t i, Vec3x8 v) {
        store(x + i, v.x);
        store(y + i, v.y);
        store(z + i, v.z);
    }
};

static inline vec3 vector_at(const Vectors& v, int32_t i) { return {v.x[i], v.y[i], v.z[i]}; }
static inline void put(Vectors& v, int32_t i, vec3 value) {
    v.x[i] = value.x;
    v.y[i] = value.y;
    v.z[i] = value.z;
}

struct Chunk {
    int32_t x, y, count, padded;                 // of a row; `x` and `y` not of fragments
    alignas(32) float at_x[CHUNK], at_y[CHUNK];  // [pixels]; on a face where the lens has a table
    // Where the lens has a table: the face, and how places change from pixel to pixel.
    alignas(32) int32_t face[CHUNK];
    alignas(32) float x_right[CHUNK], y_right[CHUNK], x_down[CHUNK], y_down[CHUNK];
    bool hit, missed, coloured, detailed;  // what there is among the pixels
    bool parallel;                         // changes of uv are not over depth, below
    alignas(32) float depth[CHUNK];
    Vectors normal;  // world frame
    // How unit normals change from a pixel to the one beside or below where they change more; 0 of
    // what does not mirror sharply.
    Vectors bend;
    // Of what has no light map light_u is a factor, see `vertex_factor`, and light_v the share that
    // it hides of itself.
    alignas(32) float u[CHUNK], v[CHUNK], light_u[CHUNK], light_v[CHUNK];
    // Changes of uv / depth and of 1 / depth from pixel to pixel; of uv and of -depth where rays
    // are parallel.
    alignas(32) float ux[CHUNK], vx[CHUNK], uy[CHUNK], vy[CHUNK];
    alignas(32) float inverse_depth_x[CHUNK], inverse_depth_y[CHUNK];
    Vectors base;  // base colour: its square root before `place_points`, linear after it
    alignas(32) float roughness[CHUNK], metallic[CHUNK], emission[CHUNK];
    alignas(32) float colour_log2[CHUNK], detail_log2[CHUNK], finish[CHUNK], relief[CHUNK];
    const uint32_t* colour_texels[CHUNK];
    const uint32_t* detail_texels[CHUNK];
    alignas(32) int32_t id[CHUNK], empty[CHUNK];  // empty: all bits where nothing is
    Vectors ray;                                  // world frame, depth 1
    Vectors point;                                // world [m]
    Vectors around;                               // irradiance / pi, but for the lamps'
    Vectors mirrored;                             // radiance, without faces of area lights
    Vectors darkened;               // by how much less of the room it is than pictures of that have
    alignas(32) float open[CHUNK];  // share of the room that is seen
    Vectors faces;                  // radiance of faces of area lights, mirrored
    alignas(32) float arrives[CHUNK];      // share of the main light
    Vectors light;                         // radiance towards the eye
    alignas(32) float from_around[CHUNK];  // luminance of what of it came from around
};

constexpr float LEAST_ROUGHNESS = 0.045f;  // smoother ones have no highlights; see textures.glsl
constexpr float NO_MAP = -1.0f;            // in place of the logarithm of a texture's size

// Interpolates what the triangles' corners know, and notes the materials: of a row's pixels, and of
// points anywhere in the picture.
void gather(const Shading& s, Chunk& c);
void gather_fragments(const Shading& s, const Fragment* fragments, Chunk& c);

// The same through a lens that has a table.
void gather_through_lens(const Shading& s, Chunk& c);

// Rays of places on faces, in the world frame; 0 where the lens sees nothing.
Vec3x8 rays_of_faces(const Shading& s, f8 x, f8 y, i8 faces);

// Depth and instance id of a row's pixels, with nothing gathered.
void write_surface(const Shading& s, int32_t x, int32_t y, int32_t count);

// Multiplies base colours by what colour maps hold: as a picture wants it, and one texel a pixel.
void colour_for_picture(Chunk& c);
void colour_of_pixels(Chunk& c);

// Views that are attributes of surfaces, of a row's pixels; see surface_attributes.cpp.
bool wants_attributes(const Outputs& outputs);
void write_attributes(const Shading& s, Chunk& c);

// Normal, roughness and metallic as the detail map has them; see shaders/textures.glsl.
void apply_detail_maps(const Shading& s, Chunk& c);

// Brings eight pixels' materials into the bounds of the light's model, and base colours, of which
// the square roots were interpolated, to linear ones.
LANES_INLINE void finish_material(Chunk& c, int32_t i) {
    store(c.roughness + i, clamp8(load(c.roughness + i), LEAST_ROUGHNESS, 1.0f));
    store(c.metallic + i, clamp8(load(c.metallic + i), 0.0f, 1.0f));
    const Vec3x8 root = c.base.at(i);
    c.base.set(i, root * root);
}

// The light around each point and the share of the main light that arrives: from baked light, and
// from an analytic sky and one shadow map where nothing is baked.
void light_from_bake(const Shading& s, Chunk& c);
void light_from_sky(const Shading& s, Chunk& c);

// What each point mirrors, as pictures of the room have it.
void mirror_surroundings(const Shading& s, Chunk& c);

// What rays from a row's pixels met: weighted sums of radiance, and of which surfaces.
struct TracedRow {
    int32_t y = -9;
    int32_t id[CHUNK];
    float weight[CHUNK];
    Vectors sum, normal, point;
};

// From this roughness on many pixels share what rays of their lobes meet.
constexpr float ROUGH = 0.36f;

// Puts in its place what rays meet of smooth surfaces, where that is worth it, with the faces of
// area lights where they are flat; see shade_traced.cpp. `before` has rows above and is brought up
// to date, null for points that lie anywhere; before and behind it stand those of the chunks beside
// this one.
void trace_reflections(const Shading& s, Chunk& c, TracedRow* before);

// By the samples of a picture: corrects what pictures of the room have and finds the faces of area
// lights; puts in its place what rough surfaces mirror. `x` and `y` are of the pixels in which the
// points lie.
void correct_mirrored(const Shading& s, const int32_t* x, const int32_t* y, Chunk& c);
void mirror_rough(const Shading& s, const int32_t* x, const int32_t* y, Chunk& c);

// The direction from which a surface mirrors light to the eye.
LANES_INLINE Vec3x8 mirrored_ray(const Chunk& c, int32_t i) {
    const Vec3x8 ray = c.ray.at(i), normal = c.normal.at(i);
    const f8 scale = inverse_length(ray);
    const f8 twice = 2.0f * dot(ray, normal) * scale;
    return ray * scale - twice * normal;
}

// Share of the light around that a surface mirrors: `x` times its reflectance head-on, plus `y`.
struct Mirroring {
    f8 x, y;
};
LANES_INLINE Mirroring mirroring(f8 roughness, f8 cosine) {
    const f8 nv = min8(cosine, splat(1.0f));
    return {mirrored_scale(roughness, nv), mirrored_bias(roughness, nv)};
}
LANES_INLINE Vec3x8 reflectance_head_on(Vec3x8 base, f8 metallic) {
    return mix(vec3(0.04f, 0.04f, 0.04f), base, metallic);
}

// Share that is mirrored of all light that eight surfaces send back, where light is even.
LANES_INLINE f8 mirrored_part(const Chunk& c, int32_t i) {
    const Vec3x8 ray = c.ray.at(i), base = c.base.at(i);
    const f8 cosine = abs8(dot(c.normal.at(i), ray) * inverse_length(ray)) + 1e-4f;
    const f8 metallic = load(c.metallic + i), diffuse = luminance(base) * (1.0f - metallic);
    const Mirroring term = mirroring(load(c.roughness + i), cosine);
    const f8 sharp = luminance(reflectance_head_on(base, metallic) * term.x + term.y);
    return sharp / (sharp + diffuse);
}

// Radiance seen where nothing was hit; see shaders/sky.frag.
Vec3x8 background(const Light& light, Vec3x8 direction);

// Adds up what surfaces send to the eye of all that arrives.
void reflect_to_eye(const Shading& s, Chunk& c);

inline bool has_main_light(const Light& light) {
    return light.main_colour.x + light.main_colour.y + light.main_colour.z > 0.0f;
}

}  // namespace sailenv
