// Leaves depth and instance id of each pixel; for pictures also normal and material.
#include "draw.glsl"

layout(location = 0) out vec2 out_surface;  // depth along the optical axis [m], instance id

#ifdef SHADED
#include "textures.glsl"

#include "lens.h"
uniform Lens lens;

in vec3 optical_normal;
in vec2 uv;
#ifndef UNLIT
layout(location = 1) out vec4 out_shape;   // octahedral normal, roughness, metallic
layout(location = 2) out vec4 out_albedo;  // square root of linear albedo, emission / 16
#endif
#ifdef BAKED
in vec2 light_uv;
layout(location = 3) out vec2 out_light_at;  // place in the light map, or a factor and what is hidden
#endif
#endif
// Views that are written as they are; the fourth component is 1 where there is a surface.
#ifdef OUT_NORMALS
layout(location = OUT_NORMALS) out vec4 out_normals;  // unit, optical frame
#endif
#ifdef OUT_ALBEDO
layout(location = OUT_ALBEDO) out vec4 out_base;  // linear base colour
#endif
#ifdef OUT_UV
layout(location = OUT_UV) out vec4 out_uv;  // texture coordinates
#endif
#ifdef OUT_METALLIC_ROUGHNESS
layout(location = OUT_METALLIC_ROUGHNESS) out vec4 out_finish;  // metalness, roughness
#endif

#if defined(SHADED) && !defined(UNLIT)
vec2 octahedral(vec3 n) {
    vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
    return n.z >= 0.0 ? p : folded;
}
#endif

void main() {
    // Clip w is the depth, and gl_FragCoord.w its reciprocal, which is linear in the window:
    // the most exact form in which the rasteriser knows it.
    out_surface = vec2(1.0 / gl_FragCoord.w, INSTANCE_ID);
#ifdef SHADED
#ifndef UNLIT
    vec3 colour = picture_colour(uv);
#endif
#ifdef MASKED
    if (base_colour(uv).a < cutoff(MATERIAL_FINISH.z, uv)) discard;
#endif
    vec3 normal = normalize(optical_normal) * (gl_FrontFacing ? 1.0 : -1.0);
#ifdef OUT_NORMALS
    out_normals = vec4(normal, 1.0);
#endif
#ifdef OUT_UV
    out_uv = vec4(uv, 0.0, 1.0);
#endif
#ifdef OUT_ALBEDO
    vec3 root = MATERIAL_BASE;
#ifdef COLOUR_MAP
    root *= texture(colour_maps, vec3(uv, MATERIAL_LAYERS.x)).rgb;
#endif
    out_base = vec4(root * root, 1.0);
#endif
#ifdef OUT_METALLIC_ROUGHNESS
    vec2 finish = roughness_metallic(MATERIAL_FINISH.xy, packed_map(uv));
    out_finish = vec4(finish.yx, 0.0, 1.0);
#endif
#ifndef UNLIT
    vec4 packed_texel = packed_map(uv);
#ifdef NORMAL_MAP
    vec3 point = ray_through(lens, gl_FragCoord.xy - 0.5) / gl_FragCoord.w;
    normal = mapped_normal(packed_texel.xy, uv, normal, point);
#endif
    vec2 rough_metal = roughness_metallic(MATERIAL_FINISH.xy, packed_texel);
    out_shape = vec4(octahedral(normal), rough_metal);
    out_albedo = vec4(colour, MATERIAL_FINISH.w);
#ifdef BAKED
    // Factors are known of the front.
    out_light_at = gl_FrontFacing ? light_uv : max(light_uv, vec2(0.0));
#endif
#endif
#endif
}
