// Where a cluster of triangles lies and where it faces.
#pragma once

#include <cmath>
#include <cstdint>

#include "point.h"
#include "render_types.h"

namespace sailenv {

// Sphere and cone of a cluster; `corner_of` returns a corner by its number.
template <class Corners>
static inline void move_cluster(const Corners& corner_of, const uint32_t* indices,
                                Cluster& cluster) {
    const uint32_t* from = indices + cluster.first_index;
    const int64_t count = cluster.index_count;
    double corners[3][3 * CLUSTER_TRIANGLES];
    double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
    for (int64_t k = 0; k < count; k++) {
        const Point p = corner_of(from[k]);
        for (int j = 0; j < 3; j++) {
            corners[j][k] = p.x[j];
            if (p.x[j] < low[j]) low[j] = p.x[j];
            if (p.x[j] > high[j]) high[j] = p.x[j];
        }
    }
    for (int j = 0; j < 3; j++) cluster.centre[j] = 0.5 * (low[j] + high[j]);
    double farthest = 0.0;
    for (int64_t k = 0; k < count; k++) {
        double square = 0.0;
        for (int j = 0; j < 3; j++) {
            const double away = corners[j][k] - cluster.centre[j];
            square += away * away;
        }
        if (square > farthest) farthest = square;
    }
    cluster.radius = std::sqrt(farthest);
    double areas[3][CLUSTER_TRIANGLES], sizes[CLUSTER_TRIANGLES], axis[3] = {};
    for (int64_t t = 0; t < count / 3; t++) {
        double b[3], c[3];
        for (int j = 0; j < 3; j++) {
            b[j] = corners[j][3 * t + 1] - corners[j][3 * t];
            c[j] = corners[j][3 * t + 2] - corners[j][3 * t];
        }
        areas[0][t] = b[1] * c[2] - b[2] * c[1];
        areas[1][t] = b[2] * c[0] - b[0] * c[2];
        areas[2][t] = b[0] * c[1] - b[1] * c[0];
        for (int j = 0; j < 3; j++) axis[j] += areas[j][t];
    }
    const double length = std::sqrt((axis[0] * axis[0] + axis[1] * axis[1]) + axis[2] * axis[2]);
    cluster.cosine = -1.0;
    for (int j = 0; j < 3; j++) cluster.axis[j] = length > 0.0 ? axis[j] / length : 0.0;
    if (!(length > 0.0)) return;
    double least = 1.0;
    for (int64_t t = 0; t < count / 3; t++) {
        const double x = areas[0][t], y = areas[1][t], z = areas[2][t];
        sizes[t] = std::sqrt((x * x + y * y) + z * z);
        areas[0][t] =
            ((x * cluster.axis[0] + y * cluster.axis[1]) + z * cluster.axis[2]) / sizes[t];
    }
    for (int64_t t = 0; t < count / 3; t++) {
        if (sizes[t] > 0.0 && areas[0][t] < least) least = areas[0][t];
    }
    cluster.cosine = least;
}

}  // namespace sailenv
