// From what each pixel sees to its light.
#pragma once

#include "lanes.h"
#include "raster.h"
#include "render_types.h"

namespace sailenv {

constexpr float LUMA[3] = {0.299f, 0.587f, 0.114f};

// What shading needs besides the scene; all in single precision.
struct Shading {
    const TriangleSet* set;
    const DrawList* parts;
    const InstanceFrame* frames;
    const uint8_t* at_baked_pose;
    const Light* light;
    const Outputs* outputs;
    int64_t width, stride;
    const uint32_t* visible;
    float focal, cx, cy;
    float world_from_camera[9], camera_from_world[9], eye[3];
};

// Light of eight pixels.
struct Colour8 {
    f8 r, g, b;
};

LANES_INLINE Colour8 splat3(const float* c) { return {splat(c[0]), splat(c[1]), splat(c[2])}; }
LANES_INLINE Colour8 mix3(Colour8 a, Colour8 b, f8 share) {
    return {mix8(a.r, b.r, share), mix8(a.g, b.g, share), mix8(a.b, b.b, share)};
}
LANES_INLINE f8 luma8(Colour8 c) { return c.r * LUMA[0] + c.g * LUMA[1] + c.b * LUMA[2]; }

// Where two angles of a direction lie in the analytic sky; see shaders/picture.glsl.
LANES_INLINE Colour8 analytic_sky(const Light& light, f8 up) {
    const Colour8 upper =
        mix3(splat3(light.sky_horizon), splat3(light.sky_zenith), sqrt8(clamp8(up, 0.0f, 1.0f)));
    return mix3(upper, splat3(light.sky_ground), smoothstep8(splat(0.0f), splat(0.12f), -up));
}

// What shiny surfaces mirror of a room, as `point` says for each; see shaders/reflections.glsl.
// Points and directions in the world frame.
Colour8 mirrored_room(const Light& light, i8 point, f8 x, f8 y, f8 z, f8 dx, f8 dy, f8 dz,
                      f8 roughness);

// Shades the pixels of one band: radiance, surfaces, normals, as wanted.
void shade_band(const Shading& shading, int32_t first_row, int32_t last_row);

// What some samples of a pixel see besides what its centre sees.
struct Fragment {
    float x, y;    // where one of the samples lies [pixels]
    float weight;  // the samples' share of the pixel
    uint32_t tag;  // number of the triangle, or NOTHING
    int32_t pixel_x, pixel_y;
};

// Shades some points of surfaces: exposed radiance and the share of it that came from around, four
// halves each.
void shade_fragments(const Shading& shading, const Fragment* fragments, int64_t count,
                     uint16_t* light);

// Draws see-through surfaces over a band of radiance.
void draw_glass_band(const Shading& shading, const TriangleSet& glass, const DrawList& parts,
                     const Projection& projection, int32_t band, int32_t band_rows,
                     const float* nearness);

}  // namespace sailenv
