// What Python hands over for rays: plain structures, mirrored in native/ray_types.py.
//
// Pointers are addresses of arrays that Python keeps alive during the call. Lengths in metres.
#pragma once

#include <cstdint>

#include "light_law.h"

namespace sailenv {

constexpr int32_t WIDTH = 8;  // children of a node, and triangles of a leaf

// A node of a tree: eight boxes in floats, rounded outward, and what is in each: the number of a
// node, ~n for the n-th leaf, or 0 for nothing.
struct TreeNode {
    float planes[6][WIDTH];  // low x, y, z, high x, y, z
    int32_t children[WIDTH];
};

// The opaque triangles of a model in its scaled body frame, in the order of the tree's leaves,
// WIDTH to each leaf. Where a leaf has fewer, triangles without area stand.
struct RayShape {
    const TreeNode* nodes;
    const void* triangles;     // (leaves, 9, WIDTH) float or double: a corner, two edges from it
    const int32_t* order;      // (leaves, WIDTH): which of the model's triangles; -1 for none
    const float* places;       // (leaves, WIDTH, 6): of the corners in the model's chart; or null
    const uint8_t* two_sided;  // (leaves, WIDTH)
    int64_t count;
    int64_t first_triangle;  // of the model, where several models' are counted on
};

struct RayInstance {
    const RayShape* shape;
    const float* radiance;  // (6, channels): of sides +x to -z of what has no chart
    float body_from_world[12];
    float sphere[4];  // around it, world: centre, radius
    float chart[4];   // offset and scale in the light map
    int32_t has_chart;
    int32_t before, after;  // 1: it stands there before, after the change
    int32_t padding;
};

// Balls around small things that shine; see bake/emitters.py.
struct Emitters {
    const float* balls;  // (count, 4): middle and radius
    int64_t count;
};

// What rays may meet, before and after a change.
struct RayScene {
    const TreeNode* nodes;       // over `order`
    const int32_t* order;        // into `resting`
    const RayInstance* resting;  // stand there before and after
    const RayInstance* changed;  // do not
    const RayShape* glass;       // world; or null
    const float* passes;         // (leaves, WIDTH): share that each pane lets through
    const float* sky;            // (sky_height, sky_width, 3)
    const int32_t* patches;      // (height, width): of each texel, -1 for none
    const float* before;         // (patches, channels): radiance
    const float* after;
    Emitters emitters;
    int64_t changed_count, patch_count, resting_count;
    int32_t sky_height, sky_width;
    int32_t height, width;
    int32_t channels, padding;
};

// A light whose rays are traced; see light/bake/direct.py.
struct RayLight {
    Lamp lamp;
    float across[3], up[3];  // of an area light: its whole width and height
    float radius;            // of a directional light's disc at distance 1, else of a lamp's ball
};

}  // namespace sailenv
