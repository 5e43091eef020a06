// From depth and instance id of each pixel to the ground-truth views; see render/annotate.py, which
// says what each view is. All in double precision.
#include <cmath>
#include <limits>

#include "../abi.h"
#include "../threads.h"

namespace {

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr float NOT_A_NUMBER = std::numeric_limits<float>::quiet_NaN();
constexpr int64_t CHUNK = 256;  // pixels whose intermediate results stay in the first-level cache
constexpr int64_t TILE_ROWS = 16;
constexpr int64_t INSTANCES = 65536;
constexpr double ROUNDING_PX = 1e-3;

struct Lens {
    double focal, cx, cy, near_m, far_m;
};

struct Input {
    int64_t width;
    const float* surface;                 // (H, W, 2): depth [m], instance id
    const uint8_t* category_of_instance;  // (65536,)
    const uint16_t* row_of_instance;      // (65536,), 0 where there is no past
    const double* motions;                // (R, 3, 4)
    int64_t motion_count;
    Lens lens;
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

// What flow and occlusion share, of the pixels of a chunk.
struct Motion {
    double z[CHUNK];  // depth now, infinite beyond far
    double x[CHUNK];  // the ray's x at depth 1
    double u[CHUNK], v[CHUNK], z_past[CHUNK];
    uint16_t row[CHUNK];
    uint8_t valid[CHUNK];
};

// Sets everything that needs a pixel's surface alone.
void annotate_surfaces(const Input& in, const Output& out, int64_t at, int64_t count,
                       Motion& motion) {
    const float* surface = in.surface + 2 * at;
    for (int64_t k = 0; k < count; k++) {
        const double seen = surface[2 * k];
        motion.z[k] = seen > in.lens.far_m ? INFINITE : seen;
        // Of double numbers, as the test for the far plane: `far_m` need not be a float.
        out.depth[at + k] =
            motion.z[k] < in.lens.near_m ? NOT_A_NUMBER : static_cast<float>(motion.z[k]);
    }
    for (int64_t first = 0; first < count;) {
        const float id_number = surface[2 * first + 1];
        const bool beyond = surface[2 * first] > in.lens.far_m;
        int64_t end = first + 1;
        if (beyond) {
            while (end < count && surface[2 * end] > in.lens.far_m) end++;
        } else {
            while (end < count && surface[2 * end + 1] == id_number &&
                   !(surface[2 * end] > in.lens.far_m)) {
                end++;
            }
        }
        // What is no id counts as no instance.
        const bool known = !beyond && id_number >= 0.0f && id_number < INSTANCES;
        const int32_t id = known ? static_cast<int32_t>(id_number) : 0;
        if (out.category != nullptr) {
            const uint8_t category = in.category_of_instance[id];
            for (int64_t k = first; k < end; k++) out.category[at + k] = category;
        }
        if (out.instance != nullptr) {
            for (int64_t k = first; k < end; k++) {
                out.instance[at + k] = static_cast<uint16_t>(id);
            }
        }
        const uint16_t row = in.row_of_instance[id];
        for (int64_t k = first; k < end; k++) {
            motion.row[k] = row < in.motion_count ? row : uint16_t{0};
        }
        first = end;
    }
}

// Displacement over the focal length of neighbours in a row of the picture that move alike.
void move_run(const double* m, bool has_past, double y, double near_m, int64_t first, int64_t end,
              Motion& motion) {
    for (int64_t k = first; k < end; k++) {
        const double z = motion.z[k], x = motion.x[k];
        const bool at_infinity = z == INFINITE;
        const double reach = at_infinity ? 1.0 : z;
        const double shift = at_infinity ? 0.0 : 1.0;
        const double dx = reach * (m[0] * x + m[1] * y + m[2]) + shift * m[3];
        const double dy = reach * (m[4] * x + m[5] * y + m[6]) + shift * m[7];
        const double dz = reach * (m[8] * x + m[9] * y + m[10]) + shift * m[11];
        const double z_past = reach + dz;
        motion.valid[k] = has_past & (z_past > 0.0) & !(z < near_m);
        motion.u[k] = (x * dz - dx) / z_past;
        motion.v[k] = (y * dz - dy) / z_past;
        motion.z_past[k] = at_infinity ? INFINITE : z_past;
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
    // Within rounding of a pixel's centre that pixel alone decides, so a still picture agrees with
    // itself; between centres any of the four around may have seen the point.
    const int64_t columns[2] = {clamped(std::floor(u + ROUNDING_PX), in.past_width),
                                clamped(std::ceil(u - ROUNDING_PX), in.past_width)};
    const int64_t rows[2] = {clamped(std::floor(v + ROUNDING_PX), in.past_height),
                             clamped(std::ceil(v - ROUNDING_PX), in.past_height)};
    for (const int64_t row : rows) {
        for (const int64_t column : columns) {
            const double seen = in.past_depth[row * in.past_width + column];
            if (seen == z || seen > least) return false;
        }
    }
    return true;
}

void annotate_chunk(const Input& in, const Output& out, int64_t v, int64_t u, int64_t count) {
    const int64_t at = v * in.width + u;
    Motion motion;
    annotate_surfaces(in, out, at, count, motion);
    if (out.flow == nullptr && out.flow_valid == nullptr && out.occlusion == nullptr) return;
    const double y = (static_cast<double>(v) - in.lens.cy) / in.lens.focal;
    for (int64_t k = 0; k < count; k++) {
        motion.x[k] =
            (static_cast<double>(static_cast<int32_t>(u + k)) - in.lens.cx) / in.lens.focal;
    }
    for (int64_t first = 0; first < count;) {
        const uint16_t row = motion.row[first];
        int64_t end = first + 1;
        while (end < count && motion.row[end] == row) end++;
        move_run(in.motions + 12 * row, row != 0, y, in.lens.near_m, first, end, motion);
        first = end;
    }
    if (out.flow != nullptr) {
        float* flow = out.flow + 2 * at;
        for (int64_t k = 0; k < count; k++) {
            const float fu = static_cast<float>(in.scale * motion.u[k]);
            const float fv = static_cast<float>(in.scale * motion.v[k]);
            flow[2 * k] = motion.valid[k] ? fu : NOT_A_NUMBER;
            flow[2 * k + 1] = motion.valid[k] ? fv : NOT_A_NUMBER;
        }
    }
    if (out.flow_valid != nullptr) {
        for (int64_t k = 0; k < count; k++) out.flow_valid[at + k] = motion.valid[k];
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
    const Input in{width,
                   surface,
                   category_of_instance,
                   row_of_instance,
                   motions,
                   motion_count,
                   {lens[0], lens[1], lens[2], lens[3], lens[4]},
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
