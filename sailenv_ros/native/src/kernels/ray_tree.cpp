// Trees of boxes for rays.
#include <algorithm>
#include <cmath>
#include <new>
#include <vector>

#include "../abi.h"
#include "rays.h"
#include "record.h"

#define REFIT_FIELDS(FIELD)                                                               \
    FIELD(int64_t, nodes_count)                                                           \
    FIELD(int64_t, leaves)                                                                \
    FIELD(int64_t, triangles)                                                             \
    FIELD(int64_t, vertices)                                                              \
    FIELD(const float*, positions)    /* (V, 3) */                                        \
    FIELD(const uint32_t*, vertex_of) /* (T, 3): the corners of each triangle */          \
    FIELD(const int32_t*, order)      /* (L, WIDTH) */                                    \
    FIELD(sailenv::TreeNode*, nodes)  /* (N,): their children are read, planes written */ \
    FIELD(double*, corners)           /* (T, 3, 3) */                                     \
    FIELD(double*, blocks)            /* (L, 9, WIDTH): as RayShape::triangles */

SAILENV_RECORD(Refit, refit_tree, REFIT_FIELDS)

namespace sailenv {
namespace {

constexpr int32_t BINS = 16;
// Nodes below this depth get halves of equal numbers, so that none is too deep.
constexpr int32_t SPLIT_EVENLY_BELOW = 40;
constexpr double ROUNDING = 2.4e-7;  // of boxes, by their largest coordinate

struct Box {
    float low[3] = {3e38f, 3e38f, 3e38f}, high[3] = {-3e38f, -3e38f, -3e38f};
    void add(const Box& other) {
        for (int k = 0; k < 3; k++) {
            low[k] = std::min(low[k], other.low[k]);
            high[k] = std::max(high[k], other.high[k]);
        }
    }
    float middle(int k) const { return 0.5f * low[k] + 0.5f * high[k]; }
    float area() const {
        const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
        return x < 0.0f ? 0.0f : x * y + y * z + z * x;
    }
};

// A node with two children, `first` and the one behind it, or a leaf of `count` things.
struct BinaryNode {
    Box box;
    int32_t first, count;
};

class Builder {
public:
    Builder(int32_t count, int32_t leaf, const double* boxes) : leaf_(leaf), boxes_(count) {
        order_.resize(static_cast<size_t>(count));
        for (int32_t i = 0; i < count; i++) {
            order_[i] = i;
            for (int k = 0; k < 3; k++) {
                const double low = boxes[6 * int64_t{i} + k], high = boxes[6 * int64_t{i} + 3 + k];
                const double margin = ROUNDING * std::max(std::fabs(low), std::fabs(high));
                boxes_[i].low[k] = static_cast<float>(std::max(low - margin, -3e38));
                boxes_[i].high[k] = static_cast<float>(std::min(high + margin, 3e38));
            }
        }
        split();
    }

    // Joins nodes until they have eight children.
    void write(TreeNode* nodes, int32_t* order, int64_t* made) const {
        struct Joined {
            int32_t from, node;
        };
        std::vector<Joined> tasks = {{0, 0}};
        int32_t used = 1, leaves = 0;
        while (!tasks.empty()) {
            const Joined task = tasks.back();
            tasks.pop_back();
            int32_t children[WIDTH] = {task.from};
            int count = 1;
            while (count < WIDTH) {
                int widest = -1;
                for (int k = 0; k < count; k++) {
                    if (binary_[children[k]].count > 0) continue;
                    if (widest < 0 ||
                        binary_[children[k]].box.area() > binary_[children[widest]].box.area()) {
                        widest = k;
                    }
                }
                if (widest < 0) break;
                const int32_t first = binary_[children[widest]].first;
                children[widest] = first;
                children[count++] = first + 1;
            }
            TreeNode& node = nodes[task.node];
            for (int k = 0; k < WIDTH; k++) {
                const BinaryNode* own = k < count ? &binary_[children[k]] : nullptr;
                for (int axis = 0; axis < 3; axis++) {
                    node.planes[axis][k] = own == nullptr ? 3e38f : own->box.low[axis];
                    node.planes[3 + axis][k] = own == nullptr ? -3e38f : own->box.high[axis];
                }
                node.children[k] = 0;
                if (own == nullptr) continue;
                if (own->count == 0) {
                    node.children[k] = used;
                    tasks.push_back({children[k], used++});
                    continue;
                }
                node.children[k] = ~leaves;
                int32_t* slots = order + int64_t{leaf_} * leaves++;
                for (int32_t i = 0; i < leaf_; i++) {
                    slots[i] = i < own->count ? order_[own->first + i] : -1;
                }
            }
        }
        made[0] = used;
        made[1] = leaves;
    }

private:
    struct Task {
        int32_t node, first, count, depth;
    };

    // By the surface area heuristic, in bins (Wald 2007).
    void split() {
        binary_.push_back({});
        std::vector<Task> tasks = {{0, 0, static_cast<int32_t>(order_.size()), 0}};
        while (!tasks.empty()) {
            const Task t = tasks.back();
            tasks.pop_back();
            Box whole;
            for (int32_t i = t.first; i < t.first + t.count; i++) whole.add(boxes_[order_[i]]);
            const bool is_leaf = t.count <= leaf_;
            const int32_t first = is_leaf ? t.first : static_cast<int32_t>(binary_.size());
            binary_[t.node] = {whole, first, is_leaf ? t.count : 0};
            if (is_leaf) continue;
            const int32_t left = t.depth < SPLIT_EVENLY_BELOW ? partition(t) : t.count / 2;
            binary_.push_back({});
            binary_.push_back({});
            tasks.push_back({first, t.first, left, t.depth + 1});
            tasks.push_back({first + 1, t.first + left, t.count - left, t.depth + 1});
        }
    }

    float cost(const Box& box, int32_t count) const {
        return box.area() * static_cast<float>((count + leaf_ - 1) / leaf_);
    }

    // Sorts things into two sides; returns how many are in the first.
    int32_t partition(const Task& t) {
        float low[3] = {3e38f, 3e38f, 3e38f}, high[3] = {-3e38f, -3e38f, -3e38f};
        for (int32_t i = t.first; i < t.first + t.count; i++) {
            for (int k = 0; k < 3; k++) {
                low[k] = std::min(low[k], boxes_[order_[i]].middle(k));
                high[k] = std::max(high[k], boxes_[order_[i]].middle(k));
            }
        }
        float best = 3e38f;
        int axis = -1, cut = 0;
        for (int k = 0; k < 3; k++) {
            if (!(high[k] > low[k])) continue;
            Box box[BINS];
            int32_t number[BINS] = {};
            for (int32_t i = t.first; i < t.first + t.count; i++) {
                const int bin = bin_of(order_[i], k, low[k], high[k]);
                box[bin].add(boxes_[order_[i]]);
                number[bin]++;
            }
            float right_cost[BINS];
            Box right, left;
            int32_t right_number = 0, left_number = 0;
            for (int j = BINS - 1; j > 0; j--) {
                right.add(box[j]);
                right_number += number[j];
                right_cost[j] = cost(right, right_number);
            }
            for (int j = 0; j + 1 < BINS; j++) {
                left.add(box[j]);
                left_number += number[j];
                if (left_number == 0 || left_number == t.count) continue;
                const float both = cost(left, left_number) + right_cost[j + 1];
                if (both < best) {
                    best = both;
                    axis = k;
                    cut = j;
                }
            }
        }
        // All in one place: halves are as good as anything.
        if (axis < 0) return t.count / 2;
        int32_t* begin = order_.data() + t.first;
        const int32_t* middle = std::stable_partition(begin, begin + t.count, [&](int32_t i) {
            return bin_of(i, axis, low[axis], high[axis]) <= cut;
        });
        return static_cast<int32_t>(middle - begin);
    }

    int bin_of(int32_t i, int axis, float low, float high) const {
        const float share = (boxes_[i].middle(axis) - low) / (high - low);
        // What is not a number comes of boxes without end.
        return share > 0.0f ? std::min(static_cast<int>(share * BINS), BINS - 1) : 0;
    }

    int32_t leaf_;
    std::vector<Box> boxes_;
    std::vector<int32_t> order_;
    std::vector<BinaryNode> binary_;
};

}  // namespace
}  // namespace sailenv

// Builds a tree over boxes. boxes: (count, 6), low and high; leaf: the most things in a leaf;
// nodes: (max(count, 1),); order: (count, leaf), the things in each leaf, then -1; made: (2,), how
// many nodes and leaves there are.
SAILENV_KERNEL(build_tree)
(int64_t count, int64_t leaf, const double* boxes, sailenv::TreeNode* nodes, int32_t* order,
 int64_t* made) {
    using namespace sailenv;
    if (count < 0 || count > (1 << 26) || leaf < 1 || leaf > WIDTH) return STATUS_INVALID_ARGUMENT;
    for (int64_t i = 0; i < 6 * count; i++) {
        if (!std::isfinite(boxes[i])) return STATUS_INVALID_ARGUMENT;
    }
    if (count == 0) {
        for (int k = 0; k < WIDTH; k++) {
            for (int axis = 0; axis < 3; axis++) {
                nodes[0].planes[axis][k] = 3e38f;
                nodes[0].planes[3 + axis][k] = -3e38f;
            }
            nodes[0].children[k] = 0;
        }
        made[0] = 1;
        made[1] = 0;
        return STATUS_OK;
    }
    try {
        const Builder builder(static_cast<int32_t>(count), static_cast<int32_t>(leaf), boxes);
        builder.write(nodes, order, made);
    } catch (const std::bad_alloc&) {
        return STATUS_OUT_OF_MEMORY;
    }
    return STATUS_OK;
}

// Fits the boxes of a tree around triangles whose corners have moved.
SAILENV_KERNEL(refit_tree)(int64_t, const Refit* given) {
    using namespace sailenv;
    const Refit in = *given;
    if (in.nodes_count < 1 || in.leaves < 0 || in.triangles < 0) return STATUS_INVALID_ARGUMENT;
    for (int64_t k = 0; k < 3 * in.triangles; k++) {
        if (in.vertex_of[k] >= in.vertices) return STATUS_INVALID_ARGUMENT;
        for (int j = 0; j < 3; j++) {
            const double x = in.positions[3 * int64_t{in.vertex_of[k]} + j];
            if (!std::isfinite(x)) return STATUS_INVALID_ARGUMENT;
            in.corners[3 * k + j] = x;
        }
    }
    for (int64_t k = 0; k < WIDTH * in.leaves; k++) {
        if (in.order[k] < -1 || in.order[k] >= in.triangles) return STATUS_INVALID_ARGUMENT;
    }
    for (int64_t leaf = 0; leaf < in.leaves; leaf++) {
        double* block = in.blocks + 9 * WIDTH * leaf;
        for (int k = 0; k < WIDTH; k++) {
            const int64_t triangle = in.order[WIDTH * leaf + k];
            for (int j = 0; j < 9; j++) {
                const double* from = in.corners + 9 * triangle;
                const double x = triangle < 0 ? 0.0 : j < 3 ? from[j] : from[j] - from[j % 3];
                block[WIDTH * j + k] = x;
            }
        }
    }
    // Children have higher numbers than the nodes that they are in.
    for (int64_t number = in.nodes_count - 1; number >= 0; number--) {
        TreeNode& node = in.nodes[number];
        for (int k = 0; k < WIDTH; k++) {
            const int32_t child = node.children[k];
            if (child == 0) continue;
            Box box;
            if (child > 0) {
                if (child <= number || child >= in.nodes_count) return STATUS_INVALID_ARGUMENT;
                const TreeNode& below = in.nodes[child];
                for (int j = 0; j < WIDTH; j++) {
                    if (below.children[j] == 0) continue;
                    for (int axis = 0; axis < 3; axis++) {
                        box.low[axis] = std::min(box.low[axis], below.planes[axis][j]);
                        box.high[axis] = std::max(box.high[axis], below.planes[3 + axis][j]);
                    }
                }
            } else {
                if (~child >= in.leaves) return STATUS_INVALID_ARGUMENT;
                for (int j = 0; j < WIDTH; j++) {
                    const int64_t triangle = in.order[WIDTH * int64_t{~child} + j];
                    if (triangle < 0) continue;
                    for (int m = 0; m < 9; m++) {
                        const double x = in.corners[9 * triangle + m];
                        const double margin = ROUNDING * std::fabs(x);
                        const int axis = m % 3;
                        box.low[axis] = std::min(box.low[axis], static_cast<float>(x - margin));
                        box.high[axis] = std::max(box.high[axis], static_cast<float>(x + margin));
                    }
                }
            }
            for (int axis = 0; axis < 3; axis++) {
                node.planes[axis][k] = box.low[axis];
                node.planes[3 + axis][k] = box.high[axis];
            }
        }
    }
    return STATUS_OK;
}
