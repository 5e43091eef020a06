// Which clusters of triangles an eye cannot see; for the rasteriser and for the OpenGL renderer.
#pragma once

#include <cmath>

#include "render_types.h"

namespace sailenv {

// What is so little beyond the picture's sides, or faces away by so little, is still drawn:
// roundings decide there.
constexpr double CULL_MARGIN = 0.01;

// Whether a sphere lies beyond one of four planes, (4, 4), that look inwards.
static inline bool is_beyond(const double* centre, double radius, const double* sides) {
    for (int s = 0; s < 4; s++) {
        const double* p = sides + 4 * s;
        if (p[0] * centre[0] + p[1] * centre[1] + p[2] * centre[2] + p[3] < -radius) return true;
    }
    return false;
}

// Tells if no triangle within the sphere, with a normal within the cone, can face the eye.
static inline bool faces_away(const Cluster& cluster, const double* eye) {
    const double dx = cluster.centre[0] - eye[0], dy = cluster.centre[1] - eye[1],
                 dz = cluster.centre[2] - eye[2];
    const double along = cluster.axis[0] * dx + cluster.axis[1] * dy + cluster.axis[2] * dz;
    if (!(cluster.cosine > 0.0) || !(along > 0.0)) return false;
    const double square = dx * dx + dy * dy + dz * dz;
    const double rest = square - along * along;
    const double across = std::sqrt(rest > 0.0 ? rest : 0.0);
    const double cosine = cluster.cosine < 1.0 ? cluster.cosine : 1.0;
    const double sine = std::sqrt(1.0 - cosine * cosine);
    return along * cluster.cosine - across * sine >=
           cluster.radius + CULL_MARGIN * std::sqrt(square);
}

}  // namespace sailenv
