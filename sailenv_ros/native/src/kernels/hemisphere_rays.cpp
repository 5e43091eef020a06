// Rays from points of surfaces: into their half spaces, to panes of glass and to small lamps.
#include <algorithm>
#include <cmath>

#include "../abi.h"
#include "bake_types.h"
#include "emitter_cones.h"
#include "net_points.h"

namespace sailenv {
namespace {

template <class Real>
Real along(const Real* d, const float* n) {
    return d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
}

bool is_above(const LitPoints& points, int64_t k, const double* d) {
    return along(d, points.normals + 3 * k) > 0.0 && along(d, points.faces + 3 * k) > 0.0;
}

void lift(const LitPoints& points, int64_t k, float* origin) {
    for (int c = 0; c < 3; c++) {
        origin[c] = points.positions[3 * k + c] + points.faces[3 * k + c] * LIFT_M;
    }
}

// Adds a ray along d, which is `length` long, to the list if it leaves the surface.
void list_if_above(const LitPoints& points, int64_t k, const double* d, double length,
                   const RayList& list) {
    if (!is_above(points, k, d)) return;
    const int64_t made = (*list.made)++;
    list.point[made] = static_cast<int32_t>(k);
    lift(points, k, list.origins + 3 * made);
    for (int c = 0; c < 3; c++) list.towards[3 * made + c] = static_cast<float>(d[c] / length);
}

}  // namespace
}  // namespace sailenv

// Rays whose density is the cosine to the normal, over pi; those that would run into the face are
// mirrored at it. pattern: (rays, 2), a net. Result: origins, directions: (count, rays, 3).
SAILENV_KERNEL(hemisphere_rays)
(const sailenv::LitPoints* points, int64_t rays, const float* pattern, float* origins,
 float* directions) {
    using namespace sailenv;
    if (points->count < 0 || rays < 1) return STATUS_INVALID_ARGUMENT;
    const double cells = std::sqrt(static_cast<double>(rays));
    for (int64_t k = 0; k < points->count; k++) {
        const float* face = points->faces + 3 * k;
        float origin[3];
        lift(*points, k, origin);
        for (int64_t m = 0; m < rays; m++) {
            double u, v, d[3];
            shifted_point(pattern + 2 * m, points->shifts + 2 * k, cells, &u, &v);
            cosine_direction(points->normals + 3 * k, u, v, d);
            const double below = along(d, face);
            float* out = directions + 3 * (k * rays + m);
            float* from = origins + 3 * (k * rays + m);
            for (int c = 0; c < 3; c++) {
                if (below < 0.0) d[c] -= 2.0 * below * face[c];
                out[c] = static_cast<float>(d[c]);
                from[c] = origin[c];
            }
        }
    }
    return STATUS_OK;
}

// Rays to points of a pane, (4, 3), that lie above the horizon.
SAILENV_KERNEL(pane_rays)
(const sailenv::LitPoints* points, const float* pane, int64_t rays, const float* pattern,
 const sailenv::RayList* list) {
    using namespace sailenv;
    if (points->count < 0 || rays < 1) return STATUS_INVALID_ARGUMENT;
    const double cells = std::sqrt(static_cast<double>(rays));
    *list->made = 0;
    for (int64_t k = 0; k < points->count; k++) {
        for (int64_t m = 0; m < rays; m++) {
            double u, v, d[3];
            shifted_point(pattern + 2 * m, points->shifts + 2 * k, cells, &u, &v);
            u = 2.0 * u - 1.0;
            v = 2.0 * v - 1.0;
            for (int c = 0; c < 3; c++) {
                d[c] = pane[c] + u * pane[3 + c] + v * pane[6 + c] - points->positions[3 * k + c];
            }
            const double length =
                std::max(std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), 1e-9);
            list_if_above(*points, k, d, length, *list);
        }
    }
    return STATUS_OK;
}

// Rays into the cone of an emitter, (4,), that lie above the horizon.
SAILENV_KERNEL(emitter_rays)
(const sailenv::LitPoints* points, const float* ball, int64_t rays, const float* pattern,
 const sailenv::RayList* list) {
    using namespace sailenv;
    if (points->count < 0 || rays < 1) return STATUS_INVALID_ARGUMENT;
    const double cells = std::sqrt(static_cast<double>(rays));
    *list->made = 0;
    for (int64_t k = 0; k < points->count; k++) {
        EmitterCone cone;
        if (!cone.about(ball, points->positions + 3 * k)) continue;
        for (int64_t m = 0; m < rays; m++) {
            double u, v, d[3];
            shifted_point(pattern + 2 * m, points->shifts + 2 * k, cells, &u, &v);
            cone.direction(u, v, d);
            list_if_above(*points, k, d, 1.0, *list);
        }
    }
    return STATUS_OK;
}

// How much rays into cones count (the balance heuristic): `shots` of them from each point, and
// `others` in all directions. point: (rays,); towards: (rays, 3). Result: weights: (rays,).
SAILENV_KERNEL(emitter_weights)
(const sailenv::LitPoints* points, const sailenv::Emitters* emitters, int64_t rays,
 const int32_t* point, const float* towards, int64_t shots, int64_t others, float* weights) {
    using namespace sailenv;
    for (int64_t ray = 0; ray < rays; ray++) {
        const int64_t k = point[ray];
        if (k < 0 || k >= points->count) return STATUS_INVALID_ARGUMENT;
        const float* d = towards + 3 * ray;
        const double own = along(d, points->normals + 3 * k) / PI;
        const double density = cone_density(*emitters, points->positions + 3 * k, d);
        weights[ray] = static_cast<float>(balanced(own, others, shots, density));
    }
    return STATUS_OK;
}

// How much less rays in all directions count that lie in cones, where without cones each counts one
// over their number. directions: (count, rays, 3); texels: (count, rays), below 0 where a ray met
// none. Result: of those that count less, of `room` at most: point, texel, weight; made: how many
// there are, whatever the room.
SAILENV_KERNEL(weights_within_cones)
(const sailenv::LitPoints* points, const sailenv::Emitters* emitters, int64_t rays,
 const float* directions, const int32_t* texels, int64_t shots, int64_t room, int32_t* point,
 int32_t* texel, float* weights, int64_t* made) {
    using namespace sailenv;
    if (points->count < 0 || rays < 1) return STATUS_INVALID_ARGUMENT;
    const double all = static_cast<double>(rays);
    int64_t count = 0;
    for (int64_t k = 0; k < points->count; k++) {
        for (int64_t m = 0; m < rays; m++) {
            const int32_t met = texels[k * rays + m];
            if (met < 0) continue;
            const float* d = directions + 3 * (k * rays + m);
            const double density = cone_density(*emitters, points->positions + 3 * k, d);
            if (density == 0.0) continue;
            if (count < room) {
                // Rays that were mirrored at the face may lie below the normal's horizon.
                const double own =
                    std::max(static_cast<double>(along(d, points->normals + 3 * k)), 1e-3) / PI;
                point[count] = static_cast<int32_t>(k);
                texel[count] = met;
                weights[count] =
                    static_cast<float>(balanced(own, rays, shots, density) - 1.0 / all);
            }
            count++;
        }
    }
    *made = count;
    return STATUS_OK;
}
