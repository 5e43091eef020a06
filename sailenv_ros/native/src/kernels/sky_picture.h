// The sky's radiance by direction, from a picture of all directions.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace sailenv {

// The radiance from a unit direction, between the nearest four texels of an equirectangular map,
// (rows, columns, 3).
static inline void picture_radiance(const float* picture, int64_t rows, int64_t columns,
                                    const float* d, double* radiance) {
    constexpr double pi = 3.14159265358979323846;
    const double height = static_cast<double>(rows), width = static_cast<double>(columns);
    const double polar = std::acos(std::min(std::max(static_cast<double>(d[2]), -1.0), 1.0));
    const double row = polar / pi * height - 0.5;
    const double column = (0.5 - std::atan2(d[1], d[0]) / (2.0 * pi)) * width - 0.5;
    // Both also where the direction is none.
    const double r = std::max(-1.0, std::min(std::floor(row), height - 1.0));
    const double c = std::max(-1.0, std::min(std::floor(column), width - 1.0));
    const double down = row - r, right = column - c;
    const int64_t y = static_cast<int64_t>(r), x = static_cast<int64_t>(c);
    const int64_t top = std::max<int64_t>(y, 0), bottom = std::min(y + 1, rows - 1);
    const int64_t left = (x + columns) % columns, next = (x + 1) % columns;
    const float *upper = picture + 3 * top * columns, *lower = picture + 3 * bottom * columns;
    for (int k = 0; k < 3; k++) {
        const double above = upper[3 * left + k] * (1.0 - right) + upper[3 * next + k] * right;
        const double below = lower[3 * left + k] * (1.0 - right) + lower[3 * next + k] * right;
        radiance[k] = above * (1.0 - down) + below * down;
    }
}

}  // namespace sailenv
