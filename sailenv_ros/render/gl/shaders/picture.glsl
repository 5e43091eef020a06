// What the lit surfaces and the sky of a picture share.
uniform vec3 sky_zenith;
uniform vec3 sky_horizon;
uniform vec3 sky_ground;
uniform vec4 lens;               // focal length, cx, cy [px], exposure factor
uniform mat3 world_from_optical;

const vec3 LUMA = vec3(0.299, 0.587, 0.114);

vec3 sky(vec3 world_direction) {
    float up = world_direction.z;
    vec3 upper = mix(sky_horizon, sky_zenith, sqrt(clamp(up, 0.0, 1.0)));
    return mix(upper, sky_ground, smoothstep(0.0, 0.12, -up));
}

// What a picture holds of a pixel: exposed radiance, and the share of it that came from around and
// not straight from a lamp. Tone curve and sRGB follow on the processor (develop.py).
vec4 finished(vec3 radiance, vec3 from_around) {
    float share = dot(from_around, LUMA) / max(dot(radiance, LUMA), 1e-6);
    // Half precision ends at 65504.
    return vec4(min(radiance * lens.w, vec3(6e4)), min(share, 1.0));
}
