// What arrives from rectangles if nothing is in the way.
#include <algorithm>
#include <cmath>

#include "../abi.h"

// Irradiance / pi at points from a rectangle of radiance 1: Lambert's formula for polygons (1760)
// of the part above each point's horizon. corners: (4, 3), one after another; direction: (3,), in
// which it shines; positions, normals: (count, 3). Result: found: (count,), 0 to 1.
SAILENV_KERNEL(form_factors)
(const double* corners, const double* direction, int64_t count, const float* positions,
 const float* normals, float* found) {
    using namespace sailenv;
    if (count < 0) return STATUS_INVALID_ARGUMENT;
    constexpr double pi = 3.14159265358979323846;
    for (int64_t k = 0; k < count; k++) {
        found[k] = 0.0f;
        const float *p = positions + 3 * k, *n = normals + 3 * k;
        double towards[4][3], heights[4], before = 0.0;
        for (int i = 0; i < 4; i++) {
            heights[i] = 0.0;
            for (int c = 0; c < 3; c++) {
                towards[i][c] = corners[3 * i + c] - p[c];
                heights[i] += towards[i][c] * n[c];
            }
        }
        for (int c = 0; c < 3; c++) before -= towards[0][c] * direction[c];
        if (!(before > 0.0)) continue;
        // Clipped at the horizon, a rectangle has at most six corners even where roundings err.
        double above[8][3];
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
        found[k] = static_cast<float>(std::min(std::fabs(total) / (2.0 * pi), 1.0));
    }
    return STATUS_OK;
}
