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

// Four terms: a number, and how it changes from place to place.
LIGHT_LAW Real at_place(Real even, Real x, Real y, Real z, Real3 point) {
    return even + x * point.x + y * point.y + z * point.z;
}

// Irradiance / pi on a surface by 28 terms: bands 0 and 1 of spherical harmonics of its normal, and
// four for each side of the body, which count by the squares of the normal's parts along the body's
// axes (the ambient cube of McTaggart 2004, "Half-Life 2 / Valve Source shading"). `front` has
// these squares where a part is above 0, `back` where it is below.
LIGHT_LAW Real irradiance_of_terms(Real t[28], Real3 normal, Real3 front, Real3 back, Real3 point) {
    return t[0] + t[1] * normal.x + t[2] * normal.y + t[3] * normal.z +
           front.x * at_place(t[4], t[5], t[6], t[7], point) +
           front.y * at_place(t[8], t[9], t[10], t[11], point) +
           front.z * at_place(t[12], t[13], t[14], t[15], point) +
           back.x * at_place(t[16], t[17], t[18], t[19], point) +
           back.y * at_place(t[20], t[21], t[22], t[23], point) +
           back.z * at_place(t[24], t[25], t[26], t[27], point);
}

// Share of the light from around that arrives where a surface hides a share of the hemisphere from
// itself, with what light it sends on between its own parts: the fit of Jimenez et al. 2016,
// "Practical real-time strategies for accurate indirect occlusion".
LIGHT_LAW Real arriving_share(Real hidden, Real albedo) {
    Real open = 1.0f - clamp(hidden, 0.0f, 1.0f);
    Real third = 2.0404f * albedo - 0.3324f;
    Real second = 0.6417f - 4.7951f * albedo;
    Real first = 2.7552f * albedo + 0.6903f;
    return open * max(((third * open) + second) * open + first, 1.0f);
}

// What light by terms is multiplied by where a surface has no place in the light map: `light_u` is
// less than 0 by that there, or 0 for 1.
LIGHT_LAW Real vertex_factor(Real light_u) {
    return max(0.0f - light_u, 0.0f) + (light_u < 0.0f ? 0.0f : 1.0f);
}

// How far reflectance rises from that head-on towards 1 where light grazes (Schlick 1994, "An
// inexpensive BRDF model for physically-based rendering").
LIGHT_LAW Real schlick_share(Real cosine) {
    Real grazing = 1.0f - cosine;
    Real square = grazing * grazing;
    return square * square * grazing;
}

// GGX's distribution of microfacets, times height-correlated Smith visibility (Heitz 2014,
// "Understanding the masking-shadowing function in microfacet-based BRDFs"): what a surface sends
// of light from one direction, but for Fresnel's term and the cosine `nl`. `a2` is its roughness to
// the fourth power; the others are cosines of light, view and the direction half-way to the normal.
LIGHT_LAW Real microfacet_lobe(Real a2, Real nl, Real nv, Real nh) {
    Real rest = 1.0f - a2;
    Real spread = 1.0f - nh * nh * rest;
    Real smith = nl * sqrt(nv * nv * rest + a2) + nv * sqrt(nl * nl * rest + a2);
    return 0.5f * a2 / (3.14159265f * spread * spread * smith);
}

// Shares of even light around that a GGX surface with height-correlated Smith shadowing mirrors at
// a cosine (split-sum environment term, Karis 2013): `mirrored_scale` times its reflectance
// head-on, plus `mirrored_bias`. Polynomials fitted to the integrals, their sum for a reflectance
// of 0.04 within 2 % (RMS), 8 % at grazing angles.
LIGHT_LAW Real mirrored_scale(Real roughness, Real cosine) {
    Real r = roughness, grazing = (1.0f - cosine) * (1.0f - cosine), g = grazing * grazing;
    Real q = cosine / (cosine + r * r), q2 = q * q;
    Real smooth_part = 2.2023f * q - 6.2876f * q2 + q2 * q * (8.0846f - 3.5346f * q) + 0.5407f;
    Real grazing_part = -0.1003f - 0.4303f * q2 + g * (-0.8263f * q + 0.3586f * g * q2);
    Real rough_part = 2.9637f - 3.0018f * q2;
    Real rougher_part = -2.8354f + q2 * (6.2797f * q - 3.1873f) + 0.4043f * g * g + 0.5116f * r * r;
    return q * smooth_part + g * grazing_part + r * (rough_part + r * rougher_part);
}
LIGHT_LAW Real mirrored_bias(Real roughness, Real cosine) {
    Real r = roughness, grazing = (1.0f - cosine) * (1.0f - cosine), g = grazing * grazing;
    Real q = cosine / (cosine + r * r), q2 = q * q;
    Real smooth_part = q2 * q2 * (4.1647f - 3.8393f * q) + 2.5199f * g * q;
    Real grazing_part = g * g *
                        (q2 * (0.5807f * q - 3.8004f) +
                         g * (q * (2.9223f * q - 1.4347f) + g * (1.0985f - 1.415f * q)));
    Real rough_part = r * g * (-2.2248f - 3.8377f * q2 * q + g * g * (5.0231f * q - 0.918f * g));
    Real rougher_part = r * r * g * (2.9558f + 0.3202f * g * g - 1.186f * r);
    return g * (smooth_part + grazing_part + rough_part + rougher_part);
}

// Roughness from where on what is mirrored of a room is less and less what a picture of it has, and
// from where on it is the light around the point: rough surfaces mirror most of the half space.
const float MIRRORS_ROOM = 0.35f;
const float MIRRORS_AROUND = 0.7f;

LIGHT_LAW Real share_mirrored_around(Real roughness) {
    return smoothstep(MIRRORS_ROOM, MIRRORS_AROUND, roughness);
}

// See-through things as rough as this are cloth, and mirror nothing.
const float LEAST_CLOTH = 0.5f;

// Share of light that a pane mirrors, for the cosine between ray and normal: by Schlick's term for
// an index of 1.5 at each of its two faces, with all that goes to and fro between these.
LIGHT_LAW Real pane_reflectance(Real cosine, float roughness) {
    Real once = 0.04f + 0.96f * schlick_share(clamp(cosine, 0.0f, 1.0f));
    return 2.0f * once / (1.0f + once) * (roughness < LEAST_CLOTH ? 1.0f : 0.0f);
}

#undef LIGHT_LAW
#undef Real
#undef Real3
#ifdef __cplusplus
}  // namespace sailenv
#endif
