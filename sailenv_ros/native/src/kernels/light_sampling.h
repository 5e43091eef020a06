// Points of lights as surfaces see them: the one text of how the sun, lamps and panels are sampled.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "form_factor.h"
#include "light_law.h"
#include "net_points.h"
#include "ray_types.h"
#include "rays.h"

namespace sailenv {

constexpr float OVER_PI = 0.318309886f;

static inline float dot(const float* a, const float* b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// A point of a light, seen from another: not unit length but for directional lights.
struct LightSample {
    float towards[3], length, irradiance;  // on a surface that faces it
};

// Of the disc of a directional light.
static inline LightSample sample_disc(const RayLight& l, float u, float v) {
    LightSample s;
    const vec3 axis = -l.lamp.direction;
    const float radius = l.radius * std::sqrt(u), turn = 6.28318531f * v;
    around_axis(&axis.x, radius * std::cos(turn), radius * std::sin(turn), 1.0f, s.towards);
    const float scale = 1.0f / std::sqrt(dot(s.towards, s.towards));
    for (float& t : s.towards) t *= scale;
    s.length = ENDLESS;
    s.irradiance = 1.0f;
    return s;
}

// Irradiance over radiant intensity by the law of light, at a point from which a light is
// `towards`.
static inline float falloff(const RayLight& l, const float* towards) {
    const float square = lamp_square(vec3(towards[0], towards[1], towards[2]));
    return lamp_falloff(l.lamp, square, -dot(towards, &l.lamp.direction.x) / std::sqrt(square));
}

// Of an area light's rectangle.
static inline LightSample sample_rectangle(const RayLight& l, const float* p, float u, float v) {
    LightSample s;
    const float* position = &l.lamp.position.x;
    for (int k = 0; k < 3; k++) {
        s.towards[k] = position[k] + (u - 0.5f) * l.across[k] + (v - 0.5f) * l.up[k] - p[k];
    }
    const float area = std::sqrt(dot(l.across, l.across)) * std::sqrt(dot(l.up, l.up));
    s.length = 0.999f;
    s.irradiance = area * falloff(l, s.towards);
    return s;
}

// Of the ball of a point or spot light: for the edges of shadows. How much arrives is that of its
// middle.
static inline LightSample sample_ball(const RayLight& l, const float* p, float u, float v) {
    LightSample s;
    float middle[3];
    for (int k = 0; k < 3; k++) middle[k] = (&l.lamp.position.x)[k] - p[k];
    s.irradiance = falloff(l, middle);
    const float z = 1.0f - 2.0f * u, ring = std::sqrt(std::max(1.0f - z * z, 0.0f));
    const float turn = 6.28318531f * v;
    s.towards[0] = middle[0] + l.radius * ring * std::cos(turn);
    s.towards[1] = middle[1] + l.radius * ring * std::sin(turn);
    s.towards[2] = middle[2] + l.radius * z;
    s.length = 0.999f;
    return s;
}

// u, v: 0 to 1.
static inline LightSample sample_light(const RayLight& l, const float* p, float u, float v) {
    if (l.lamp.kind == LIGHT_DIRECTIONAL) return sample_disc(l, u, v);
    if (l.lamp.kind == LIGHT_AREA) return sample_rectangle(l, p, u, v);
    return sample_ball(l, p, u, v);
}

// Irradiance / pi by a sample on a surface with normal n, if nothing is in the way.
static inline float sample_power(const LightSample& s, const float* n) {
    const float cosine = dot(s.towards, n);
    if (!(cosine > 0.0f) || !(s.irradiance > 0.0f)) return 0.0f;
    return s.irradiance * cosine * OVER_PI / std::max(std::sqrt(dot(s.towards, s.towards)), 1e-12f);
}

// What the mean of samples is to be multiplied by. Samples of a rectangle tell the share that
// arrives of what the formula knows (Heitz, Hill and McGuire 2018, "Combining analytic direct
// illumination and stochastic shadows"); `unhindered` is their mean if nothing is in the way.
static inline float sample_scale(const RayLight& l, const float* p, const float* n,
                                 float unhindered) {
    if (l.lamp.kind != LIGHT_AREA) return 1.0f;
    if (!(unhindered > 0.0f)) return 0.0f;
    double corners[4][3], direction[3];
    constexpr double u[4] = {-0.5, -0.5, 0.5, 0.5}, v[4] = {-0.5, 0.5, 0.5, -0.5};
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < 4; i++) {
            corners[i][c] = (&l.lamp.position.x)[c] + u[i] * l.across[c] + v[i] * l.up[c];
        }
        direction[c] = (&l.lamp.direction.x)[c];
    }
    return form_factor(corners[0], direction, p, n) / unhindered;
}

}  // namespace sailenv
