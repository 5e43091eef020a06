// What Python hands over for a picture: plain structures, mirrored in native/render_types.py.
//
// Pointers are addresses of arrays that Python keeps alive during the call.
#pragma once

#include <cstdint>

#include "lens.h"
#include "lens_table.h"
#include "light_law.h"

namespace sailenv {

constexpr int32_t CLUSTER_TRIANGLES = 32;  // at most; as in native/mesh_kernels.py

// A group of neighbouring triangles that face alike.
struct Cluster {
    int64_t first_index, index_count;
    double centre[3], radius;
    double axis[3], cosine;
};

// A mip chain of a square texture: level by level from the finest, rows from the bottom up, four
// bytes a texel. A row of n texels holds n + 1: the first is repeated at its end, so that two
// neighbours are always one load.
struct Texture {
    const uint32_t* texels;
    int64_t log2_size;
};

enum PartFlag : int32_t {
    PART_DOUBLE_SIDED = 1,
    PART_MASKED = 2,
    PART_FINISH_MAP = 4,  // the detail map holds roughness and metallic
    PART_NORMAL_MAP = 8,  // the detail map holds normals
};

// A mesh with a material, of one instance.
struct Part {
    const float* corner_x;  // positions, each once; readable up to 8 numbers beyond the last
    const float* corner_y;
    const float* corner_z;
    const uint32_t* corner_indices;  // three per triangle
    const uint32_t* vertex_indices;
    const float* vertices;  // (V, 8): normal, uv, light uv (or 0, hidden), 0
    const Cluster* clusters;
    const Texture* colour_map;  // square root of linear colour, alpha; null for none
    const Texture* detail_map;  // normal x and y, roughness, metallic; null for none
    int32_t corner_count, cluster_count;
    float sphere[4];  // around the mesh: centre, radius
    float colour[4];  // square root of linear colour, or of the glow's where there is one; alpha
    float base[3];    // square root of linear base colour
    float roughness, metallic, alpha_cutoff, emission;  // emission: radiance over colour
    float cutoff_fall, least_cutoff;  // how the cut-off falls from level to level, and where to
    float chart[4];                   // offset and scale in the light map
    int32_t flags, instance, id;
    int32_t has_chart;
    int32_t first_vertex;    // among those of a model that deforms; else `RIGID`
    int32_t first_of_model;  // number of the first vertex among those of the model's parts
};

constexpr int32_t RIGID = -1;

struct Instances {
    const double* world_from_body;  // (N, 4, 4)
    const double* scales;           // (N, 3)
    const uint8_t* drawn;           // (N,), or null: all are
    const uint8_t* at_baked_pose;   // (N,)
    int64_t count;
    int64_t clipped;  // 1 + the instance that is drawn in a part of the picture alone; 0 for none
    int32_t clip[4];  // first column and row, last column and row of that part; may be empty
};

struct DrawList {
    const Part* parts;
    int64_t count;
};

static_assert(sizeof(Lamp) == 64, "shaders and lights.py take it for so long");

// A shadow map: 1 - depth as the light sees it, the nearest surface, 0 where there is none.
struct ShadowMap {
    const float* inverse_depth;  // (size, size + ROW_PADDING)
};

// A light map that is added up where it is looked at: texels from `LAYER_RUN` to `LAYER_RUN`, each
// run when it is needed first. See kernels/layer_sum.h.
struct LayerSum {
    int64_t count;  // of texels, a multiple of eight
    int64_t terms;
    const uint16_t* const* layers;  // halves, (count, 3) or (count,)
    const int32_t* channels;        // of each layer, 3 or 1
    const float* factors;           // (terms, 24): three numbers, eight times
    const float* more;              // (24,)
    const uint8_t* shown;           // (count,)
    uint16_t* texels;               // halves (count, 4): takes the sum
    uint8_t* states;                // RunState of each run; zeros at first
};

// From where a room was looked at for what is mirrored.
struct ReflectionPoint {
    vec3 position;
    float light[4];  // irradiance / pi there: c0, cx, cy, cz; luminance
};

// A row of `instance_light`: terms of red, green and blue, see irradiance_of_terms; then the body's
// three axes in the world, four numbers each, of which the last is 0; that of the first axis is 1
// more than the number of the first vertex among `vertex_factors`, or 0.
constexpr int32_t LIGHT_TERMS = 28, INSTANCE_ROW = 3 * LIGHT_TERMS + 12;
constexpr int32_t FIRST_FACTOR = 3 * LIGHT_TERMS + 3;

struct TracedScene;  // see traced_types.h
struct RayLight;     // see ray_types.h

// Everything that lights a picture; all vectors in the world frame.
struct Light {
    vec3 main_colour, main_towards;
    Mat3x4 map_from_world;  // the map's sides are 0 and 1
    float texel_m;
    int32_t shadow_size;
    ShadowMap shadow, static_shadow;
    vec3 ambient;
    float sky_share;
    vec3 sky_zenith, sky_horizon, sky_ground;
    vec3 background;
    int32_t background_plain;  // 1: the background is a colour
    const uint16_t* sky_map;   // halves (height, width, 4), or null
    int32_t sky_width, sky_height;
    float sky_factor;  // of the map's radiance
    float exposure;    // factor
    int32_t lamp_count;
    const Lamp* lamps;
    int32_t baked;              // 1: what follows counts
    int32_t reflecting;         // 1: there is a reflection map
    const LayerSum* light_map;  // (height, width): irradiance / pi, share of main light
    int32_t light_map_width, light_map_height;
    const float* instance_light;  // (ids, INSTANCE_ROW)
    const float* vertex_factors;  // what that is multiplied by at vertices
    float main_baked, main_clear;
    const int32_t* edge_index;   // (height, width) of the light map: number of a block, or -1; null
    const uint8_t* edge_blocks;  // (blocks, 6, 6): share of main light, see SunEdges
    const uint16_t* reflections;  // halves (points, layers, edge, edge, 4)
    int32_t reflection_edge, reflection_layers;
    float reflection_scale;  // share of the square without its border
    float layers_per_roughness;
    const ReflectionPoint* reflection_points;
    const int32_t* reflection_table;  // (ids,): the point that an instance uses
    vec3 room_low, room_high;
    const TracedScene* traced;        // or null
    const RayLight* mirrored_lights;  // whose faces and highlights surfaces mirror
    int64_t mirrored_light_count;
    int32_t outside_id;      // of what lies outside the room, which shines as the sky does; 0
    float outside_radiance;  // of its white
};

struct View {
    double camera_from_world[16], world_from_camera[16];
    Lens lens;
    int64_t width, height;
    int64_t smooth_edges;  // 1: edges of surfaces are smoothed, see kernels/edges.cpp
    int64_t parallel;      // 1: rays are, see `Sight`
    // Of a lens that bends straight lines: of the pixels' centres, and of samples half a pixel
    // apart where edges are smoothed. Else null.
    const LensTable *table, *fine_table;
};

// Where on a triangle of a model that deforms a point is: vertices and their weights.
struct TrianglePlace {
    uint32_t vertices[3];
    float weights[3];
};

constexpr int64_t MOST_ATTRIBUTES = 8;

// What is wanted; null pointers for what is not.
struct Outputs {
    float* surface;                      // (height, width, 2): depth [m], instance id
    uint16_t* radiance;                  // halves (height, width, 4): exposed, share from around
    float* attributes[MOST_ATTRIBUTES];  // see surface_attributes.cpp
    TrianglePlace* places;               // (height, width): written of what deforms
};

}  // namespace sailenv
