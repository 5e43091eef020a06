// One drawn part; written by draw_list.py and materials.py. Shaders name what they read of it.
uniform vec4 draw[ROWS];
#define CLIP_FROM_OBJECT mat4(draw[0], draw[1], draw[2], draw[3])
#define INSTANCE_ID draw[4].x
#define CUTOFF_BY_LEVEL draw[4].yz   // fall of the alpha cut-off from level to level, where it ends
#define MATERIAL_LAYERS draw[5].xy   // of base colour and packed map
#define MATERIAL_BASE vec3(draw[4].w, draw[5].zw)  // square root of linear base colour
#define MATERIAL_COLOUR draw[6]      // the same, or that of the glow where there is one; alpha
#define MATERIAL_FINISH draw[7]      // roughness, metallic, alpha cut-off, emission
#define OPTICAL_NORMAL_FROM_OBJECT transpose(mat3(draw[8].xyz, draw[9].xyz, draw[10].xyz))
#define TO_MODEL_VERTEX draw[8].w    // from numbers of vertices to those among the model's own
#define LIGHT_CHART draw[11]         // offset and scale in the light map, 0 for none
