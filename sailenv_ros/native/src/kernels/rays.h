// Rays against triangles in trees of boxes, one ray at a time.
#pragma once

#include <cmath>
#include <cstdint>

#include "ray_types.h"

namespace sailenv {

constexpr float ENDLESS = 1e30f;
constexpr float RAY_BEGIN = 1e-5f;
constexpr int32_t TREE_DEPTH = 64;  // no tree is deeper; see build_tree

struct Ray {
    float o[3], d[3], inverse[3];
};

static inline Ray ray_of(const float* o, const float* d) {
    Ray r;
    for (int k = 0; k < 3; k++) {
        r.o[k] = o[k];
        r.d[k] = d[k];
        // A direction along an axis would divide by 0.
        r.inverse[k] = 1.0f / (std::fabs(d[k]) > 1e-12f ? d[k] : 1e-12f);
    }
    return r;
}

struct Hit {
    float t = ENDLESS;
    int32_t triangle = -1;
    float second = 0.0f, third = 0.0f;  // weights of the second and third corner
    bool front = true;
    const RayInstance* instance = nullptr;
};

// Where a ray enters a box; ENDLESS if it does not before `end`.
static inline float enters(const TreeNode& n, const Ray& r, float end) {
    float near = 0.0f, far = end;
    for (int k = 0; k < 3; k++) {
        const float a = (n.low[k] - r.o[k]) * r.inverse[k];
        const float b = (n.high[k] - r.o[k]) * r.inverse[k];
        const float small = a < b ? a : b, large = a < b ? b : a;
        near = small > near ? small : near;
        far = large < far ? large : far;
    }
    return near <= far ? near : ENDLESS;
}

// Calls leaf(first, count), which returns the new end of the ray; stops at an end of 0 or less.
template <class Leaf>
static inline void walk_tree(const TreeNode* nodes, const Ray& r, float end, const Leaf& leaf) {
    int32_t stack[TREE_DEPTH];
    int32_t depth = 0, at = 0;
    if (enters(nodes[0], r, end) >= ENDLESS) return;
    while (true) {
        const TreeNode& n = nodes[at];
        if (n.count > 0) {
            end = leaf(n.first, n.count, end);
            if (end <= 0.0f) return;
        } else {
            const float left = enters(nodes[n.first], r, end);
            const float right = enters(nodes[n.first + 1], r, end);
            const bool swap = right < left;
            const float near = swap ? right : left, far = swap ? left : right;
            if (near < ENDLESS) {
                at = n.first + (swap ? 1 : 0);
                if (far < ENDLESS && depth < TREE_DEPTH) stack[depth++] = n.first + (swap ? 0 : 1);
                continue;
            }
        }
        do {
            if (depth == 0) return;
            at = stack[--depth];
        } while (enters(nodes[at], r, end) >= ENDLESS);
    }
}

// Moeller and Trumbore 1997. The distance; below 0 for none.
static inline float meets(const float* t, const Ray& r, float& second, float& third, bool& front) {
    const float *v = t, *a = t + 3, *b = t + 6;
    const float px = r.d[1] * b[2] - r.d[2] * b[1], py = r.d[2] * b[0] - r.d[0] * b[2],
                pz = r.d[0] * b[1] - r.d[1] * b[0];
    const float det = a[0] * px + a[1] * py + a[2] * pz;
    if (std::fabs(det) < 1e-20f) return -1.0f;
    const float scale = 1.0f / det;
    const float sx = r.o[0] - v[0], sy = r.o[1] - v[1], sz = r.o[2] - v[2];
    second = (sx * px + sy * py + sz * pz) * scale;
    if (!(second >= 0.0f && second <= 1.0f)) return -1.0f;
    const float qx = sy * a[2] - sz * a[1], qy = sz * a[0] - sx * a[2], qz = sx * a[1] - sy * a[0];
    third = (r.d[0] * qx + r.d[1] * qy + r.d[2] * qz) * scale;
    if (!(third >= 0.0f && second + third <= 1.0f)) return -1.0f;
    front = det > 0.0f;
    return (b[0] * qx + b[1] * qy + b[2] * qz) * scale;
}

static inline Ray in_body(const RayInstance& i, const Ray& r) {
    const float* m = i.body_from_world;
    float o[3], d[3];
    for (int k = 0; k < 3; k++) {
        o[k] = m[4 * k] * r.o[0] + m[4 * k + 1] * r.o[1] + m[4 * k + 2] * r.o[2] + m[4 * k + 3];
        d[k] = m[4 * k] * r.d[0] + m[4 * k + 1] * r.d[1] + m[4 * k + 2] * r.d[2];
    }
    return ray_of(o, d);
}

// Makes `hit` the nearest there is, if the instance is nearer.
static inline void meet_instance(const RayInstance& i, const Ray& world, Hit& hit) {
    const RayShape& s = *i.shape;
    if (s.count == 0) return;
    const Ray r = in_body(i, world);
    walk_tree(s.nodes, r, hit.t, [&](int32_t first, int32_t count, float end) {
        for (int32_t k = first; k < first + count; k++) {
            float second, third;
            bool front;
            float t = meets(s.triangles + 9 * static_cast<int64_t>(k), r, second, third, front);
            if (!(t > RAY_BEGIN)) continue;
            const bool shown = front || s.two_sided[k];
            // Of two sheets back to back, the one that faces the ray is meant.
            if (!shown) t = t * 1.0001f + 1e-4f;
            if (t >= end) continue;
            end = t;
            hit = {t, k, second, third, shown, &i};
        }
        return end;
    });
}

static inline bool stops_instance(const RayInstance& i, const Ray& world, float length) {
    const RayShape& s = *i.shape;
    if (s.count == 0) return false;
    const Ray r = in_body(i, world);
    bool stopped = false;
    walk_tree(s.nodes, r, length, [&](int32_t first, int32_t count, float end) {
        for (int32_t k = first; k < first + count; k++) {
            float second, third;
            bool front;
            const float t =
                meets(s.triangles + 9 * static_cast<int64_t>(k), r, second, third, front);
            if (t > RAY_BEGIN && t < end) {
                stopped = true;
                return 0.0f;
            }
        }
        return end;
    });
    return stopped;
}

// What rests, nearest first.
static inline void meet_resting(const RayScene& s, const Ray& r, Hit& hit) {
    if (s.resting_count == 0) return;
    walk_tree(s.nodes, r, hit.t, [&](int32_t first, int32_t count, float) {
        for (int32_t k = first; k < first + count; k++) {
            meet_instance(s.resting[s.order[k]], r, hit);
        }
        return hit.t;
    });
}

static inline bool stops_resting(const RayScene& s, const Ray& r, float length) {
    if (s.resting_count == 0) return false;
    bool stopped = false;
    walk_tree(s.nodes, r, length, [&](int32_t first, int32_t count, float end) {
        for (int32_t k = first; k < first + count; k++) {
            if (stops_instance(s.resting[s.order[k]], r, length)) {
                stopped = true;
                return 0.0f;
            }
        }
        return end;
    });
    return stopped;
}

// Whether a ray passes through the ball around an instance, or within `margin` of it, before
// `length`.
static inline bool comes_near(const RayInstance& i, const Ray& r, float length,
                              float margin = 0.0f) {
    const float x = i.sphere[0] - r.o[0], y = i.sphere[1] - r.o[1], z = i.sphere[2] - r.o[2];
    const float d2 = r.d[0] * r.d[0] + r.d[1] * r.d[1] + r.d[2] * r.d[2];
    float t = (x * r.d[0] + y * r.d[1] + z * r.d[2]) / d2;
    t = t < 0.0f ? 0.0f : t > length ? length : t;
    const float fx = x - t * r.d[0], fy = y - t * r.d[1], fz = z - t * r.d[2];
    const float reach = i.sphere[3] + margin;
    return fx * fx + fy * fy + fz * fz <= reach * reach;
}

// Share of light that glass lets through along an endless ray; see bake/rays.py.
static inline float through_panes(const RayScene& s, const Ray& r) {
    if (s.glass_count == 0) return 1.0f;
    float slant = 1.0f;
    int32_t pane = -1;
    walk_tree(s.glass_nodes, r, ENDLESS, [&](int32_t first, int32_t count, float end) {
        for (int32_t k = first; k < first + count; k++) {
            float second, third;
            bool front;
            const float* t = s.glass + 9 * static_cast<int64_t>(k);
            const float at = meets(t, r, second, third, front);
            if (!(at > RAY_BEGIN && at < end)) continue;
            end = at;
            pane = k;
            const float nx = t[4] * t[8] - t[5] * t[7], ny = t[5] * t[6] - t[3] * t[8],
                        nz = t[3] * t[7] - t[4] * t[6];
            const float along = nx * r.d[0] + ny * r.d[1] + nz * r.d[2];
            const float size = std::sqrt(nx * nx + ny * ny + nz * nz) *
                               std::sqrt(r.d[0] * r.d[0] + r.d[1] * r.d[1] + r.d[2] * r.d[2]);
            slant = std::fabs(along) / (size > 1e-20f ? size : 1e-20f);
        }
        return end;
    });
    if (pane < 0) return 1.0f;
    const float c = slant < 1.0f ? slant : 1.0f;
    const float inside = std::sqrt(1.0f - (1.0f - c * c) / 2.25f);
    const float across = (c - 1.5f * inside) / (c + 1.5f * inside);
    const float along = (1.5f * c - inside) / (1.5f * c + inside);
    const float mirrored = 0.5f * (across * across + along * along);
    const float left = (1.0f - mirrored) / (1.0f + mirrored);
    return s.passes[pane] * left * left;
}

}  // namespace sailenv
