// What Python hands over for rays from shiny surfaces: plain structures, mirrored in
// native/traced_types.py.
//
// Pointers are addresses of arrays that Python keeps alive during the call.
#pragma once

#include <cstdint>

#include "ray_types.h"
#include "render_types.h"

namespace sailenv {

// An instance that rays may meet, and where its parts are.
struct TracedInstance {
    RayInstance placed;        // its shape alone, and where that stands
    const Part* parts;         // of its model, those that are not see-through
    const int32_t* part_of;    // (triangles,): in `parts`, of each one of the shape's; -1 for none
    const uint32_t* vertices;  // (triangles, 3): in Part::vertices
    float inverse_scale[3];
    int32_t at_baked_pose;
};

struct TracedScene {
    const TreeNode* nodes;  // over `order`
    const int32_t* order;   // into `instances`
    const TracedInstance* instances;
    int64_t count;
};

}  // namespace sailenv
