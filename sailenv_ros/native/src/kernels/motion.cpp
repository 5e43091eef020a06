// Where the surface points of one picture are in another one, and points in other axes; see
// tests/support/reference_motion.py, which says what is computed. All in double precision.
#include <cmath>
#include <limits>

#include "../abi.h"
#include "../threads.h"
#include "lanes.h"
#include "scratch.h"

namespace {

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr int64_t CHUNK = 256;
constexpr int64_t TILE_ROWS = 16;
constexpr double ROUNDING_PX = 1e-3;

typedef double d8 __attribute__((vector_size(64)));
typedef int64_t l8 __attribute__((vector_size(64)));
typedef double d8_any __attribute__((vector_size(64), aligned(8), may_alias));

struct Lens {
    double focal, cx, cy, near_m, far_m;
};

struct Input {
    int64_t width;
    const float* depth;
    const uint16_t* instance;
    const uint16_t* row_of_instance;  // (65536,), 0 where there is no motion
    const double* motions;            // (R, 3, 4)
    const double* displacements;      // (R, 3, 4)
    int64_t count;
    Lens from, to;
    const double* columns;  // (width + 8,): the ray's x at depth 1
    const float* to_depth;
    const uint16_t* to_instance;
    int64_t to_height, to_width;
    double tolerance;
};

struct Output {
    float* flow;
    float* scene_flow;
    uint8_t* valid;
    uint8_t* occluded;
    uint8_t* out_of_view;
};

// What is known of a chunk's pixels; there is room for steps of eight.
struct Places {
    float z[CHUNK + 8];
    double u[CHUNK + 8], v[CHUNK + 8], z_to[CHUNK + 8];  // displacement [px], depth then
    float scene[3][CHUNK + 8];
    uint8_t known[CHUNK + 8], valid[CHUNK + 8];
};

inline d8 vector_of(const double* p) { return *reinterpret_cast<const d8_any*>(p); }
inline void put(double* p, d8 x) { *reinterpret_cast<d8_any*>(p) = x; }

// The points of neighbours in a row of the picture that move alike.
void move_run(const Input& in, const double* m, const double* s, bool has_motion, int64_t column,
              double y, int64_t first, int64_t end, Places& places) {
    const d8 zero = {}, one = zero + 1.0;
    const double m_x = m[1] * y, m_y = m[5] * y, m_z = m[9] * y;
    const double s_x = s[1] * y, s_y = s[5] * y, s_z = s[9] * y;
    const double wider = in.to.focal - in.from.focal;
    const double right = in.to.cx - in.from.cx, down = in.to.cy - in.from.cy;
    const float unknown = std::numeric_limits<float>::quiet_NaN();
    for (int64_t k = first; k < end; k += 8) {
        const d8 z = __builtin_convertvector(load(places.z + k), d8);
        const d8 x = vector_of(in.columns + column + k);
        const l8 at_infinity = z == INFINITE;
        const l8 known = has_motion ? (z == z) : l8{};
        const d8 reach = at_infinity ? one : z, shift = at_infinity ? zero : one;
        const d8 dx = reach * (m[0] * x + m_x + m[2]) + shift * m[3];
        const d8 dy = reach * (m[4] * x + m_y + m[6]) + shift * m[7];
        const d8 dz = reach * (m[8] * x + m_z + m[10]) + shift * m[11];
        const d8 z_to = reach + dz;
        const l8 valid = known & (z_to > 0.0);
        put(places.u + k, wider * x + right + in.to.focal * ((dx - x * dz) / z_to));
        put(places.v + k, wider * y + down + in.to.focal * ((dy - y * dz) / z_to));
        put(places.z_to + k, at_infinity ? zero + INFINITE : z_to);
        const i8 there = __builtin_convertvector(known & ~at_infinity, i8);
        const d8 sx = reach * (s[0] * x + s_x + s[2]) + s[3];
        const d8 sy = reach * (s[4] * x + s_y + s[6]) + s[7];
        const d8 sz = reach * (s[8] * x + s_z + s[10]) + s[11];
        store(places.scene[0] + k, there ? __builtin_convertvector(sx, f8) : splat(unknown));
        store(places.scene[1] + k, there ? __builtin_convertvector(sy, f8) : splat(unknown));
        store(places.scene[2] + k, there ? __builtin_convertvector(sz, f8) : splat(unknown));
        const i8 knows = __builtin_convertvector(known, i8);
        const i8 exists = __builtin_convertvector(valid, i8);
        for (int64_t j = 0; j < 8; j++) {
            places.known[k + j] = static_cast<uint8_t>(knows[j] & 1);
            places.valid[k + j] = static_cast<uint8_t>(exists[j] & 1);
        }
    }
}

// Tells if the other picture shows a point of an instance at (u, v), depth z.
bool is_seen(const Input& in, uint16_t id, double u, double v, double z) {
    const double least = z * (1.0 - in.tolerance);
    const double nearest = in.to.near_m * (1.0 + in.tolerance);
    const auto clamped = [](double place, int64_t size) {
        const int64_t whole = static_cast<int64_t>(place);
        return whole < 0 ? 0 : whole < size ? whole : size - 1;
    };
    const auto shows = [&](int64_t row, int64_t column) {
        const int64_t at = row * in.to_width + column;
        if (in.to_instance[at] != id) return false;
        const double seen = in.to_depth[at];
        return seen == z || seen > least || (seen != seen && z < nearest);
    };
    const int64_t left = clamped(std::floor(u + ROUNDING_PX), in.to_width);
    const int64_t upper = clamped(std::floor(v + ROUNDING_PX), in.to_height);
    if (shows(upper, left)) return true;
    const int64_t right = clamped(std::ceil(u - ROUNDING_PX), in.to_width);
    if (shows(upper, right)) return true;
    const int64_t lower = clamped(std::ceil(v - ROUNDING_PX), in.to_height);
    return shows(lower, left) || shows(lower, right);
}

void move_chunk(const Input& in, const Output& out, int64_t v, int64_t u, int64_t count) {
    const int64_t at = v * in.width + u;
    const uint16_t* ids = in.instance + at;
    Places places;
    memcpy(places.z, in.depth + at, sizeof(float) * static_cast<size_t>(count));
    for (int64_t k = count; k < count + 8; k++) places.z[k] = 1.0f;
    const double y = (static_cast<double>(v) - in.from.cy) / in.from.focal;
    for (int64_t first = 0; first < count;) {
        const uint16_t id = ids[first];
        int64_t end = first + 1;
        while (end < count && ids[end] == id) end++;
        const uint16_t asked = in.row_of_instance[id];
        const uint16_t row = asked < in.count ? asked : uint16_t{0};
        move_run(in, in.motions + 12 * row, in.displacements + 12 * row, row != 0, u, y, first, end,
                 places);
        first = end;
    }
    const float unknown = std::numeric_limits<float>::quiet_NaN();
    for (int64_t k = 0; k < count; k++) {
        const bool valid = places.valid[k];
        out.valid[at + k] = valid;
        out.flow[2 * (at + k)] = valid ? static_cast<float>(places.u[k]) : unknown;
        out.flow[2 * (at + k) + 1] = valid ? static_cast<float>(places.v[k]) : unknown;
        for (int64_t axis = 0; axis < 3; axis++) {
            out.scene_flow[3 * (at + k) + axis] = places.scene[axis][k];
        }
        const double there_u = static_cast<double>(u + k) + places.u[k];
        const double there_v = static_cast<double>(v) + places.v[k];
        const double z = places.z_to[k];
        const bool inside = valid && there_u >= -0.5 &&
                            there_u <= static_cast<double>(in.to_width) - 0.5 && there_v >= -0.5 &&
                            there_v <= static_cast<double>(in.to_height) - 0.5 &&
                            (z <= in.to.far_m || z == INFINITE);
        out.out_of_view[at + k] = places.known[k] && !inside;
        out.occluded[at + k] = inside && !is_seen(in, ids[k], there_u, there_v, z);
    }
}

}  // namespace

SAILENV_KERNEL(motion)
(int64_t threads, int64_t height, int64_t width, const float* depth, const uint16_t* instance,
 const uint16_t* row_of_instance, const double* motions, const double* displacements, int64_t count,
 const double* from, const double* to, const float* to_depth, const uint16_t* to_instance,
 int64_t to_height, int64_t to_width, double tolerance, float* flow, float* scene_flow,
 uint8_t* valid, uint8_t* occluded, uint8_t* out_of_view) {
    if (height < 0 || width < 0 || count < 1 || to_height < 1 || to_width < 1) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    const auto columns = sailenv::allocate<double>(width + 8);
    if (!columns) return sailenv::STATUS_OUT_OF_MEMORY;
    for (int64_t u = 0; u < width + 8; u++) {
        columns[u] = (static_cast<double>(static_cast<int32_t>(u)) - from[1]) / from[0];
    }
    const Input in{width,
                   depth,
                   instance,
                   row_of_instance,
                   motions,
                   displacements,
                   count,
                   {from[0], from[1], from[2], from[3], from[4]},
                   {to[0], to[1], to[2], to[3], to[4]},
                   columns.get(),
                   to_depth,
                   to_instance,
                   to_height,
                   to_width,
                   tolerance};
    const Output out{flow, scene_flow, valid, occluded, out_of_view};
    sailenv::parallel_for(threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t v = first; v < last; v++) {
            for (int64_t u = 0; u < width; u += CHUNK) {
                move_chunk(in, out, v, u, u + CHUNK < width ? CHUNK : width - u);
            }
        }
    });
    return sailenv::STATUS_OK;
}

// Surface points in other axes: one affine transform for each instance.
SAILENV_KERNEL(transform_points)
(int64_t threads, int64_t height, int64_t width, const float* depth, const uint16_t* instance,
 const uint16_t* row_of_instance, const double* transforms, int64_t count, const double* lens,
 float* points) {
    if (height < 0 || width < 0 || count < 1) return sailenv::STATUS_INVALID_ARGUMENT;
    sailenv::parallel_for(threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t v = first; v < last; v++) {
            const double y = (static_cast<double>(v) - lens[2]) / lens[0];
            for (int64_t u = 0; u < width; u++) {
                const int64_t at = v * width + u;
                const double z = depth[at];
                const uint16_t asked = row_of_instance[instance[at]];
                const uint16_t row = asked < count ? asked : uint16_t{0};
                const bool there = row != 0 && z - z == 0.0;
                const double x = (static_cast<double>(u) - lens[1]) / lens[0];
                const double* m = transforms + 12 * row;
                for (int64_t axis = 0; axis < 3; axis++) {
                    const double* r = m + 4 * axis;
                    const double place = z * (r[0] * x + r[1] * y + r[2]) + r[3];
                    points[3 * at + axis] =
                        there ? static_cast<float>(place) : std::numeric_limits<float>::quiet_NaN();
                }
            }
        }
    });
    return sailenv::STATUS_OK;
}
