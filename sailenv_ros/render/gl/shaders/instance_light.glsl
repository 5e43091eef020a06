// Light around instances that have no place in the light map; written by baked_textures.py.
#ifdef BAKED
uniform sampler2D instance_light;  // 28 terms each of red, green and blue, see light_law.h; axes
uniform vec3 eye;

// Irradiance / pi on a surface of an instance, in the world frame.
vec3 light_of_instance(int id, vec3 normal, vec3 point) {
    ivec2 first = ivec2((id & 255) * 24, id >> 8);
    vec3 along;
    for (int k = 0; k < 3; k++) {
        along[k] = dot(texelFetch(instance_light, first + ivec2(21 + k, 0), 0).xyz, normal);
    }
    vec3 front = along * max(along, vec3(0.0)), back = along * min(along, vec3(0.0));
    vec3 found;
    for (int colour = 0; colour < 3; colour++) {
        float terms[28];
        for (int part = 0; part < 7; part++) {
            vec4 four = texelFetch(instance_light, first + ivec2(7 * colour + part, 0), 0);
            for (int k = 0; k < 4; k++) terms[4 * part + k] = four[k];
        }
        found[colour] = max(irradiance_of_terms(terms, normal, front, back, point), 0.0);
    }
    return found;
}
#endif
