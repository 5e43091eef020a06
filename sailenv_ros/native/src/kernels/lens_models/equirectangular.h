// The whole sphere: columns are longitudes and rows are latitudes, in radians, right and down.
#pragma once

#include "law.h"

namespace sailenv {

struct Equirectangular {
    static constexpr ModelText TEXT = {"equirectangular", "", "0", "", "central", ""};

    static Reach reach(const double*) { return {HALF_TURN, 0.5 * HALF_TURN, false}; }

    static double radius(const LensLaw&) { return 0.0; }

    static bool project(const LensLaw& law, const double* point, double* place) {
        if (!within_limit(law, length2(point[0], point[1]), point[2]) &&
            !(law.limit >= HALF_TURN && point[2] < 0.0)) {
            return false;
        }
        place[0] = std::atan2(point[0], point[2]);
        place[1] = std::atan2(point[1], length2(point[0], point[2]));
        return true;
    }

    static bool unproject(const LensLaw& law, const double* place, double* ray) {
        if (!(std::fabs(place[0]) <= HALF_TURN && std::fabs(place[1]) <= 0.5 * HALF_TURN))
            return false;
        const double across = std::cos(place[1]);
        ray[0] = across * std::sin(place[0]);
        ray[1] = std::sin(place[1]);
        ray[2] = across * std::cos(place[0]);
        return law.limit >= HALF_TURN || within_limit(law, length2(ray[0], ray[1]), ray[2]);
    }
};

}  // namespace sailenv
