// Shading: what surfaces send to the eye of the light that arrives; the same model as
// shaders/lighting.frag.
#include "shade_chunk.h"

namespace sailenv {
namespace {

// A surface of eight pixels, as the light from one direction meets it.
struct Surface8 {
    Vec3x8 point, normal, view;  // world frame; `view` leads to the eye
    Vec3x8 diffuse, f0;
    f8 a2, nv;  // roughness to the fourth power, cosine of the viewing angle
};

// Diffuse below Schlick's Fresnel term, mirrored above it.
template <class Direction, class Power>
LANES_INLINE void add_reflected(const Surface8& s, Direction towards, Power power, Vec3x8& sum) {
    const f8 nl = clamp8(dot(s.normal, towards), 0.0f, 1.0f);
    Vec3x8 halfway = towards + s.view;
    halfway = halfway * inverse_length(halfway);
    const f8 nh = clamp8(dot(s.normal, halfway), 0.0f, 1.0f);
    const f8 vh = clamp8(dot(s.view, halfway), 0.0f, 1.0f);
    const f8 lobe = microfacet_lobe(s.a2, nl, s.nv, nh);
    const Vec3x8 fresnel = s.f0 + (1.0f - s.f0) * schlick_share(vh);
    sum = sum + power * nl * (s.diffuse * (1.0f - fresnel) * (1.0f / PI) + fresnel * lobe);
}

void add_lamp(const Lamp& lamp, const Surface8& s, Vec3x8& sum) {
    if (lamp.kind == LIGHT_DIRECTIONAL) {
        add_reflected(s, -lamp.direction, lamp.colour, sum);
        return;
    }
    const Vec3x8 offset = lamp.position - s.point;
    const f8 square = lamp_square(offset);
    const Vec3x8 towards = offset * (1.0f / sqrt8(square));
    const f8 share = lamp_falloff(lamp, square, -dot(towards, lamp.direction));
    if (!any((share > 0.0f) & (dot(s.normal, towards) > 0.0f))) return;
    add_reflected(s, towards, lamp.colour * share, sum);
}

// What a surface sends to the eye of the light around it and of what it mirrors.
LANES_INLINE Vec3x8 from_environment(const Surface8& s, f8 roughness, Vec3x8 around,
                                     Vec3x8 mirrored) {
    const Mirroring term = mirroring(roughness, s.nv);
    const f8 lost = 1.0f - (term.x + term.y);
    // Single bounces in the microfacets, and what comes back from further ones (Fdez-Aguera
    // 2019, "A multiple-scattering microfacet model").
    const Vec3x8 once = s.f0 * term.x + term.y;
    const Vec3x8 mean = s.f0 + (1.0f - s.f0) * (1.0f / 21.0f);
    const Vec3x8 again = lost * once * mean / (1.0f - mean * lost);
    return once * mirrored + (again + s.diffuse * (1.0f - once - again)) * around;
}

}  // namespace

void reflect_to_eye(const Shading& s, Chunk& c) {
    const Light& light = *s.light;
    const bool has_main = has_main_light(light);
    for (int32_t i = 0; i < c.padded; i += 8) {
        const Vec3x8 ray = c.ray.at(i), base = c.base.at(i);
        const f8 metallic = load(c.metallic + i), roughness = load(c.roughness + i);
        Surface8 here;
        here.point = c.point.at(i);
        here.normal = c.normal.at(i);
        here.view = ray * -inverse_length(ray);
        here.f0 = reflectance_head_on(base, metallic);
        here.diffuse = base * (1.0f - metallic);
        const f8 square = roughness * roughness;
        here.a2 = square * square;
        here.nv = abs8(dot(here.normal, here.view)) + 1e-4f;
        Vec3x8 sum = from_environment(here, roughness, c.around.at(i), c.mirrored.at(i));
        store(c.from_around + i, luminance(sum));
        sum = sum + base * load(c.emission + i);
        const f8 arrives = load(c.arrives + i);
        if (has_main && any(arrives > 0.0f)) {
            add_reflected(here, light.main_towards, light.main_colour * arrives, sum);
        }
        for (int32_t k = 0; k < light.lamp_count; k++) add_lamp(light.lamps[k], here, sum);
        const i8 beyond = light.outside_id > 0 ? load(c.id + i) == light.outside_id : splat(0);
        if (any(beyond)) {
            sum = where(beyond, base * light.outside_radiance, sum);
            store(c.from_around + i, beyond ? splat(0.0f) : load(c.from_around + i));
        }
        c.light.set(i, sum);
    }
}

}  // namespace sailenv
