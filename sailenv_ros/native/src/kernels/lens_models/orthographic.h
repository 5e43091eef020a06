// Parallel rays: the plane is in metres, fx and fy in pixels a metre. The ray of a place (x, y)
// begins at (x, y, 0); all have the direction of the axis.
#pragma once

#include "law.h"

namespace sailenv {

struct Orthographic {
    static constexpr ModelText TEXT = {"orthographic", "", "0", "", "parallel", ""};

    static Reach reach(const double*) { return {0.5 * HALF_TURN, 0.0, false}; }

    static double radius(const LensLaw&) { return 0.0; }

    static bool project(const LensLaw&, const double* point, double* place) {
        if (!(point[2] > 0.0)) return false;
        place[0] = point[0];
        place[1] = point[1];
        return true;
    }

    static bool unproject(const LensLaw&, const double* place, double* ray) {
        if (!std::isfinite(place[0]) || !std::isfinite(place[1])) return false;
        ray[0] = ray[1] = 0.0;
        ray[2] = 1.0;
        return true;
    }
};

}  // namespace sailenv
