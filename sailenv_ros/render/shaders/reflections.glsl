// What shiny surfaces mirror of a room; written by reflection_map.py.
#ifdef REFLECTIONS
uniform sampler3D reflections;     // octahedral, world frame; roughness along z
uniform vec3 reflection_from, room_low, room_high, eye;
uniform vec4 room_light;           // irradiance / pi where it was seen from: c0, cx, cy, cz; luma
uniform vec3 reflection_texel;     // share of the square without its border, layers per roughness, layers

// What lies in a direction, looked for on the walls of a box around the room (box projection).
vec3 mirrored_room(vec3 from, vec3 direction, float roughness) {
    vec3 inverse = 1.0 / (direction + vec3(1e-6));
    vec3 ends = max((room_low - from) * inverse, (room_high - from) * inverse);
    float distance = max(min(ends.x, min(ends.y, ends.z)), 0.05);
    vec3 to = from + direction * distance - reflection_from;
    vec3 n = to / (abs(to.x) + abs(to.y) + abs(to.z));
    float fold = max(-n.z, 0.0);
    n.xy -= vec2(n.x >= 0.0 ? fold : -fold, n.y >= 0.0 ? fold : -fold);
    float layer = (roughness * reflection_texel.y + 0.5) / reflection_texel.z;
    return textureLod(reflections, vec3(0.5 + 0.5 * n.xy * reflection_texel.x, layer), 0.0).rgb;
}
#endif
