// Rays against the triangles of instances: what each one meets first; see
// tests/support/reference_rays.py.
//
// All in double precision. Which triangle is met does not depend on the tree: of equal distances
// the lower instance and the lower triangle win.
#include <algorithm>
#include <cmath>
#include <limits>

#include "../abi.h"
#include "../threads.h"

namespace {

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double EDGE = 1e-9;    // how far beside a triangle its edge still counts as met
constexpr double MARGIN = 1e-7;  // of boxes, by the largest coordinate in them
constexpr int32_t LEAF = 4;      // triangles of a leaf
constexpr int32_t DEPTH = 64;    // of the stack: trees are halved, so that none is deeper
constexpr int64_t TILE_RAYS = 64;

struct Tree {
    const double* bounds;     // (K, 6): lowest and highest corner
    const int32_t* children;  // (K, 2): first child and 0, or first triangle in `order` and count
};

struct Builder {
    const double* corners;  // (M, 3, 3)
    double* bounds;
    int32_t* children;
    int32_t* order;
    int32_t used;

    double middle(int32_t triangle, int axis) const {
        const double* c = corners + 9 * static_cast<int64_t>(triangle) + axis;
        return c[0] + c[3] + c[6];
    }

    void build(int32_t node, int32_t first, int32_t count) {
        double low[3] = {INFINITE, INFINITE, INFINITE}, high[3] = {-INFINITE, -INFINITE, -INFINITE};
        double least[3] = {INFINITE, INFINITE, INFINITE},
               most[3] = {-INFINITE, -INFINITE, -INFINITE};
        for (int32_t k = first; k < first + count; k++) {
            const double* c = corners + 9 * static_cast<int64_t>(order[k]);
            for (int axis = 0; axis < 3; axis++) {
                for (int corner = 0; corner < 3; corner++) {
                    low[axis] = std::min(low[axis], c[3 * corner + axis]);
                    high[axis] = std::max(high[axis], c[3 * corner + axis]);
                }
                least[axis] = std::min(least[axis], middle(order[k], axis));
                most[axis] = std::max(most[axis], middle(order[k], axis));
            }
        }
        double* box = bounds + 6 * static_cast<int64_t>(node);
        for (int axis = 0; axis < 3; axis++) {
            const double margin = MARGIN * std::max(std::fabs(low[axis]), std::fabs(high[axis]));
            box[axis] = low[axis] - margin;
            box[3 + axis] = high[axis] + margin;
        }
        if (count <= LEAF) {
            children[2 * node] = first;
            children[2 * node + 1] = count;
            return;
        }
        int axis = 0;
        for (int other = 1; other < 3; other++) {
            if (most[other] - least[other] > most[axis] - least[axis]) axis = other;
        }
        const int32_t half = count / 2;
        std::nth_element(order + first, order + first + half, order + first + count,
                         [&](int32_t a, int32_t b) {
                             const double x = middle(a, axis), y = middle(b, axis);
                             return x < y || (x == y && a < b);
                         });
        const int32_t child = used;
        used += 2;
        children[2 * node] = child;
        children[2 * node + 1] = 0;
        build(child, first, half);
        build(child + 1, first + half, count - half);
    }
};

struct Scene {
    const double* model_from_world;  // (I, 3, 4)
    const int32_t* models;           // (I,): the model of each instance
    int64_t instances;
    const int64_t* first_node;      // (S,): of each model
    const int64_t* first_triangle;  // (S,)
    const double* bounds;
    const int32_t* children;
    const int32_t* order;
    const double* corners;     // (M, 3, 3) of all models
    const uint8_t* two_sided;  // (M,)
};

struct Hit {
    double distance, second, third;
    int64_t instance, triangle;
};

// Meets one triangle (T. Möller, B. Trumbore, "Fast, minimum storage ray-triangle intersection").
inline void meet(const double* o, const double* d, const double* c, bool both, double nearest,
                 int64_t instance, int64_t triangle, Hit& hit) {
    const double ab[3] = {c[3] - c[0], c[4] - c[1], c[5] - c[2]};
    const double ac[3] = {c[6] - c[0], c[7] - c[1], c[8] - c[2]};
    const double p[3] = {d[1] * ac[2] - d[2] * ac[1], d[2] * ac[0] - d[0] * ac[2],
                         d[0] * ac[1] - d[1] * ac[0]};
    const double determinant = ab[0] * p[0] + ab[1] * p[1] + ab[2] * p[2];
    // The side that a ray meets is the same in the model's own frame, whatever its scale.
    if (!(determinant > 0.0 || (both && determinant < 0.0))) return;
    const double ao[3] = {o[0] - c[0], o[1] - c[1], o[2] - c[2]};
    const double second = (ao[0] * p[0] + ao[1] * p[1] + ao[2] * p[2]) / determinant;
    if (!(second >= -EDGE && second <= 1.0 + EDGE)) return;
    const double q[3] = {ao[1] * ab[2] - ao[2] * ab[1], ao[2] * ab[0] - ao[0] * ab[2],
                         ao[0] * ab[1] - ao[1] * ab[0]};
    const double third = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / determinant;
    if (!(third >= -EDGE && second + third <= 1.0 + EDGE)) return;
    const double distance = (ac[0] * q[0] + ac[1] * q[1] + ac[2] * q[2]) / determinant;
    if (!(distance > nearest) || distance > hit.distance) return;
    if (distance == hit.distance &&
        (instance > hit.instance || (instance == hit.instance && triangle >= hit.triangle))) {
        return;
    }
    hit = {distance, second, third, instance, triangle};
}

inline bool touches(const double* box, const double* o, const double* inverse, double nearest,
                    double farthest) {
    double enters = nearest, leaves = farthest;
    for (int axis = 0; axis < 3; axis++) {
        const double a = (box[axis] - o[axis]) * inverse[axis];
        const double b = (box[3 + axis] - o[axis]) * inverse[axis];
        // What is no number (a ray within a side's plane) rules nothing out.
        const double first = a < b ? a : b, last = a < b ? b : a;
        if (first > enters) enters = first;
        if (last < leaves) leaves = last;
    }
    return !(enters > leaves);
}

void cast(const Scene& s, int64_t instance, const double* origin, const double* direction,
          double nearest, Hit& hit) {
    const double* m = s.model_from_world + 12 * instance;
    double o[3], d[3], inverse[3];
    for (int axis = 0; axis < 3; axis++) {
        const double* r = m + 4 * axis;
        o[axis] = r[0] * origin[0] + r[1] * origin[1] + r[2] * origin[2] + r[3];
        d[axis] = r[0] * direction[0] + r[1] * direction[1] + r[2] * direction[2];
        inverse[axis] = 1.0 / d[axis];
    }
    const int32_t model = s.models[instance];
    const int64_t base = s.first_node[model], triangles = s.first_triangle[model];
    if (s.first_triangle[model + 1] == triangles) return;
    int32_t stack[DEPTH];
    int32_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const int64_t node = base + stack[--depth];
        if (!touches(s.bounds + 6 * node, o, inverse, nearest, hit.distance)) continue;
        const int32_t first = s.children[2 * node], count = s.children[2 * node + 1];
        if (count == 0) {
            if (depth + 2 > DEPTH) continue;  // cannot be: trees are halved
            stack[depth++] = first + 1;
            stack[depth++] = first;
            continue;
        }
        for (int32_t k = first; k < first + count; k++) {
            const int64_t triangle = triangles + s.order[triangles + k];
            meet(o, d, s.corners + 9 * triangle, s.two_sided[triangle] != 0, nearest, instance,
                 triangle, hit);
        }
    }
}

}  // namespace

// Builds the tree of one model; `nodes` gets the number of nodes, of which there are fewer than 2
// M.
SAILENV_KERNEL(build_tree)
(const double* corners, int64_t count, double* bounds, int32_t* children, int32_t* order,
 int64_t* nodes) {
    if (count < 1 || count > (int64_t{1} << 29)) return sailenv::STATUS_INVALID_ARGUMENT;
    for (int64_t k = 0; k < 9 * count; k++) {
        if (!std::isfinite(corners[k])) return sailenv::STATUS_INVALID_ARGUMENT;
    }
    for (int64_t k = 0; k < count; k++) order[k] = static_cast<int32_t>(k);
    Builder builder{corners, bounds, children, order, 1};
    builder.build(0, 0, static_cast<int32_t>(count));
    nodes[0] = builder.used;
    return sailenv::STATUS_OK;
}

SAILENV_KERNEL(cast_rays)
(int64_t threads, int64_t rays, const double* origins, const double* directions,
 const double* nearest, int64_t instances, const double* model_from_world, const int32_t* models,
 const int64_t* first_node, const int64_t* first_triangle, const double* bounds,
 const int32_t* children, const int32_t* order, const double* corners, const uint8_t* two_sided,
 double* distance, int32_t* instance, int64_t* triangle, double* weights) {
    if (rays < 0 || instances < 0) return sailenv::STATUS_INVALID_ARGUMENT;
    const Scene scene{model_from_world, models,   instances, first_node, first_triangle,
                      bounds,           children, order,     corners,    two_sided};
    sailenv::parallel_for(threads, rays, TILE_RAYS, [&](int64_t first, int64_t last, int64_t) {
        for (int64_t ray = first; ray < last; ray++) {
            Hit hit{INFINITE, 0.0, 0.0, -1, -1};
            for (int64_t k = 0; k < instances; k++) {
                cast(scene, k, origins + 3 * ray, directions + 3 * ray, nearest[ray], hit);
            }
            distance[ray] = hit.distance;
            instance[ray] = static_cast<int32_t>(hit.instance);
            triangle[ray] = hit.triangle;
            weights[2 * ray] = hit.second;
            weights[2 * ray + 1] = hit.third;
        }
    });
    return sailenv::STATUS_OK;
}
