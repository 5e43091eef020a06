// The lens of a camera: from places in the picture to rays and back.
//
// `Lens` mirrors `native.lens.LENS`, which `CameraIntrinsics.lens_record` alone fills in. Pixel (u,
// v) of the picture sees the points z (x, y, 1) of the optical frame; only the functions here know
// how x and y come of u and v. They take single numbers and vectors of them alike. A point whose
// ray has moved from (x, y) to (x', y') has moved by refocused + f (x' - x) in the picture.
#pragma once

namespace sailenv {

struct Lens {
    double fx, fy, cx, cy;  // focal lengths, and the place of the optical axis [px]
    double near_m, far_m;   // clip distances along the optical axis [m]
};

template <class T>
inline T ray_x(const Lens& lens, T u) {
    return (u - lens.cx) / lens.fx;
}
template <class T>
inline T ray_y(const Lens& lens, T v) {
    return (v - lens.cy) / lens.fy;
}
template <class T>
inline T pixel_u(const Lens& lens, T x) {
    return lens.fx * x + lens.cx;
}
template <class T>
inline T pixel_v(const Lens& lens, T y) {
    return lens.fy * y + lens.cy;
}

// How far the place of one ray moves from one lens to another [px]; exactly 0 where they are equal.
template <class T>
inline T refocused_u(const Lens& from, const Lens& to, T x) {
    return (to.fx - from.fx) * x + (to.cx - from.cx);
}
template <class T>
inline T refocused_v(const Lens& from, const Lens& to, T y) {
    return (to.fy - from.fy) * y + (to.cy - from.cy);
}

// The same in single precision, for pictures: its rays are products with 1 / f. `scale` is 0.5
// where samples are every second pixel.
struct FastLens {
    float fx, fy, cx, cy, per_fx, per_fy;

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
};

}  // namespace sailenv
