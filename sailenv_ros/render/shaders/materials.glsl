// Metallic-roughness materials; written by materials.py.
struct Material {
    vec4 base_colour;  // linear
    vec4 finish;       // roughness, metallic, alpha cutoff, emission
    ivec4 textures;    // base colour, metallic-roughness, normal: array * 4096 + layer, or -1
};

layout(std430, binding = 1) readonly buffer Materials { Material materials[]; };
