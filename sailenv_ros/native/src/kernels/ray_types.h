// What Python hands over for rays: plain structures, mirrored in native/ray_types.py.
//
// Pointers are addresses of arrays that Python keeps alive during the call. Lengths in metres.
#pragma once

#include <cstdint>

namespace sailenv {

// A box of a tree. An inner node has two children, `first` and the one behind it; a leaf has
// `count` things from `first` on.
struct TreeNode {
    float low[3];
    int32_t first;
    float high[3];
    int32_t count;
};

// The opaque triangles of a model in its scaled body frame, in the order of the tree's leaves.
struct RayShape {
    const TreeNode* nodes;
    const float* triangles;    // (T, 9): a corner, and the two edges from it
    const float* places;       // (T, 6): of the corners in the model's chart, 0 to 1; or null
    const uint8_t* two_sided;  // (T,)
    int64_t count;
};

struct RayInstance {
    const RayShape* shape;
    const float* radiance;  // (channels,): of what has no chart
    float body_from_world[12];
    float sphere[4];  // around it, world: centre, radius
    float chart[4];   // offset and scale in the light map
    int32_t has_chart;
    int32_t before, after;  // 1: it stands there before, after the change
    int32_t padding;
};

// What rays may meet, before and after a change.
struct RayScene {
    const TreeNode* nodes;        // over `order`
    const int32_t* order;         // into `resting`
    const RayInstance* resting;   // stand there before and after
    const RayInstance* changed;   // do not
    const TreeNode* glass_nodes;  // or null
    const float* glass;           // (G, 9), as `triangles`, world
    const float* passes;          // (G,): share that each lets through
    const float* sky;             // (sky_height, sky_width, 3)
    const int32_t* patches;       // (height, width): of each texel, -1 for none
    const float* before;          // (patches, channels): radiance
    const float* after;
    int64_t changed_count, patch_count;
    int32_t resting_count, glass_count;
    int32_t sky_height, sky_width;
    int32_t height, width;
    int32_t channels, padding;
};

// A light whose rays are traced; see bake/direct.py.
struct RayLight {
    float position[3], direction[3];
    float across[3], up[3];  // of an area light: its whole width and height
    float range, inner_cosine, outer_cosine;
    int32_t kind;  // LightKind
};

}  // namespace sailenv
