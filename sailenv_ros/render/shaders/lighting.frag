// Lights what the geometry pass left: metallic-roughness surfaces under sun, lamps and sky.
// GGX distribution, height-correlated Smith visibility, Schlick's Fresnel term.
layout(location = 0) out vec4 out_colour;  // sRGB, luma in alpha for the edge pass

uniform sampler2D surface;
uniform sampler2D shape;
uniform sampler2D albedo;
uniform sampler2DShadow shadow_map;

struct Light {
    vec4 colour_kind;     // linear colour times intensity; 0 directional, 1 point, 2 spot, 3 area
    vec4 position_range;  // optical frame [m]
    vec4 direction_inner; // where it travels to, optical frame; cosine of the inner cone
    vec4 outer_shadow;    // cosine of the outer cone; 1 if it casts the shadow map
};
layout(std140, binding = 0) uniform Lights { Light lights[MAX_LIGHTS]; };

uniform int light_count;
uniform vec4 lens;               // focal length, cx, cy [px], exposure factor
uniform mat3 world_from_optical;
uniform mat4 shadow_from_optical;
uniform vec3 shadow_texel;       // size of a texel [m], its share of the map, penumbra [texels]
uniform vec3 ambient;
uniform vec3 sky_zenith;
uniform vec3 sky_horizon;
uniform vec3 sky_ground;
uniform vec4 background;         // colour; 1 if nothing-hit pixels show it instead of the sky

const float PI = 3.14159265;

vec3 sky(vec3 world_direction) {
    float up = world_direction.z;
    vec3 upper = mix(sky_horizon, sky_zenith, sqrt(clamp(up, 0.0, 1.0)));
    return mix(upper, sky_ground, smoothstep(0.0, 0.12, -up));
}

// Irradiance / pi of that sky on a surface that faces world_normal: its average over the
// hemisphere, fitted to within a few per cent by the share of sky that the surface sees.
vec3 sky_light(vec3 world_normal) {
    vec3 dome = mix(sky_horizon, sky_zenith, 0.55);
    return mix(sky_ground, mix(sky_horizon, dome, max(world_normal.z, 0.0)),
               0.5 + 0.5 * world_normal.z);
}

vec3 unfolded(vec2 p) {
    vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    float fold = max(-n.z, 0.0);
    n.xy -= vec2(n.x >= 0.0 ? fold : -fold, n.y >= 0.0 ? fold : -fold);
    return normalize(n);
}

float shadowed(vec3 point, vec3 normal, float slope) {
    vec3 lifted = point + normal * shadow_texel.x * (1.0 + 2.0 * slope);
    vec3 at = (shadow_from_optical * vec4(lifted, 1.0)).xyz;
    if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
    float r = shadow_texel.y * shadow_texel.z;
    float lit = texture(shadow_map, at) * 2.0;
    lit += texture(shadow_map, at + vec3(0.94, 0.34, 0.0) * r);
    lit += texture(shadow_map, at + vec3(-0.34, 0.94, 0.0) * r);
    lit += texture(shadow_map, at + vec3(-0.94, -0.34, 0.0) * r);
    lit += texture(shadow_map, at + vec3(0.34, -0.94, 0.0) * r);
    return lit / 6.0;
}

vec3 lit_by(Light light, vec3 point, vec3 normal, vec3 view, vec3 diffuse, vec3 f0, float a2) {
    vec3 towards = -light.direction_inner.xyz;
    vec3 power = light.colour_kind.rgb;
    if (light.colour_kind.w > 0.5) {
        vec3 offset = light.position_range.xyz - point;
        float d2 = max(dot(offset, offset), 1e-4);
        towards = offset * inversesqrt(d2);
        float reach = d2 / (light.position_range.w * light.position_range.w);
        float window = clamp(1.0 - reach * reach, 0.0, 1.0);
        power *= window * window / d2;
        float along = dot(-towards, light.direction_inner.xyz);
        if (light.colour_kind.w > 2.5) power *= max(along, 0.0);
        else if (light.colour_kind.w > 1.5)
            power *= smoothstep(light.outer_shadow.x, light.direction_inner.w, along);
    }
    float nl = dot(normal, towards);
    if (nl <= 0.0) return vec3(0.0);
    if (light.outer_shadow.y > 0.5) {
        float lit = shadowed(point, normal, 1.0 - nl);
        if (lit <= 0.0) return vec3(0.0);
        power *= lit;
    }
    vec3 halfway = normalize(towards + view);
    float nh = clamp(dot(normal, halfway), 0.0, 1.0);
    float nv = abs(dot(normal, view)) + 1e-4;
    float vh = clamp(dot(view, halfway), 0.0, 1.0);
    float spread = nh * nh * (a2 - 1.0) + 1.0;
    float distribution = a2 / (PI * spread * spread);
    float visibility = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2));
    float grazing = 1.0 - vh;
    float g2 = grazing * grazing;
    vec3 fresnel = f0 + (1.0 - f0) * (g2 * g2 * grazing);
    return power * nl * (diffuse * (1.0 - fresnel) / PI + fresnel * distribution * visibility);
}

// Split-sum environment term, analytic fit for GGX (Karis, "Physically based shading on mobile").
vec2 environment_term(float nv, float roughness) {
    vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
    return vec2(-1.04, 1.04) * a + r.zw;
}

// Filmic curve: a rational fit to the ACES reference tone scale (Narkowicz 2015).
vec3 filmic(vec3 c) {
    return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0);
}

vec4 finished(vec3 radiance) {
    vec3 c = filmic(radiance * lens.w);
    c = mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
    return vec4(c, dot(c, vec3(0.299, 0.587, 0.114)));
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float z = texelFetch(surface, pixel, 0).x;
    vec3 ray = vec3((gl_FragCoord.xy - 0.5 - lens.yz) / lens.x, 1.0);
    if (isinf(z)) {
        out_colour = finished(background.a > 0.5 ? background.rgb : sky(normalize(world_from_optical * ray)));
        return;
    }
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

    float nv = clamp(dot(normal, view), 0.0, 1.0);
    vec3 world_normal = world_from_optical * normal;
    vec3 around = ambient + sky_light(world_normal);
    vec3 mirrored = world_from_optical * reflect(-view, normal);
    vec3 reflected = ambient + mix(sky(mirrored), sky_light(mirrored), min(1.0, roughness * 1.4));
    vec2 term = environment_term(nv, roughness);
    vec3 radiance = diffuse * around + (f0 * term.x + term.y) * reflected;
    radiance += base * (a.a * 16.0);
    for (int i = 0; i < light_count; i++)
        radiance += lit_by(lights[i], point, normal, view, diffuse, f0, a2);
    out_colour = finished(radiance);
}
