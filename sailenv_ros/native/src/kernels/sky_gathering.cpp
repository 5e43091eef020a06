// The sky's light at points, by rays in all directions and by rays to panes of glass.
#include <algorithm>
#include <cmath>

#include "../abi.h"
#include "bake_types.h"
#include "sky_picture.h"

namespace sailenv {
namespace {

constexpr double PI = 3.14159265358979323846;
constexpr int32_t NOTHING = -1;  // of a texel: the ray met nothing

// The density, over solid angle, of directions to evenly chosen points of all panes.
double pane_density(const SkyWindows& sky, const float* p, const float* d) {
    double density = 0.0;
    for (int64_t number = 0; number < sky.pane_count; number++) {
        const float* pane = sky.panes + 12 * number;
        const float *middle = pane, *n = pane + 9;
        const float slant = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
        if (static_cast<double>(std::fabs(slant)) < 1e-6) continue;
        const float o[3] = {middle[0] - p[0], middle[1] - p[1], middle[2] - p[2]};
        const float far = (o[0] * n[0] + o[1] * n[1] + o[2] * n[2]) / slant;
        if (far <= 0.0f) continue;
        const float h[3] = {d[0] * far - o[0], d[1] * far - o[1], d[2] * far - o[2]};
        double area = 4.0;
        bool inside = true;
        for (const float* side = pane + 3; side < n; side += 3) {
            const float length2 = side[0] * side[0] + side[1] * side[1] + side[2] * side[2];
            area *= std::sqrt(length2);
            inside &= !(std::fabs(h[0] * side[0] + h[1] * side[1] + h[2] * side[2]) > length2);
        }
        if (inside) density += far * far / (area * std::fabs(slant));
    }
    return density;
}

void add_sky(const SkyWindows& sky, const float* d, double weight, float* light) {
    double radiance[3];
    picture_radiance(sky.picture, sky.height, sky.width, d, radiance);
    for (int c = 0; c < 3; c++) light[c] = static_cast<float>(light[c] + weight * radiance[c]);
}

}  // namespace
}  // namespace sailenv

// Adds the sky that rays in all directions meet; see bake/gather.py. directions: (count, rays, 3);
// texels, clear: (count, rays), what they met and how much glass lets through; shots: the number of
// rays to each pane. Result: light: (count, 3).
SAILENV_KERNEL(sky_by_chance)
(const sailenv::LitPoints* points, const sailenv::SkyWindows* sky, int64_t rays,
 const float* directions, const int32_t* texels, const float* clear, int64_t shots, float* light) {
    using namespace sailenv;
    if (points->count < 0 || rays < 1 || sky->height < 1 || sky->width < 1)
        return STATUS_INVALID_ARGUMENT;
    for (int64_t k = 0; k < points->count; k++) {
        const float *p = points->positions + 3 * k, *n = points->normals + 3 * k;
        for (int64_t m = 0; m < rays; m++) {
            if (texels[k * rays + m] != NOTHING) continue;
            const float* d = directions + 3 * (k * rays + m);
            // Rays that were mirrored at the face may lie below the normal's horizon.
            const float cosine = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
            const double own = std::max(static_cast<double>(cosine), 1e-3) / PI;
            double weight = own / (static_cast<double>(rays) * own +
                                   static_cast<double>(shots) * pane_density(*sky, p, d));
            weight *= clear[k * rays + m];
            add_sky(*sky, d, weight, light + 3 * k);
        }
    }
    return STATUS_OK;
}

// Adds the sky that rays to panes meet. point, share: (rays,), where each begins and how much of
// its light arrives; towards: (rays, 3); shots, others: numbers of rays to each pane and in all
// directions. Result: light: (count, 3).
SAILENV_KERNEL(sky_by_choice)
(const sailenv::LitPoints* points, const sailenv::SkyWindows* sky, int64_t rays,
 const int32_t* point, const float* towards, const float* share, int64_t shots, int64_t others,
 float* light) {
    using namespace sailenv;
    if (rays < 0 || sky->height < 1 || sky->width < 1) return STATUS_INVALID_ARGUMENT;
    for (int64_t ray = 0; ray < rays; ray++) {
        if (share[ray] <= 0.0f) continue;
        const int64_t k = point[ray];
        if (k < 0 || k >= points->count) return STATUS_INVALID_ARGUMENT;
        const float *d = towards + 3 * ray, *n = points->normals + 3 * k;
        const double own = (d[0] * n[0] + d[1] * n[1] + d[2] * n[2]) / PI;
        double weight =
            own / (static_cast<double>(others) * own +
                   static_cast<double>(shots) * pane_density(*sky, points->positions + 3 * k, d));
        weight *= share[ray];
        add_sky(*sky, d, weight, light + 3 * k);
    }
    return STATUS_OK;
}
