// One row per drawn part; written by draw_list.py, read by every geometry program.
struct Draw {
    mat4 clip_from_object;
    vec4 optical_normal_from_object[3];  // rows; w unused
    float instance_id;
    uint material;
    float unused_0, unused_1;
    vec4 light_chart;                    // offset and scale in the light map, 0 for none
};

layout(std430, binding = 0) readonly buffer Draws { Draw draws[]; };
