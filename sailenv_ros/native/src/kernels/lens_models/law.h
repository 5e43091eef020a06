// The law of a lens: from points of the optical frame to places in the normalised plane, and back.
//
// Place (x, y) is pixel (fx x + cx, fy y + cy). A model is a header beside this one: a structure
//
//     TEXT                              its names, see ModelText
//     reach(k)                          how far the law goes with coefficients k, see Reach
//     radius(law)                       what the other two want to know of the limit, made once
//     project(law, point, place)        false where the lens does not see the point
//     unproject(law, place, ray)        unit vector; false where no ray leads to the place
//
// and its name in table.h. Everything else, in C++ and Python, takes it from there. Nothing is
// clamped: what lies beyond the limit has no place, and what no ray leads to has no ray.
#pragma once

#include <cmath>
#include <cstdint>

namespace sailenv {

constexpr int64_t MOST_COEFFICIENTS = 12;
constexpr double HALF_TURN = 3.14159265358979323846;  // [rad]

// Words with spaces between. `counts` are the accepted numbers of coefficients; those left out are
// 0. `odd` change their signs where left and right are exchanged. `rays` is "central" where all
// rays meet in one point, and "parallel" where all have one direction.
struct ModelText {
    const char *name, *coefficients, *counts, *odd, *rays, *accepted;
};

constexpr bool has_parallel_rays(const ModelText& text) { return text.rays[0] == 'p'; }

// How far a law goes from the axis [rad]: at all, and straight up and down. It folds where it would
// go on if the distance in the plane did not shrink again.
struct Reach {
    double angle, vertical;
    bool folds;
};

// A step of Newton's after which the next one would be below the rounding: its error is about the
// square of the step.
constexpr double LAST_STEP = 1e-10;

struct LensLaw {
    int64_t model;
    double limit;   // largest angle from the axis [rad], at most Reach::angle
    double radius;  // see the models
    double k[MOST_COEFFICIENTS];
};

inline double length2(double x, double y) { return std::sqrt(x * x + y * y); }

// Whether the law's limit lets a point be seen; false for the centre and for no numbers.
inline bool within_limit(const LensLaw& law, double r, double z) {
    return (r > 0.0 || z > 0.0) && std::atan2(r, z) <= law.limit;
}

// The argument from 0 to `most` where an increasing function reaches `goal`: Newton's steps, and
// halves where they leave the interval or, beside a pole, go nowhere. `function(t, value, slope)`;
// false beyond `most`. `enough` is an error of the value, as a share of 1 + goal, that ends it.
template <class Function>
inline bool increasing_root(double goal, double most, const Function& function, double& t,
                            double enough = 0.0) {
    double low = 0.0, high = most, value, slope;
    function(most, value, slope);
    if (!(goal <= value)) return false;
    t = goal < most ? goal : 0.5 * most;
    for (int step = 0; step < 200; step++) {
        function(t, value, slope);
        const double error = value - goal;
        if (std::fabs(error) < enough * (1.0 + goal)) return true;
        (error > 0.0 ? high : low) = t;
        double next = t - error / slope;
        const bool is_near = std::fabs(error) <= 1e-6 * (1.0 + goal);
        const bool is_newton =
            next >= low && next <= high && (is_near || std::fabs(next - t) > 1e-3 * (high - low));
        if (!is_newton) next = 0.5 * (low + high);
        const double moved = std::fabs(next - t);
        t = next;
        if (is_near && moved <= (is_newton ? LAST_STEP : 1e-16) * (1.0 + t)) return true;
        if (!(high > low)) break;
    }
    function(t, value, slope);
    return std::fabs(value - goal) <= 1e-6 * (1.0 + goal);
}

// The first argument of (0, most] for which a condition does not hold; `most` where there is none.
template <class Condition>
inline double first_failure(double most, const Condition& holds) {
    constexpr int STEPS = 2048;
    for (int step = 1; step <= STEPS; step++) {
        double low = most * (step - 1) / STEPS, high = most * step / STEPS;
        if (holds(high)) continue;
        for (int half = 0; half < 60; half++) {
            const double middle = 0.5 * (low + high);
            (holds(middle) ? low : high) = middle;
        }
        return low;
    }
    return most;
}

}  // namespace sailenv
