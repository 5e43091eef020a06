// Cones of directions to balls around small things that shine; see light/bake/emitters.py.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "net_points.h"
#include "ray_types.h"

namespace sailenv {

// Nearer to the middle of an emitter, in radii, it has no cone.
constexpr double NEAREST_RADII = 1.02;

// Cosine of the angle from a cone's axis to its side, by the squares of an emitter's radius and
// distance.
static inline double cone_edge(float r2, float d2) {
    return std::sqrt(1.0 - static_cast<double>(r2 / d2));
}

// The cone of directions from a point to an emitter.
struct EmitterCone {
    float axis[3];
    double edge;  // see cone_edge

    // False where the point is too near.
    bool about(const float* ball, const float* p) {
        for (int c = 0; c < 3; c++) axis[c] = ball[c] - p[c];
        const float d2 = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
        const float r2 = ball[3] * ball[3];
        if (!(d2 > NEAREST_RADII * NEAREST_RADII * r2)) return false;
        const float far = std::sqrt(d2);
        for (float& c : axis) c /= far;
        edge = cone_edge(r2, d2);
        return true;
    }

    // The direction, spread evenly over the cone, that a point of the unit square stands for.
    void direction(double u, double v, double* d) const {
        const double up = 1.0 - u * (1.0 - edge);
        const double out = std::sqrt(std::max(1.0 - up * up, 0.0)), turn = 2.0 * PI * v;
        around_axis(axis, out * std::cos(turn), out * std::sin(turn), up, d);
    }
};

// The density, over solid angle, of directions into the cones of all emitters.
static inline double cone_density(const Emitters& emitters, const float* p, const float* d) {
    double density = 0.0;
    for (int64_t e = 0; e < emitters.count; e++) {
        const float* ball = emitters.balls + 4 * e;
        const float x = ball[0] - p[0], y = ball[1] - p[1], z = ball[2] - p[2];
        const float d2 = x * x + y * y + z * z, r2 = ball[3] * ball[3];
        if (d2 <= NEAREST_RADII * NEAREST_RADII * r2) continue;
        const float ahead = d[0] * x + d[1] * y + d[2] * z;
        if (ahead > 0.0f && ahead * ahead >= d2 - r2) {
            density += 1.0 / (2.0 * PI * (1.0 - cone_edge(r2, d2)));
        }
    }
    return density;
}

// How much a ray counts, of `others` with the density `own` and `shots` into the cone of each
// emitter: the balance heuristic (Veach and Guibas 1995).
static inline double balanced(double own, int64_t others, int64_t shots, double density) {
    return own / (static_cast<double>(others) * own + static_cast<double>(shots) * density);
}

}  // namespace sailenv
