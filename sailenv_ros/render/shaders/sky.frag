// Pixels that hit nothing: the sky or a plain colour.
layout(location = 0) out vec4 out_colour;  // sRGB, luma in alpha for the edge pass

#include "picture.glsl"

uniform vec4 background;  // colour; 1 if it is shown instead of the sky

void main() {
    vec3 ray = vec3((gl_FragCoord.xy - 0.5 - lens.yz) / lens.x, 1.0);
    vec3 seen = background.a > 0.5 ? background.rgb : sky(normalize(world_from_optical * ray));
    out_colour = finished(seen);
}
