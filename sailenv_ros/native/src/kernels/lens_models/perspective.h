// What models share that distort the plane of a pin-hole camera.
#pragma once

#include "brown.h"

namespace sailenv {

// `LensLaw::radius` is the undistorted radius at the limit.
template <bool RATIONAL>
struct Perspective {
    static constexpr double MOST_ANGLE = 89.5 * HALF_TURN / 180.0,
                            MOST_VERTICAL = 85.0 * HALF_TURN / 180.0;

    static Reach reach(const double* k) {
        const double most = std::tan(MOST_ANGLE), radius = unfolded_radius(k, most);
        if (!(radius < most)) return {MOST_ANGLE, MOST_VERTICAL, false};
        const double angle = std::atan(radius);
        return {angle, std::fmin(angle, MOST_VERTICAL), true};
    }

    static double radius(const LensLaw& law) { return std::tan(std::fmin(law.limit, MOST_ANGLE)); }

    static bool project(const LensLaw& law, const double* point, double* place) {
        // Without branches, so that loops over points become vectors.
        const double z = point[2], x = point[0] / z, y = point[1] / z;
        const BrownLaw<RATIONAL> at(law.k, x, y);
        place[0] = at.x;
        place[1] = at.y;
        return (z > 0.0) & (x * x + y * y <= law.radius * law.radius);
    }

    static bool unproject(const LensLaw& law, const double* place, double* ray) {
        double at[2];
        if (!undistort(law.k, law.radius, place, at)) return false;
        const double scale = 1.0 / std::sqrt(at[0] * at[0] + at[1] * at[1] + 1.0);
        ray[0] = scale * at[0];
        ray[1] = scale * at[1];
        ray[2] = scale;
        return true;
    }
};

}  // namespace sailenv
