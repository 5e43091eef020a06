// Smooths stair-steps along edges of brightness, and nothing else: where the contrast of a pixel
// with its four neighbours is high, it is blended along the edge's direction.
layout(location = 0) out vec4 out_colour;

uniform sampler2D picture;  // luma in alpha
uniform vec2 texel;         // 1 / size

const float LEAST_CONTRAST = 0.04;
const float RELATIVE_CONTRAST = 0.10;
const float REACH_PX = 6.0;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(picture, 0) - 1;
    vec4 here = texelFetch(picture, pixel, 0);
    float up = texelFetch(picture, ivec2(pixel.x, max(pixel.y - 1, 0)), 0).a;
    float down = texelFetch(picture, ivec2(pixel.x, min(pixel.y + 1, last.y)), 0).a;
    float left = texelFetch(picture, ivec2(max(pixel.x - 1, 0), pixel.y), 0).a;
    float right = texelFetch(picture, ivec2(min(pixel.x + 1, last.x), pixel.y), 0).a;
    float low = min(here.a, min(min(up, down), min(left, right)));
    float high = max(here.a, max(max(up, down), max(left, right)));
    out_colour = here;
    if (high - low < max(LEAST_CONTRAST, RELATIVE_CONTRAST * high)) return;

    vec2 at = gl_FragCoord.xy * texel;
    float nw = texture(picture, at + texel * vec2(-0.5, -0.5)).a;
    float ne = texture(picture, at + texel * vec2(0.5, -0.5)).a;
    float sw = texture(picture, at + texel * vec2(-0.5, 0.5)).a;
    float se = texture(picture, at + texel * vec2(0.5, 0.5)).a;
    vec2 gradient = vec2((ne + se) - (nw + sw), (sw + se) - (nw + ne));
    vec2 along = vec2(-gradient.y, gradient.x);
    float smallest = min(abs(along.x), abs(along.y));
    along = clamp(along / max(smallest, 0.02 * (abs(along.x) + abs(along.y)) + 1e-4), -REACH_PX, REACH_PX);
    along *= texel;
    vec3 near_ones = 0.5 * (texture(picture, at + along * -0.17).rgb + texture(picture, at + along * 0.17).rgb);
    vec4 far_a = texture(picture, at + along * -0.5), far_b = texture(picture, at + along * 0.5);
    vec3 all_four = 0.5 * near_ones + 0.25 * (far_a.rgb + far_b.rgb);
    float luma = dot(all_four, vec3(0.299, 0.587, 0.114));
    // Far samples that fall outside the edge's own range belong to another one.
    out_colour.rgb = (luma < low || luma > high) ? near_ones : all_four;
}
