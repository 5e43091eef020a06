// Depth as the light sees it; its draws hold the light's clip matrices.
in vec3 in_position;

#include "draw.glsl"

void main() {
    gl_Position = CLIP_FROM_OBJECT * vec4(in_position, 1.0);
}
