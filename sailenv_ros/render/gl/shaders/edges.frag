// Smooth edges: where a pixel's samples see several surfaces, the mean of their light; elsewhere the
// light of its middle. The samples lie half a pixel apart, see half_pixels.py.
layout(location = 0) out vec4 out_colour;  // see picture.glsl

uniform sampler2D surface;
uniform sampler2D shape;
uniform sampler2D picture;

const float LEAST_COSINE = 0.9;     // between normals within one smooth surface
const float LEAST_NEARNESS = 0.01;  // as a share: by that much a sample may lie off a plane

#include "octahedral.glsl"

void main() {
    ivec2 middle = 2 * ivec2(gl_FragCoord.xy) + 1;
    vec2 own = texelFetch(surface, middle, 0).xy;
    vec3 normal = unfolded(texelFetch(shape, middle, 0).xy);
    bool mixed = false;
    vec4 sum = vec4(0.0);
    for (int row = -1; row <= 1; row++) {
        for (int column = -1; column <= 1; column++) {
            ivec2 step = ivec2(column, row);
            vec2 there = texelFetch(surface, middle + step, 0).xy;
            float opposite = texelFetch(surface, middle - step, 0).x;
            mixed = mixed || there.y != own.y;
            if (own.y > 0.0 && there.y == own.y) {
                vec3 turned = unfolded(texelFetch(shape, middle + step, 0).xy);
                // Over a plane 1 / depth is linear.
                float off = abs(0.5 * own.x * (1.0 / there.x + 1.0 / opposite) - 1.0);
                mixed = mixed || dot(turned, normal) < LEAST_COSINE || off > LEAST_NEARNESS;
            }
            float weight = float((2 - abs(column)) * (2 - abs(row)));
            sum += weight * texelFetch(picture, middle + step, 0);
        }
    }
    out_colour = mixed ? sum / 16.0 : texelFetch(picture, middle, 0);
}
