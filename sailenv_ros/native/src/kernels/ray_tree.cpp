// Trees of boxes for rays.
#include <algorithm>
#include <cmath>

#include "../abi.h"
#include "ray_types.h"

namespace sailenv {
namespace {

constexpr int32_t LEAF = 4;
constexpr int32_t BINS = 12;
constexpr int32_t DEEPEST = 56;  // leaves below it take what is left; walk_tree's stack holds it

struct Box {
    float low[3] = {3e38f, 3e38f, 3e38f}, high[3] = {-3e38f, -3e38f, -3e38f};
    void add(const float* low_of, const float* high_of) {
        for (int k = 0; k < 3; k++) {
            low[k] = std::min(low[k], low_of[k]);
            high[k] = std::max(high[k], high_of[k]);
        }
    }
    float area() const {
        const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
        return x < 0.0f ? 0.0f : x * y + y * z + z * x;
    }
};

}  // namespace
}  // namespace sailenv

// Builds a tree over boxes by the surface area heuristic, in bins (Wald 2007).
// boxes: (count, 6), low and high; nodes: (2 count, ...) TreeNode; order: (count,), the boxes in
// the order of the leaves; made: (1,), how many nodes there are.
SAILENV_KERNEL(build_box_tree)
(int64_t count, const float* boxes, sailenv::TreeNode* nodes, int32_t* order, int64_t* made) {
    using namespace sailenv;
    if (count < 1 || count > (1 << 28)) return STATUS_INVALID_ARGUMENT;
    for (int64_t i = 0; i < 6 * count; i++) {
        if (!std::isfinite(boxes[i])) return STATUS_INVALID_ARGUMENT;
    }
    for (int32_t i = 0; i < count; i++) order[i] = i;
    struct Task {
        int32_t node, first, count, depth;
    } stack[2 * DEEPEST + 8];
    int32_t tasks = 0, used = 1;
    stack[tasks++] = {0, 0, static_cast<int32_t>(count), 0};
    while (tasks > 0) {
        const Task t = stack[--tasks];
        Box whole, middles;
        for (int32_t i = t.first; i < t.first + t.count; i++) {
            const float* b = boxes + 6 * static_cast<int64_t>(order[i]);
            whole.add(b, b + 3);
            float middle[3];
            for (int k = 0; k < 3; k++) middle[k] = 0.5f * b[k] + 0.5f * b[k + 3];
            middles.add(middle, middle);
        }
        TreeNode& n = nodes[t.node];
        for (int k = 0; k < 3; k++) {
            n.low[k] = whole.low[k];
            n.high[k] = whole.high[k];
        }
        n.first = t.first;
        n.count = t.count;
        if (t.count <= LEAF || t.depth >= DEEPEST) continue;
        float best = 3e38f;
        int axis = -1;
        int32_t cut = 0;
        for (int k = 0; k < 3; k++) {
            const float size = middles.high[k] - middles.low[k];
            if (!(size > 0.0f)) continue;
            const float scale = BINS * 0.9999f / size;
            Box box[BINS];
            int32_t number[BINS] = {};
            for (int32_t i = t.first; i < t.first + t.count; i++) {
                const float* b = boxes + 6 * static_cast<int64_t>(order[i]);
                const float at = 0.5f * b[k] + 0.5f * b[k + 3] - middles.low[k];
                const int32_t bin =
                    std::min(std::max(static_cast<int32_t>(at * scale), 0), BINS - 1);
                box[bin].add(b, b + 3);
                number[bin]++;
            }
            float right_cost[BINS];
            Box right;
            int32_t right_number = 0;
            for (int32_t j = BINS - 1; j > 0; j--) {
                if (number[j] > 0) right.add(box[j].low, box[j].high);
                right_number += number[j];
                right_cost[j] = right.area() * static_cast<float>(right_number);
            }
            Box left;
            int32_t left_number = 0;
            for (int32_t j = 0; j + 1 < BINS; j++) {
                if (number[j] > 0) left.add(box[j].low, box[j].high);
                left_number += number[j];
                if (left_number == 0 || left_number == t.count) continue;
                const float cost =
                    left.area() * static_cast<float>(left_number) + right_cost[j + 1];
                if (cost < best) {
                    best = cost;
                    axis = k;
                    cut = j;
                }
            }
        }
        if (axis < 0) {
            if (t.count <= 16) continue;
            // All in one place: halves are as good as anything.
            const int32_t half = t.count / 2;
            n.first = used;
            n.count = 0;
            stack[tasks++] = {used + 1, t.first + half, t.count - half, t.depth + 1};
            stack[tasks++] = {used, t.first, half, t.depth + 1};
            used += 2;
            continue;
        }
        const float scale = BINS * 0.9999f / (middles.high[axis] - middles.low[axis]);
        int32_t* begin = order + t.first;
        int32_t* middle = std::stable_partition(begin, begin + t.count, [&](int32_t i) {
            const float* b = boxes + 6 * static_cast<int64_t>(i);
            const float at = 0.5f * b[axis] + 0.5f * b[axis + 3] - middles.low[axis];
            return std::min(std::max(static_cast<int32_t>(at * scale), 0), BINS - 1) <= cut;
        });
        const int32_t left = static_cast<int32_t>(middle - begin);
        n.first = used;
        n.count = 0;
        // The smaller side first, so that the stack stays short.
        const Task one = {used, t.first, left, t.depth + 1};
        const Task two = {used + 1, t.first + left, t.count - left, t.depth + 1};
        stack[tasks++] = left > t.count - left ? one : two;
        stack[tasks++] = left > t.count - left ? two : one;
        used += 2;
    }
    *made = used;
    return STATUS_OK;
}
