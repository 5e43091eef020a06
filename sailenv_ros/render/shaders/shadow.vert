// Depth as the light sees it; its draws hold the light's clip matrices.
in vec3 in_position;
in int in_draw;

#include "draws.glsl"

void main() {
    gl_Position = draws[in_draw].clip_from_object * vec4(in_position, 1.0);
}
