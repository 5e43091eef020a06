// Rays against triangles in trees of boxes.
//
// There is one tree, whose nodes and leaves are eight wide, and one formula for a triangle. Boxes
// are held against a ray in floats, with margins for all that floats lose, so that no triangle is
// missed that doubles would find. Triangles are in floats for light, in doubles for ground truth.
#pragma once

#include <cmath>
#include <cstdint>

#include "lanes.h"
#include "ray_types.h"

namespace sailenv {

constexpr float ENDLESS = 1e30f;
constexpr float RAY_BEGIN = 1e-5f;
constexpr int32_t TREE_DEPTH = 72;  // no tree is deeper; see ray_tree.cpp
constexpr int32_t WAITING = (WIDTH - 1) * TREE_DEPTH + WIDTH;

// Meets nothing nearer than `begin`, in lengths of the direction.
struct Ray {
    float o[3], d[3];
    float begin = RAY_BEGIN;
};

// A ray as boxes are held against it. Of an axis, `first` is the row of TreeNode::planes that the
// ray passes first, and `enters` and `leaves` are its origin, moved by the margin either way.
struct BoxRay {
    float enters[3], leaves[3], inverse[3];
    int32_t first[3];
};

// `margin` says how far the ray may lie beside where it is taken to be, along each axis.
static inline BoxRay box_ray(const float* o, const float* d, float margin) {
    BoxRay r;
    for (int k = 0; k < 3; k++) {
        const bool down = d[k] < 0.0f;
        // A direction along an axis would divide by 0.
        r.inverse[k] = 1.0f / (std::fabs(d[k]) > 1e-12f ? d[k] : down ? -1e-12f : 1e-12f);
        r.enters[k] = down ? o[k] - margin : o[k] + margin;
        r.leaves[k] = down ? o[k] + margin : o[k] - margin;
        r.first[k] = down ? 3 + k : k;
    }
    return r;
}

static inline Ray ray_of(const float* o, const float* d, float begin = RAY_BEGIN) {
    return {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, begin};
}

// Where a ray enters the eight boxes of a node; `met` tells which of them it passes before `end`.
LANES_INLINE f8 ray_box_entry(const TreeNode& n, const BoxRay& r, float begin, float end,
                              uint32_t& met) {
    f8 near = splat(begin), far = splat(end);
    for (int k = 0; k < 3; k++) {
        const int32_t in = r.first[k], out = in < 3 ? in + 3 : in - 3;
        near = max8((load(n.planes[in]) - r.enters[k]) * r.inverse[k], near);
        far = min8((load(n.planes[out]) - r.leaves[k]) * r.inverse[k], far);
    }
    // Differences, quotients and the direction are rounded (Ize 2013, "Robust BVH ray traversal").
    met = lane_bits((near <= far * 1.000001f) & (load(n.children) != 0));
    return near;
}

// Calls leaf(number, end) for the leaves that a ray passes, if ORDERED near ones first; it returns
// the new end of the ray, or less than 0 to stop.
template <bool ORDERED, class Leaf>
static inline void walk_tree(const TreeNode* nodes, const BoxRay& r, float begin, float end,
                             const Leaf& leaf) {
    struct Entry {
        float at;
        int32_t child;
    } waiting[WAITING];
    int32_t count = 0, child = 0;
    while (true) {
        if (child < 0) {
            end = leaf(~child, end);
            if (end < 0.0f) return;
        } else {
            const TreeNode& n = nodes[child];
            uint32_t met;
            const f8 entry = ray_box_entry(n, r, begin, end, met);
            if (met != 0 && (met & (met - 1)) == 0) {
                child = n.children[__builtin_ctz(met)];
                continue;
            }
            const int32_t base = count;
            while (met != 0) {
                const int lane = __builtin_ctz(met);
                met &= met - 1;
                const Entry e = {entry[lane], n.children[lane]};
                int32_t at = count++;
                for (; ORDERED && at > base && waiting[at - 1].at < e.at; at--) {
                    waiting[at] = waiting[at - 1];
                }
                waiting[at] = e;
            }
        }
        do {
            if (count == 0) return;
            count--;
        } while (ORDERED && !(waiting[count].at <= end * 1.000001f));
        child = waiting[count].child;
    }
}

// T. Moeller, B. Trumbore, "Fast, minimum storage ray-triangle intersection", 1997. The
// determinant is above 0 where the front is met; the others are to be divided by it. Real: one
// number or a vector of them.
template <class Real>
struct Intersection {
    Real determinant, distance, second, third;
};

template <class Real, class Number>
LANES_INLINE Intersection<Real> intersect_triangle(const Real* t, const Number* o,
                                                   const Number* d) {
    const Real *a = t + 3, *b = t + 6;
    const Real px = d[1] * b[2] - d[2] * b[1], py = d[2] * b[0] - d[0] * b[2],
               pz = d[0] * b[1] - d[1] * b[0];
    const Real sx = o[0] - t[0], sy = o[1] - t[1], sz = o[2] - t[2];
    const Real qx = sy * a[2] - sz * a[1], qy = sz * a[0] - sx * a[2], qz = sx * a[1] - sy * a[0];
    return {a[0] * px + a[1] * py + a[2] * pz, b[0] * qx + b[1] * qy + b[2] * qz,
            sx * px + sy * py + sz * pz, d[0] * qx + d[1] * qy + d[2] * qz};
}

// The triangles of a leaf against a ray in floats; `met` tells which are met before `end`.
LANES_INLINE Intersection<f8> intersect_leaf(const RayShape& s, int32_t leaf, const Ray& r,
                                             float end, uint32_t& met) {
    const float* from = static_cast<const float*>(s.triangles) + 9 * WIDTH * int64_t{leaf};
    f8 t[9];
    for (int k = 0; k < 9; k++) t[k] = load(from + WIDTH * k);
    const Intersection<f8> x = intersect_triangle(t, r.o, r.d);
    const f8 size = abs8(x.determinant);
    const i8 turned = bits(x.determinant);
    const f8 second = negated_if(x.second, turned), third = negated_if(x.third, turned);
    const f8 distance = negated_if(x.distance, turned);
    met =
        lane_bits((size >= 1e-20f) & (second >= 0.0f) & (third >= 0.0f) & (second + third <= size) &
                  (distance >= r.begin * size) & (distance < end * size));
    return x;
}

struct Hit {
    float t = ENDLESS;
    int32_t triangle = -1;              // in the order of the leaves
    float second = 0.0f, third = 0.0f;  // weights of the second and third corner
    bool front = true;
    const RayInstance* instance = nullptr;
};

// Makes `hit` the nearest triangle, if one is nearer. Of two sheets back to back, the one that
// faces the ray is meant if `sides` is set: then backs count as a little farther.
static inline void meet_shape(const RayShape& s, const Ray& r, bool sides, Hit& hit) {
    if (s.count == 0) return;
    walk_tree<true>(s.nodes, box_ray(r.o, r.d, 0.0f), 0.0f, hit.t, [&](int32_t leaf, float end) {
        uint32_t met;
        const Intersection<f8> x = intersect_leaf(s, leaf, r, end, met);
        if (met == 0) return end;
        const f8 scale = 1.0f / x.determinant;
        f8 distance = x.distance * scale;
        i8 front = x.determinant > 0.0f;
        if (sides) {
            front |= load_bytes(s.two_sided + WIDTH * int64_t{leaf}) > 0.0f;
            distance = front ? distance : distance * 1.0001f + 1e-4f;
        }
        while (met != 0) {
            const int k = __builtin_ctz(met);
            met &= met - 1;
            if (!(distance[k] < end)) continue;
            end = distance[k];
            hit.t = end;
            hit.triangle = WIDTH * leaf + k;
            hit.second = x.second[k] * scale[k];
            hit.third = x.third[k] * scale[k];
            hit.front = front[k] != 0;
        }
        return end;
    });
}

// Whether a triangle is in the way before `length`.
static inline bool shape_occludes(const RayShape& s, const Ray& r, float length) {
    if (s.count == 0) return false;
    uint32_t met = 0;
    walk_tree<false>(s.nodes, box_ray(r.o, r.d, 0.0f), 0.0f, length, [&](int32_t leaf, float end) {
        intersect_leaf(s, leaf, r, end, met);
        return met != 0 ? -1.0f : end;
    });
    return met != 0;
}

static inline Ray in_body(const RayInstance& i, const Ray& r) {
    const float* m = i.body_from_world;
    Ray own = r;
    for (int k = 0; k < 3; k++) {
        own.o[k] = m[4 * k] * r.o[0] + m[4 * k + 1] * r.o[1] + m[4 * k + 2] * r.o[2] + m[4 * k + 3];
        own.d[k] = m[4 * k] * r.d[0] + m[4 * k + 1] * r.d[1] + m[4 * k + 2] * r.d[2];
    }
    return own;
}

// Makes `hit` the nearest there is, if the instance is nearer.
static inline void meet_instance(const RayInstance& i, const Ray& world, Hit& hit) {
    const float before = hit.t;
    meet_shape(*i.shape, in_body(i, world), true, hit);
    if (hit.t < before) hit.instance = &i;
}

static inline bool instance_occludes(const RayInstance& i, const Ray& world, float length) {
    return shape_occludes(*i.shape, in_body(i, world), length);
}

// What rests, nearest first.
static inline void meet_resting(const RayScene& s, const Ray& r, Hit& hit) {
    if (s.resting_count == 0) return;
    walk_tree<true>(s.nodes, box_ray(r.o, r.d, 0.0f), 0.0f, hit.t, [&](int32_t leaf, float) {
        meet_instance(s.resting[s.order[leaf]], r, hit);
        return hit.t;
    });
}

static inline bool resting_occlude(const RayScene& s, const Ray& r, float length) {
    if (s.resting_count == 0) return false;
    bool found = false;
    walk_tree<false>(s.nodes, box_ray(r.o, r.d, 0.0f), 0.0f, length, [&](int32_t leaf, float end) {
        found = instance_occludes(s.resting[s.order[leaf]], r, length);
        return found ? -1.0f : end;
    });
    return found;
}

// Whether a ray passes through the ball around an instance, or within `margin` of it, before
// `length`.
static inline bool ray_passes_ball(const RayInstance& i, const Ray& r, float length,
                                   float margin = 0.0f) {
    const float x = i.sphere[0] - r.o[0], y = i.sphere[1] - r.o[1], z = i.sphere[2] - r.o[2];
    const float d2 = r.d[0] * r.d[0] + r.d[1] * r.d[1] + r.d[2] * r.d[2];
    float t = (x * r.d[0] + y * r.d[1] + z * r.d[2]) / d2;
    t = t < 0.0f ? 0.0f : t > length ? length : t;
    const float fx = x - t * r.d[0], fy = y - t * r.d[1], fz = z - t * r.d[2];
    const float reach = i.sphere[3] + margin;
    return fx * fx + fy * fy + fz * fz <= reach * reach;
}

// The normal of a triangle that light met, in the shape's frame; as long as twice its area.
static inline vec3 triangle_normal(const RayShape& shape, int32_t triangle) {
    const float* block = static_cast<const float*>(shape.triangles) +
                         9 * WIDTH * int64_t{triangle / WIDTH} + triangle % WIDTH;
    const vec3 a(block[3 * WIDTH], block[4 * WIDTH], block[5 * WIDTH]);
    const vec3 b(block[6 * WIDTH], block[7 * WIDTH], block[8 * WIDTH]);
    return cross(a, b);
}

// Share of light that clear double glazing lets through, for the cosine between ray and normal:
// Fresnel's equations for an index of 1.5, both polarisations alike, with all that goes to and
// fro between the two faces of each of the two sheets; 0.85 head-on.
static inline float glazing_transmittance(float cosine) {
    const float c = cosine < 1.0f ? cosine : 1.0f;
    const float inside = std::sqrt(1.0f - (1.0f - c * c) / 2.25f);
    const float across = (c - 1.5f * inside) / (c + 1.5f * inside);
    const float along = (1.5f * c - inside) / (1.5f * c + inside);
    const float mirrored = 0.5f * (across * across + along * along);
    const float left = (1.0f - mirrored) / (1.0f + mirrored);
    return left * left;
}

// Share of light that glass lets through before `length`: the nearest pane counts, once, however
// many faces it has. `passes` is in the order of the leaves.
static inline float glass_transmittance(const RayShape& glass, const float* passes, const Ray& r,
                                        float length) {
    Hit hit;
    hit.t = length;
    meet_shape(glass, r, false, hit);
    if (hit.triangle < 0) return 1.0f;
    const vec3 normal = triangle_normal(glass, hit.triangle), along(r.d[0], r.d[1], r.d[2]);
    const float cosine = dot(normal, along);
    const float size = std::sqrt(dot(normal, normal)) * std::sqrt(dot(along, along));
    return passes[hit.triangle] *
           glazing_transmittance(std::fabs(cosine) / (size > 1e-20f ? size : 1e-20f));
}

static inline float glass_transmittance(const RayScene& s, const Ray& r) {
    return s.glass == nullptr ? 1.0f : glass_transmittance(*s.glass, s.passes, r, ENDLESS);
}

}  // namespace sailenv
