// What rays of shading meet, and what it sends back along them: lit like what the camera sees, and
// mirroring the pictures of the room.
#pragma once

#include <cmath>

#include "rays.h"
#include "shade_chunk.h"
#include "traced_types.h"

namespace sailenv {

constexpr float BEGIN_M = 5e-4f;  // a point lies that far from its surface, at most

struct SceneHit {
    Hit hit;
    const TracedInstance* instance = nullptr;
};

// The nearest place that a ray meets before `reach` [m].
SceneHit closest_hit(const TracedScene& scene, vec3 from, vec3 ray, float reach);

// Whether it is drawn. Backs are not: where one is met, the ray is inside of something.
static inline bool is_drawn(const SceneHit& met) {
    return met.instance != nullptr && met.hit.front &&
           met.instance->part_of[met.instance->placed.shape->order[met.hit.triangle]] >= 0;
}

// Begins with places that rays meet: `set_hit` adds the i-th. `distance` is how far the ray's
// origin is from the eye [m], `angle` how far rays beside it are turned away [rad].
void begin_hits(Chunk& c);
void set_hit(const Light* light, const SceneHit& met, vec3 from, vec3 ray, float distance,
             float angle, Chunk& c, int32_t i);

// The light that the first `count` places that were met send back along the rays.
void shade_hits(const Shading& s, Chunk& c, int32_t count);

// Rays of a lobe, each at the next golden angle, of which these are cosines and sines.
constexpr int32_t LOBE = 16;
constexpr float GOLDEN_X[LOBE] = {
    1.000000f, -0.737369f, 0.087426f, 0.608439f, -0.984713f, 0.843755f, -0.259604f, -0.460907f,
    0.939321f, -0.924346f, 0.423846f, 0.299284f, -0.865211f, 0.976676f, -0.575129f, -0.128511f};
constexpr float GOLDEN_Y[LOBE] = {
    0.000000f, 0.675490f, -0.996171f, 0.793601f, -0.174182f, -0.536728f, 0.965715f, -0.887448f,
    0.343039f, 0.381556f, -0.905734f, 0.954164f, -0.501408f, -0.214719f, 0.818062f, -0.991708f};

// A ray of GGX's lobe about a normal, which is so wide (roughness squared): by the microfacet of a
// number, turned about the normal by so many golden angles. The facets are the least steep `part`
// of all, in parts of equal weight (Vogel 1979, "A better way to construct the sunflower head").
static inline vec3 lobe_ray(const Chunk& c, int32_t i, vec3 n, int32_t number, int32_t turn,
                            float wide, float part) {
    const int32_t k = number & (LOBE - 1), t = turn & (LOBE - 1);
    const float within = part * (static_cast<float>(k) + 0.5f) / LOBE;
    const float slope = wide * std::sqrt(within / (1.0f - within));
    const float x = slope * (GOLDEN_X[k] * GOLDEN_X[t] - GOLDEN_Y[k] * GOLDEN_Y[t]);
    const float y = slope * (GOLDEN_X[k] * GOLDEN_Y[t] + GOLDEN_Y[k] * GOLDEN_X[t]);
    // Two axes across the normal (Duff et al. 2017, "Building an orthonormal basis, revisited").
    const float sign = n.z < 0.0f ? -1.0f : 1.0f, a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    const vec3 first(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    const vec3 second(b, sign + n.y * n.y * a, -n.y);
    const vec3 facet = unit(n + first * x + second * y);
    const vec3 along = unit(vector_at(c.ray, i));
    return along - facet * (2.0f * dot(along, facet));
}

// Luminance of a surface's reflectance head-on.
static inline float head_on_luminance(const Chunk& c, int32_t i) {
    return 0.04f + (luminance(vector_at(c.base, i)) - 0.04f) * c.metallic[i];
}

constexpr float ALIKE = 0.97f;  // cosine between normals of those who share what rays meet

// From this share of all light that is sent back on, what is mirrored is worth more rays.
constexpr float LARGE_SHARE = 0.6f;

// Angle between the mirrored rays of neighbouring pixels: up to where surfaces are flat, so that
// pixels can share what their rays meet, and from where on they are too bent for it [rad].
constexpr float FLAT = 0.05f, BENT = 0.15f;

// Whether rays of a relief lead everywhere: too few would be alike, where little is mirrored.
LANES_INLINE i8 leads_everywhere(const Chunk& c, int32_t i, f8 mirrored) {
    return c.detailed ? (load(c.relief + i) > 0.0f) & (mirrored < LARGE_SHARE) : i8{};
}

// How much a ray of the lobe counts: its directions are as dense as the slopes of microfacets, seen
// from above (Walter et al. 2007, "Microfacet models for refraction through rough surfaces").
static inline float lobe_weight(const Chunk& c, int32_t i, vec3 ray) {
    const vec3 normal = vector_at(c.normal, i);
    const vec3 view = unit(vector_at(c.ray, i)) * -1.0f;
    const vec3 facet = unit(ray + view);
    const float nl = max(dot(normal, ray), 1e-3f), vh = max(dot(view, facet), 0.0f);
    const float square = c.roughness[i] * c.roughness[i], a2 = square * square;
    const float seen = 2.0f * nl / (nl + std::sqrt(a2 + (1.0f - a2) * nl * nl));
    const float f0 = head_on_luminance(c, i);
    const float fresnel = f0 + (1.0f - f0) * schlick_share(vh);
    return fresnel * seen * vh / max(dot(normal, facet), 1e-3f);
}

}  // namespace sailenv
