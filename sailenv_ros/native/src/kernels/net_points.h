// Points of the unit square and of the sphere that rays are cast by; see bake/sampling.py.
#pragma once

#include <cmath>

namespace sailenv {

constexpr float LIFT_M = 1e-3f;  // rays begin this far off the surface
constexpr double PI = 3.14159265358979323846;

// One point of a net of cells x cells points, moved within its own cell.
static inline void shifted_point(const float* point, const float* shift, double cells, double* u,
                                 double* v) {
    *u = point[0] * cells;
    *v = point[1] * cells;
    const double left = std::floor(*u), low = std::floor(*v);
    *u = *u - left + shift[0];
    *v = *v - low + shift[1];
    *u = (left + *u - std::floor(*u)) / cells;
    *v = (low + *v - std::floor(*v)) / cells;
}

// A direction that is given about z, about a unit axis instead (Duff et al. 2017).
static inline void around_axis(const float* axis, double x, double y, double z, double* d) {
    const double ax = axis[0], ay = axis[1], az = axis[2];
    const double sign = az >= 0.0 ? 1.0 : -1.0;
    const double a = -1.0 / (sign + az);
    const double b = static_cast<double>(axis[0] * axis[1]) * a;
    d[0] = x * (1.0 + sign * ax * ax * a) + y * b + z * ax;
    d[1] = x * sign * b + y * (sign + ay * ay * a) + z * ay;
    d[2] = -x * sign * ax - y * ay + z * az;
}

}  // namespace sailenv
