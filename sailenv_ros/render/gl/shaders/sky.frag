// Pixels that hit nothing: the sky or a plain colour.
layout(location = 0) out vec4 out_colour;  // see picture.glsl

#include "picture.glsl"

uniform vec4 background;  // colour; 1 if it is shown instead of the sky
#ifdef SKY_MAP
uniform sampler2D sky_map;  // equirectangular, row 0 is the zenith
uniform float sky_factor;   // of its radiance

vec3 mapped_sky(vec3 d) {
    const float PI = 3.14159265;
    // Of the finest level always: at the seam the derivatives of the angle mean nothing.
    vec2 place = vec2(0.5 - atan(d.y, d.x) / (2.0 * PI), acos(d.z) / PI);
    return sky_factor * textureLod(sky_map, place, 0.0).rgb;
}
#else
#define mapped_sky sky
#endif

void main() {
    vec3 ray = ray_through(lens, gl_FragCoord.xy - 0.5);
    vec3 seen = background.a > 0.5 ? background.rgb : mapped_sky(normalize(world_from_optical * ray));
    out_colour = finished(seen, vec3(0.0));
}
