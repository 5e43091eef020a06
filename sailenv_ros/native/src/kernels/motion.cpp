// Where the surface points of one picture are in another one, and points in other axes; see
// native/motion_kernels.py. All in double precision.
#include <algorithm>
#include <cmath>
#include <limits>

#include "../threads.h"
#include "id_runs.h"
#include "lanes.h"
#include "lens.h"
#include "lens_models/table.h"
#include "record.h"
#include "scratch.h"

#define MOTION_FIELDS(FIELD)                                                                 \
    FIELD(int64_t, height)                                                                   \
    FIELD(int64_t, width)                                                                    \
    FIELD(const float*, depth)              /* (H, W) [m] */                                 \
    FIELD(const uint16_t*, instance)        /* (H, W) */                                     \
    FIELD(const uint16_t*, row_of_instance) /* (65536,), 0 where there is no motion */       \
    FIELD(int64_t, rows)                                                                     \
    FIELD(const double*, motions)       /* (R, 3, 4) */                                      \
    FIELD(const double*, displacements) /* (R, 3, 4), or null without scene flow */          \
    FIELD(const sailenv::Lens*, from_lens)                                                   \
    FIELD(const sailenv::Lens*, to_lens)                                                     \
    FIELD(int64_t, bent)                  /* 1: a lens is no pin-hole; the next count */     \
    FIELD(const float*, from_rays)        /* (3, H, W): unit rays, `depth` is along */       \
                                          /* them; else null, and it is along the axis */    \
    FIELD(int64_t, from_parallel)         /* 1: rays are; see `Sight` of lens.h */           \
    FIELD(int64_t, to_model)              /* of the other lens; below 0: a pin-hole */       \
    FIELD(const double*, to_coefficients) /* (MOST_COEFFICIENTS,) */                         \
    FIELD(double, to_limit)               /* [rad] */                                        \
    FIELD(int64_t, same_lens)                                                                \
    FIELD(int64_t, to_height)                                                                \
    FIELD(int64_t, to_width)                                                                 \
    FIELD(const float*, to_depth)       /* (H', W') [m], or null: nothing is seen */         \
    FIELD(const uint16_t*, to_instance) /* (H', W'), or null: depth alone decides */         \
    FIELD(double, tolerance)            /* share of its depth a hidden point is behind */    \
    FIELD(double, duration)             /* what displacements in the picture are over */     \
    FIELD(const double*, own_from_rows) /* (R, H, 4, 4), by columns: other axes from each */ \
                                        /* row's, instead of `motions`; else null */         \
    FIELD(const double*, rows_from_own) /* (R, row_poses, 4, 4), of the other picture */     \
    FIELD(const uint8_t*, at_rest)      /* (R,): 1 where nothing moves */                    \
    FIELD(int64_t, row_poses)                                                                \
    FIELD(const float*, offsets)     /* (H, W, 3), own axes: how a point that deforms has */ \
                                     /* moved besides; nan: unknown. Or null: none does */   \
    FIELD(const uint8_t*, deforming) /* (R,): 1 where offsets count */                       \
    FIELD(const double*, turns)      /* (R, 3, 3): to the other camera */                    \
    FIELD(const double*, displacement_turns) /* (R, 3, 3), or null */                        \
    FIELD(float*, flow)                      /* (H, W, 2); these and the next may be null */ \
    FIELD(float*, scene_flow)                /* (H, W, 3) */                                 \
    FIELD(uint8_t*, valid)                                                                   \
    FIELD(uint8_t*, occluded)                                                                \
    FIELD(uint8_t*, out_of_view)                                                             \
    FIELD(uint8_t*, hidden) /* not seen, for whatever reason */

SAILENV_RECORD(Motion, motion, MOTION_FIELDS)

#define TRANSFORM_FIELDS(FIELD)                               \
    FIELD(int64_t, height)                                    \
    FIELD(int64_t, width)                                     \
    FIELD(const float*, depth)                                \
    FIELD(const uint16_t*, instance)                          \
    FIELD(const uint16_t*, row_of_instance)                   \
    FIELD(int64_t, rows)                                      \
    FIELD(const double*, transforms)                          \
    FIELD(const sailenv::Lens*, lens)                         \
    FIELD(const double*, rays) /* as `from_rays` of Motion */ \
    FIELD(int64_t, parallel)   /* as `from_parallel` */       \
    FIELD(float*, points)      /* (H, W, 3) */

SAILENV_RECORD(Transform, transform_points, TRANSFORM_FIELDS)

namespace {

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr float NOT_A_NUMBER = std::numeric_limits<float>::quiet_NaN();
constexpr int64_t CHUNK = 256;  // pixels whose intermediate results stay in the first-level cache
constexpr int64_t BENT_CHUNK = 64;  // the same through lenses that bend lines: these keep more
constexpr int64_t TILE_ROWS = 16;
constexpr int64_t ROLLING_ROWS = 4;  // of which pixels' points are found side by side
constexpr double ROUNDING_PX = 1e-3;
constexpr double SAME_ROW = 1e-4;    // rows between two guesses that end the search: a place
                                     // moves by a hundredth of that, or less
constexpr int32_t MOST_ROUNDS = 64;  // of the search for a row

typedef double d8 __attribute__((vector_size(64)));
typedef int64_t l8 __attribute__((vector_size(64)));
typedef double d8_any __attribute__((vector_size(64), aligned(8), may_alias));
typedef int64_t l8_any __attribute__((vector_size(64), aligned(8), may_alias));

constexpr d8 COUNTING = {0, 1, 2, 3, 4, 5, 6, 7};

inline l8 vector_of(const int64_t* p) { return *reinterpret_cast<const l8_any*>(p); }
inline d8 vector_of(const double* p) { return *reinterpret_cast<const d8_any*>(p); }
inline void put(double* p, d8 x) { *reinterpret_cast<d8_any*>(p) = x; }
inline void put_flags(uint8_t* p, l8 mask) {
    const i8 narrow = __builtin_convertvector(mask, i8);
    for (int j = 0; j < 8; j++) p[j] = static_cast<uint8_t>(narrow[j] & 1);
}

// Where a chunk's points are; there is room for steps of eight.
struct Places {
    float z[CHUNK + 8];
    float flow[2 * (CHUNK + 8)];
    float scene[3][CHUNK + 8];
    double u[CHUNK + 8], v[CHUNK + 8], z_to[CHUNK + 8];  // displacement [px], depth then
    uint8_t known[CHUNK + 8], valid[CHUNK + 8];
};

// What of it is asked for.
struct Wanted {
    bool flow, scene, place;
};

// The vector that an affine transform makes of reach (x, y, 1), with its translation times shift.
struct Affine {
    const double* m;
    double y_x, y_y, y_z;

    Affine(const double* matrix, double y)
        : m(matrix), y_x(matrix[1] * y), y_y(matrix[5] * y), y_z(matrix[9] * y) {}

    d8 x(d8 ray, d8 reach, d8 shift) const {
        return reach * (m[0] * ray + y_x + m[2]) + shift * m[3];
    }
    d8 y(d8 ray, d8 reach, d8 shift) const {
        return reach * (m[4] * ray + y_y + m[6]) + shift * m[7];
    }
    d8 z(d8 ray, d8 reach, d8 shift) const {
        return reach * (m[8] * ray + y_z + m[10]) + shift * m[11];
    }
};

// The points of neighbours in a row of the picture that move alike. Steps of eight may go beyond
// `end`: the next run writes there again.
void move_run(const Motion& in, const double* columns, Wanted wanted, int64_t row, double y,
              int64_t column, int64_t first, int64_t end, Places& places) {
    const Affine motion(in.motions + 12 * row, y);
    const Affine displacement((wanted.scene ? in.displacements : in.motions) + 12 * row, y);
    const sailenv::Lens &from = *in.from_lens, &to = *in.to_lens;
    const double rate = 1.0 / in.duration;
    const double fx = to.fx / in.duration, fy = to.fy / in.duration;
    const double down = sailenv::refocused_v(from, to, y);
    const d8 zero = {}, one = zero + 1.0;
    const f8 unknown = splat(NOT_A_NUMBER);
    for (int64_t k = first; k < end; k += 8) {
        const d8 z = __builtin_convertvector(load(places.z + k), d8);
        const d8 x = vector_of(columns + column + k);
        const l8 at_infinity = z == INFINITE;
        const l8 known = row != 0 ? (z == z) : l8{};
        const d8 reach = at_infinity ? one : z, shift = at_infinity ? zero : one;
        const d8 dx = motion.x(x, reach, shift);
        const d8 dy = motion.y(x, reach, shift);
        const d8 dz = motion.z(x, reach, shift);
        const d8 z_to = reach + dz;
        const l8 valid = known & (z_to > 0.0);
        // How far the point's ray has moved the other way, at depth 1.
        const d8 u = (x * dz - dx) / z_to, v = (y * dz - dy) / z_to;
        const d8 right = sailenv::refocused_u(from, to, x);
        const i8 exists = __builtin_convertvector(valid, i8);
        if (wanted.flow) {
            const d8 along = rate * right - fx * u, across = rate * down - fy * v;
            const f8 fu = exists ? __builtin_convertvector(along, f8) : unknown;
            const f8 fv = exists ? __builtin_convertvector(across, f8) : unknown;
            store(places.flow + 2 * k, SHUFFLE(fu, fv, 0, 8, 1, 9, 2, 10, 3, 11));
            store(places.flow + 2 * k + 8, SHUFFLE(fu, fv, 4, 12, 5, 13, 6, 14, 7, 15));
        }
        put_flags(places.valid + k, valid);
        if (wanted.place) {
            put(places.u + k, right - to.fx * u);
            put(places.v + k, down - to.fy * v);
            put(places.z_to + k, at_infinity ? zero + INFINITE : z_to);
            put_flags(places.known + k, known);
        }
        if (wanted.scene) {
            const i8 there = __builtin_convertvector(known & ~at_infinity, i8);
            const d8 sx = displacement.x(x, reach, one);
            const d8 sy = displacement.y(x, reach, one);
            const d8 sz = displacement.z(x, reach, one);
            store(places.scene[0] + k, there ? __builtin_convertvector(sx, f8) : unknown);
            store(places.scene[1] + k, there ? __builtin_convertvector(sy, f8) : unknown);
            store(places.scene[2] + k, there ? __builtin_convertvector(sz, f8) : unknown);
        }
    }
}

// A vector times rows of three numbers, and with a fourth one times `shift`.
void transformed(const double* rows, const double* point, double shift, double* out) {
    for (int k = 0; k < 3; k++) {
        const double* r = rows + 4 * k;
        out[k] = r[0] * point[0] + r[1] * point[1] + r[2] * point[2] + shift * r[3];
    }
}

// A vector times a matrix of three rows of three numbers.
void turned(const double* rows, const float* vector, double* out) {
    for (int k = 0; k < 3; k++) {
        const double* r = rows + 3 * k;
        out[k] = r[0] * vector[0] + r[1] * vector[1] + r[2] * vector[2];
    }
}

// The same as `move_run` for points of a surface that deforms, whose first point is pixel `at`.
void move_deforming_run(const Motion& in, const double* columns, Wanted wanted, int64_t row,
                        double y, int64_t column, int64_t at, int64_t first, int64_t end,
                        Places& places) {
    const double* m = in.motions + 12 * row;
    const sailenv::Lens &from = *in.from_lens, &to = *in.to_lens;
    const double rate = 1.0 / in.duration;
    const double down = sailenv::refocused_v(from, to, y);
    for (int64_t k = first; k < end; k++) {
        const float* offset = in.offsets + 3 * (at + k);
        const double z = places.z[k], x = columns[column + k];
        const double point[3] = {z * x, z * y, z};
        const bool known = z - z == 0.0 && offset[0] == offset[0];
        double step[3], more[3];
        transformed(m, point, 1.0, step);
        turned(in.turns + 9 * row, offset, more);
        for (int axis = 0; axis < 3; axis++) step[axis] += more[axis];
        const double z_to = z + step[2];
        const bool valid = known && z_to > 0.0;
        const double u = (x * step[2] - step[0]) / z_to, v = (y * step[2] - step[1]) / z_to;
        const double right = sailenv::refocused_u(from, to, x);
        if (wanted.flow) {
            const double along = rate * right - to.fx / in.duration * u;
            const double across = rate * down - to.fy / in.duration * v;
            places.flow[2 * k] = valid ? static_cast<float>(along) : NOT_A_NUMBER;
            places.flow[2 * k + 1] = valid ? static_cast<float>(across) : NOT_A_NUMBER;
        }
        places.valid[k] = valid;
        places.known[k] = known;
        places.u[k] = right - to.fx * u;
        places.v[k] = down - to.fy * v;
        places.z_to[k] = z_to;
        if (!wanted.scene) continue;
        transformed(in.displacements + 12 * row, point, 1.0, step);
        turned(in.displacement_turns + 9 * row, offset, more);
        for (int axis = 0; axis < 3; axis++) {
            places.scene[axis][k] =
                known ? static_cast<float>(step[axis] + more[axis]) : NOT_A_NUMBER;
        }
    }
}

// Tells if the other picture shows a point of an instance at (u, v), depth z.
bool is_seen(const Motion& in, uint16_t id, double u, double v, double z) {
    const double least = z * (1.0 - in.tolerance);
    const double nearest = in.to_lens->near_m * (1.0 + in.tolerance);
    const auto clamped = [](double place, int64_t size) {
        const int64_t whole = static_cast<int64_t>(place);
        return whole < 0 ? 0 : whole < size ? whole : size - 1;
    };
    const auto shows = [&](int64_t row, int64_t column) {
        const int64_t at = row * in.to_width + column;
        const double seen = in.to_depth[at];
        if (in.to_instance == nullptr) return seen == z || seen > least;
        if (in.to_instance[at] != id) return false;
        return seen == z || seen > least || (seen != seen && z < nearest);
    };
    // Within rounding of a pixel's centre that pixel alone decides, so a still picture agrees with
    // itself; between centres any of the four around may show the point. Mostly the first does.
    const int64_t left = clamped(std::floor(u + ROUNDING_PX), in.to_width);
    const int64_t upper = clamped(std::floor(v + ROUNDING_PX), in.to_height);
    if (shows(upper, left)) return true;
    const int64_t right = clamped(std::ceil(u - ROUNDING_PX), in.to_width);
    if (shows(upper, right)) return true;
    const int64_t lower = clamped(std::ceil(v - ROUNDING_PX), in.to_height);
    return shows(lower, left) || shows(lower, right);
}

// Compares places with what the other picture shows there.
void look_up(const Motion& in, const Places& places, int64_t v, int64_t u, int64_t count) {
    const int64_t at = v * in.width + u;
    // What lies beyond the far plane is in no picture; where there are no ids, depth tells it.
    const double farthest = in.to_instance == nullptr ? INFINITE : in.to_lens->far_m;
    const bool is_looked_at =
        (in.occluded != nullptr || in.hidden != nullptr) && in.to_height > 0 && in.to_width > 0;
    for (int64_t k = 0; k < count; k++) {
        const double there_u = static_cast<double>(u + k) + places.u[k];
        const double there_v = static_cast<double>(v) + places.v[k];
        const double z = places.z_to[k];
        const bool inside = places.valid[k] && there_u >= -0.5 &&
                            there_u <= static_cast<double>(in.to_width) - 0.5 && there_v >= -0.5 &&
                            there_v <= static_cast<double>(in.to_height) - 0.5 &&
                            (z <= farthest || z == INFINITE);
        const bool seen =
            is_looked_at && inside && is_seen(in, in.instance[at + k], there_u, there_v, z);
        if (in.out_of_view != nullptr) in.out_of_view[at + k] = places.known[k] && !inside;
        if (in.occluded != nullptr) in.occluded[at + k] = inside && !seen;
        if (in.hidden != nullptr) in.hidden[at + k] = !seen;
    }
}

void move_chunk(const Motion& in, const double* columns, Wanted wanted, int64_t v, int64_t u,
                int64_t count) {
    const int64_t at = v * in.width + u;
    const size_t size = static_cast<size_t>(count);
    const uint16_t* ids = in.instance + at;
    Places places;
    memcpy(places.z, in.depth + at, sizeof(float) * size);
    for (int64_t k = count; k < count + 8; k++) places.z[k] = 1.0f;
    const double y = sailenv::ray_y(*in.from_lens, static_cast<double>(v));
    for (int64_t first = 0; first < count;) {
        const uint16_t id = ids[first];
        const int64_t end = sailenv::same_until(ids, first, count);
        const uint16_t asked = in.row_of_instance[id];
        const int64_t row = asked < in.rows ? asked : 0;
        if (in.offsets != nullptr && in.deforming[row] != 0) {
            move_deforming_run(in, columns, wanted, row, y, u, at, first, end, places);
        } else {
            move_run(in, columns, wanted, row, y, u, first, end, places);
        }
        first = end;
    }
    if (in.flow != nullptr) memcpy(in.flow + 2 * at, places.flow, 2 * sizeof(float) * size);
    if (in.valid != nullptr) memcpy(in.valid + at, places.valid, size);
    if (in.scene_flow != nullptr) {
        for (int64_t k = 0; k < count; k++) {
            for (int64_t axis = 0; axis < 3; axis++) {
                in.scene_flow[3 * (at + k) + axis] = places.scene[axis][k];
            }
        }
    }
    if (wanted.place) look_up(in, places, v, u, count);
}

// A picture's pixels as points.
template <class Real>
struct Pixels {
    const sailenv::Lens& lens;
    const Real* rays;
    int64_t count;
    bool parallel;
};

// Where a pixel's ray begins, in the camera's plane, and where it leads.
template <class Real>
LANES_INLINE void ray_of(const Pixels<Real>& in, int64_t at, int64_t u, int64_t v, double* begin,
                         double* ray) {
    begin[0] = begin[1] = 0.0;
    if (in.rays != nullptr) {
        for (int k = 0; k < 3; k++) ray[k] = in.rays[k * in.count + at];
        return;
    }
    const double x = sailenv::ray_x(in.lens, static_cast<double>(u)),
                 y = sailenv::ray_y(in.lens, static_cast<double>(v));
    begin[0] = in.parallel ? x : 0.0;
    begin[1] = in.parallel ? y : 0.0;
    ray[0] = in.parallel ? 0.0 : x;
    ray[1] = in.parallel ? 0.0 : y;
    ray[2] = 1.0;
}

// The point that a pixel sees at a depth, or at a distance along its ray; its direction where that
// is infinite.
template <class Real>
LANES_INLINE void point_of(const Pixels<Real>& in, int64_t at, int64_t u, int64_t v, double depth,
                           double* point) {
    double begin[2], ray[3];
    ray_of(in, at, u, v, begin, ray);
    const double reach = depth == INFINITE ? 1.0 : depth;
    for (int k = 0; k < 3; k++) point[k] = reach * ray[k];
    const bool aside = in.parallel && depth != INFINITE;
    point[0] = aside ? begin[0] : point[0];
    point[1] = aside ? begin[1] : point[1];
}

// Where a chunk's points are in the other camera's frame; there is room for steps of eight.
struct MovedPoints {
    double from[3][BENT_CHUNK + 8], at[3][BENT_CHUNK + 8], step[3][BENT_CHUNK + 8];
    double shift[BENT_CHUNK + 8];  // see `Affine`
    double place[2][BENT_CHUNK + 8] = {};
    int64_t seen[BENT_CHUNK + 8] = {};  // -1 where the other camera has it
};

// Moves the points of neighbours that move alike; steps of eight as in `move_run`.
void move_points(const double* rows, int64_t first, int64_t end, MovedPoints& p) {
    for (int64_t k = first; k < end; k += 8) {
        const d8 shift = vector_of(p.shift + k);
        const d8 x = vector_of(p.from[0] + k), y = vector_of(p.from[1] + k),
                 z = vector_of(p.from[2] + k);
        const d8 own[3] = {x, y, z};
        for (int axis = 0; axis < 3; axis++) {
            const double* r = rows + 4 * axis;
            const d8 step = r[0] * x + r[1] * y + r[2] * z + shift * r[3];
            put(p.step[axis] + k, step);
            put(p.at[axis] + k, own[axis] + step);
        }
    }
}

// Where the other camera has points. The loop becomes one of vectors where the law has no branch.
template <class Project>
void project_points(const Project& project, int64_t first, int64_t end, MovedPoints& p) {
    for (int64_t k = first; k < end; k++) {
        const double moved[3] = {p.at[0][k], p.at[1][k], p.at[2][k]};
        double place[2] = {0.0, 0.0};
        p.seen[k] = project(moved, p.shift[k], place) ? -1 : 0;
        for (int axis = 0; axis < 2; axis++) p.place[axis][k] = place[axis];
    }
}

// Whether a motion leaves all points where they are.
bool is_zero(const double* rows) {
    return std::all_of(rows, rows + 12, [](double x) { return x == 0.0; });
}

// The same as `move_run` where one of the lenses is no pin-hole. `project(point, place)` tells
// where the other lens has a point, as a place for x and y of `Lens`; false if it does not see it.
// It takes the `shift` of points between the two: 0 for directions.
template <class Project>
void move_bent_chunk(const Motion& in, Wanted wanted, int64_t v, int64_t u, int64_t count,
                     const Project& project) {
    const int64_t at = v * in.width + u;
    const uint16_t* ids = in.instance + at;
    const sailenv::Lens& to = *in.to_lens;
    const double rate = 1.0 / in.duration;
    const Pixels<float> pixels{*in.from_lens, in.from_rays, in.height * in.width,
                               in.from_parallel != 0};
    MovedPoints p;
    Places places;
    const float* depths = in.depth + at;
    if (in.from_rays != nullptr) {
        // Rays of the next chunk.
        for (int axis = 0; axis < 3; axis++) {
            const float* rays = in.from_rays + axis * pixels.count + at + count;
            for (int64_t k = 0; k < BENT_CHUNK; k += 16) __builtin_prefetch(rays + k, 0, 2);
        }
    }
    int64_t found = 0;
    for (; in.from_rays != nullptr && found + 8 <= count; found += 8) {
        const d8 z = __builtin_convertvector(load(depths + found), d8), zero = {};
        const l8 at_infinity = z == INFINITE;
        const d8 reach = at_infinity ? zero + 1.0 : z;
        for (int axis = 0; axis < 3; axis++) {
            const float* rays = in.from_rays + axis * pixels.count + at;
            put(p.from[axis] + found, reach * __builtin_convertvector(load(rays + found), d8));
        }
        put(p.shift + found, at_infinity ? zero : zero + 1.0);
    }
    for (int64_t k = found; k < count; k++) {
        const double z = depths[k];
        double point[3];
        point_of(pixels, at + k, u + k, v, z, point);
        for (int axis = 0; axis < 3; axis++) p.from[axis][k] = point[axis];
        p.shift[k] = z == INFINITE ? 0.0 : 1.0;
    }
    for (int64_t k = count; k < count + 8; k++) {
        for (int axis = 0; axis < 3; axis++) p.from[axis][k] = 0.0;
        p.shift[k] = 0.0;
    }
    for (int64_t first = 0; first < count;) {
        const int64_t end = sailenv::same_until(ids, first, count);
        const uint16_t asked = in.row_of_instance[ids[first]];
        const int64_t row = asked < in.rows ? asked : 0;
        move_points(in.motions + 12 * row, first, end, p);
        const bool deforms = in.offsets != nullptr && in.deforming[row] != 0;
        for (int64_t k = first; deforms && k < end; k++) {
            double more[3];
            turned(in.turns + 9 * row, in.offsets + 3 * (at + k), more);
            for (int axis = 0; axis < 3; axis++) {
                p.step[axis][k] += more[axis];
                p.at[axis][k] += more[axis];
            }
        }
        // Not where all rest: some laws are slow.
        const bool has_motion = row != 0, same_lens = in.same_lens != 0;
        const bool moves_at_all =
            has_motion && (!same_lens || deforms || !is_zero(in.motions + 12 * row));
        if (moves_at_all) {
            project_points(project, first, end, p);
        } else {
            std::fill(p.seen + first, p.seen + end, 0);
            for (auto& axis : p.place) std::fill(axis + first, axis + end, 0.0);
        }
        for (int64_t k = first; k < end; k += 8) {
            const l8 stays = (vector_of(p.step[0] + k) == 0.0) & (vector_of(p.step[1] + k) == 0.0) &
                             (vector_of(p.step[2] + k) == 0.0);
            const d8 z = vector_of(p.from[2] + k), z_to = vector_of(p.at[2] + k);
            const l8 known = has_motion ? (z == z) & (z_to == z_to) : l8{};
            const l8 rests = same_lens ? stays : l8{};
            const l8 moves = known & ~rests & vector_of(p.seen + k);
            const double column = static_cast<double>(u + k);
            const d8 right = sailenv::pixel_u(to, vector_of(p.place[0] + k)) - (column + COUNTING);
            const d8 down =
                sailenv::pixel_v(to, vector_of(p.place[1] + k)) - static_cast<double>(v);
            put(places.u + k, moves ? right : d8{});
            put(places.v + k, moves ? down : d8{});
            put_flags(places.known + k, known);
            put_flags(places.valid + k, known & (rests | moves));
        }
        if (wanted.scene) {
            for (int64_t k = first; k < end; k++) {
                double point[3], step[3];
                for (int axis = 0; axis < 3; axis++) point[axis] = p.from[axis][k];
                transformed(in.displacements + 12 * row, point, 1.0, step);
                if (deforms) {
                    double more[3];
                    turned(in.displacement_turns + 9 * row, in.offsets + 3 * (at + k), more);
                    for (int axis = 0; axis < 3; axis++) step[axis] += more[axis];
                }
                const bool there = places.known[k] && p.shift[k] != 0.0;
                for (int j = 0; j < 3; j++) {
                    in.scene_flow[3 * (at + k) + j] =
                        there ? static_cast<float>(step[j]) : NOT_A_NUMBER;
                }
            }
        }
        first = end;
    }
    if (wanted.flow) {
        for (int64_t k = 0; k < count; k++) {
            const bool valid = places.valid[k] != 0;
            float* flow = in.flow + 2 * (at + k);
            flow[0] = valid ? static_cast<float>(rate * places.u[k]) : NOT_A_NUMBER;
            flow[1] = valid ? static_cast<float>(rate * places.v[k]) : NOT_A_NUMBER;
        }
    }
    if (in.valid != nullptr) memcpy(in.valid + at, places.valid, static_cast<size_t>(count));
    if (!wanted.place) return;
    for (int64_t k = 0; k < count; k++) {
        const double moved[3] = {p.at[0][k], p.at[1][k], p.at[2][k]};
        places.z_to[k] = p.shift[k] == 0.0 ? INFINITE : project.reach(moved);
    }
    look_up(in, places, v, u, count);
}

// The search for the row of the other picture that sees a point: `own` in other axes, `point` in
// the frame of the camera at row `at`.
struct RowSearch {
    double own[3], shift;
    const double* poses;  // of all rows
    double at, found;     // a row, and that in which its camera has the point
    double point[4], place[2];
    bool seen, ended;
};

// A point or direction in other axes, of which a matrix holds the columns.
LANES_INLINE d4 carried(const double* columns, const double* point, double shift) {
    const auto column = [columns](int k) {
        d4 numbers;
        memcpy(&numbers, columns + 4 * k, sizeof numbers);
        return numbers;
    };
    return column(0) * point[0] + column(1) * point[1] + column(2) * point[2] + shift * column(3);
}

// Looks from row `at`, and goes on to the row found unless it is the same: what has ended finds the
// same again. A row's pose is between those of its neighbours; points beside the picture are where
// its first or last row has them.
template <class Project>
LANES_INLINE void look_from_row(const Motion& in, const Project& project, RowSearch& search) {
    const double last = static_cast<double>(in.row_poses - 1);
    const double within = search.at < 0.0 ? 0.0 : search.at < last ? search.at : last;
    const int64_t upper = static_cast<int64_t>(within);
    const int64_t lower = upper + 1 < in.row_poses ? upper + 1 : upper;
    const double share = within - static_cast<double>(upper);
    const d4 above = carried(search.poses + 16 * upper, search.own, search.shift);
    const d4 below = carried(search.poses + 16 * lower, search.own, search.shift);
    const d4 point = above + share * (below - above);
    memcpy(search.point, &point, sizeof point);
    search.seen = project(search.point, search.shift, search.place);
    search.found = sailenv::pixel_v(*in.to_lens, search.place[1]);
    const double step = search.found - search.at;
    const bool lost = !search.seen;
    search.ended = lost | ((step < SAME_ROW) & (step > -SAME_ROW));
    search.at = search.ended ? search.at : search.found;
}

// The same as `move_bent_chunk` where rows have poses of their own, for some rows at once. The
// search for a pixel's row begins where that for its neighbour ended.
template <class Project>
void move_rolling_chunk(const Motion& in, Wanted wanted, int64_t first_v, int64_t rows, int64_t u,
                        int64_t count, const Project& project) {
    const sailenv::Lens& to = *in.to_lens;
    const double rate = 1.0 / in.duration;
    const Pixels<float> pixels{*in.from_lens, in.from_rays, in.height * in.width,
                               in.from_parallel != 0};
    Places all_places[ROLLING_ROWS];
    RowSearch searches[ROLLING_ROWS] = {};
    for (int64_t j = 0; j < ROLLING_ROWS; j++) searches[j].found = static_cast<double>(first_v + j);
    for (int64_t k = 0; k < count; k++) {
        bool known[ROLLING_ROWS] = {}, rests[ROLLING_ROWS] = {};
        bool any = false;
        for (int64_t j = 0; j < ROLLING_ROWS; j++) {
            // Beyond the rows the last one is searched for again.
            const int64_t v = first_v + std::min(j, rows - 1), at = v * in.width + u + k;
            RowSearch& search = searches[j];
            const uint16_t asked = in.row_of_instance[in.instance[at]];
            const int64_t group = asked < in.rows ? asked : 0;
            const double z = in.depth[at];
            search.shift = z == INFINITE ? 0.0 : 1.0;
            double point[3];
            point_of(pixels, at, u + k, v, z, point);
            const bool deforms = in.offsets != nullptr && in.deforming[group] != 0;
            const float* offset = deforms ? in.offsets + 3 * at : nullptr;
            known[j] = group != 0 && point[2] == point[2] && (!deforms || offset[0] == offset[0]);
            rests[j] = in.at_rest[group] != 0;
            const d4 own =
                carried(in.own_from_rows + 16 * (group * in.height + v), point, search.shift);
            for (int axis = 0; axis < 3; axis++) {
                search.own[axis] = deforms ? own[axis] + offset[axis] : own[axis];
                search.point[axis] = point[axis];
            }
            search.poses = in.rows_from_own + 16 * group * in.row_poses;
            search.at = search.found;
            search.ended = search.seen = false;
            search.place[0] = search.place[1] = 0.0;
            any |= known[j] && !rests[j];
        }
        bool goes_on = any;
        for (int32_t round = 0; goes_on && round < MOST_ROUNDS; round++) {
            goes_on = false;
            for (int64_t j = 0; j < ROLLING_ROWS; j++) {
                look_from_row(in, project, searches[j]);
                const bool goes = known[j] && !rests[j] && !searches[j].ended;
                goes_on |= goes;
            }
        }
        for (int64_t j = 0; j < ROLLING_ROWS; j++) {
            if (j == rows) break;
            RowSearch& search = searches[j];
            Places& places = all_places[j];
            const int64_t v = first_v + j, at = v * in.width + u + k;
            const bool found = known[j] && !rests[j] && search.seen && search.ended;
            if (!found) search.found = static_cast<double>(v);
            const bool valid = found || (known[j] && rests[j]);
            const double right = sailenv::pixel_u(to, search.place[0]) - static_cast<double>(u + k);
            const double down = sailenv::pixel_v(to, search.place[1]) - static_cast<double>(v);
            places.known[k] = known[j];
            places.valid[k] = valid;
            places.u[k] = found ? right : 0.0;
            places.v[k] = found ? down : 0.0;
            places.z_to[k] = search.shift == 0.0 ? INFINITE : project.reach(search.point);
            if (in.valid != nullptr) in.valid[at] = valid;
            if (!wanted.flow) continue;
            float* flow = in.flow + 2 * at;
            flow[0] = valid ? static_cast<float>(rate * places.u[k]) : NOT_A_NUMBER;
            flow[1] = valid ? static_cast<float>(rate * places.v[k]) : NOT_A_NUMBER;
        }
    }
    for (int64_t j = 0; wanted.place && j < rows; j++) {
        look_up(in, all_places[j], first_v + j, u, count);
    }
}

// Where a pin-hole has points. `reach` is what its picture tells of their distance, as those of the
// next two do.
struct ToPinhole {
    bool operator()(const double* point, double, double* place) const {
        place[0] = point[0] / point[2];
        place[1] = point[1] / point[2];
        return point[2] > 0.0;
    }
    double reach(const double* point) const { return point[2]; }
};

template <class Model>
struct ToModel {
    const sailenv::LensLaw& law;

    bool operator()(const double* point, double, double* place) const {
        return Model::project(law, point, place);
    }
    double reach(const double* p) const {
        return std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    }
};

// A direction has no place in a picture of parallel rays.
template <class Model>
struct ToParallel {
    const sailenv::LensLaw& law;

    bool operator()(const double* point, double shift, double* place) const {
        return shift != 0.0 && Model::project(law, point, place);
    }
    double reach(const double* point) const { return point[2]; }
};

int32_t move_through_bent_lenses(int64_t threads, const Motion& in, Wanted wanted) {
    const auto move = [&](const auto& project) {
        sailenv::parallel_for(
            threads, in.height, TILE_ROWS, [&](int64_t begin, int64_t end, int64_t) {
                const bool rolls = in.own_from_rows != nullptr;
                for (int64_t v = begin; v < end; v += rolls ? ROLLING_ROWS : 1) {
                    for (int64_t u = 0; u < in.width; u += BENT_CHUNK) {
                        const int64_t count = u + BENT_CHUNK < in.width ? BENT_CHUNK : in.width - u;
                        if (rolls) {
                            move_rolling_chunk(in, wanted, v, std::min(ROLLING_ROWS, end - v), u,
                                               count, project);
                        } else {
                            move_bent_chunk(in, wanted, v, u, count, project);
                        }
                    }
                }
            });
    };
    if (in.to_model < 0) {
        move(ToPinhole{});
        return sailenv::STATUS_OK;
    }
    if (in.to_coefficients == nullptr) return sailenv::STATUS_INVALID_ARGUMENT;
    const sailenv::LensLaw law = sailenv::lens_law(in.to_model, in.to_coefficients, in.to_limit);
    const bool is_model = sailenv::LensModels::choose(in.to_model, [&](auto model) {
        using Model = decltype(model);
        if constexpr (sailenv::has_parallel_rays(Model::TEXT)) {
            move(ToParallel<Model>{law});
        } else {
            move(ToModel<Model>{law});
        }
    });
    return is_model ? sailenv::STATUS_OK : sailenv::STATUS_INVALID_ARGUMENT;
}

}  // namespace

SAILENV_KERNEL(motion)(int64_t threads, const Motion* given) {
    Motion in = *given;
    if (in.height < 0 || in.width < 0 || in.rows < 1 || in.to_height < 0 || in.to_width < 0 ||
        (in.scene_flow != nullptr && in.displacements == nullptr)) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    if (in.offsets != nullptr && (in.deforming == nullptr || in.turns == nullptr ||
                                  (in.scene_flow != nullptr && in.displacement_turns == nullptr))) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    if (in.to_depth == nullptr) in.to_height = in.to_width = 0;
    const bool looks = in.occluded != nullptr || in.out_of_view != nullptr || in.hidden != nullptr;
    const Wanted wanted{in.flow != nullptr, in.scene_flow != nullptr, looks};
    if (in.own_from_rows != nullptr && (in.rows_from_own == nullptr || in.at_rest == nullptr ||
                                        in.row_poses < 1 || wanted.scene)) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    if (in.bent != 0 || in.own_from_rows != nullptr) {
        return move_through_bent_lenses(threads, in, wanted);
    }
    const auto columns = sailenv::allocate<double>(in.width + 8);
    if (!columns) return sailenv::STATUS_OUT_OF_MEMORY;
    for (int64_t u = 0; u < in.width + 8; u++) {
        columns[u] = sailenv::ray_x(*in.from_lens, static_cast<double>(static_cast<int32_t>(u)));
    }
    sailenv::parallel_for(threads, in.height, TILE_ROWS, [&](int64_t begin, int64_t end, int64_t) {
        for (int64_t v = begin; v < end; v++) {
            for (int64_t u = 0; u < in.width; u += CHUNK) {
                move_chunk(in, columns.get(), wanted, v, u,
                           u + CHUNK < in.width ? CHUNK : in.width - u);
            }
        }
    });
    return sailenv::STATUS_OK;
}

namespace {

// A pixel's point in other axes.
void transform_point(const Transform& in, const Pixels<double>& pixels, int64_t row, int64_t at,
                     int64_t u, int64_t v) {
    const double z = in.depth[at];
    const bool known = z - z == 0.0;
    double origin[2], ray[3];
    ray_of(pixels, at, u, v, origin, ray);
    for (int64_t axis = 0; axis < 3; axis++) {
        const double* r = in.transforms + 12 * row + 4 * axis;
        const double shift = in.parallel != 0 ? r[0] * origin[0] + r[1] * origin[1] + r[3] : r[3];
        const double place = z * (r[0] * ray[0] + r[1] * ray[1] + r[2] * ray[2]) + shift;
        in.points[3 * at + axis] = known ? static_cast<float>(place) : NOT_A_NUMBER;
    }
}

}  // namespace

// Surface points in other axes: one affine transform for each instance.
SAILENV_KERNEL(transform_points)(int64_t threads, const Transform* given) {
    const Transform in = *given;
    if (in.height < 0 || in.width < 0 || in.rows < 1) return sailenv::STATUS_INVALID_ARGUMENT;
    const Pixels<double> pixels{*in.lens, in.rays, in.height * in.width, in.parallel != 0};
    sailenv::parallel_for(threads, in.height, TILE_ROWS, [&](int64_t begin, int64_t end, int64_t) {
        for (int64_t v = begin; v < end; v++) {
            const int64_t first = v * in.width, last = first + in.width;
            for (int64_t at = first; at < last;) {
                const uint16_t row = in.row_of_instance[in.instance[at]];
                const int64_t run = sailenv::same_until(in.instance, at, last);
                if (row == 0 || row >= in.rows) {
                    std::fill(in.points + 3 * at, in.points + 3 * run, NOT_A_NUMBER);
                    at = run;
                }
                for (; at < run; at++) transform_point(in, pixels, row, at, at - first, v);
            }
        }
    });
    return sailenv::STATUS_OK;
}
