// From depth and instance number of each pixel to the views of depth, instance and category; see
// native/view_kernels.py.
#include <limits>

#include "../threads.h"
#include "clip_distances.h"
#include "lanes.h"
#include "lens.h"
#include "record.h"

#define ANNOTATE_FIELDS(FIELD)                                                    \
    FIELD(int64_t, height)                                                        \
    FIELD(int64_t, width)                                                         \
    FIELD(const float*, surface)                /* (H, W, 2): depth [m], id */    \
    FIELD(const uint8_t*, category_of_instance) /* (65536,) */                    \
    FIELD(const sailenv::Lens*, lens)                                             \
    FIELD(const float*, along) /* (H, W), or null: z of unit rays; the surface */ \
                               /* holds distances along them then */              \
    FIELD(float*, depth)                                                          \
    FIELD(float*, range)       /* or null; only beside `along` */                 \
    FIELD(uint8_t*, category)  /* or null */                                      \
    FIELD(uint16_t*, instance) /* or null */

SAILENV_RECORD(Annotate, annotate, ANNOTATE_FIELDS)

namespace {

constexpr int64_t CHUNK = 256;  // pixels whose intermediate results stay in the first-level cache
constexpr int64_t TILE_ROWS = 16;
constexpr int64_t INSTANCES = 65536;

// What is known of the pixels of a chunk; there is room for steps of eight.
struct Surfaces {
    float depth[CHUNK + 8];
    float key[CHUNK + 8];  // instance id, -1 beyond far
};

void split_surfaces(const Annotate& in, float near_m, float far_m, int64_t at, int64_t count,
                    Surfaces& found) {
    const float* surface = in.surface + 2 * at;
    float padded[2 * (CHUNK + 8)];
    if (count % 8 != 0) {
        memcpy(padded, surface, sizeof(float) * static_cast<size_t>(2 * count));
        for (int64_t k = 2 * count; k < 2 * count + 16; k++) padded[k] = 0.0f;
        surface = padded;
    }
    const f8 infinite = splat(__builtin_inff());
    const f8 unknown = splat(std::numeric_limits<float>::quiet_NaN());
    for (int64_t k = 0; k < count; k += 8) {
        const f8 low = load(surface + 2 * k), high = load(surface + 2 * k + 8);
        const f8 seen = SHUFFLE(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
        const f8 id = SHUFFLE(low, high, 1, 3, 5, 7, 9, 11, 13, 15);
        const i8 beyond = seen > far_m;
        const f8 z = beyond ? infinite : seen;
        store(found.key + k, beyond ? splat(-1.0f) : id);
        store(found.depth + k, z < near_m ? unknown : z);
    }
}

// Depths along the axis from distances along rays. Where the lens sees nothing, neither is known;
// what is infinitely far is so along the axis, too.
void set_depths(const float* along, int64_t count, Surfaces& found, float* depth) {
    for (int64_t k = 0; k < count; k++) {
        const float share = along[k], range = found.depth[k];
        if (share != share) found.depth[k] = share;
        depth[k] = share == share && range == __builtin_inff() ? range : range * share;
    }
}

void annotate_chunk(const Annotate& in, float near_m, float far_m, int64_t at, int64_t count) {
    Surfaces found;
    split_surfaces(in, near_m, far_m, at, count, found);
    const size_t size = sizeof(float) * static_cast<size_t>(count);
    if (in.along == nullptr) {
        memcpy(in.depth + at, found.depth, size);
    } else {
        set_depths(in.along + at, count, found, in.depth + at);
        if (in.range != nullptr) memcpy(in.range + at, found.depth, size);
    }
    if (in.category == nullptr && in.instance == nullptr) return;
    for (int64_t first = 0; first < count;) {
        const float key = found.key[first];
        int64_t end = first + 1;
        while (end + 8 <= count && !any(load(found.key + end) != key)) end += 8;
        while (end < count && found.key[end] == key) end++;
        // What is no id counts as no instance.
        const bool known = key >= 0.0f && key < INSTANCES;
        const int32_t id = known ? static_cast<int32_t>(key) : 0;
        if (in.category != nullptr) {
            memset(in.category + at + first, in.category_of_instance[id],
                   static_cast<size_t>(end - first));
        }
        if (in.instance != nullptr) {
            for (int64_t k = first; k < end; k++) in.instance[at + k] = static_cast<uint16_t>(id);
        }
        first = end;
    }
}

}  // namespace

SAILENV_KERNEL(annotate)(int64_t threads, const Annotate* given) {
    const Annotate in = *given;
    if (in.height < 0 || in.width < 0) return sailenv::STATUS_INVALID_ARGUMENT;
    // Of numbers of single precision: what is less than near, what is more than far.
    const float near_m = -sailenv::rounded_down(-in.lens->near_m);
    const float far_m = sailenv::rounded_down(in.lens->far_m);
    sailenv::parallel_for(threads, in.height, TILE_ROWS, [&](int64_t begin, int64_t end, int64_t) {
        for (int64_t v = begin; v < end; v++) {
            for (int64_t u = 0; u < in.width; u += CHUNK) {
                annotate_chunk(in, near_m, far_m, v * in.width + u,
                               u + CHUNK < in.width ? CHUNK : in.width - u);
            }
        }
    });
    return sailenv::STATUS_OK;
}
