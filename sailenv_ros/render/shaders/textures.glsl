// What a pixel of a material is, from its factors and its textures, where it has any.
#ifdef TEXTURED
flat in ivec4 material_textures;

uniform sampler2DArray textures_0;
uniform sampler2DArray textures_1;
uniform sampler2DArray textures_2;

vec4 sampled(int which, vec2 uv) {
    vec3 at = vec3(uv, float(which & 4095));
    int size = which >> 12;
    if (size == 0) return texture(textures_0, at);
    if (size == 1) return texture(textures_1, at);
    return texture(textures_2, at);
}
#endif

vec4 base_colour(vec4 base, vec2 uv) {
#ifdef TEXTURED
    if (material_textures.x >= 0) {
        vec4 texel = sampled(material_textures.x, uv);
        vec3 c = texel.rgb;  // sRGB to linear: a cubic that is within 0.3 % of the curve
        base *= vec4(c * (c * (c * 0.305306 + 0.682171) + 0.012523), texel.a);
    }
#endif
    return base;
}

vec2 roughness_metallic(vec2 factors, vec2 uv) {
#ifdef TEXTURED
    if (material_textures.y >= 0) factors *= sampled(material_textures.y, uv).gb;
#endif
    return clamp(factors, vec2(0.045, 0.0), vec2(1.0));
}

#ifdef TEXTURED
// The tangent frame follows from how point and uv change from pixel to pixel, so meshes need none.
vec3 mapped_normal(vec2 uv, vec3 normal, vec3 point) {
    if (material_textures.z < 0) return normal;
    vec3 px = dFdx(point), py = dFdy(point);
    vec2 tx = dFdx(uv), ty = dFdy(uv);
    vec3 across_y = cross(py, normal), across_x = cross(normal, px);
    vec3 tangent = across_y * tx.x + across_x * ty.x;
    vec3 bitangent = across_y * tx.y + across_x * ty.y;
    float longest = max(dot(tangent, tangent), dot(bitangent, bitangent));
    if (longest < 1e-30) return normal;
    vec3 local = sampled(material_textures.z, uv).xyz * 2.0 - 1.0;
    float scale = inversesqrt(longest);
    // The window's rows run downwards here, which turns the sense of the derivatives' frame.
    return normalize(tangent * scale * -local.x + bitangent * scale * -local.y + normal * local.z);
}
#endif
