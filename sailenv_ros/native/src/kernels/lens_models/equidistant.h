// The fisheye of Kannala and Brandt, `cv2.fisheye`: the radius is a polynomial of the angle.
// Source: J. Kannala and S. Brandt, IEEE PAMI 28(8), 2006; the coefficients are OpenCV's.
#pragma once

#include "law.h"

namespace sailenv {

struct Equidistant {
    static constexpr ModelText TEXT = {
        "equidistant", "k1 k2 k3 k4", "4", "", "central", "a radius that grows with the angle"};

    static void radius_of(const double* k, double angle, double& value, double& slope) {
        const double t = angle * angle;
        value = angle * (1.0 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3]))));
        slope = 1.0 + t * (3.0 * k[0] + t * (5.0 * k[1] + t * (7.0 * k[2] + t * 9.0 * k[3])));
    }

    static Reach reach(const double* k) {
        const double angle = first_failure(HALF_TURN, [&](double t) {
            double value, slope;
            radius_of(k, t, value, slope);
            return slope > 0.0;
        });
        return {angle, angle, angle < HALF_TURN};
    }

    static double radius(const LensLaw&) { return 0.0; }

    static bool project(const LensLaw& law, const double* point, double* place) {
        const double r = length2(point[0], point[1]);
        if (!within_limit(law, r, point[2])) return false;
        double value, slope;
        radius_of(law.k, std::atan2(r, point[2]), value, slope);
        const double scale = r > 0.0 ? value / r : 0.0;
        place[0] = scale * point[0];
        place[1] = scale * point[1];
        return true;
    }

    static bool unproject(const LensLaw& law, const double* place, double* ray) {
        const double r = length2(place[0], place[1]);
        double angle = 0.0;
        const auto law_of = [&](double t, double& value, double& slope) {
            radius_of(law.k, t, value, slope);
        };
        if (!increasing_root(r, law.limit, law_of, angle)) return false;
        const double scale = r > 0.0 ? std::sin(angle) / r : 0.0;
        ray[0] = scale * place[0];
        ray[1] = scale * place[1];
        ray[2] = std::cos(angle);
        return true;
    }
};

}  // namespace sailenv
