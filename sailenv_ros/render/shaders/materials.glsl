// Metallic-roughness materials; written by materials.py.
struct Material {
    vec4 base_colour;  // linear
    vec4 finish;       // roughness, metallic, alpha cutoff, emission
    ivec4 layers;      // of base colour, metallic-roughness and normal map; cut-off by level
};

layout(std430, binding = 1) readonly buffer Materials { Material materials[]; };
