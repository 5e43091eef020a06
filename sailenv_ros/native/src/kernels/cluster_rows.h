// Triangles of a cluster while they are set up.
#pragma once

#include "lanes.h"
#include "raster.h"

namespace sailenv {

LANES_INLINE d4 load_double(const float* p) {
    const f4 r = *reinterpret_cast<const f4_any*>(p);
    return __builtin_convertvector(r, d4);
}
LANES_INLINE void store_double(float* p, d4 x) {
    *reinterpret_cast<f4_any*>(p) = __builtin_convertvector(x, f4);
}

// The numbers of a cluster's triangles, each in a row of its own.
struct ClusterRows {
    alignas(32) float corner[9][CLUSTER_TRIANGLES];  // x, y, z of three corners
    alignas(32) float edge[9][CLUSTER_TRIANGLES];
    alignas(32) float inverse_depth[3][CLUSTER_TRIANGLES];
    alignas(32) float inverse_det[CLUSTER_TRIANGLES];
    alignas(32) float x0[CLUSTER_TRIANGLES], x1[CLUSTER_TRIANGLES];
    alignas(32) float y0[CLUSTER_TRIANGLES], y1[CLUSTER_TRIANGLES];
    const CornerPlace* place[3][CLUSTER_TRIANGLES];  // where the lens has a table
    int32_t back[CLUSTER_TRIANGLES];
    int32_t vertex[3][CLUSTER_TRIANGLES];
};

}  // namespace sailenv
