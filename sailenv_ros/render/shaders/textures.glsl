// What a pixel of a material is, from its factors and its textures, where it has any. Which maps
// there are is known when the program is made: a software rasteriser runs all sides of a branch.
#ifdef COLOUR_MAP
uniform sampler2DArray colour_maps;
// Mip-maps blur along a slanted surface as far as across it: half a level is given back.
const float FINER = -0.5;
#endif
#ifdef FINISH_MAP
uniform sampler2DArray finish_maps;
#endif
#ifdef NORMAL_MAP
uniform sampler2DArray normal_maps;
#endif

vec4 base_colour(vec4 base, vec2 uv) {
#ifdef COLOUR_MAP
    vec4 texel = texture(colour_maps, vec3(uv, MATERIAL_LAYERS.x), FINER);
    vec3 c = texel.rgb;  // sRGB to linear: a cubic that is within 0.3 % of the curve
    base *= vec4(c * (c * (c * 0.305306 + 0.682171) + 0.012523), texel.a);
#endif
    return base;
}

// Alpha below which there is nothing; from afar it is less (coverage.py).
float cutoff(float nearby, vec2 uv) {
#ifdef COLOUR_MAP
    vec2 falls = CUTOFF_BY_LEVEL;
    float level = max(textureQueryLod(colour_maps, uv).x + FINER, 0.0);
    return max(nearby - falls.x * level, min(nearby, falls.y));
#else
    return nearby;
#endif
}

vec2 roughness_metallic(vec2 factors, vec2 uv) {
#ifdef FINISH_MAP
    factors *= texture(finish_maps, vec3(uv, MATERIAL_LAYERS.y)).gb;
#endif
    return clamp(factors, vec2(0.045, 0.0), vec2(1.0));
}

#ifdef NORMAL_MAP
// The tangent frame follows from how point and uv change from pixel to pixel, so meshes need none.
vec3 mapped_normal(vec2 uv, vec3 normal, vec3 point) {
    vec3 px = dFdx(point), py = dFdy(point);
    vec2 tx = dFdx(uv), ty = dFdy(uv);
    vec3 across_y = cross(py, normal), across_x = cross(normal, px);
    vec3 tangent = across_y * tx.x + across_x * ty.x;
    vec3 bitangent = across_y * tx.y + across_x * ty.y;
    float longest = max(dot(tangent, tangent), dot(bitangent, bitangent));
    if (longest < 1e-30) return normal;
    vec3 local = texture(normal_maps, vec3(uv, MATERIAL_LAYERS.z)).xyz * 2.0 - 1.0;
    float scale = inversesqrt(longest);
    // The window's rows run downwards here, which turns the sense of the derivatives' frame.
    return normalize(tangent * scale * -local.x + bitangent * scale * -local.y + normal * local.z);
}
#endif
