// The law of light: how much of a lamp's light arrives where, how bright the analytic sky is, and
// how bright a colour. Native kernels and shaders both include this text, which is written in the
// common subset of C++ and GLSL; `Real` is a number of one point, or of eight in C++.
//
// Lengths in metres. Colours are linear, with the primaries of Rec. 709.
#ifdef __cplusplus
#pragma once
#include "vec3.h"
#define LIGHT_LAW         \
    template <class Real> \
    LANES_INLINE
#define Real3 Vec3<Real>
namespace sailenv {
#else
#define LIGHT_LAW
#define Real float
#define Real3 vec3
#endif

// Kinds of lamps, as LIGHT_KINDS in lights.py has them.
const int LIGHT_DIRECTIONAL = 0;
const int LIGHT_POINT = 1;
const int LIGHT_SPOT = 2;
const int LIGHT_AREA = 3;

// One lamp; mirrored by native.lamp.LAMP. By the rules of std140 it is as long as in C++.
struct Lamp {
    vec3 colour;  // radiant intensity (irradiance, if directional)
    int kind;
    vec3 position;
    float range_m;   // of point and spot lights
    vec3 direction;  // where it travels to; unit length
    float inner_cosine;
    float outer_cosine;
    float exponent;  // of a spot's cosine
    float padding_0;
    float padding_1;
};

// Share of each colour in luminance (ITU-R BT.709).
const vec3 LUMINANCE = vec3(0.2126f, 0.7152f, 0.0722f);

LIGHT_LAW Real luminance(Real3 colour) { return dot(colour, LUMINANCE); }

// Squared distance of a lamp; within a centimetre it counts as that far.
LIGHT_LAW Real lamp_square(Real3 offset) { return max(dot(offset, offset), 1e-4f); }

// Irradiance at a point over a lamp's radiant intensity; not of directional lights.
//
// `square` is the squared distance, `along` the cosine between the lamp's direction and the way
// from the lamp to the point. The light of points and spots ends at their range, by the window of
// Karis 2013, "Real shading in Unreal Engine 4". A spot without a soft edge ends at once; with an
// exponent it is brighter in its middle, as OpenGL's and MuJoCo's spots are.
LIGHT_LAW Real lamp_falloff(Lamp lamp, Real square, Real along) {
    if (lamp.kind == LIGHT_AREA) return max(along, 0.0f) / square;
    Real reach = square / (lamp.range_m * lamp.range_m);
    Real window = clamp(1.0f - reach * reach, 0.0f, 1.0f);
    Real share = window * window / square;
    if (lamp.kind != LIGHT_SPOT) return share;
    if (lamp.exponent > 0.0f) share = share * pow(max(along, 1e-6f), lamp.exponent);
    if (lamp.inner_cosine <= lamp.outer_cosine) return share * step(lamp.outer_cosine, along);
    return share * smoothstep(lamp.outer_cosine, lamp.inner_cosine, along);
}

// Radiance of the analytic sky in a direction; `up` is its z.
LIGHT_LAW Real3 sky_radiance(Real up, vec3 zenith, vec3 horizon, vec3 ground) {
    Real3 upper = mix(horizon, zenith, sqrt(clamp(up, 0.0f, 1.0f)));
    return mix(upper, ground, smoothstep(0.0f, 0.12f, -up));
}

// Irradiance / pi of that sky on a surface; `up` is the z of its normal. An approximation: ground
// and sky by the share of each that the surface sees, and the more of the zenith the more it faces
// it.
LIGHT_LAW Real3 sky_irradiance(Real up, vec3 zenith, vec3 horizon, vec3 ground) {
    vec3 dome = mix(horizon, zenith, 0.55f);
    return mix(ground, mix(horizon, dome, max(up, 0.0f)), 0.5f + 0.5f * up);
}

// Irradiance / pi on a surface by twelve terms: spherical harmonics of bands 0, 1 and 2 of its
// normal (Ramamoorthi and Hanrahan 2001), and how it changes from place to place.
LIGHT_LAW Real irradiance_of_terms(Real t[12], Real3 normal, Real3 point) {
    Real even = t[0] + t[1] * normal.x + t[2] * normal.y + t[3] * normal.z;
    Real mixed =
        t[4] * (normal.x * normal.y) + t[5] * (normal.y * normal.z) + t[6] * (normal.z * normal.x);
    Real squares = t[7] * (normal.x * normal.x - normal.y * normal.y) +
                   t[8] * (3.0f * normal.z * normal.z - 1.0f);
    return even + mixed + squares + t[9] * point.x + t[10] * point.y + t[11] * point.z;
}

#undef LIGHT_LAW
#undef Real
#undef Real3
#ifdef __cplusplus
}  // namespace sailenv
#endif
