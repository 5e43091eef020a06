// From what each pixel sees to its light.
#pragma once

#include "lanes.h"
#include "lens.h"
#include "raster.h"
#include "render_types.h"

namespace sailenv {

struct Chunk;
struct MirrorSamples;

// What shading needs besides the scene; all in single precision.
struct Shading {
    const TriangleSet* set;
    const DrawList* parts;
    const InstanceFrame* frames;
    const uint8_t* at_baked_pose;
    const Light* light;
    const Outputs* outputs;
    const MirrorSamples* samples;  // of what surfaces mirror; null where no rays tell
    int64_t width, stride;
    const uint32_t* visible;
    FastLens lens;  // 1, 1, 0, 0 where there is a table
    Sight sight;
    const LensTable *table, *fine_table;  // null through a lens that leaves lines straight
    Mat3 world_from_face[CUBE_FACES], camera_from_face[CUBE_FACES];  // where there is a table
    Mat3 world_from_camera, camera_from_world;
    vec3 eye;
};

// Where the ray of a place in the picture begins, in the world frame, and where it leads to; at
// depth 1 the point is the sum of both. Through a lens that leaves lines straight.
template <class A, class B>
LANES_INLINE Vec3x8 begin_of_ray(const Shading& s, A x, B y) {
    if (s.sight == Sight::CENTRAL) return splat(s.eye);
    return s.world_from_camera.column(0) * (s.lens.ray_x(x) + splat(0.0f)) +
           s.world_from_camera.column(1) * (s.lens.ray_y(y) + splat(0.0f)) + s.eye;
}
template <class A, class B>
LANES_INLINE Vec3x8 ray_to(const Shading& s, A x, B y) {
    if (s.sight == Sight::PARALLEL) return splat(s.world_from_camera.column(2));
    return ray_through(s.lens, s.world_from_camera, x, y);
}

// The sky's light on a surface whose normal has the z `up`: irradiance / pi.
LANES_INLINE Vec3x8 light_of_sky(const Light& l, f8 up) {
    return l.ambient + l.sky_share * sky_irradiance(up, l.sky_zenith, l.sky_horizon, l.sky_ground);
}

// Radiance of the analytic sky in a direction whose z is `up`.
LANES_INLINE Vec3x8 analytic_sky(const Light& l, f8 up) {
    return sky_radiance(up, l.sky_zenith, l.sky_horizon, l.sky_ground);
}

// What the light on a part that can move is multiplied by at its vertices; null where by nothing:
// it is known of the side that the normals are of.
LANES_INLINE const float* factors_of(const Light* light, const Part& part, bool back) {
    if (light == nullptr || !light->baked || back) return nullptr;
    const float* row = light->instance_light + INSTANCE_ROW * static_cast<int64_t>(part.id);
    const int64_t first = static_cast<int64_t>(row[FIRST_FACTOR]) - 1 + part.first_of_model;
    return row[FIRST_FACTOR] > 0.0f ? light->vertex_factors + first : nullptr;
}

// What a vertex knows, see `Part`; with a factor as `vertex_factor` of light_law.h takes it.
LANES_INLINE f8 vertex_of(const Part& part, const float* factors, int64_t number) {
    f8 known = load(part.vertices + 8 * number);
    if (factors != nullptr) known[5] = -factors[number];
    return known;
}

// Irradiance / pi that instances know of themselves, on surfaces that are turned along `normal` and
// lie at `point`; unit vectors and points in the world frame.
Vec3x8 light_of_instances(const Light& light, i8 ids, i8 wanted, Vec3x8 normal, Vec3x8 point);

// What shiny surfaces mirror of a room, as `point` says for each; see shaders/reflections.glsl.
// Points and directions in the world frame.
Vec3x8 mirrored_room(const Light& light, i8 point, Vec3x8 at, Vec3x8 direction, f8 roughness);

// What eight pixels of glass mirror, by rays at both ends and between where these differ; what they
// mirror of pictures of the room where nothing is met. `distance` is how far they are from the eye
// [m].
Vec3x8 trace_glass(const Shading& shading, Vec3x8 point, Vec3x8 direction, f8 distance, i8 wanted,
                   Vec3x8 mirrored);

// Shades the pixels of one band: radiance, surfaces, normals, as wanted.
void shade_band(const Shading& shading, int32_t first_row, int32_t last_row);

// What some samples of a pixel see besides what its centre sees.
struct Fragment {
    float x, y;    // where one of the samples lies [pixels]; on a face where there is a table
    float weight;  // the samples' share of the pixel
    uint32_t tag;  // number of the triangle, or NOTHING
    int32_t pixel_x, pixel_y;
    int32_t face;
};

// Shades some points of surfaces of a band: exposed radiance and the share of it that came from
// around, four halves each.
void shade_fragments(const Shading& shading, const Fragment* fragments, int64_t count,
                     uint16_t* light);

// Whether rays tell what surfaces mirror.
bool traces_reflections(const Shading& shading);

// Gathers some points of surfaces, and what their materials are, as far as light asks for it.
void gather_points(const Shading& shading, const Fragment* fragments, Chunk& chunk);

// Draws see-through surfaces over a band of radiance.
void draw_glass_band(const Shading& shading, const TriangleSet& glass, const DrawList& parts,
                     const Projection& projection, int32_t band, int32_t band_rows,
                     const float* inverse_depth);

}  // namespace sailenv
