// Light at vertices of what can move; written by baked_textures.py.
uniform sampler2D instance_light;  // see instance_light.glsl; 1 + the first factor, or 0, beside axes
uniform sampler2D vertex_factors;

// What light on an instance is multiplied by at a vertex of its model, 0 for nothing.
float factor_of_vertex(int id, int vertex) {
    float first = texelFetch(instance_light, ivec2((id & 255) * 24 + 21, id >> 8), 0).w;
    int place = int(first) - 1 + vertex, width = textureSize(vertex_factors, 0).x;
    return first > 0.0 ? texelFetch(vertex_factors, ivec2(place % width, place / width), 0).x : 0.0;
}
