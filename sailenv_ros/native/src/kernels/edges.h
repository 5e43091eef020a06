// Smooth edges of surfaces: which surfaces the fine samples of a pixel see, and the mean of their
// light.
#pragma once

#include <cstdint>
#include <vector>

#include "shade.h"

namespace sailenv {

// Memory of a thread for one band of fine samples.
struct EdgeScratch {
    std::vector<uint32_t> visible;  // as in `Scratch`, of fine samples
    std::vector<float> inverse_depth;
    std::vector<float> nearest, through;  // what glass needs; see `draw_layers`
    int64_t stride = 0;
};

// What the fine samples of a band's pixels see besides what their centres see.
struct BandEdges {
    std::vector<Fragment> fragments;  // pixel by pixel
    std::vector<uint16_t> light;      // four halves of each
};

// Numbers from row to row of fine samples. Behind the last one is room for eight, and as many
// samples as a load of the last eight pixels reads.
int64_t fine_stride(int64_t width);

// Copies what the centres of a row of pixels see from its row of fine samples.
void take_centres(const uint32_t* fine, int64_t width, uint32_t* pixels);
void take_centres(const float* fine, int64_t width, float* pixels);

// Lists what the fine samples of a band see.
void list_edges(const Shading& shading, int32_t first_row, int32_t last_row,
                const EdgeScratch& scratch, BandEdges& edges);

// Mixes their light into the radiance of the pixels.
void smooth_edges(const Shading& shading, BandEdges& edges);

}  // namespace sailenv
