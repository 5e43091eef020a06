// A unit sphere, a pin-hole camera xi behind its centre, and distortion of the plane:
// `cv2.omnidir`. Source: C. Mei and P. Rives, ICRA 2007.
#pragma once

#include "brown.h"

namespace sailenv {

// `LensLaw::radius` is the undistorted radius at the limit.
struct Mei {
    static constexpr ModelText TEXT = {
        "mei", "xi k1 k2 p1 p2", "5",
        "p2",  "central",        "xi of at least 0 and a radius that grows from the axis"};

    static double radius_of(double xi, double angle) {
        return std::sin(angle) / (std::cos(angle) + xi);
    }

    static Reach reach(const double* k) {
        const double xi = k[0];
        if (!(xi >= 0.0 && xi < 1e6)) return {0.0, 0.0, false};
        // Beyond this angle the camera sees the sphere from within or its far side.
        const double own = (1.0 - 1e-3) * std::acos(xi > 1.0 ? -1.0 / xi : -xi);
        const double most = radius_of(xi, own);
        const Plane plane(k);
        const double radius = unfolded_radius(plane.k, most);
        if (!(radius < most)) return {own, own, false};
        double ray[3];
        onto_sphere(xi, radius, 0.0, ray);
        const double angle = std::atan2(ray[0], ray[2]);
        return {angle, angle, true};
    }

    static double radius(const LensLaw& law) { return radius_of(law.k[0], law.limit); }

    static bool project(const LensLaw& law, const double* point, double* place) {
        const double r2 = point[0] * point[0] + point[1] * point[1];
        if (!within_limit(law, std::sqrt(r2), point[2])) return false;
        const double below = point[2] + law.k[0] * std::sqrt(r2 + point[2] * point[2]);
        const Brown at(Plane(law.k).k, point[0] / below, point[1] / below);
        place[0] = at.x;
        place[1] = at.y;
        return true;
    }

    static bool unproject(const LensLaw& law, const double* place, double* ray) {
        double at[2];
        if (!undistort(Plane(law.k).k, law.radius, place, at)) return false;
        onto_sphere(law.k[0], at[0], at[1], ray);
        return true;
    }

private:
    // The coefficients in the order of `Brown`.
    struct Plane {
        double k[MOST_COEFFICIENTS] = {};
        explicit Plane(const double* all) {
            for (int i = 0; i < 4; i++) k[i] = all[1 + i];
        }
    };

    static void onto_sphere(double xi, double x, double y, double* ray) {
        const double r2 = x * x + y * y;
        const double under = std::fmax(1.0 + r2 * (1.0 - xi * xi), 0.0);
        const double scale = (xi + std::sqrt(under)) / (1.0 + r2);
        ray[0] = scale * x;
        ray[1] = scale * y;
        ray[2] = scale - xi;
    }
};

}  // namespace sailenv
