// What arrives from rectangles if nothing is in the way.
#pragma once

#include <algorithm>
#include <cmath>

namespace sailenv {

// Irradiance / pi at a point from a rectangle of radiance 1, 0 to 1: Lambert's formula for polygons
// (1760) of the part above the point's horizon. corners: (4, 3), one after another; direction: in
// which it shines; n: the point's normal.
static inline float form_factor(const double* corners, const double* direction, const float* p,
                                const float* n) {
    double towards[4][3], heights[4], before = 0.0;
    for (int i = 0; i < 4; i++) {
        heights[i] = 0.0;
        for (int c = 0; c < 3; c++) {
            towards[i][c] = corners[3 * i + c] - p[c];
            heights[i] += towards[i][c] * n[c];
        }
    }
    for (int c = 0; c < 3; c++) before -= towards[0][c] * direction[c];
    if (!(before > 0.0)) return 0.0f;
    double above[8][3];  // a corner, or what the horizon cuts off it, for each corner and each side
    int size = 0;
    for (int i = 0; i < 4; i++) {
        const int j = (i + 1) % 4;
        if (heights[i] >= 0.0) std::copy_n(towards[i], 3, above[size++]);
        if ((heights[i] >= 0.0) != (heights[j] >= 0.0)) {
            const double share = heights[i] / (heights[i] - heights[j]);
            for (int c = 0; c < 3; c++) {
                above[size][c] = towards[i][c] + share * (towards[j][c] - towards[i][c]);
            }
            size++;
        }
    }
    double total = 0.0;
    for (int i = 0; i < size; i++) {
        const double *a = above[i], *b = above[(i + 1) % size];
        const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2],
                     z = a[0] * b[1] - a[1] * b[0];
        const double sine = std::sqrt(x * x + y * y + z * z);
        if (!(sine > 0.0)) continue;
        const double angle = std::atan2(sine, a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
        total += angle * (x * n[0] + y * n[1] + z * n[2]) / sine;
    }
    constexpr double turn = 6.28318530717958647692;
    return static_cast<float>(std::min(std::fabs(total) / turn, 1.0));
}

}  // namespace sailenv
