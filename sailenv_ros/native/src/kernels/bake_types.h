// What Python hands over for baking light: plain structures, mirrored in native/bake_types.py.
//
// Pointers are addresses of arrays that Python keeps alive during the call. Lengths in metres.
#pragma once

#include <cstdint>

namespace sailenv {

// The texels in use of a light map; see bake/texels.py.
struct TexelMap {
    const int32_t* index;    // (height, width): the number of each texel, -1 where it is unused
    const int32_t* rows;     // (count,)
    const int32_t* columns;  // (count,)
    const int32_t* owners;   // (count,): instances
    const float* positions;  // (count, 3), world
    const float* normals;    // (count, 3), of the smooth surface
    const float* faces;      // (count, 3), of the triangle
    int64_t count, height, width;
};

// Points of surfaces that are lit; see light/bake/direct.py.
struct LitPoints {
    const float* positions;  // (count, 3), world
    const float* normals;    // (count, 3), of the smooth surface
    const float* faces;      // (count, 3), of the triangle
    const float* shifts;     // (count, 2), of the patterns, in sizes of cells
    int64_t count;
};

// Triangles and the texels of a map that they have.
struct MappedTriangles {
    const float* faces;        // (count, 3)
    const uint8_t* two_sided;  // (count,)
    const int32_t* twin;       // (count,): the triangle that lies on it back to back, or -1
    const int32_t* corner;     // (count, 3): which corner of that one each corner lies on
    const float* places;       // (count, 3, 2), of the corners in the map
    const int32_t* index;      // (height, width): the number of each texel, -1 where it is unused
    int64_t count, height, width;
};

// The sky and the windows that it comes in by; see bake/sky.py.
struct SkyWindows {
    const float* picture;  // (height, width, 3): radiance
    const float* panes;    // (pane_count, 4, 3): middle, half the two sides, unit normal
    int64_t height, width, pane_count;
};

// Rays that leave some points, in a list.
struct RayList {
    int32_t* point;  // (room,): where each begins
    float* origins;  // (room, 3)
    float* towards;  // (room, 3), unit length
    int64_t* made;   // (1,): how many there are
};

}  // namespace sailenv
