// Object space to clip space with one matrix composed in double precision: no sum of large numbers.
in vec3 in_position;
in vec3 in_normal;
in vec2 in_uv;
#ifdef BAKED
in vec2 in_light_uv;
out vec2 light_uv;
#endif

#include "draw.glsl"
#ifdef BAKED
#include "vertex_factors.glsl"
#endif

#include "lens.h"
uniform Lens lens;

#ifdef SHADED
out vec3 optical_normal;
out vec2 uv;
#endif

out float gl_ClipDistance[1];

void main() {
    gl_Position = CLIP_FROM_OBJECT * vec4(in_position, 1.0);
    // Depth clamp lets surfaces nearer than near through; it must not let those beyond far.
    gl_ClipDistance[0] = lens.far_m - gl_Position.w;
#ifdef SHADED
    optical_normal = OPTICAL_NORMAL_FROM_OBJECT * in_normal;
    uv = in_uv;
#ifdef BAKED
    light_uv = LIGHT_CHART.xy + LIGHT_CHART.zw * in_light_uv;
    float factor = factor_of_vertex(int(INSTANCE_ID + 0.5), gl_VertexID + int(TO_MODEL_VERTEX));
    if (factor > 0.0) light_uv.x = -factor;
#endif
#endif
}
