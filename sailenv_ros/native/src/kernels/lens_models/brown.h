// OpenCV's distortion of the plane: radial, tangential and thin prism; shared by several models.
// Source: OpenCV, module calib3d, "Camera Calibration and 3D Reconstruction".
#pragma once

#include "law.h"

namespace sailenv {

// Coefficients k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 at a place, with all derivatives; the first five
// alone where `RATIONAL` is false.
template <bool RATIONAL>
struct BrownLaw {
    double factor, change;  // the radial factor, and its derivative by r²
    double x, y;            // the distorted place
    double xx, xy, yx, yy;  // its derivatives: xy is that of x by y
    bool positive;          // the radial factor has passed neither 0 nor a pole

    BrownLaw(const double* k, double a, double b) {
        const double r2 = a * a + b * b;
        const double above = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
        const double d_above = k[0] + r2 * (2.0 * k[1] + r2 * 3.0 * k[4]);
        const double p1 = k[2], p2 = k[3];
        double s_x = 0.0, s_y = 0.0, ds_x = 0.0, ds_y = 0.0;
        if (RATIONAL) {
            const double below = 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
            const double d_below = k[5] + r2 * (2.0 * k[6] + r2 * 3.0 * k[7]);
            factor = above / below;
            change = (d_above - factor * d_below) / below;
            positive = above > 0.0 && below > 0.0;
            s_x = r2 * (k[8] + r2 * k[9]);
            s_y = r2 * (k[10] + r2 * k[11]);
            ds_x = k[8] + 2.0 * r2 * k[9];
            ds_y = k[10] + 2.0 * r2 * k[11];
        } else {
            factor = above;
            change = d_above;
            positive = above > 0.0;
        }
        x = a * factor + 2.0 * p1 * a * b + p2 * (r2 + 2.0 * a * a) + s_x;
        y = b * factor + p1 * (r2 + 2.0 * b * b) + 2.0 * p2 * a * b + s_y;
        const double mixed = 2.0 * a * b * change + 2.0 * p1 * a + 2.0 * p2 * b;
        xx = factor + 2.0 * a * a * change + 2.0 * p1 * b + 6.0 * p2 * a + 2.0 * a * ds_x;
        xy = mixed + 2.0 * b * ds_x;
        yx = mixed + 2.0 * a * ds_y;
        yy = factor + 2.0 * b * b * change + 6.0 * p1 * b + 2.0 * p2 * a + 2.0 * b * ds_y;
    }

    double determinant() const { return xx * yy - xy * yx; }
    bool unfolded() const { return positive && determinant() > 0.0 && xx + yy > 0.0; }
};
using Brown = BrownLaw<true>;

inline bool is_radial(const double* k) {
    return k[2] == 0.0 && k[3] == 0.0 && k[8] == 0.0 && k[9] == 0.0 && k[10] == 0.0 && k[11] == 0.0;
}

// The radius up to which no direction folds, at most `most`. It is exact where the law is radial;
// otherwise the least of many directions.
inline double unfolded_radius(const double* k, double most) {
    const int directions = is_radial(k) ? 1 : 72;
    double angle = std::atan(most);
    for (int turn = 0; turn < directions; turn++) {
        const double c = std::cos(2.0 * HALF_TURN * turn / directions);
        const double s = std::sin(2.0 * HALF_TURN * turn / directions);
        angle = first_failure(angle, [&](double t) {
            const double r = std::tan(t);
            return Brown(k, r * c, r * s).unfolded();
        });
    }
    return angle < std::atan(most) ? std::tan(angle) : most;
}

// The place that is distorted to `place`, within a radius up to which nothing folds.
inline bool undistort(const double* k, double most, const double* place, double* found) {
    const double goal = length2(place[0], place[1]);
    double r = 0.0;
    const auto radial = [&](double t, double& value, double& slope) {
        const double r2 = t * t;
        const double above = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
        const double below = 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
        const double factor = above / below;
        const double change = (k[0] + r2 * (2.0 * k[1] + r2 * 3.0 * k[4]) -
                               factor * (k[5] + r2 * (2.0 * k[6] + r2 * 3.0 * k[7]))) /
                              below;
        value = t * factor;
        slope = factor + 2.0 * r2 * change;
    };
    const bool all = is_radial(k);
    // Where more follows, a guess.
    const bool reached = increasing_root(goal, most, radial, r, all ? 0.0 : 1e-3);
    if (!reached) {
        // The rest of the law may still bring the place within.
        if (all || !(goal < 1e150)) return false;
        r = most;
    }
    const double scale = goal > 0.0 ? r / goal : 0.0;
    double x = scale * place[0], y = scale * place[1];
    if (!all) {
        bool solved = false;
        for (int step = 0; step < 50 && !solved; step++) {
            const Brown at(k, x, y);
            const double right = place[0] - at.x, down = place[1] - at.y;
            const double d = at.determinant();
            const double dx = (at.yy * right - at.xy * down) / d;
            const double dy = (at.xx * down - at.yx * right) / d;
            x += dx;
            y += dy;
            solved = length2(dx, dy) <= LAST_STEP * (1.0 + length2(x, y));
            const double length = length2(x, y);
            if (length > most && !solved) {
                x *= most / length;
                y *= most / length;
            }
        }
        const Brown at(k, x, y);
        const double error = length2(at.x - place[0], at.y - place[1]);
        if (!(error <= 1e-13 * (1.0 + goal)) || !(length2(x, y) <= most) || !at.unfolded()) {
            return false;
        }
    }
    found[0] = x;
    found[1] = y;
    return true;
}

}  // namespace sailenv
