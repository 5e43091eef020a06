// Which triangles the texels of a light map stand for; see bake/texels.py and bake/sun_edges.py.
#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <vector>

#include "../abi.h"
#include "../threads.h"
#include "bake_types.h"

namespace sailenv {
namespace {

constexpr int64_t SIDE = 4, BORDERED = SIDE + 2;  // of a block of points; EDGE_POINTS
constexpr int64_t POINTS = SIDE * SIDE;

// Whether a triangle has a point, whose weights are in `share` then.
bool contains(const float* corners, double x, double y, float* share) {
    const float ax = corners[0], ay = corners[1], bx = corners[2], by = corners[3], cx = corners[4],
                cy = corners[5];
    const float area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if (!(static_cast<double>(std::fabs(area)) > 1e-9)) return false;
    const double wb = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area;
    const double wc = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area;
    if (!(wb >= 0.0 && wc >= 0.0 && wb + wc <= 1.0)) return false;
    share[0] = static_cast<float>(1.0 - wb - wc);
    share[1] = static_cast<float>(wb);
    share[2] = static_cast<float>(wc);
    return true;
}

// The squared distance of a point from a triangle, and in `share` the nearest point's weights.
double closest_point(const float* corners, double x, double y, float* share) {
    if (contains(corners, x, y, share)) return 0.0;
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; k++) {
        const int next = (k + 1) % 3;
        const float px = corners[2 * k], py = corners[2 * k + 1];
        const float dx = corners[2 * next] - px, dy = corners[2 * next + 1] - py;
        double along = ((x - px) * dx + (y - py) * dy) /
                       std::max(static_cast<double>(dx * dx + dy * dy), 1e-12);
        along = std::min(std::max(along, 0.0), 1.0);
        const double ox = x - px - along * dx, oy = y - py - along * dy;
        const double far = ox * ox + oy * oy;
        if (far < best) {
            best = far;
            share[k] = static_cast<float>(1.0 - along);
            share[next] = static_cast<float>(along);
            share[(k + 2) % 3] = 0.0f;
        }
    }
    return best;
}

// Calls `visit` with the number and the centre of each texel that may lie within reach.
template <typename Visit>
void for_texels(const float* corners, double reach, int64_t side, Visit visit) {
    const float* c = corners;
    const double last = static_cast<double>(side);
    const double left = std::min(std::min(c[0], c[2]), c[4]) - reach;
    const double right = std::max(std::max(c[0], c[2]), c[4]) + reach;
    const double top = std::min(std::min(c[1], c[3]), c[5]) - reach;
    const double bottom = std::max(std::max(c[1], c[3]), c[5]) + reach;
    if (!(right > 0.0 && bottom > 0.0 && left < last && top < last)) return;
    const int64_t x0 = static_cast<int64_t>(std::max(left, 0.0));
    const int64_t x1 = static_cast<int64_t>(std::min(std::ceil(right), last));
    const int64_t y0 = static_cast<int64_t>(std::max(top, 0.0));
    const int64_t y1 = static_cast<int64_t>(std::min(std::ceil(bottom), last));
    for (int64_t y = y0; y < y1; y++) {
        for (int64_t x = x0; x < x1; x++) {
            visit(y * side + x, static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
        }
    }
}

constexpr int SAMPLES = 8;       // along a side of the square in which look-ups meet a texel
constexpr double SLIVER = 0.25;  // of what the widest triangle of a texel has

// How much of a triangle looks a texel up: the bilinear weights of the points that it has.
double looked_up(const float* corners, double x, double y) {
    double sum = 0.0;
    float share[3];
    for (int i = 0; i < SAMPLES; i++) {
        const double dy = (static_cast<double>(i) + 0.5) * 2.0 / SAMPLES - 1.0;
        for (int j = 0; j < SAMPLES; j++) {
            const double dx = (static_cast<double>(j) + 0.5) * 2.0 / SAMPLES - 1.0;
            if (!contains(corners, x + dx, y + dy, share)) continue;
            sum += (1.0 - std::fabs(dx)) * (1.0 - std::fabs(dy));
        }
    }
    return sum;
}

}  // namespace
}  // namespace sailenv

// Gives each texel the triangle that is nearest to its centre, not farther than `reach`; of equally
// near ones the first. Where that one is a sliver beside a wide one, as a bevel is, the wide one:
// its light would be seen along the edge of that. places: (count, 3, 2) [texels]; owner: (side,
// side), -1 at first; weights: (side, side, 3), of the corners; nearest: (side, side), the square
// of the reach at first.
SAILENV_KERNEL(cover_texels)
(int64_t count, int64_t side, double reach, const float* places, int32_t* owner, float* weights,
 float* nearest) {
    using namespace sailenv;
    if (count < 0 || side < 1 || side > 65536 || !(reach >= 0.0 && reach < 16.0)) {
        return STATUS_INVALID_ARGUMENT;
    }
    for (int64_t t = 0; t < count; t++) {
        const float* corners = places + 6 * t;
        for_texels(corners, reach, side, [&](int64_t at, double x, double y) {
            if (nearest[at] == 0.0f) return;
            float share[3] = {0.0f, 0.0f, 0.0f};
            const double far = closest_point(corners, x, y, share);
            if (!(far < nearest[at])) return;
            nearest[at] = static_cast<float>(far);
            owner[at] = static_cast<int32_t>(t);
            for (int k = 0; k < 3; k++) weights[3 * at + k] = share[k];
        });
    }
    try {
        const size_t texels = static_cast<size_t>(side * side);
        std::vector<float> most(texels, 0.0f), own(texels, 0.0f);
        std::vector<int32_t> widest(texels, -1);
        for (int64_t t = 0; t < count; t++) {
            const float* corners = places + 6 * t;
            for_texels(corners, 1.0, side, [&](int64_t at, double x, double y) {
                const float seen = static_cast<float>(looked_up(corners, x, y));
                if (owner[at] == static_cast<int32_t>(t)) own[static_cast<size_t>(at)] = seen;
                if (!(seen > most[static_cast<size_t>(at)])) return;
                most[static_cast<size_t>(at)] = seen;
                widest[static_cast<size_t>(at)] = static_cast<int32_t>(t);
            });
        }
        for (int64_t at = 0; at < side * side; at++) {
            const size_t k = static_cast<size_t>(at);
            if (!(own[k] < static_cast<float>(SLIVER) * most[k])) continue;
            owner[at] = widest[k];
            closest_point(places + 6 * static_cast<int64_t>(widest[k]),
                          static_cast<double>(at % side) + 0.5,
                          static_cast<double>(at / side) + 0.5, weights + 3 * at);
        }
    } catch (const std::bad_alloc&) {
        return STATUS_OUT_OF_MEMORY;
    }
    return STATUS_OK;
}

// What each of 4 by 4 points of some texels stands for, among the triangles of neighbours.
// triangles: (texels,), those of the map's texels; places: (triangles, 3, 2); chosen: (count,),
// numbers of texels. Result: triangle: (count, 16), weights: (count, 16, 3).
SAILENV_KERNEL(nearest_triangles)
(const sailenv::TexelMap* texels, const int32_t* triangles, int64_t triangle_count,
 const float* places, int64_t count, const int64_t* chosen, int32_t* triangle, float* weights) {
    using namespace sailenv;
    const TexelMap& map = *texels;
    for (int64_t k = 0; k < count; k++) {
        if (chosen[k] < 0 || chosen[k] >= map.count) return STATUS_INVALID_ARGUMENT;
        const int64_t row0 = map.rows[chosen[k]], column0 = map.columns[chosen[k]];
        for (int64_t point = 0; point < POINTS; point++) {
            const double side = static_cast<double>(SIDE);
            const double x =
                static_cast<double>(column0) + (static_cast<double>(point % SIDE) + 0.5) / side;
            const double y =
                static_cast<double>(row0) + (static_cast<double>(point / SIDE) + 0.5) / side;
            const int64_t at = k * POINTS + point;
            double best = std::numeric_limits<double>::infinity();
            // Its own first, so that others must be nearer.
            for (int number = 0; number < 10 && best != 0.0; number++) {
                const int64_t row = row0 + (number > 0 ? (number - 1) / 3 - 1 : 0);
                const int64_t column = column0 + (number > 0 ? (number - 1) % 3 - 1 : 0);
                if (row < 0 || row >= map.height || column < 0 || column >= map.width) continue;
                const int32_t texel = map.index[row * map.width + column];
                if (texel < 0 || texel >= map.count) continue;
                const int32_t t = triangles[texel];
                if (t < 0 || t >= triangle_count) return STATUS_INVALID_ARGUMENT;
                float share[3] = {0.0f, 0.0f, 0.0f};
                const double far = closest_point(places + 6 * static_cast<int64_t>(t), x, y, share);
                if (!(far < best)) continue;
                best = far;
                triangle[at] = t;
                for (int c = 0; c < 3; c++) weights[3 * at + c] = share[c];
            }
        }
    }
    return STATUS_OK;
}

// Puts a border around the block of each texel, from its neighbour's block where the surface goes
// on. shares: (count, 4, 4). Result: blocks: (count, 6, 6).
SAILENV_KERNEL(bordered_blocks)
(const sailenv::TexelMap* texels, const float* shares, float* blocks) {
    using namespace sailenv;
    const TexelMap& map = *texels;
    for (int64_t k = 0; k < map.count; k++) {
        for (int64_t i = 0; i < BORDERED; i++) {
            for (int64_t j = 0; j < BORDERED; j++) {
                const int64_t row = map.rows[k] + (i == 0 ? -1 : i == SIDE + 1 ? 1 : 0);
                const int64_t column = map.columns[k] + (j == 0 ? -1 : j == SIDE + 1 ? 1 : 0);
                int64_t other = -1;
                if (row >= 0 && row < map.height && column >= 0 && column < map.width) {
                    other = map.index[row * map.width + column];
                }
                // Its own nearest point, unless the surface goes on there.
                const float* from = shares + k * POINTS;
                int64_t y = std::min(std::max<int64_t>(i - 1, 0), SIDE - 1);
                int64_t x = std::min(std::max<int64_t>(j - 1, 0), SIDE - 1);
                if (other >= 0 && other < map.count && map.owners[other] == map.owners[k]) {
                    double alike = 0.0;
                    for (int c = 0; c < 3; c++) {
                        alike += map.faces[3 * other + c] * map.faces[3 * k + c];
                    }
                    if (alike > 0.5) {
                        from = shares + other * POINTS;
                        y = (i + SIDE - 1) % SIDE;
                        x = (j + SIDE - 1) % SIDE;
                    }
                }
                blocks[(k * BORDERED + i) * BORDERED + j] = from[y * SIDE + x];
            }
        }
    }
    return STATUS_OK;
}
