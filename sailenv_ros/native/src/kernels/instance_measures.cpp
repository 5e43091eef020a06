// Pixels, box and mean flow of each instance of a picture, in one pass over its ids; see
// object_truth/visible_parts.py.
#include "../abi.h"
#include "lanes.h"

namespace {

constexpr int64_t INSTANCES = 65536;
constexpr double STEPS = 1048576.0;  // per px/s: sums of whole steps do not depend on their order
constexpr float GREATEST = 1e7f;     // px/s; what is not less is no flow

// The first pixel of a row, from `first` on, that has another id.
LANES_INLINE int64_t run_end(const uint16_t* ids, int64_t first, int64_t width) {
    const uint64_t four = ids[first] * 0x0001000100010001ull;
    int64_t u = first + 1;
    for (; u + 4 <= width; u += 4) {
        uint64_t next;
        memcpy(&next, ids + u, sizeof next);
        if (next != four) break;
    }
    while (u < width && ids[u] == ids[first]) u++;
    return u;
}

LANES_INLINE int64_t steps_of(float speed) {
    const double scaled = speed * STEPS;
    return static_cast<int64_t>(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
}

// Adds flow up: steps of u, steps of v, number of pixels that have any.
void add_flow(const float* flow, int64_t count, int64_t* sums) {
    int64_t u = 0, v = 0, known = 0;
    for (int64_t k = 0; k < count; k++) {
        const float a = flow[2 * k], b = flow[2 * k + 1];
        const bool there = a > -GREATEST && a < GREATEST && b > -GREATEST && b < GREATEST;
        u += there ? steps_of(a) : 0;
        v += there ? steps_of(b) : 0;
        known += there;
    }
    sums[0] += u;
    sums[1] += v;
    sums[2] += known;
}

}  // namespace

// `counts` (65536,) is 0 at first and takes the pixels of each id. `boxes` (65536, 4) takes left,
// top, right, bottom (the last ones included) of each id that there is, and `sums` (65536, 3) its
// flow; `flow` (height, width, 2) may be null, and then `sums` too. `seen` (65536,) takes the ids
// that there are, in the order in which they are found, 0 among them; `seen_count` (1,) how many.
SAILENV_KERNEL(measure_instances)
(int64_t height, int64_t width, const uint16_t* ids, const float* flow, int32_t* counts,
 int32_t* boxes, int64_t* sums, uint16_t* seen, int64_t* seen_count) {
    if (height < 0 || width < 0 || height * width > 0x7fffffff) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    int64_t found = 0;
    for (int64_t v = 0; v < height; v++) {
        const uint16_t* row = ids + v * width;
        for (int64_t u = 0; u < width;) {
            const int64_t end = run_end(row, u, width);
            const int64_t id = row[u];
            int32_t* box = boxes + 4 * id;
            const int32_t left = static_cast<int32_t>(u), right = static_cast<int32_t>(end - 1);
            if (counts[id] == 0 && found < INSTANCES) {
                seen[found++] = static_cast<uint16_t>(id);
                box[0] = left;
                box[1] = static_cast<int32_t>(v);
                box[2] = right;
                if (flow != nullptr) sums[3 * id] = sums[3 * id + 1] = sums[3 * id + 2] = 0;
            }
            counts[id] += static_cast<int32_t>(end - u);
            box[0] = left < box[0] ? left : box[0];
            box[2] = right > box[2] ? right : box[2];
            box[3] = static_cast<int32_t>(v);
            if (flow != nullptr && id != 0) {
                add_flow(flow + 2 * (v * width + u), end - u, sums + 3 * id);
            }
            u = end;
        }
    }
    *seen_count = found;
    return sailenv::STATUS_OK;
}
