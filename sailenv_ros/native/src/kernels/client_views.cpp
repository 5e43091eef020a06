// From a frame's views to the arrays that the SAILenv client's dict holds; see agent/frame_dict.py.
#include "../abi.h"
#include "../threads.h"
#include "lanes.h"

namespace {

constexpr int64_t TILE = 16384;  // pixels

// 255 up to the near plane, linearly down to 0; what is too near is no number, and counts as near.
void set_grey(const float* __restrict depth, int64_t count, float range_m, float scale,
              uint8_t* __restrict grey) {
    for (int64_t k = 0; k < count; k++) {
        const float level = (range_m - depth[k]) * scale + 0.5f;
        const float low = level < 255.0f ? level : 255.0f;
        grey[k] = static_cast<uint8_t>(static_cast<int32_t>(low > 0.0f ? low : 0.0f));
    }
}

void set_colours(const uint16_t* __restrict ids, int64_t count, const uint32_t* __restrict colours,
                 int64_t last_colour, uint8_t* __restrict out) {
    const auto colour_of = [&](int64_t k) {
        return colours[ids[k] < last_colour ? ids[k] : last_colour];
    };
    // Four bytes at a time, of which the next pixel overwrites the last.
    for (int64_t k = 0; k + 1 < count; k++) {
        const uint32_t colour = colour_of(k);
        memcpy(out + 3 * k, &colour, 4);
    }
    const uint32_t colour = colour_of(count - 1);
    memcpy(out + 3 * (count - 1), &colour, 3);
}

void fill_flow(float* __restrict flow, int64_t count, uint8_t* __restrict valid) {
    for (int64_t k = 0; k < count; k++) {
        const float u = flow[2 * k], v = flow[2 * k + 1];
        valid[k] = u == u;
        flow[2 * k] = u == u ? u : 0.0f;
        flow[2 * k + 1] = u == u ? v : 0.0f;
    }
}

}  // namespace

// `count` pixels. Of each pair of pointers both may be null. `grey` is 255 up to `near_m`, linearly
// down to 0 at `range_m`. `colours` has `colour_count` numbers, whose first three bytes are a
// colour; larger ids have the last. Flow that is no number becomes 0, in its place.
SAILENV_KERNEL(client_views)
(int64_t threads, int64_t count, const float* depth, uint8_t* grey, double range_m, double scale,
 const uint16_t* ids, uint8_t* id_colours, const uint32_t* colours, int64_t colour_count,
 float* flow, uint8_t* flow_valid) {
    if (count < 0 || colour_count < 1) return sailenv::STATUS_INVALID_ARGUMENT;
    const int64_t last_colour = colour_count - 1;
    const float range = static_cast<float>(range_m), per_m = static_cast<float>(scale);
    sailenv::parallel_for(threads, count, TILE, [&](int64_t first, int64_t last, int64_t) {
        const int64_t size = last - first;
        if (depth != nullptr) set_grey(depth + first, size, range, per_m, grey + first);
        if (ids != nullptr) {
            set_colours(ids + first, size, colours, last_colour, id_colours + 3 * first);
        }
        if (flow != nullptr) fill_flow(flow + 2 * first, size, flow_valid + first);
    });
    return sailenv::STATUS_OK;
}
