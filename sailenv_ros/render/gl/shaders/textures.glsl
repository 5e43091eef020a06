// What a pixel of a material is, from its factors and its textures, where it has any. Which maps
// there are is known when the program is made: a software rasteriser runs all sides of a branch.
#ifdef COLOUR_MAP
uniform sampler2DArray colour_maps;
#endif
// Samples half a pixel apart take the levels of whole pixels.
#ifdef HALF_PIXELS
const float COARSER = 1.0;
#else
const float COARSER = 0.0;
#endif
#if defined(FINISH_MAP) || defined(NORMAL_MAP)
uniform sampler2DArray packed_maps;
#endif

// Square root of linear colour, and alpha: the roots of factor and texel multiply as these do.
vec4 base_colour(vec2 uv) {
#ifdef COLOUR_MAP
    return MATERIAL_COLOUR * texture(colour_maps, vec3(uv, MATERIAL_LAYERS.x), COARSER);
#else
    return MATERIAL_COLOUR;
#endif
}

// The same for pictures: the mean of up to four look-ups along the longer side of what the pixel
// covers (an anisotropic filter; drivers' own ones differ, and llvmpipe's may take seconds), of a
// slightly finer level: that is nearer to the mean over the pixel, as measured beside 4 x 4 samples
// a pixel. Alpha, which decides what is there, is looked up once.
vec3 picture_colour(vec2 uv) {
#ifdef COLOUR_MAP
    vec2 across = dFdx(uv) * exp2(COARSER), down = dFdy(uv) * exp2(COARSER);
    float wide = dot(across, across), high = dot(down, down);
    float longer = max(wide, high), shorter = min(wide, high);
    float ratio = sqrt(longer / max(shorter, 0.001 * longer + 1e-20));
    float count = clamp(floor(ratio + 0.5), 1.0, 4.0);
    vec2 along = (wide >= high ? across : down) / count;
    float texels = length(along) * float(textureSize(colour_maps, 0).x);
    float level = log2(max(texels, 1e-6)) - 0.25;
    vec2 at = uv + along * (0.5 - 0.5 * count);
    vec3 sum = vec3(0.0);
    for (float k = 0.0; k < count; k += 1.0) {
        sum += textureLod(colour_maps, vec3(at + k * along, MATERIAL_LAYERS.x), level).rgb;
    }
    return MATERIAL_COLOUR.rgb * sum / count;
#else
    return MATERIAL_COLOUR.rgb;
#endif
}

// Alpha below which there is nothing; from afar it is less (coverage.py).
float cutoff(float nearby, vec2 uv) {
#ifdef COLOUR_MAP
    vec2 falls = CUTOFF_BY_LEVEL;
    return max(nearby - falls.x * max(textureQueryLod(colour_maps, uv).y + COARSER, 0.0), min(nearby, falls.y));
#else
    return nearby;
#endif
}

// Normal's x and y, roughness, metallic; see packed_maps.py.
vec4 packed_map(vec2 uv) {
#if defined(FINISH_MAP) || defined(NORMAL_MAP)
    return texture(packed_maps, vec3(uv, MATERIAL_LAYERS.y), COARSER);
#else
    return vec4(0.0);
#endif
}

vec2 roughness_metallic(vec2 factors, vec4 packed_texel) {
#ifdef FINISH_MAP
    factors *= packed_texel.ba;
#endif
    return clamp(factors, vec2(0.045, 0.0), vec2(1.0));
}

#ifdef NORMAL_MAP
// The tangent frame follows from how point and uv change from pixel to pixel, so meshes need none.
vec3 mapped_normal(vec2 texel, vec2 uv, vec3 normal, vec3 point) {
    vec3 px = dFdx(point), py = dFdy(point);
    vec2 tx = dFdx(uv), ty = dFdy(uv);
    vec3 across_y = cross(py, normal), across_x = cross(normal, px);
    vec3 tangent = across_y * tx.x + across_x * ty.x;
    vec3 bitangent = across_y * tx.y + across_x * ty.y;
    float longest = max(dot(tangent, tangent), dot(bitangent, bitangent));
    if (longest < 1e-30) return normal;
    vec2 local = texel * 2.0 - 1.0;
    float upright = sqrt(max(1.0 - dot(local, local), 0.0));
    float scale = inversesqrt(longest);
    // The window's rows run downwards here, which turns the sense of the derivatives' frame.
    return normalize(tangent * scale * -local.x + bitangent * scale * -local.y + normal * upright);
}
#endif
