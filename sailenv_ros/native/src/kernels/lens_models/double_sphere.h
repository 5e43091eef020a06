// Two unit spheres, one behind the other, and a pin-hole camera.
// Source: V. Usenko, N. Demmel and D. Cremers, "The Double Sphere Camera Model", 3DV 2018.
#pragma once

#include "law.h"

namespace sailenv {

struct DoubleSphere {
    static constexpr ModelText TEXT = {"double_sphere",
                                       "xi alpha",
                                       "2",
                                       "",
                                       "central",
                                       "xi above -1 and at most 1, alpha from 0 to 1"};

    static Reach reach(const double* k) {
        const double xi = k[0], alpha = k[1];
        if (!(xi > -1.0 && xi <= 1.0 && alpha >= 0.0 && alpha <= 1.0)) return {0.0, 0.0, false};
        const double w1 = alpha > 0.5 ? (1.0 - alpha) / alpha : alpha / (1.0 - alpha);
        // The angle from the second centre at which the place is infinite, or two rays meet; then
        // that from the first one. The paper's w2 is only near it where xi is not 0.
        const double second = std::acos(-std::fmin(w1, 1.0));
        const double angle = (1.0 - 1e-6) * (second + std::asin(xi * std::sin(second)));
        return {angle, angle, false};
    }

    static double radius(const LensLaw&) { return 0.0; }

    static bool project(const LensLaw& law, const double* point, double* place) {
        const double xi = law.k[0], alpha = law.k[1];
        const double r2 = point[0] * point[0] + point[1] * point[1];
        if (!within_limit(law, std::sqrt(r2), point[2])) return false;
        const double ahead = xi * std::sqrt(r2 + point[2] * point[2]) + point[2];
        const double below = alpha * std::sqrt(r2 + ahead * ahead) + (1.0 - alpha) * ahead;
        if (!(below > 0.0)) return false;
        place[0] = point[0] / below;
        place[1] = point[1] / below;
        return true;
    }

    static bool unproject(const LensLaw& law, const double* place, double* ray) {
        const double xi = law.k[0], alpha = law.k[1];
        const double r2 = place[0] * place[0] + place[1] * place[1];
        const double inside = 1.0 - (2.0 * alpha - 1.0) * r2;
        if (!(inside >= 0.0)) return false;
        const double z = (1.0 - alpha * alpha * r2) / (alpha * std::sqrt(inside) + 1.0 - alpha);
        const double under = z * z + (1.0 - xi * xi) * r2;
        if (!(under >= 0.0)) return false;
        const double scale = (z * xi + std::sqrt(under)) / (z * z + r2);
        ray[0] = scale * place[0];
        ray[1] = scale * place[1];
        ray[2] = scale * z - xi;
        return within_limit(law, length2(ray[0], ray[1]), ray[2]);
    }
};

}  // namespace sailenv
