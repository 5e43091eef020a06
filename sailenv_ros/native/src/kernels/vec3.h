// Positions, directions and colours, of one point (float) or of eight (f8), and GLSL's functions on
// them, by the same names: what is written in the common subset of C++ and GLSL means the same in
// both (light_law.h).
#pragma once

#include "lanes.h"

namespace sailenv {

#define VEC3_INLINE static inline constexpr __attribute__((always_inline))

// x, y, z; or red, green, blue.
template <class T>
struct Vec3 {
    T x, y, z;

    Vec3() = default;
    __attribute__((always_inline)) constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
};
using vec3 = Vec3<float>;
using Vec3x8 = Vec3<f8>;

// Type of the sum of two numbers: eight numbers, if either is.
template <class A, class B>
struct Either {
    using type = f8;
};
template <>
struct Either<float, float> {
    using type = float;
};
template <class A, class B>
using Vec3Of = Vec3<typename Either<A, B>::type>;

#define VEC3_OPERATOR(op)                                        \
    template <class A, class B>                                  \
    VEC3_INLINE Vec3Of<A, B> operator op(Vec3<A> a, Vec3<B> b) { \
        return {a.x op b.x, a.y op b.y, a.z op b.z};             \
    }                                                            \
    template <class A>                                           \
    VEC3_INLINE Vec3<A> operator op(Vec3<A> a, float b) {        \
        return {a.x op b, a.y op b, a.z op b};                   \
    }                                                            \
    template <class A>                                           \
    VEC3_INLINE Vec3x8 operator op(Vec3<A> a, f8 b) {            \
        return {a.x op b, a.y op b, a.z op b};                   \
    }                                                            \
    template <class B>                                           \
    VEC3_INLINE Vec3<B> operator op(float a, Vec3<B> b) {        \
        return {a op b.x, a op b.y, a op b.z};                   \
    }                                                            \
    template <class B>                                           \
    VEC3_INLINE Vec3x8 operator op(f8 a, Vec3<B> b) {            \
        return {a op b.x, a op b.y, a op b.z};                   \
    }
VEC3_OPERATOR(+)
VEC3_OPERATOR(-)
VEC3_OPERATOR(*)
VEC3_OPERATOR(/)
#undef VEC3_OPERATOR
#undef VEC3_INLINE

template <class T>
LANES_INLINE Vec3<T> operator-(Vec3<T> a) {
    return {-a.x, -a.y, -a.z};
}

using ::splat;
LANES_INLINE Vec3x8 splat(vec3 a) { return {splat(a.x), splat(a.y), splat(a.z)}; }

// GLSL's functions. Of lanes, `min` and `max` give the second number where one is NaN.
LANES_INLINE float min(float a, float b) { return a < b ? a : b; }
LANES_INLINE float max(float a, float b) { return a > b ? a : b; }
LANES_INLINE f8 min(f8 a, f8 b) { return min8(a, b); }
LANES_INLINE f8 max(f8 a, f8 b) { return max8(a, b); }
LANES_INLINE f8 min(f8 a, float b) { return min8(a, splat(b)); }
LANES_INLINE f8 max(f8 a, float b) { return max8(a, splat(b)); }
LANES_INLINE float clamp(float x, float low, float high) { return min(max(x, low), high); }
LANES_INLINE f8 clamp(f8 x, float low, float high) { return clamp8(x, low, high); }
LANES_INLINE float sqrt(float x) { return __builtin_sqrtf(x); }
LANES_INLINE f8 sqrt(f8 x) { return sqrt8(x); }
LANES_INLINE float pow(float x, float y) { return __builtin_powf(x, y); }
LANES_INLINE f8 pow(f8 x, float y) {
    for (int k = 0; k < 8; k++) x[k] = __builtin_powf(x[k], y);
    return x;
}
LANES_INLINE float step(float edge, float x) { return x < edge ? 0.0f : 1.0f; }
LANES_INLINE f8 step(float edge, f8 x) { return x < edge ? splat(0.0f) : splat(1.0f); }

// Not defined where `low` is `high`, as in GLSL.
template <class T>
LANES_INLINE T smoothstep(float low, float high, T x) {
    const T t = clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

template <class A, class B, class Share>
LANES_INLINE auto mix(Vec3<A> a, Vec3<B> b, Share share) {
    return a + (b - a) * share;
}

template <class A, class B>
LANES_INLINE typename Either<A, B>::type dot(Vec3<A> a, Vec3<B> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class A, class B>
LANES_INLINE Vec3Of<A, B> cross(Vec3<A> a, Vec3<B> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
LANES_INLINE Vec3<T> max(Vec3<T> a, float b) {
    return {max(a.x, b), max(a.y, b), max(a.z, b)};
}

template <class T>
LANES_INLINE Vec3<T> clamp(Vec3<T> a, float low, float high) {
    return {clamp(a.x, low, high), clamp(a.y, low, high), clamp(a.z, low, high)};
}

// What GLSL has no name for.
LANES_INLINE vec3 unit(vec3 a) { return a * (1.0f / sqrt(dot(a, a))); }
LANES_INLINE f8 inverse_length(Vec3x8 a) { return 1.0f / sqrt(max(dot(a, a), 1e-20f)); }
LANES_INLINE f8 largest(Vec3x8 a) { return max8(a.x, max8(a.y, a.z)); }
LANES_INLINE Vec3x8 where(i8 mask, Vec3x8 a, Vec3x8 b) {
    return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
}

// Three rows of numbers, from a frame to another.
struct Mat3 {
    vec3 rows[3];

    constexpr vec3 column(int k) const {
        return k == 0   ? vec3(rows[0].x, rows[1].x, rows[2].x)
               : k == 1 ? vec3(rows[0].y, rows[1].y, rows[2].y)
                        : vec3(rows[0].z, rows[1].z, rows[2].z);
    }
};
template <class T>
LANES_INLINE Vec3<T> operator*(const Mat3& m, Vec3<T> a) {
    return {dot(m.rows[0], a), dot(m.rows[1], a), dot(m.rows[2], a)};
}
// The same of (x, y, 1), a ray of depth 1.
template <class A, class B>
LANES_INLINE Vec3Of<A, B> ray_at(const Mat3& m, A x, B y) {
    return {m.rows[0].x * x + (m.rows[0].y * y + m.rows[0].z),
            m.rows[1].x * x + (m.rows[1].y * y + m.rows[1].z),
            m.rows[2].x * x + (m.rows[2].y * y + m.rows[2].z)};
}

// The first three rows of a transform of points.
struct Mat3x4 {
    struct Row {
        vec3 turn;
        float shift;
    } rows[3];
};
template <class T>
LANES_INLINE Vec3<T> operator*(const Mat3x4& m, Vec3<T> a) {
    return {dot(m.rows[0].turn, a) + m.rows[0].shift, dot(m.rows[1].turn, a) + m.rows[1].shift,
            dot(m.rows[2].turn, a) + m.rows[2].shift};
}

}  // namespace sailenv
