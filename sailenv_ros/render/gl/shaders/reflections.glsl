// What shiny surfaces mirror of a room; written by reflection_map.py.
#ifdef REFLECTIONS
uniform sampler3D reflections;     // octahedral, world frame; roughness along z, point after point
uniform sampler2D reflection_table; // the point that each instance uses
uniform vec3 reflection_from[REFLECTION_POINTS];
uniform vec4 room_light[REFLECTION_POINTS];  // irradiance / pi there: c0, cx, cy, cz; luminance
uniform vec3 room_low, room_high;
uniform vec4 reflection_texel;     // share of the square without its border, layers per roughness,
                                   // layers of a point, of all points

int reflection_point(int id) {
    return int(texelFetch(reflection_table, ivec2(id & 255, id >> 8), 0).x + 0.5);
}

// What lies in a direction, looked for on the walls of a box around the room (box projection).
vec3 mirrored_room(int point, vec3 from, vec3 direction, float roughness) {
    vec3 inverse = 1.0 / (direction + vec3(1e-6));
    vec3 ends = max((room_low - from) * inverse, (room_high - from) * inverse);
    float distance = max(min(ends.x, min(ends.y, ends.z)), 0.05);
    vec3 to = from + direction * distance - reflection_from[point];
    vec3 n = to / (abs(to.x) + abs(to.y) + abs(to.z));
    float fold = max(-n.z, 0.0);
    n.xy += vec2(n.x >= 0.0 ? fold : -fold, n.y >= 0.0 ? fold : -fold);
    float layer = clamp(roughness * reflection_texel.y, 0.0, reflection_texel.z - 1.0);
    layer = (float(point) * reflection_texel.z + layer + 0.5) / reflection_texel.w;
    return textureLod(reflections, vec3(0.5 + 0.5 * n.xy * reflection_texel.x, layer), 0.0).rgb;
}
#endif
