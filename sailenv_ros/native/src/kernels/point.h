// Points in double precision.
#pragma once

#include <cstdint>

namespace sailenv {

struct Point {
    double x[3];
};

inline double dot(const Point& a, const Point& b) {
    return (a.x[0] * b.x[0] + a.x[1] * b.x[1]) + a.x[2] * b.x[2];
}

inline Point minus(const Point& a, const Point& b) {
    return {{a.x[0] - b.x[0], a.x[1] - b.x[1], a.x[2] - b.x[2]}};
}

inline Point vertex_at(const float* vertices, uint32_t number) {
    const float* v = vertices + 3 * static_cast<int64_t>(number);
    return {{v[0], v[1], v[2]}};
}

}  // namespace sailenv
