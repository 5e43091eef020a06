// Lights what the geometry pass left: metallic-roughness surfaces under sun, lamps and sky.
// GGX distribution, height-correlated Smith visibility, Schlick's Fresnel term.
layout(location = 0) out vec4 out_colour;  // see picture.glsl

uniform sampler2D surface;
uniform sampler2D shape;
uniform sampler2D albedo;
uniform sampler2DShadow shadow_map;

#include "picture.glsl"

layout(std140, binding = 0) uniform Lamps { Lamp lamps[MAX_LIGHTS]; };  // optical frame

uniform int lamp_count;            // lamps beside the main light
uniform vec3 main_colour;          // linear colour times intensity; 0 if there is none
uniform vec3 main_towards;         // optical frame
uniform mat4 shadow_from_optical;
uniform vec3 shadow_texel;       // size of a texel [m], its share of the map, penumbra [texels]
uniform float outside_id;          // of what lies outside the room, which shines as the sky; 0
uniform float outside_radiance;    // of its white
#ifdef BAKED
uniform sampler2D light_at;        // place in the light map, or a factor and what is hidden
uniform sampler2D light_map;       // irradiance / pi; share of the main light that arrives
uniform sampler2DShadow static_shadow_map;  // of what stands still; the other is of what moves
uniform float main_transmittance;   // of glass, for what is not in the light map
uniform float main_baked;          // 1 if the light map knows the main light's shadows
uniform isampler2D edge_index;     // of the light map's texels: number of a block, or -1
uniform sampler2D edge_blocks;     // 6 by 6 shares of main light each, 128 blocks in a row
#endif
#include "instance_light.glsl"
#include "reflections.glsl"
#include "octahedral.glsl"

const float PI = 3.14159265;

// `lift`: how far above its surface a point is looked up, lest this casts shadows on itself [texels].
vec3 in_shadow_map(vec3 point, vec3 normal, float lift) {
    return (shadow_from_optical * vec4(point + normal * shadow_texel.x * lift, 1.0)).xyz;
}

#ifdef BAKED
// Share of the main light where its shadows end, from blocks of four by four points a texel with
// a border; elsewhere the light map's.
float edge_share(vec2 place, float share) {
    if (share <= 0.0 || share >= 1.0) return share;
    vec2 at = place * vec2(textureSize(edge_index, 0));
    ivec2 texel = ivec2(at);
    int block = texelFetch(edge_index, texel, 0).x;
    if (block < 0) return share;
    vec2 within = 4.0 * (at - vec2(texel)) + 0.5;
    ivec2 corner = min(ivec2(within), ivec2(4));
    vec2 beyond = within - vec2(corner);
    ivec2 first = 6 * ivec2(block % 128, block / 128) + corner;
    float a = texelFetch(edge_blocks, first, 0).x;
    float b = texelFetch(edge_blocks, first + ivec2(1, 0), 0).x;
    float c = texelFetch(edge_blocks, first + ivec2(0, 1), 0).x;
    float d = texelFetch(edge_blocks, first + ivec2(1, 1), 0).x;
    return mix(mix(a, b, beyond.x), mix(c, d, beyond.x), beyond.y);
}
#endif

#ifndef BAKED
float four_taps(sampler2DShadow map, vec3 at) {
    if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
    float r = shadow_texel.y * shadow_texel.z;
    float lit = texture(map, at + vec3(0.94, 0.34, 0.0) * r);
    lit += texture(map, at + vec3(-0.34, 0.94, 0.0) * r);
    lit += texture(map, at + vec3(-0.94, -0.34, 0.0) * r);
    lit += texture(map, at + vec3(0.34, -0.94, 0.0) * r);
    return lit / 4.0;
}
#endif

struct Surface {
    vec3 point, normal, view;  // optical frame
    vec3 diffuse, f0;
    float a2, nv;              // roughness to the fourth power, cosine of the viewing angle
};

vec3 reflected_light(Surface s, vec3 towards, vec3 power) {
    float nl = clamp(dot(s.normal, towards), 0.0, 1.0);
    vec3 halfway = normalize(towards + s.view);
    float nh = clamp(dot(s.normal, halfway), 0.0, 1.0);
    float vh = clamp(dot(s.view, halfway), 0.0, 1.0);
    float lobe = microfacet_lobe(s.a2, nl, s.nv, nh);
    vec3 fresnel = s.f0 + (1.0 - s.f0) * schlick_share(vh);
    return power * nl * (s.diffuse * (1.0 - fresnel) / PI + fresnel * lobe);
}

vec3 lamp_light(Lamp lamp, Surface s) {
    if (lamp.kind == LIGHT_DIRECTIONAL) return reflected_light(s, -lamp.direction, lamp.colour);
    vec3 offset = lamp.position - s.point;
    float square = lamp_square(offset);
    vec3 towards = offset * inversesqrt(square);
    float share = lamp_falloff(lamp, square, -dot(towards, lamp.direction));
    return reflected_light(s, towards, lamp.colour * share);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float z = texelFetch(surface, pixel, 0).x;
    vec3 ray = ray_through(lens, gl_FragCoord.xy - 0.5);
    vec4 s = texelFetch(shape, pixel, 0);
    vec4 a = texelFetch(albedo, pixel, 0);
    vec3 base = a.rgb * a.rgb;
    vec3 normal = unfolded(s.xy);
    vec3 point = ray * z;
    vec3 view = -normalize(ray);
    float roughness = s.z, metallic = s.w;
    vec3 f0 = mix(vec3(0.04), base, metallic);
    vec3 diffuse = base * (1.0 - metallic);
    float a2 = roughness * roughness;
    a2 *= a2;

    float nv = abs(dot(normal, view)) + 1e-4;
    vec3 world_normal = world_from_optical * normal;
    float facing = dot(normal, main_towards);
#ifdef BAKED
    vec2 place = texelFetch(light_at, pixel, 0).xy;
    float charted = place.x > 0.0 ? 1.0 : 0.0;
    // What stands still is not among what casts into the map of what moves.
    float mapped_main = charted * main_baked;
    float lift = 0.2 + 1.5 * sqrt(max(1.0 - facing * facing, 0.0));
    vec3 in_shadow = in_shadow_map(point, normal, (1.0 - mapped_main) * lift);
    // What moves casts edges of one texel; soft shadows of what stands still are in the light map.
    float main_arrives = texture(shadow_map, in_shadow);
    vec4 mapped = textureLod(light_map, place, 0.0);
    int id = int(texelFetch(surface, pixel, 0).y + 0.5);
    vec3 place_in_world = world_from_optical * point + eye;
    vec3 probed = light_of_instance(id, world_normal, place_in_world) * vertex_factor(place.x);
    // What has no place in the light map has there a factor and the share that it hides of itself.
    for (int k = 0; k < 3; k++) probed[k] *= arriving_share(place.y, diffuse[k]);
    vec3 around = mix(probed, mapped.rgb, charted);
    float past_what_stands = main_transmittance * texture(static_shadow_map, in_shadow);
    float known = edge_share(place, mapped.a);
    main_arrives *= mix(past_what_stands, known, mapped_main);
    vec3 reflected = around;
#else
    vec3 in_shadow = in_shadow_map(point, normal, 1.0 + 2.0 * (1.0 - facing));
    float main_arrives = four_taps(shadow_map, in_shadow);
    vec3 around = light_of_sky(world_normal);
#endif
#if defined(REFLECTIONS) || !defined(BAKED)
    vec3 mirrored = world_from_optical * reflect(-view, normal);
#endif
#ifdef REFLECTIONS
    int seen_from = reflection_point(id);
    vec3 room = mirrored_room(seen_from, place_in_world, mirrored, roughness);
    // Where less light arrives than where the room was seen from, less of it is seen as well.
    float in_the_open = dot(room_light[seen_from], vec4(1.0, world_normal));
    room *= clamp(luminance(around) / max(in_the_open, 1e-4), 0.0, 1.0);
    reflected = mix(room, around, share_mirrored_around(roughness));
#elif !defined(BAKED)
    vec3 soft = sky_irradiance(mirrored.z, sky_zenith, sky_horizon, sky_ground);
    vec3 reflected =
        ambient + sky_share * mix(sky(mirrored), soft, min(1.0, roughness * 1.4));
#endif
    float cosine = min(nv, 1.0);
    vec2 term = vec2(mirrored_scale(roughness, cosine), mirrored_bias(roughness, cosine));
    // What single bounces in the microfacets lose comes back from further ones, so that a white
    // surface in uniform light vanishes (Fdez-Aguera 2019, "A multiple-scattering microfacet model").
    vec3 once = f0 * term.x + term.y;
    float lost = 1.0 - (term.x + term.y);
    vec3 mean = f0 + (1.0 - f0) / 21.0;
    vec3 again = lost * once * mean / (1.0 - mean * lost);
    vec3 radiance = once * reflected + (again + diffuse * (1.0 - once - again)) * around;
    vec3 from_around = radiance;
    radiance += base * (a.a * 16.0);
    Surface here = Surface(point, normal, view, diffuse, f0, a2, nv);
    radiance += reflected_light(here, main_towards, main_colour * main_arrives);
#ifdef LAMPS
    for (int i = 0; i < lamp_count; i++) radiance += lamp_light(lamps[i], here);
#endif
    if (outside_id > 0.0 && texelFetch(surface, pixel, 0).y == outside_id) {
        radiance = base * outside_radiance;
        from_around = vec3(0.0);
    }
    out_colour = finished(radiance, from_around);
}
