// What the lit surfaces and the sky of a picture share.
uniform vec3 sky_zenith;
uniform vec3 sky_horizon;
uniform vec3 sky_ground;
uniform vec4 lens;               // focal length, cx, cy [px], exposure factor
uniform mat3 world_from_optical;

vec3 sky(vec3 world_direction) {
    float up = world_direction.z;
    vec3 upper = mix(sky_horizon, sky_zenith, sqrt(clamp(up, 0.0, 1.0)));
    return mix(upper, sky_ground, smoothstep(0.0, 0.12, -up));
}

// Filmic curve: a rational fit to the ACES reference tone scale (Narkowicz 2015).
vec3 filmic(vec3 c) {
    return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0);
}

vec4 finished(vec3 radiance) {
#ifdef LINEAR
    return vec4(min(radiance, vec3(6e4)), 1.0);
#else
    vec3 c = filmic(radiance * lens.w);
    // The sRGB curve as a sum of roots, within 0.001 of it: powers cost a CPU more than the lamps.
    vec3 root = sqrt(c), fourth = sqrt(root), eighth = sqrt(fourth);
    c = max(0.662002687 * root + 0.68412206 * fourth - 0.323583601 * eighth - 0.022541147 * c, 0.0);
    return vec4(c, dot(c, vec3(0.299, 0.587, 0.114)));
#endif
}
