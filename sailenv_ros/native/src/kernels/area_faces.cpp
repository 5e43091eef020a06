// What surfaces mirror of the faces of area lights, by the shape of GGX's lobe. Glass and flat
// mirrors show none: area lights have no body, and behind that of a window the sky is seen.
//
// The slopes of GGX's microfacets along an axis are spread as p(x) = a^2 / (2 (a^2 + x^2)^(3/2))
// (Walter et al. 2007, "Microfacet models for refraction through rough surfaces", integrated over
// the other axis), of which the share below x is 1/2 + x / (2 sqrt(a^2 + x^2)). Where facets slope,
// the mirrored ray moves over the plane of the face; along each of the face's axes the lobe is
// taken to spread by itself. Wide lobes are met at points of the face instead.
#include "area_faces.h"

#include <cmath>

#include "ray_types.h"
#include "shade_chunk.h"

namespace sailenv {
namespace {

// Rays along a face count as if they led to it by this cosine.
constexpr float LEAST_SLANT = 1e-3f;
// The narrowest lobe, in halves of a face's side.
constexpr float NARROWEST = 1e-4f;
// Square of the sine to the normal up to where the plane of incidence is any.
constexpr float HEAD_ON = 1e-8f;

// Width of a lobe, in halves of the narrower side, from where on points tell of it, and alone.
constexpr float NARROW = 0.3f, WIDE = 0.6f;
// Places and weights of Gauss and Legendre along an axis from -1 to 1.
constexpr float PLACES[3] = {-0.7745967f, 0.0f, 0.7745967f};
constexpr float WEIGHTS[3] = {5.0f / 9.0f, 8.0f / 9.0f, 5.0f / 9.0f};

vec3 whole_width(const RayLight& l) { return {l.across[0], l.across[1], l.across[2]}; }
vec3 whole_height(const RayLight& l) { return {l.up[0], l.up[1], l.up[2]}; }

float area_of(const RayLight& l) {
    const vec3 across = whole_width(l), up = whole_height(l);
    return std::sqrt(dot(across, across) * dot(up, up));
}

// Share of facets whose slope along an axis is below one, in widths of the lobe.
f8 share_below(f8 x) { return 0.5f + 0.5f * x / sqrt8(1.0f + x * x); }

// Along an axis of a face: where the mirrored ray leads, and how far facets of slope 1 move it,
// those that slope in the plane of incidence and those that slope across it.
LobeOnFace::Axis axis_of(f8 middle, f8 first, f8 second, f8 rough) {
    LobeOnFace::Axis r;
    r.middle = middle;
    r.width = max8(rough * sqrt8(first * first + second * second), splat(NARROWEST));
    const f8 scale = 1.0f / r.width;
    r.below = share_below((-1.0f - middle) * scale);
    r.share = share_below((1.0f - middle) * scale) - r.below;
    return r;
}

// A unit vector across a normal.
Vec3x8 across_of(Vec3x8 n) {
    const f8 none = splat(0.0f);
    const Vec3x8 flat = where(abs8(n.z) < 0.7f, Vec3x8(-n.y, n.x, none), Vec3x8(none, -n.z, n.y));
    return flat * inverse_length(flat);
}

}  // namespace

float LobeOnFace::place(const Axis& axis, int lane, float part) {
    const float y = 2.0f * (axis.below[lane] + axis.share[lane] * part) - 1.0f;
    const float x = axis.middle[lane] + axis.width[lane] * y / std::sqrt(max(1.0f - y * y, 1e-6f));
    return x < -1.0f ? -1.0f : min(x, 1.0f);
}

vec3 place_on_face(const RayLight& light, float x, float y) {
    return light.lamp.position + whole_width(light) * (0.5f * x) + whole_height(light) * (0.5f * y);
}

LobeOnFace lobe_on_face(const RayLight& light, Vec3x8 point, Vec3x8 along, Vec3x8 normal,
                        f8 roughness) {
    const vec3 across = whole_width(light), up = whole_height(light);
    const vec3 shines = light.lamp.direction;
    const vec3 half_across = across * (2.0f / dot(across, across)),
               half_up = up * (2.0f / dot(up, up));
    const f8 facing = -dot(along, normal);
    const Vec3x8 ray = along + 2.0f * facing * normal;
    const f8 into = dot(ray, shines), slant = min8(into, splat(-LEAST_SLANT));
    const Vec3x8 to_middle = splat(light.lamp.position) - point;
    const f8 before = dot(to_middle, shines), reach = before / slant;
    const i8 ahead = (into < 0.0f) & (before < 0.0f);
    if (!any(before < 0.0f)) return LobeOnFace{};
    const Vec3x8 place = ray * reach - to_middle;
    // Facets that slope in the plane of incidence turn the ray by twice as much, those that slope
    // across it by less the more it grazes.
    const Vec3x8 across_both = cross(normal, along);
    const f8 sine2 = dot(across_both, across_both);
    const f8 inverse_sine = 1.0f / sqrt8(max8(sine2, splat(HEAD_ON)));
    const Vec3x8 side = where(sine2 > HEAD_ON, across_both * inverse_sine, across_of(normal));
    const auto moved = [&](Vec3x8 turned) {
        return (turned - ray * (dot(turned, shines) / slant)) * reach;
    };
    const Vec3x8 first = moved(cross(side, ray) * 2.0f),
                 second = moved(side * (2.0f * abs8(facing)));
    const f8 rough = roughness * roughness;
    LobeOnFace r;
    r.across =
        axis_of(dot(place, half_across), dot(first, half_across), dot(second, half_across), rough);
    r.up = axis_of(dot(place, half_up), dot(first, half_up), dot(second, half_up), rough);
    r.share = ahead ? r.across.share * r.up.share : splat(0.0f);
    return r;
}

FaceLight light_of_face(const RayLight& light, const LobeOnFace& met, Vec3x8 point, Vec3x8 along,
                        Vec3x8 normal, f8 roughness, f8 head_on) {
    const f8 width = min8(met.across.width, met.up.width);
    const f8 wide = smoothstep(NARROW, WIDE, width);
    const i8 mirrors_around = roughness > MIRRORS_ROOM;
    if (!any((wide > 0.0f) | mirrors_around)) return {met.share, splat(0.0f)};
    const float quarter = 0.25f * area_of(light);
    const f8 square = roughness * roughness, a2 = square * square;
    const f8 nv = min8(abs8(dot(normal, along)) + 1e-4f, splat(1.0f));
    f8 sent = splat(0.0f), arrives = splat(0.0f);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const Vec3x8 to = splat(place_on_face(light, PLACES[i], PLACES[j])) - point;
            const f8 distance2 = lamp_square(to);
            const Vec3x8 towards = to * (1.0f / sqrt8(distance2));
            Vec3x8 halfway = towards - along;
            halfway = halfway * inverse_length(halfway);
            const f8 nl = max8(dot(normal, towards), splat(0.0f));
            const f8 nh = clamp8(dot(normal, halfway), 0.0f, 1.0f);
            const f8 vh = clamp8(-dot(along, halfway), 0.0f, 1.0f);
            const f8 fresnel = head_on + (1.0f - head_on) * schlick_share(vh);
            const f8 seen =
                lamp_falloff(light.lamp, distance2, -dot(towards, light.lamp.direction));
            const f8 lobe = nl > 0.0f ? microfacet_lobe(a2, nl, nv, nh) * nl : splat(0.0f);
            const float weight = WEIGHTS[i] * WEIGHTS[j] * quarter;
            sent = sent + weight * (fresnel * lobe * seen);
            arrives = arrives + (weight / PI) * (nl * seen);
        }
    }
    const Mirroring term = mirroring(roughness, nv);
    const f8 even = head_on * term.x + term.y;
    const f8 share = clamp8(sent / max8(even, splat(1e-3f)), 0.0f, 1.0f);
    return {met.share + (share - met.share) * wide,
            mirrors_around ? min8(arrives, splat(1.0f)) : splat(0.0f)};
}

Vec3x8 mirrored_faces(const Light& light, Vec3x8 point, Vec3x8 along, Vec3x8 normal, f8 roughness) {
    Vec3x8 sum = splat(vec3(0.0f, 0.0f, 0.0f));
    for (int64_t k = 0; k < light.mirrored_light_count; k++) {
        const RayLight& l = light.mirrored_lights[k];
        if (l.lamp.kind != LIGHT_AREA) continue;
        sum = sum + lobe_on_face(l, point, along, normal, roughness).share * face_radiance(l);
    }
    return sum;
}

vec3 face_radiance(const RayLight& light) { return light.lamp.colour * (1.0f / area_of(light)); }

vec3 radiance_of_faces(const Light& light, vec3 from, vec3 ray, float end) {
    vec3 sum(0.0f, 0.0f, 0.0f);
    for (int64_t k = 0; k < light.mirrored_light_count; k++) {
        const RayLight& l = light.mirrored_lights[k];
        const float along = dot(ray, l.lamp.direction);
        if (l.lamp.kind != LIGHT_AREA || along > -1e-6f) continue;
        const vec3 to_middle = l.lamp.position - from;
        const float distance = dot(to_middle, l.lamp.direction) / along;
        if (!(distance > 0.0f && distance < end)) continue;
        const vec3 place = ray * distance - to_middle;
        const vec3 across = whole_width(l), up = whole_height(l);
        if (std::fabs(dot(place, across)) > 0.5f * dot(across, across)) continue;
        if (std::fabs(dot(place, up)) > 0.5f * dot(up, up)) continue;
        sum = sum + face_radiance(l);
    }
    return sum;
}

}  // namespace sailenv
