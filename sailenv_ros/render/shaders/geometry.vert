// Object space to clip space with one matrix composed in double precision: no sum of large numbers.
in vec3 in_position;
in vec3 in_normal;
in vec2 in_uv;
#ifdef BAKED
in vec2 in_light_uv;
out vec2 light_uv;
#endif
in int in_draw;  // advances once per draw: the base instance chooses the row

#include "draws.glsl"
#ifdef SHADED
#include "materials.glsl"
#endif

uniform float far_m;

// Fetched once per vertex: a fetch from a buffer costs a software rasteriser much per pixel.
flat out float instance_id;
#ifdef SHADED
out vec3 optical_normal;
out vec2 uv;
flat out vec4 material_colour;
flat out vec4 material_finish;    // roughness, metallic, alpha cutoff, emission
#if defined(COLOUR_MAP) || defined(FINISH_MAP) || defined(NORMAL_MAP)
flat out ivec4 material_layers;
#endif
#endif

out float gl_ClipDistance[1];

void main() {
    gl_Position = draws[in_draw].clip_from_object * vec4(in_position, 1.0);
    // Depth clamp lets surfaces nearer than near through; it must not let those beyond far.
    gl_ClipDistance[0] = far_m - gl_Position.w;
    instance_id = draws[in_draw].instance_id;
#ifdef SHADED
    Material material = materials[draws[in_draw].material];
    material_colour = material.base_colour;
    material_finish = material.finish;
#if defined(COLOUR_MAP) || defined(FINISH_MAP) || defined(NORMAL_MAP)
    material_layers = material.layers;
#endif
    optical_normal = vec3(dot(draws[in_draw].optical_normal_from_object[0].xyz, in_normal),
                          dot(draws[in_draw].optical_normal_from_object[1].xyz, in_normal),
                          dot(draws[in_draw].optical_normal_from_object[2].xyz, in_normal));
    uv = in_uv;
#ifdef BAKED
    vec4 chart = draws[in_draw].light_chart;
    light_uv = chart.xy + chart.zw * in_light_uv;
#endif
#endif
}
