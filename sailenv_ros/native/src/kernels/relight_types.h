// What Python hands over for relighting: plain structures, mirrored in native/relight_types.py.
//
// Pointers are addresses of arrays that Python keeps alive during the call. Lengths in metres.
#pragma once

#include <cstdint>

#include "ray_types.h"

namespace sailenv {

// What was found at a patch, or is wanted of it.
enum PatchState : uint8_t {
    PATCH_AS_IT_WAS = 0,
    PATCH_CHANGED = 1,  // what was found is to be added
    PATCH_WHOLE = 2,    // it is all of the light
    PATCH_INSIDE = 3,   // nothing is known: the patch lies inside of something
};

// Tiles of 4 x 4 texels of a light map; see relight/baked_scene.py.
struct PatchMap {
    const int32_t* of_texel;  // (side, side), -1 for none
    const float* places;      // (count, 2): column and row of the texel that stands for each
    const float* positions;   // (count, 3), world
    const float* normals;     // (count, 3)
    const int32_t* owners;    // (count,): instances
    int64_t count, side;
};

// The texels in use of a light map.
struct MappedTexels {
    const int32_t* places;   // (count,): row * side + column
    const float* positions;  // (count, 3), world
    const float* normals;    // (count, 3)
    const int32_t* owners;   // (count,): instances
    int64_t count;
};

// What is to be gathered where.
struct PatchQuery {
    const float* positions;     // (count, 3), world
    const float* normals;       // (count, 3)
    const uint8_t* wanted;      // (count,): PATCH_AS_IT_WAS (nothing), PATCH_CHANGED, PATCH_WHOLE
    const uint32_t* numbers;    // (count,): seeds of their random numbers
    const float* pattern;       // (rays, 2), points of the unit square
    const RayLight* lights;     // (light_count,): area lights
    const float* shot_pattern;  // (shots, 2), for rays to each of them
    const RayInstance* own;     // what the points lie on, and was not baked; or null
    int64_t count, rays, light_count, shots;
    double least;         // share of a view that changed things must be able to take
    double most_changed;  // share of rays; where more meet a change, all of the light is gathered
    double inside_share;  // of backs that are seen; a patch that sees more lies inside of something
};

// What was gathered: irradiance / pi, the difference or all of it.
struct PatchChange {
    uint8_t* found;   // (count,): PatchState
    float* bounced;   // (count, channels)
    float* direct;    // (count, light_count)
    float* nearness;  // (count,): harmonic mean of the distances of what was looked at
};

// Channels of maps of halves.
struct HalfMaps {
    uint16_t* const* texels;  // (channels,): the first texel of each
    const int64_t* steps;     // (channels,): from one texel to the next
    int64_t channels;
};

}  // namespace sailenv
