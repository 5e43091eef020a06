// Points of the unit square and of the sphere that rays are cast by; see bake/sampling.py.
#pragma once

#include <algorithm>
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
template <class Real>
static inline void around_axis(const float* axis, Real x, Real y, Real z, Real* d) {
    const Real ax = axis[0], ay = axis[1], az = axis[2];
    const Real sign = az >= 0 ? Real(1) : Real(-1);
    const Real a = Real(-1) / (sign + az);
    const Real b = static_cast<Real>(axis[0] * axis[1]) * a;
    d[0] = x * (Real(1) + sign * ax * ax * a) + y * b + z * ax;
    d[1] = x * sign * b + y * (sign + ay * ay * a) + z * ay;
    d[2] = -x * sign * ax - y * ay + z * az;
}

// The direction about a unit axis, with the density of the cosine over pi, that a point of the unit
// square stands for.
template <class Real>
static inline void cosine_direction(const float* axis, Real u, Real v, Real* d) {
    const Real radius = std::sqrt(u), turn = Real(2.0 * PI) * v;
    around_axis(axis, radius * std::cos(turn), radius * std::sin(turn),
                std::sqrt(std::max(Real(1) - u, Real(0))), d);
}

}  // namespace sailenv
