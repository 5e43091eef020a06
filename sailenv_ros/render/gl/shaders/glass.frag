// What see-through surfaces do to the picture behind them: each colour is dimmed by what does not
// come through, and what they mirror and scatter themselves is added.
layout(location = 0, index = 0) out vec4 out_added;    // see picture.glsl
layout(location = 0, index = 1) out vec4 out_through;  // share of what lies behind

#include "draw.glsl"
#include "picture.glsl"
#include "textures.glsl"
#include "instance_light.glsl"
#include "reflections.glsl"

in vec3 optical_normal;
in vec2 uv;
#ifdef BAKED
in vec2 light_uv;  // place in the light map, or a factor and what is hidden
#endif

// Irradiance / pi on a surface.
vec3 light_around(vec3 world_normal, vec3 point, vec3 albedo) {
#ifdef BAKED
    vec3 light = light_of_instance(int(INSTANCE_ID + 0.5), world_normal, world_from_optical * point + eye);
    light *= vertex_factor(gl_FrontFacing ? light_uv.x : 0.0);
    float hidden = light_uv.x > 0.0 ? 0.0 : light_uv.y;
    return light * vec3(arriving_share(hidden, albedo.r), arriving_share(hidden, albedo.g), arriving_share(hidden, albedo.b));
#else
    return light_of_sky(world_normal);
#endif
}

vec3 mirrored_light(vec3 point, vec3 direction, float roughness) {
#ifdef REFLECTIONS
    return mirrored_room(reflection_point(int(INSTANCE_ID + 0.5)), world_from_optical * point + eye, direction, roughness);
#else
    return ambient + sky_share * sky(direction);
#endif
}

void main() {
    vec4 base = base_colour(uv);
    base.rgb *= base.rgb;
    vec3 ray = ray_through(lens, gl_FragCoord.xy - 0.5);
    vec3 view = -normalize(ray);
    vec3 normal = normalize(optical_normal);
    if (dot(normal, view) < 0.0) normal = -normal;
    // A pixel at a border mirrors what it does in its middle, wherever its centre lies: there the
    // square of the cosine grows evenly from 0 on. What it mirrors in many directions is as if it
    // were rough.
    float square = dot(normal, view) * dot(normal, view);
    float least = 0.5 * max(abs(dFdx(square)), abs(dFdy(square)));
    float share = pane_reflectance(sqrt(max(square, least)), MATERIAL_FINISH.x);
    float bend = max(length(dFdx(normal)), length(dFdy(normal)));
    float roughness = clamp(bend, MATERIAL_FINISH.x, 1.0);
    // What comes through takes the hue of the material, the more the denser it is.
    vec3 hue = base.rgb / max(max(base.r, max(base.g, base.b)), 1e-3);
    vec3 through = (1.0 - share) * (1.0 - base.a) * mix(vec3(1.0), hue, base.a);
    vec3 world_normal = world_from_optical * normal;
    vec3 mirrored = world_from_optical * reflect(-view, normal);
    vec3 added = share * mirrored_light(ray / gl_FragCoord.w, mirrored, roughness);
    added += (1.0 - share) * base.a * base.rgb * light_around(world_normal, ray / gl_FragCoord.w, base.rgb);
    added += base.rgb * (MATERIAL_FINISH.w * 16.0);
    // The share of light from around stays that of what lies behind.
    out_added = vec4(finished(added, vec3(0.0)).rgb, 0.0);
    out_through = vec4(through, 1.0);
}
