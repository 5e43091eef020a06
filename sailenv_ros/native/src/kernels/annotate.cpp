// From depth and instance id of each pixel to the ground-truth views; see render/annotate.py, which
// says what each view is. All in double precision.
#include <cmath>
#include <limits>

#include "../abi.h"
#include "../threads.h"
#include "clip_distances.h"
#include "lanes.h"
#include "scratch.h"

namespace {

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr float NOT_A_NUMBER = std::numeric_limits<float>::quiet_NaN();
constexpr int64_t CHUNK = 256;  // pixels whose intermediate results stay in the first-level cache
constexpr int64_t TILE_ROWS = 16;
constexpr int64_t INSTANCES = 65536;
constexpr double ROUNDING_PX = 1e-3;

typedef double d8 __attribute__((vector_size(64)));
typedef int64_t l8 __attribute__((vector_size(64)));
typedef double d8_any __attribute__((vector_size(64), aligned(8), may_alias));

struct Lens {
    double focal, cx, cy;
    // Of numbers of single precision: what is less than near, what is more than far.
    float near_m, far_m;
};

struct Input {
    int64_t width;
    const float* surface;                 // (H, W, 2): depth [m], instance id
    const uint8_t* category_of_instance;  // (65536,)
    const uint16_t* row_of_instance;      // (65536,), 0 where there is no past
    const double* motions;                // (R, 3, 4)
    int64_t motion_count;
    Lens lens;
    const double* columns;    // (width + 8,): the ray's x at depth 1
    double scale;             // from a displacement over the focal length to flow [px/s]
    double tolerance;         // share of its depth by which a hidden point lies behind
    const float* past_depth;  // (past_height, past_width) or null
    int64_t past_width, past_height;
};

// All but `depth` may be null.
struct Output {
    float* depth;
    uint8_t* category;
    uint16_t* instance;
    float* flow;
    uint8_t* flow_valid;
    uint8_t* occlusion;
};

// What is known of the pixels of a chunk; there is room for steps of eight.
struct Motion {
    float z[CHUNK + 8];                                    // depth now, infinite beyond far
    float key[CHUNK + 8];                                  // instance id, -1 beyond far
    double u[CHUNK + 8], v[CHUNK + 8], z_past[CHUNK + 8];  // for occlusion
    float flow[2 * (CHUNK + 8)];
    uint8_t valid[CHUNK + 8];
};

// Sets depths and keys, and the view of depth.
void split_surfaces(const Input& in, const Output& out, int64_t at, int64_t count, Motion& motion) {
    const float* surface = in.surface + 2 * at;
    float padded[2 * (CHUNK + 8)], depth[CHUNK + 8];
    if (count % 8 != 0) {
        memcpy(padded, surface, sizeof(float) * static_cast<size_t>(2 * count));
        for (int64_t k = 2 * count; k < 2 * count + 16; k++) padded[k] = 0.0f;
        surface = padded;
    }
    const f8 infinite = splat(__builtin_inff());
    for (int64_t k = 0; k < count; k += 8) {
        const f8 low = load(surface + 2 * k), high = load(surface + 2 * k + 8);
        const f8 seen = SHUFFLE(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
        const f8 id = SHUFFLE(low, high, 1, 3, 5, 7, 9, 11, 13, 15);
        const i8 beyond = seen > in.lens.far_m;
        const f8 z = beyond ? infinite : seen;
        store(motion.z + k, z);
        store(motion.key + k, beyond ? splat(-1.0f) : id);
        store(depth + k, z < in.lens.near_m ? splat(NOT_A_NUMBER) : z);
    }
    memcpy(out.depth + at, depth, sizeof(float) * static_cast<size_t>(count));
}

// Displacement over the focal length of neighbours in a row of the picture that move alike. Steps
// of eight may go beyond `end`: whoever comes next writes there again.
void move_run(const Input& in, const double* m, bool has_past, int64_t column, double y,
              bool keeps_place, int64_t first, int64_t end, Motion& motion) {
    const double near_m = in.lens.near_m;
    const double y_x = m[1] * y, y_y = m[5] * y, y_z = m[9] * y;
    const d8 zero = {}, one = zero + 1.0;
    const f8 unknown = splat(NOT_A_NUMBER);
    for (int64_t k = first; k < end; k += 8) {
        const d8 z = __builtin_convertvector(load(motion.z + k), d8);
        const d8 x = *reinterpret_cast<const d8_any*>(in.columns + column + k);
        const l8 at_infinity = z == INFINITE;
        const d8 reach = at_infinity ? one : z, shift = at_infinity ? zero : one;
        const d8 dx = reach * (m[0] * x + y_x + m[2]) + shift * m[3];
        const d8 dy = reach * (m[4] * x + y_y + m[6]) + shift * m[7];
        const d8 dz = reach * (m[8] * x + y_z + m[10]) + shift * m[11];
        const d8 z_past = reach + dz;
        const d8 u = (x * dz - dx) / z_past, v = (y * dz - dy) / z_past;
        l8 valid = (z_past > 0.0) & ~(z < near_m);
        if (!has_past) valid = l8{};
        const i8 known = __builtin_convertvector(valid, i8);
        for (int64_t j = 0; j < 8; j++) motion.valid[k + j] = static_cast<uint8_t>(known[j] & 1);
        const f8 fu = known ? __builtin_convertvector(in.scale * u, f8) : unknown;
        const f8 fv = known ? __builtin_convertvector(in.scale * v, f8) : unknown;
        store(motion.flow + 2 * k, SHUFFLE(fu, fv, 0, 8, 1, 9, 2, 10, 3, 11));
        store(motion.flow + 2 * k + 8, SHUFFLE(fu, fv, 4, 12, 5, 13, 6, 14, 7, 15));
        if (!keeps_place) continue;
        const d8 infinite = zero + INFINITE;
        *reinterpret_cast<d8_any*>(motion.u + k) = u;
        *reinterpret_cast<d8_any*>(motion.v + k) = v;
        *reinterpret_cast<d8_any*>(motion.z_past + k) = at_infinity ? infinite : z_past;
    }
}

// Tells if a point at (u, v), depth z of the previous frame was not visible there.
bool is_hidden(const Input& in, double u, double v, double z) {
    if (!(u >= -0.5 && u <= in.past_width - 0.5 && v >= -0.5 && v <= in.past_height - 0.5)) {
        return true;
    }
    const double least = z * (1.0 - in.tolerance);
    const auto clamped = [](double place, int64_t size) {
        const int64_t whole = static_cast<int64_t>(place);
        return whole < 0 ? 0 : whole < size ? whole : size - 1;
    };
    const auto was_seen = [&](int64_t row, int64_t column) {
        const double seen = in.past_depth[row * in.past_width + column];
        return seen == z || seen > least;
    };
    // Within rounding of a pixel's centre that pixel alone decides, so a still picture agrees with
    // itself; between centres any of the four around may have seen the point. Mostly the first has.
    const int64_t left = clamped(std::floor(u + ROUNDING_PX), in.past_width);
    const int64_t upper = clamped(std::floor(v + ROUNDING_PX), in.past_height);
    if (was_seen(upper, left)) return false;
    const int64_t right = clamped(std::ceil(u - ROUNDING_PX), in.past_width);
    if (was_seen(upper, right)) return false;
    const int64_t lower = clamped(std::ceil(v - ROUNDING_PX), in.past_height);
    return !was_seen(lower, left) && !was_seen(lower, right);
}

void annotate_chunk(const Input& in, const Output& out, int64_t v, int64_t u, int64_t count) {
    const int64_t at = v * in.width + u;
    Motion motion;
    split_surfaces(in, out, at, count, motion);
    const bool moves = out.flow != nullptr || out.flow_valid != nullptr || out.occlusion != nullptr;
    const double y = (static_cast<double>(v) - in.lens.cy) / in.lens.focal;
    for (int64_t first = 0; first < count;) {
        const float key = motion.key[first];
        int64_t end = first + 1;
        while (end + 8 <= count && !any(load(motion.key + end) != key)) end += 8;
        while (end < count && motion.key[end] == key) end++;
        // What is no id counts as no instance.
        const bool known = key >= 0.0f && key < INSTANCES;
        const int32_t id = known ? static_cast<int32_t>(key) : 0;
        const size_t length = static_cast<size_t>(end - first);
        if (out.category != nullptr) {
            memset(out.category + at + first, in.category_of_instance[id], length);
        }
        if (out.instance != nullptr) {
            for (int64_t k = first; k < end; k++) {
                out.instance[at + k] = static_cast<uint16_t>(id);
            }
        }
        if (moves) {
            const uint16_t asked = in.row_of_instance[id];
            const uint16_t row = asked < in.motion_count ? asked : uint16_t{0};
            move_run(in, in.motions + 12 * row, row != 0, u, y, out.occlusion != nullptr, first,
                     end, motion);
        }
        first = end;
    }
    if (out.flow != nullptr) {
        memcpy(out.flow + 2 * at, motion.flow, sizeof(float) * static_cast<size_t>(2 * count));
    }
    if (out.flow_valid != nullptr) {
        memcpy(out.flow_valid + at, motion.valid, static_cast<size_t>(count));
    }
    if (out.occlusion != nullptr) {
        for (int64_t k = 0; k < count; k++) {
            out.occlusion[at + k] =
                !motion.valid[k] ||
                is_hidden(in, static_cast<double>(u + k) - in.lens.focal * motion.u[k],
                          static_cast<double>(v) - in.lens.focal * motion.v[k], motion.z_past[k]);
        }
    }
}

}  // namespace

SAILENV_KERNEL(annotate)
(int64_t threads, int64_t height, int64_t width, const float* surface,
 const uint8_t* category_of_instance, const uint16_t* row_of_instance, const double* motions,
 int64_t motion_count, const double* lens, double scale, double tolerance, const float* past_depth,
 int64_t past_height, int64_t past_width, float* depth, uint8_t* category, uint16_t* instance,
 float* flow, uint8_t* flow_valid, uint8_t* occlusion) {
    if (height < 0 || width < 0 || motion_count < 1) return sailenv::STATUS_INVALID_ARGUMENT;
    if (past_depth == nullptr) past_height = past_width = 0;
    const auto columns = sailenv::allocate<double>(width + 8);
    if (!columns) return sailenv::STATUS_OUT_OF_MEMORY;
    for (int64_t u = 0; u < width + 8; u++) {
        columns[u] = (static_cast<double>(static_cast<int32_t>(u)) - lens[1]) / lens[0];
    }
    const Input in{width,
                   surface,
                   category_of_instance,
                   row_of_instance,
                   motions,
                   motion_count,
                   {lens[0], lens[1], lens[2], -sailenv::rounded_down(-lens[3]),
                    sailenv::rounded_down(lens[4])},
                   columns.get(),
                   scale,
                   tolerance,
                   past_depth,
                   past_width,
                   past_height};
    const Output out{depth, category, instance, flow, flow_valid, occlusion};
    sailenv::parallel_for(threads, height, TILE_ROWS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t v = first; v < last; v++) {
            for (int64_t u = 0; u < width; u += CHUNK) {
                annotate_chunk(in, out, v, u, u + CHUNK < width ? CHUNK : width - u);
            }
        }
    });
    return sailenv::STATUS_OK;
}
