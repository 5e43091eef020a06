// What the lit surfaces and the sky of a picture share.
uniform vec3 sky_zenith;
uniform vec3 sky_horizon;
uniform vec3 sky_ground;
uniform vec3 ambient;
uniform float sky_share;         // of the sky's light that reaches the objects
uniform float exposure;          // factor
uniform mat3 world_from_optical;

#include "lens.h"
#include "light_law.h"

uniform Lens lens;

vec3 sky(vec3 world_direction) {
    return sky_radiance(world_direction.z, sky_zenith, sky_horizon, sky_ground);
}

// The sky's light on a surface: irradiance / pi.
vec3 light_of_sky(vec3 world_normal) {
    return ambient +
           sky_share * sky_irradiance(world_normal.z, sky_zenith, sky_horizon, sky_ground);
}

// What a picture holds of a pixel: exposed radiance, and the share of it that came from around and
// not straight from a lamp. Tone curve and sRGB follow on the processor (post_pass.py).
vec4 finished(vec3 radiance, vec3 from_around) {
    float share = luminance(from_around) / max(luminance(radiance), 1e-6);
    // Half precision ends at 65504.
    return vec4(min(radiance * exposure, vec3(6e4)), min(share, 1.0));
}
