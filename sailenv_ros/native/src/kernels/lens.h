// The lens of a camera: from places in the picture to rays and back. Native kernels and shaders
// both include this text, whose first part is written in the common subset of C++ and GLSL.
//
// `Lens` mirrors `native.lens.LENS`, which `CameraIntrinsics.lens_record` alone fills in. Pixel (u,
// v) of the picture sees the points z (x, y, 1) of the optical frame; only the functions here know
// how x and y come of u and v. `Real` is a single number, or in C++ a vector of them. A point whose
// ray has moved from (x, y) to (x', y') has moved by refocused + f (x' - x) in the picture.
#ifdef __cplusplus
#pragma once
#include "vec3.h"
#define LENS_LAW                          \
    template <class SomeLens, class Real> \
    LANES_INLINE
#define Number double
namespace sailenv {
#else
#define LENS_LAW
#define SomeLens Lens
#define Real float
#define Number float
#endif

struct Lens {
    Number fx, fy, cx, cy;  // focal lengths, and the place of the optical axis [px]
    Number near_m, far_m;   // clip distances along the optical axis [m]
};

LENS_LAW Real ray_x(const SomeLens lens, Real u) { return (u - lens.cx) / lens.fx; }
LENS_LAW Real ray_y(const SomeLens lens, Real v) { return (v - lens.cy) / lens.fy; }
LENS_LAW Real pixel_u(const SomeLens lens, Real x) { return lens.fx * x + lens.cx; }
LENS_LAW Real pixel_v(const SomeLens lens, Real y) { return lens.fy * y + lens.cy; }

// How long something near the axis is at depth 1, from its length in the picture [px].
LENS_LAW Real ray_length(const SomeLens lens, Real pixels) { return pixels / lens.fx; }

#undef LENS_LAW
#undef Number
#ifdef __cplusplus
// How places of a picture look: all from one point; or side by side along the axis, each from where
// (x, y) lies [m] in the camera's plane.
enum class Sight : int32_t { CENTRAL, PARALLEL };

// How far the place of one ray moves from one lens to another [px]; exactly 0 where they are equal.
template <class T>
inline T refocused_u(const Lens& from, const Lens& to, T x) {
    return (to.fx - from.fx) * x + (to.cx - from.cx);
}
template <class T>
inline T refocused_v(const Lens& from, const Lens& to, T y) {
    return (to.fy - from.fy) * y + (to.cy - from.cy);
}

// The lens of samples half a pixel apart: sample k lies at pixel (k - 1) / 2.
inline Lens of_half_pixels(const Lens& lens) {
    return {2.0 * lens.fx,       2.0 * lens.fy, 2.0 * lens.cx + 1.0,
            2.0 * lens.cy + 1.0, lens.near_m,   lens.far_m};
}

// The function a u + b v + c of the place in the picture that is `scale` times the ray's share
// along some direction. Only through a lens that leaves lines straight is there one.
template <class T>
struct Linear {
    T a, b, c;
};
template <class T>
LANES_INLINE Linear<T> share_along(const Lens& lens, T scale, T x, T y, T z) {
    const T a = scale * (1.0 / lens.fx) * x, b = scale * (1.0 / lens.fy) * y;
    return {a, b, scale * z - a * lens.cx - b * lens.cy};
}

// The same in single precision, for pictures: its rays are products with 1 / f. `scale` is 0.5
// where samples are every second pixel.
struct FastLens {
    float fx, fy, cx, cy, per_fx, per_fy;

    FastLens() = default;
    explicit FastLens(const Lens& lens, double scale = 1.0)
        : fx(static_cast<float>(scale * lens.fx)),
          fy(static_cast<float>(scale * lens.fy)),
          cx(static_cast<float>(scale * lens.cx)),
          cy(static_cast<float>(scale * lens.cy)),
          per_fx(1.0f / fx),
          per_fy(1.0f / fy) {}

    template <class T>
    T ray_x(T u) const {
        return (u - cx) * per_fx;
    }
    template <class T>
    T ray_y(T v) const {
        return (v - cy) * per_fy;
    }

    // The direction whose share along rays is a function of the place; see `share_along`.
    vec3 direction(const float* linear) const {
        return {linear[0] * fx, linear[1] * fy, linear[0] * cx + linear[1] * cy + linear[2]};
    }
};

// Where points of the optical frame lie in the picture.
LANES_INLINE void project(const FastLens& lens, f8 depth, f8& x, f8& y) {
    const f8 scale = lens.fx / depth;
    x = lens.cx + x * scale;
    y = lens.cy + y * (scale * (lens.fy / lens.fx));
}

// The ray of a place in the frame that `turn` leads to. Pictures keep their bytes: x is a product
// and y a quotient.
template <class A, class B>
LANES_INLINE Vec3Of<A, B> ray_through(const FastLens& lens, const Mat3& turn, A u, B v) {
    return ray_at(turn, lens.ray_x(u), ray_y(lens, v));
}

// How the ray changes from pixel to pixel, in the frame that `turn` leads to.
struct RaySteps {
    vec3 right, down;
};
LANES_INLINE RaySteps ray_steps(const FastLens& lens, const Mat3& turn) {
    return {turn.column(0) * lens.per_fx, turn.column(1) * lens.per_fy};
}

}  // namespace sailenv
#else
// The point at depth 1 that a place of the picture sees, in the optical frame.
vec3 ray_through(const Lens lens, vec2 at) {
    return vec3(ray_x(lens, at.x), ray_y(lens, at.y), 1.0);
}
#undef SomeLens
#undef Real
#endif
