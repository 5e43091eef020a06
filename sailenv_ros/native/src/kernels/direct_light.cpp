// What arrives straight from lights, for bakes; see light/bake/direct.py.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "../abi.h"
#include "bake_types.h"
#include "light_sampling.h"
#include "net_points.h"

namespace sailenv {
namespace {

// Calls body(ray, position, sample) for rays from each point to a light.
template <class Body>
void for_samples(const RayLight& light, const LitPoints& points, int64_t k, int64_t rays,
                 const float* pattern, const Body& body) {
    const double cells = std::sqrt(static_cast<double>(rays));
    for (int64_t m = 0; m < rays; m++) {
        double u, v;
        shifted_point(pattern + 2 * m, points.shifts + 2 * k, cells, &u, &v);
        body(k * rays + m, sample_light(light, points.positions + 3 * k, static_cast<float>(u),
                                        static_cast<float>(v)));
    }
}

}  // namespace
}  // namespace sailenv

// Points of a light, seen from others. Of `points` positions and shifts are read. Result: towards:
// (count, rays, 3); lengths, irradiance: (count, rays).
SAILENV_KERNEL(light_samples)
(const sailenv::RayLight* light, const sailenv::LitPoints* points, int64_t rays,
 const float* pattern, float* towards, float* lengths, float* irradiance) {
    using namespace sailenv;
    if (points->count < 0 || rays < 1) return STATUS_INVALID_ARGUMENT;
    for (int64_t k = 0; k < points->count; k++) {
        for_samples(*light, *points, k, rays, pattern, [&](int64_t ray, const LightSample& s) {
            std::copy_n(s.towards, 3, towards + 3 * ray);
            lengths[ray] = s.length;
            irradiance[ray] = s.irradiance;
        });
    }
    return STATUS_OK;
}

// Rays to a light that may bring light, those above both horizons. Result: list: of them, each with
// its number among all as its point; lengths: of them.
SAILENV_KERNEL(light_rays)
(const sailenv::RayLight* light, const sailenv::LitPoints* points, int64_t rays,
 const float* pattern, const sailenv::RayList* list, float* lengths) {
    using namespace sailenv;
    if (points->count < 0 || rays < 1) return STATUS_INVALID_ARGUMENT;
    int64_t made = 0;
    for (int64_t k = 0; k < points->count; k++) {
        const float *n = points->normals + 3 * k, *face = points->faces + 3 * k;
        for_samples(*light, *points, k, rays, pattern, [&](int64_t ray, const LightSample& s) {
            if (!(sample_power(s, n) > 0.0f) || !(dot(s.towards, face) > 0.0f)) return;
            list->point[made] = static_cast<int32_t>(ray);
            for (int c = 0; c < 3; c++) {
                list->origins[3 * made + c] = points->positions[3 * k + c] + face[c] * LIFT_M;
            }
            std::copy_n(s.towards, 3, list->towards + 3 * made);
            lengths[made++] = s.length;
        });
    }
    *list->made = made;
    return STATUS_OK;
}

// What arrives by rays to a light. free: (count, rays), how much of each arrives. Result: arriving:
// (count,), irradiance / pi; share: (count,), of the rays.
SAILENV_KERNEL(direct_light)
(const sailenv::RayLight* light, const sailenv::LitPoints* points, int64_t rays,
 const float* pattern, const float* free, float* arriving, float* share) {
    using namespace sailenv;
    if (points->count < 0 || rays < 1) return STATUS_INVALID_ARGUMENT;
    const float each = 1.0f / static_cast<float>(rays);
    for (int64_t k = 0; k < points->count; k++) {
        const float *p = points->positions + 3 * k, *n = points->normals + 3 * k;
        double arrives = 0.0, unhindered = 0.0, all = 0.0;
        for_samples(*light, *points, k, rays, pattern, [&](int64_t ray, const LightSample& s) {
            const double power = sample_power(s, n);
            unhindered += power;
            arrives += power * free[ray];
            all += free[ray];
        });
        const float scale = sample_scale(*light, p, n, static_cast<float>(unhindered) * each);
        arriving[k] = static_cast<float>(arrives) * each * scale;
        share[k] = static_cast<float>(all) * each;
    }
    return STATUS_OK;
}

// What arrives from a rectangle if nothing is in the way; see form_factor.
SAILENV_KERNEL(form_factors)
(const double* corners, const double* direction, int64_t count, const float* positions,
 const float* normals, float* found) {
    using namespace sailenv;
    if (count < 0) return STATUS_INVALID_ARGUMENT;
    for (int64_t k = 0; k < count; k++) {
        found[k] = form_factor(corners, direction, positions + 3 * k, normals + 3 * k);
    }
    return STATUS_OK;
}
